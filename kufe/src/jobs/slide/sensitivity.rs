//! Sensitivity of friction to hardness, speed, temperature, viscosity and boundary contact.

use kufe_contact::{Measure, Options};
use kufe_sled::friction::film::{BoundaryContact, FilmConditions, HARDNESS_EXPONENT};

use crate::jobs::failure::Failure;
use crate::jobs::slide::ploughing::{Hardness, HardnessFrom, Ploughing, SolvedGroove};
use crate::jobs::slide::sliding::{FilmAlong, conditions, film_along, film_failure, film_on};
use crate::results::{Friction, SensitivityResult};

/// Step of ln H of the central difference: so wide that the scatter between meshes is a small part
/// of the difference, so narrow that the error by the third derivative is small too.
const HARDNESS_STEP: f64 = 0.223;
/// Smallest relative tolerance of the two grooves of the difference.
const MIN_TOLERANCE: f64 = 0.03;
/// Step of the logarithm of speed, viscosity, roughness and shear stress.
const STEP: f64 = 0.01;
/// Step of the temperature [K].
const TEMPERATURE_STEP: f64 = 0.05;

impl Ploughing<'_> {
    /// Elasticities d ln mu/d ln x of the coefficient of friction with respect to its parameters;
    /// for the temperature d ln mu/dT [1/K].
    ///
    /// The elasticities of speed and temperature are total derivatives: they include the change of
    /// the hardness where a law states it. A hardness that the case states is fixed, and a hardness
    /// at the melting pressure follows that pressure. The elastic constants of the ice are fixed.
    ///
    /// ```text
    /// e_V = d ln mu/d ln V at one hardness + e_H d ln H/d ln V,    e_T = d ln mu/dT at one hardness + e_H d ln H/dT
    /// law of creep: t = l/V with l ~ H^a, so that d ln H/d ln V = (1/3)/(1 + a/3) and d ln H/dT = (d ln H/dT at fixed t)/(1 + a/3)
    /// ```
    ///
    /// Central differences: for the hardness between grooves in ice harder and softer by a quarter,
    /// for the other parameters between films on the same groove.
    ///
    /// # Errors
    /// As [`at`](Self::at) and [`film_along`].
    pub fn sensitivity(
        &self,
        groove: &SolvedGroove,
        along: &FilmAlong,
        options: &Options,
    ) -> Result<SensitivityResult, Failure> {
        let base = conditions(self.sliding);
        let mu = Friction::of(&groove.solution, along).mu;
        let side = Options {
            p_max_tolerance: options.p_max_tolerance.max(MIN_TOLERANCE),
            ..options.clone()
        };
        let harder = |step: f64| {
            let (solution, _) = self.at(groove.hardness.value * step.exp(), &side)?;
            let along = film_along(self.loaded, &solution, &base)?;
            let length = solution.groove.front.value - solution.groove.back.value;
            Ok::<_, Failure>((Friction::of(&solution, &along).mu, length))
        };
        // Side by side: each is too small for two processors.
        let (harder, softer) = rayon::join(|| harder(HARDNESS_STEP), || harder(-HARDNESS_STEP));
        let ((above, long), (below, short)) = (harder?, softer?);
        let width = 2.0 * HARDNESS_STEP;
        let hardness = Measure {
            value: (above.value / below.value).ln() / width,
            error: (above.error / above.value).hypot(below.error / below.value) / width,
        };
        let length_exponent = (long / short).ln() / width;
        let film = |change: &dyn Fn(&mut FilmConditions, f64), step: f64| {
            let side = |sign: f64| -> Result<f64, Failure> {
                let mut conditions = base;
                change(&mut conditions, sign * step);
                let (contact, groove) = (&groove.solution.contact, &groove.solution.groove);
                let film = film_on(&groove.sections, contact.fz, &conditions);
                let film = film.map_err(film_failure(self.loaded))?;
                Ok(film.totals.friction)
            };
            Ok::<_, Failure>((side(1.0)? - side(-1.0)?) / (2.0 * step * mu.value))
        };
        let speed = film(&|c, step| c.v *= step.exp(), STEP)?;
        let viscosity = film(&|c, step| c.viscosity_factor *= step.exp(), STEP)?;
        let boundary = match base.boundary {
            BoundaryContact { roughness, shear } if roughness > 0.0 && shear > 0.0 => Some([
                film(&|c, step| c.boundary.roughness *= step.exp(), STEP)?,
                film(&|c, step| c.boundary.shear *= step.exp(), STEP)?,
            ]),
            _ => None,
        };
        let warmer = |c: &mut FilmConditions, step: f64| {
            c.ice_c += step;
            c.steel_c += step;
        };
        let temperature = film(&warmer, TEMPERATURE_STEP)?;
        let [by_speed, by_temperature] = self.hardness_slopes(&groove.hardness, length_exponent)?;
        // The films are on the same groove: their difference has the relative error of mu.
        let relative_error = mu.error / mu.value;
        let total = |fixed: f64, hardness_slope: f64| Measure {
            value: fixed + hardness_slope * hardness.value,
            error: relative_error * fixed.abs() + hardness_slope.abs() * hardness.error,
        };
        let boundary = boundary.map(|both| both.map(|value| total(value, 0.0)));
        Ok(SensitivityResult {
            hardness: hardness.into(),
            speed: total(speed, by_speed).into(),
            viscosity: total(viscosity, 0.0).into(),
            roughness: boundary.map(|[roughness, _]| roughness.into()),
            boundary_shear: boundary.map(|[_, shear]| shear.into()),
            temperature: total(temperature, by_temperature).into(),
        })
    }

    /// d ln H/d ln V, and d ln H/dT [1/K]. The patch's length is proportional to the hardness to
    /// the power `length_exponent`.
    fn hardness_slopes(
        &self,
        hardness: &Hardness,
        length_exponent: f64,
    ) -> Result<[f64; 2], Failure> {
        let exponent = match hardness.from {
            HardnessFrom::TimeLaw => 1.0 / HARDNESS_EXPONENT,
            _ => 0.0,
        };
        let feedback = 1.0 + exponent * length_exponent;
        let log_hardness = |step: f64| {
            let ice_c = self.sliding.ice_c + step;
            let hardness = self.law.at(ice_c, hardness.contact_time.value);
            let (pressure, _) = hardness.map_err(film_failure(self.loaded))?;
            Ok::<_, Failure>(pressure.ln())
        };
        let difference = log_hardness(TEMPERATURE_STEP)? - log_hardness(-TEMPERATURE_STEP)?;
        let at_fixed_time = difference / (2.0 * TEMPERATURE_STEP);
        Ok([exponent / feedback, at_fixed_time / feedback])
    }
}
