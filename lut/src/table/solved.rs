//! A point of a table and the figures of the contact solved there.

use crate::table::quantity::Quantity;

/// The figures of one solved contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Solved {
    /// Peak pressure [Pa].
    pub p_max: f64,
    /// Estimated discretisation error of the peak pressure [Pa].
    pub p_max_error: f64,
    /// Force over contact area [Pa].
    pub p_mean: f64,
    /// Contact area [m2].
    pub area: f64,
    /// Extent of the contact along the runner [m].
    pub length: f64,
    /// Extent of the contact across the runner [m].
    pub width: f64,
    /// Rigid approach [m].
    pub approach: f64,
}

impl Solved {
    /// How many figures there are.
    pub const COUNT: usize = 7;

    /// Keys of [`to_array`](Self::to_array).
    pub const KEYS: [&'static str; Self::COUNT] = [
        "p_max_pa",
        "p_max_error_pa",
        "p_mean_pa",
        "area_m2",
        "length_m",
        "width_m",
        "approach_m",
    ];

    /// One figure.
    pub fn get(&self, quantity: Quantity) -> f64 {
        match quantity {
            Quantity::PMax => self.p_max,
            Quantity::PMean => self.p_mean,
            Quantity::Area => self.area,
            Quantity::Length => self.length,
            Quantity::Width => self.width,
            Quantity::Approach => self.approach,
        }
    }

    /// All figures in the order of [`KEYS`](Self::KEYS).
    pub fn to_array(&self) -> [f64; Self::COUNT] {
        [
            self.p_max,
            self.p_max_error,
            self.p_mean,
            self.area,
            self.length,
            self.width,
            self.approach,
        ]
    }

    /// The inverse of [`to_array`](Self::to_array).
    pub fn from_array(figures: [f64; Self::COUNT]) -> Self {
        let [p_max, p_max_error, p_mean, area, length, width, approach] = figures;
        Solved {
            p_max,
            p_max_error,
            p_mean,
            area,
            length,
            width,
            approach,
        }
    }
}

/// Where a contact is solved.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Normal force [N].
    pub fz: f64,
    /// Track curvature in the vertical plane, positive in a valley [1/m].
    pub curvature: f64,
    /// Rocker radius of the runner where the table has that axis [m].
    pub rocker_radius: Option<f64>,
}

impl std::fmt::Display for Point {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "fz_n = {}, curvature_1pm = {}", self.fz, self.curvature)?;
        match self.rocker_radius {
            Some(radius) => write!(f, ", rocker_radius_m = {radius}"),
            None => Ok(()),
        }
    }
}
