//! The load and what may tilt under it.

/// The load on the runner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// The normal force is given.
    Force {
        /// Normal force [N].
        fz: f64,
        /// Line of action along the runner, from the origin [m].
        offset_x: f64,
        /// Line of action across the runner, from the origin [m].
        offset_y: f64,
        /// Whether pitch and roll follow from moment balance.
        tilt: Tilt,
    },
    /// The approach is given and the force follows.
    Approach {
        /// Rigid approach of runner and far ice, measured at the origin from first touch [m].
        approach: f64,
        /// Fixed pitch about y, positive lowers the nose [rad].
        pitch: f64,
        /// Fixed roll about x [rad].
        roll: f64,
    },
}

impl Load {
    /// A normal force [N] through the origin.
    pub fn central(fz: f64, tilt: Tilt) -> Self {
        Load::Force {
            fz,
            offset_x: 0.0,
            offset_y: 0.0,
            tilt,
        }
    }
}

/// Whether the runner may turn about its line of action.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Tilt {
    /// Pitch and roll settle where the moments balance.
    Free,
    /// Pitch and roll are held.
    Fixed {
        /// Pitch about y, positive lowers the nose [rad].
        pitch: f64,
        /// Roll about x [rad].
        roll: f64,
    },
}

impl Tilt {
    /// Held as the hull is drawn.
    pub const LEVEL: Tilt = Tilt::Fixed {
        pitch: 0.0,
        roll: 0.0,
    };
}
