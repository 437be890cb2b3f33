//! The coefficient of friction and its parts.

use kufe_contact::{Measure, SlidingSolution};

use crate::jobs::slide::film::FilmAlong;

/// The coefficient of friction and its parts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// Both together.
    pub mu: Measure,
    /// Force that ploughs the groove over the load.
    pub ploughing: Measure,
    /// Drag of the melt film over the load.
    pub viscous: Measure,
}

impl Friction {
    /// Of a solution and the film on it.
    ///
    /// The film's error has that of the patch in it, whose share is taken as the groove's.
    pub fn of(solution: &SlidingSolution, along: &FilmAlong) -> Self {
        let fz = solution.contact.fz;
        let depth = solution.groove.deepest;
        let patch = if depth.value > 0.0 {
            depth.error / depth.value
        } else {
            solution.contact.p_max_error / solution.contact.p_max
        };
        let totals = &along.film.totals;
        let viscous = Measure {
            value: totals.friction,
            error: along.friction_error() + patch * totals.friction,
        };
        let ploughing = Measure {
            value: solution.groove.ploughing.value / fz,
            error: solution.groove.ploughing.error / fz,
        };
        Friction {
            mu: Measure {
                value: ploughing.value + viscous.value,
                error: ploughing.error + viscous.error,
            },
            ploughing,
            viscous,
        }
    }
}
