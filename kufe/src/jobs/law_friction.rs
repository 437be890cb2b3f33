//! Friction of one runner under one load by a model's law, evaluated at the peak contact pressure.

use std::path::Path;
use std::time::Instant;

use kufe_sled::effects::{Effects, Kind, OperatingPoint};
use kufe_sled::friction::film::Patch;
use kufe_sled::friction::{Longitudinal, longitudinal_force};
use kufe_sled::{Conditions, Model};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::{Failure, Located};
use crate::jobs::press::Contact;
use crate::jobs::watch::Watch;
use crate::results::FrictionByLaw;

/// A law of friction as a function of pressure, with the effects on it.
#[derive(Clone, Debug)]
pub struct FrictionLaw {
    law: Longitudinal,
    effects: Effects,
    /// Drag area of the sled [m2]; NaN without a sled.
    drag_area: f64,
}

/// Speed and slip angle of a runner, and the ice and air around it. Conditions that are not stated
/// are NaN; only effects that depend on them need them.
#[derive(Clone, Copy, Debug)]
pub struct DrivingConditions {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Slip angle [rad].
    pub alpha_rad: f64,
    /// Ice and air.
    pub environment: Conditions,
}

impl DrivingConditions {
    /// Checks the ranges of speed and slip angle.
    fn check(&self) -> Result<(), Failure> {
        let quarter = std::f64::consts::FRAC_PI_2;
        let angle = "a slip angle in rad within a quarter turn";
        for (option, value, range, expected) in [
            ("v-mps", self.v_mps, 0.0..=100.0, "0 to 100 m/s"),
            ("alpha-rad", self.alpha_rad, -quarter..=quarter, angle),
        ] {
            if !range.contains(&value) {
                return Err(Failure::option(option, value, expected));
            }
        }
        Ok(())
    }
}

impl FrictionLaw {
    /// The published law without effects.
    pub fn published() -> FrictionLaw {
        FrictionLaw {
            law: Longitudinal::PUBLISHED,
            effects: Effects::default(),
            drag_area: f64::NAN,
        }
    }

    /// `[friction.longitudinal]` and `[effects]` of a model file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place.
    pub fn of_model(path: &Path) -> Result<FrictionLaw, Failure> {
        let model = Model::load(path)?;
        Ok(FrictionLaw {
            law: model.friction.longitudinal.model().in_file(path)?,
            effects: Effects::from_tables(&model.effects).in_file(path)?,
            drag_area: model.sled.cda_m2,
        })
    }

    /// Solves a case and evaluates the law at its peak pressure.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a condition out of range or one that an effect needs and that is not
    /// stated, [`Failure::BadInput`] for the case, [`Failure::NotConverged`] if the solver stops
    /// short.
    pub fn solve(
        &self,
        loaded: &LoadedCase,
        conditions: &DrivingConditions,
        watch: &Watch,
    ) -> Result<FrictionByLaw, Failure> {
        conditions.check()?;
        watch.progress("solving the contact");
        loaded.at_rest()?;
        let started = Instant::now();
        let mut solved = Contact::from(loaded.clone()).best(watch)?;
        loaded.fine_enough(solved.hull.as_ref(), &solved.solution)?;
        let short = solved.short.take();
        let (solution, peak) = (&solved.solution, solved.peak());
        // An error due to the hull's scan is reported; only a discretisation error above the
        // tolerance is a failure.
        let is_coarse = solution.p_max_error > loaded.case.accuracy.p_max * solution.p_max;
        if let Some(short) = short.filter(|_| is_coarse) {
            return Err(short);
        }
        let point = OperatingPoint {
            t: 0.0,
            s: 0.0,
            v: conditions.v_mps,
            fz: solution.fz,
            conditions: Conditions {
                distance_m: 0.0,
                ..conditions.environment
            },
            air_density: conditions.environment.air_density(),
            drag_area: self.drag_area,
            film: f64::NAN,
            patch: Patch::UNKNOWN,
        };
        let (p_max, mu_base) = (solution.p_max, self.law.mu(solution.p_max));
        let (mu, effects, effects_not_concerned) = self.with_effects(mu_base, &point)?;
        let (depends_on_pressure, capped, mu_error) = match self.law {
            Longitudinal::Pressure(law) => (
                true,
                law.uncapped(p_max) > law.mu_cap,
                law.slope(p_max).abs() * peak.error,
            ),
            Longitudinal::Fixed(_) => (false, false, 0.0),
        };
        let alpha_rad = conditions.alpha_rad;
        let fx_n = longitudinal_force(solution.fz, alpha_rad, mu);
        Ok(FrictionByLaw {
            p_max: peak,
            fz_n: solution.fz,
            mu,
            mu_base,
            mu_error,
            depends_on_pressure,
            capped,
            alpha_rad,
            fx_n,
            v_mps: point.v,
            power_w: fx_n * point.v,
            effects,
            effects_not_concerned,
            seconds: started.elapsed().as_secs_f64(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        })
    }

    /// The coefficient after every effect on it, the names of these effects, and the names of the
    /// model's other effects.
    fn with_effects(
        &self,
        mut mu: f64,
        point: &OperatingPoint,
    ) -> Result<(f64, Vec<String>, Vec<String>), Failure> {
        let (mut applied, mut ignored) = (Vec::new(), Vec::new());
        for active in &self.effects.active {
            let Some(changed) = active.coefficient(mu, point) else {
                ignored.push(active.name.clone());
                continue;
            };
            let needed = match &active.kind {
                Kind::Custom(formula) if changed.is_nan() => {
                    let names = formula.names().join(", ");
                    let why = "a condition is not given, or belongs to a run";
                    Some(format!("{names}: {why}"))
                }
                _ => {
                    let columns = active.columns();
                    let mut missing = columns.iter().filter_map(|c| missing(c, &point.conditions));
                    let air = changed.is_nan().then_some("--air-c and --air-pa");
                    missing.next().or(air).map(str::to_owned)
                }
            };
            if let Some(what) = needed {
                let name = &active.name;
                let text = format!("the model's effect {name} needs {what}");
                return Err(Failure::Usage(text));
            }
            mu = changed;
            applied.push(active.name.clone());
        }
        Ok((mu, applied, ignored))
    }
}

/// The option or source that provides `column`, if the conditions do not state it.
fn missing(column: &str, stated: &Conditions) -> Option<&'static str> {
    let (source, value) = match column {
        "ice_c" => ("--ice-c", stated.ice_c),
        "air_c" => ("--air-c", stated.air_c),
        "air_pa" => ("--air-pa", stated.air_pa),
        "humidity_pct" => ("--humidity-pct", stated.humidity_pct),
        "film" => ("the tables of a sled's runners", f64::NAN),
        "contact_length_m" => ("the contact of a friction experiment", f64::NAN),
        _ => return None,
    };
    value.is_nan().then_some(source)
}
