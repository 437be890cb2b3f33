//! Friction of one runner under one load: the peak pressure of its contact in the law of a model.

use std::path::Path;
use std::time::Instant;

use kufe_contact::solve;
use kufe_sled::effects::{Effects, Kind, OperatingPoint};
use kufe_sled::friction::film::Patch;
use kufe_sled::friction::{Longitudinal, longitudinal_force};
use kufe_sled::{Conditions, Model};

use crate::case::StatedProblem;
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::watch::Watch;
use crate::results::{FrictionByLaw, Measured};

/// A law of friction over pressure with the effects on it.
#[derive(Clone, Debug)]
pub struct FrictionLaw {
    law: Longitudinal,
    effects: Effects,
    /// Drag area of the sled [m2]; not a number without a sled.
    drag_area: f64,
}

/// How a runner is driven, and the air and ice around it. Conditions that are not stated are needed
/// only by effects on them.
#[derive(Clone, Copy, Debug)]
pub struct DrivingConditions {
    /// Speed [m/s].
    pub v_mps: f64,
    /// Slip angle [rad].
    pub alpha_rad: f64,
    /// Ice and air.
    pub conditions: Conditions,
}

impl DrivingConditions {
    /// Checks the ranges of speed and slip angle.
    fn check(&self) -> Result<(), Failure> {
        let quarter = std::f64::consts::FRAC_PI_2;
        let text = if !(0.0..=100.0).contains(&self.v_mps) {
            format!("--v-mps {}: expected 0 to 100 m/s", self.v_mps)
        } else if !(-quarter..=quarter).contains(&self.alpha_rad) {
            let found = self.alpha_rad;
            format!("--alpha-rad {found}: expected a slip angle in rad within a quarter turn")
        } else {
            return Ok(());
        };
        Err(Failure::Usage(text))
    }

    /// The same under a normal force [N], with the drag area of the sled [m2].
    fn operating_point(&self, fz: f64, drag_area: f64) -> OperatingPoint {
        OperatingPoint {
            t: 0.0,
            s: 0.0,
            v: self.v_mps,
            fz,
            conditions: Conditions {
                distance_m: 0.0,
                ..self.conditions
            },
            air_density: self.conditions.air_density(),
            drag_area,
            film: f64::NAN,
            patch: Patch::UNKNOWN,
        }
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
        let law = model.friction.longitudinal.model();
        let effects = Effects::from_tables(&model.effects);
        Ok(FrictionLaw {
            law: law.map_err(|error| Failure::in_file(path, error))?,
            effects: effects.map_err(|error| Failure::in_file(path, error))?,
            drag_area: model.sled.cda_m2,
        })
    }

    /// Solves a case and evaluates the law at its peak pressure.
    ///
    /// # Errors
    /// [`Failure::Usage`] for a condition out of range, and for one that an effect needs and that
    /// is not stated, [`Failure::BadInput`] for the case, [`Failure::NotConverged`] where the
    /// solver stops short.
    pub fn solve(
        &self,
        loaded: &LoadedCase,
        conditions: &DrivingConditions,
        watch: &Watch,
    ) -> Result<FrictionByLaw, Failure> {
        conditions.check()?;
        watch.progress("solving the contact");
        let StatedProblem { problem, hull } = loaded.stated()?;
        let started = Instant::now();
        let solution =
            solve(&problem, &loaded.case.options()).map_err(|error| loaded.failure(&error))?;
        loaded.fine_enough(hull.as_ref(), &solution)?;
        loaded.hull_warnings(hull.as_ref(), watch);
        let at = conditions.operating_point(solution.fz, self.drag_area);
        let (p_max, mu_base) = (solution.p_max, self.law.mu(solution.p_max));
        let (mu, effects, effects_not_concerned) = self.with_effects(mu_base, &at)?;
        let (depends_on_pressure, capped, mu_error) = match self.law {
            Longitudinal::Pressure(law) => (
                true,
                law.uncapped(p_max) > law.mu_cap,
                law.slope(p_max).abs() * solution.p_max_error,
            ),
            Longitudinal::Fixed(_) => (false, false, 0.0),
        };
        let alpha_rad = conditions.alpha_rad;
        let fx_n = longitudinal_force(solution.fz, alpha_rad, mu);
        Ok(FrictionByLaw {
            p_max: Measured::new(p_max, solution.p_max_error),
            fz_n: solution.fz,
            mu,
            mu_base,
            mu_error,
            depends_on_pressure,
            capped,
            alpha_rad,
            fx_n,
            v_mps: at.v,
            power_w: fx_n * at.v,
            effects,
            effects_not_concerned,
            seconds: started.elapsed().as_secs_f64(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
        })
    }

    /// The coefficient after every effect on it, the names of those, and of the model's others.
    fn with_effects(
        &self,
        mut mu: f64,
        at: &OperatingPoint,
    ) -> Result<(f64, Vec<String>, Vec<String>), Failure> {
        let (mut applied, mut ignored) = (Vec::new(), Vec::new());
        for active in &self.effects.active {
            let Some(with) = active.coefficient(mu, at) else {
                ignored.push(active.name.clone());
                continue;
            };
            let needs = |what: &str| {
                let name = &active.name;
                let text = format!("the model's effect {name} needs {what}");
                Err(Failure::Usage(text))
            };
            if let Kind::Custom(own) = &active.kind
                && with.is_nan()
            {
                let names = own.names().join(", ");
                return needs(&format!(
                    "{names}: a condition is not given, or belongs to a run"
                ));
            }
            let stated = &at.conditions;
            let missing = active
                .columns()
                .into_iter()
                .find_map(|column| match column {
                    "ice_c" => stated.ice_c.is_nan().then_some("--ice-c"),
                    "air_c" => stated.air_c.is_nan().then_some("--air-c"),
                    "air_pa" => stated.air_pa.is_nan().then_some("--air-pa"),
                    "humidity_pct" => stated.humidity_pct.is_nan().then_some("--humidity-pct"),
                    "film" => Some("the tables of a sled's runners"),
                    "contact_length_m" => Some("the contact of a friction experiment"),
                    _ => None,
                });
            if let Some(missing) = missing {
                return needs(missing);
            }
            mu = with;
            if mu.is_nan() {
                return needs("--air-c and --air-pa");
            }
            applied.push(active.name.clone());
        }
        Ok((mu, applied, ignored))
    }
}
