//! Ice, air, runners and crew of a run.

use crate::friction::air_density;

/// Ice, air, runners and crew of a run; NaN for a quantity that is not stated.
#[derive(Clone, Copy, Debug)]
pub struct Conditions {
    /// Ice temperature [degrees Celsius].
    pub ice_c: f64,
    /// Air temperature [degrees Celsius].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Relative humidity [%].
    pub humidity_pct: f64,
    /// Distance run on this finish of the runners before the run [m].
    pub distance_m: f64,
    /// Mass of the sled with its crew [kg]; NaN for the mass of the model.
    pub mass_kg: f64,
}

/// Name, smallest and largest value of each quantity of [`Conditions`].
pub const CONDITIONS: [(&str, f64, f64); 6] = [
    ("ice_c", -60.0, 5.0),
    ("air_c", -60.0, 50.0),
    ("air_pa", 50e3, 110e3),
    ("humidity_pct", 0.0, 100.0),
    ("distance_m", 0.0, 1e8),
    ("mass_kg", 1.0, 1e5),
];

impl Conditions {
    /// Conditions without any stated quantity.
    pub const UNSTATED: Conditions = Conditions::from_values([f64::NAN; 6]);

    /// From values in the order of [`CONDITIONS`].
    pub const fn from_values(values: [f64; 6]) -> Conditions {
        let [ice_c, air_c, air_pa, humidity_pct, distance_m, mass_kg] = values;
        Conditions {
            ice_c,
            air_c,
            air_pa,
            humidity_pct,
            distance_m,
            mass_kg,
        }
    }

    /// Values in the order of [`CONDITIONS`].
    pub const fn values(&self) -> [f64; 6] {
        [
            self.ice_c,
            self.air_c,
            self.air_pa,
            self.humidity_pct,
            self.distance_m,
            self.mass_kg,
        ]
    }

    /// Names of the quantities that are not stated.
    pub fn absent(&self) -> Vec<&'static str> {
        let named = CONDITIONS.iter().zip(self.values());
        let absent = named.filter(|(_, value)| !value.is_finite());
        absent.map(|((name, ..), _)| *name).collect()
    }

    /// Density of the air [kg/m3] by [`air_density`]; NaN if the weather is not stated.
    pub fn air_density(&self) -> f64 {
        air_density(self.air_pa, self.air_c)
    }
}

impl Default for Conditions {
    fn default() -> Self {
        Conditions::UNSTATED
    }
}

/// Equal where the same quantities are stated with the same values.
impl PartialEq for Conditions {
    fn eq(&self, other: &Self) -> bool {
        let mut pairs = self.values().into_iter().zip(other.values());
        pairs.all(|(a, b)| a == b || a.is_nan() && b.is_nan())
    }
}
