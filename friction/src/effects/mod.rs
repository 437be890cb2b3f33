//! Effects that can be switched on in the friction coefficient.
//!
//! An effect turns the coefficient that the base law gives into another one, mu' = effect(mu, conditions, parameters).
//! Every amplitude is 0 when the effect is off, so that leaving an effect out and setting it to zero are the same.
//!
//! | type | what it is |
//! |---|---|
//! | [`Effect`] | one effect: what it is called, what it needs, what it does |
//! | [`Info`] | name, level, parameters with units and bounds, columns |
//! | [`Conditions`] | what a friction coefficient may depend on |
//! | [`CATALOGUE`] | all effects of this crate |

mod air_density;
mod asperities;
mod conditions;
mod drag_area;
mod expression;
mod headwind;
mod humidity;
mod info;
mod load;
mod plowing;
mod slope;
mod speed;
mod temperature;
mod warm_up;
mod wear;

pub use conditions::Conditions;
pub use expression::{Expression, ExpressionError};
pub use info::{Column, Info, Level, Parameter};

/// A switchable part of the friction coefficient.
pub trait Effect: Sync {
    /// Name, parameters and what the effect needs.
    fn info(&self) -> &'static Info;
    /// The coefficient with the effect, from the coefficient without it.
    ///
    /// `parameters` are in the order of [`Info::parameters`].
    fn coefficient(&self, parameters: &[f64], mu: f64, at: &Conditions) -> f64;
}

/// All effects on the friction coefficient; a new one is a file and a line here.
pub static CATALOGUE: &[&dyn Effect] = &[
    &temperature::Temperature,
    &speed::Speed,
    &load::Load,
    &plowing::Plowing,
    &asperities::Asperities,
    &humidity::Humidity,
    &wear::Wear,
    &warm_up::WarmUp,
    &drag_area::DragArea,
    &headwind::Headwind,
    &air_density::AirDensity,
    &slope::Slope,
];

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static dyn Effect> {
    CATALOGUE
        .iter()
        .copied()
        .find(|effect| effect.info().name == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_effect_is_off_at_its_default_parameters() {
        let at = Conditions {
            t: 10.0,
            s: 120.0,
            v: 27.0,
            fz: 1800.0,
            ice_c: -9.0,
            air_c: 2.0,
            air_pa: 94_000.0,
            humidity_pct: 60.0,
            distance: 900.0,
            air_density: 1.2,
            drag_area: 0.25,
        };
        for effect in CATALOGUE {
            let off: Vec<f64> = effect.info().parameters.iter().map(|p| p.default).collect();
            assert_eq!(
                effect.coefficient(&off, 0.004, &at),
                0.004,
                "{}",
                effect.info().name
            );
        }
    }

    #[test]
    fn every_effect_acts_at_its_typical_size() {
        let at = Conditions {
            t: 3.0,
            s: 20.0,
            v: 21.0,
            fz: 1300.0,
            ice_c: -9.0,
            air_c: 2.0,
            air_pa: 94_000.0,
            humidity_pct: 60.0,
            distance: 900.0,
            air_density: 1.2,
            drag_area: 0.25,
        };
        for effect in CATALOGUE {
            let on: Vec<f64> = effect
                .info()
                .parameters
                .iter()
                .map(|p| p.default + p.typical)
                .collect();
            let mu = effect.coefficient(&on, 0.004, &at);
            assert!(
                mu.is_finite() && (mu - 0.004).abs() > 1e-7,
                "{}: {mu}",
                effect.info().name
            );
        }
    }

    #[test]
    fn names_are_unique_and_found() {
        for effect in CATALOGUE {
            let name = effect.info().name;
            assert_eq!(find(name).unwrap().info().name, name);
        }
        assert!(find("no-such-effect").is_none());
    }
}
