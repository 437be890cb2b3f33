//! How friction changes with hardness, speed, temperature, viscosity and boundary contact.

use kufe_contact::{Measure, Options};
use kufe_sled::friction::film::{BoundaryContact, FilmConditions, HARDNESS_EXPONENT};

use crate::jobs::failure::Failure;
use crate::jobs::slide::ploughing::{Hardness, HardnessFrom, Ploughing, SolvedGroove};
use crate::jobs::slide::sliding::{FilmAlong, conditions, film_along, film_failure, film_on};
use crate::results::{Friction, SensitivityResult};

/// Logarithm of the ratio of hardnesses to either side: so wide that the scatter of two meshes is a
/// small part of the difference, so narrow that the third derivative is.
const HARDNESS_STEP: f64 = 0.223;
/// Least accuracy requested of the two grooves.
const SIDE_ACCURACY: f64 = 0.03;
/// Logarithm of the ratio of speeds, of viscosities, of roughnesses and of shear stresses.
const STEP: f64 = 0.01;
/// Difference of temperatures [K].
const TEMPERATURE_STEP: f64 = 0.05;

impl Ploughing<'_> {
    /// Relative change of the coefficient of friction over that of what it depends on: elasticities
    /// d ln mu/d ln x, of the temperature d ln mu/dT [1/K].
    ///
    /// Those of speed and temperature are what a change of the weather or of the speed makes: where
    /// a law states the hardness, it follows. Where the hardness is the melting pressure or a
    /// case's own, that is what it stays. The ice's elasticity is fixed.
    ///
    /// ```text
    /// e_V = d ln mu/d ln V at one hardness + e_H d ln H/d ln V,    e_T = d ln mu/dT at one hardness + e_H d ln H/dT
    /// law of creep: t = l/V with l ~ H^a, so that d ln H/d ln V = (1/3)/(1 + a/3) and d ln H/dT is that at one time over 1 + a/3
    /// ```
    ///
    /// Central differences: of grooves in ice harder and softer by a quarter, of films on one
    /// groove.
    ///
    /// # Errors
    /// As [`at`](Self::at) and [`film_along`].
    pub fn sensitivity(
        &self,
        groove: &SolvedGroove,
        along: &FilmAlong,
        options: &Options,
    ) -> Result<SensitivityResult, Failure> {
        let own = conditions(self.sliding);
        let mu = Friction::of(&groove.solution, along).mu;
        let side = Options {
            p_max_tolerance: options.p_max_tolerance.max(SIDE_ACCURACY),
            ..options.clone()
        };
        let harder = |step: f64| {
            let (solution, _) = self.at(groove.hardness.value * step.exp(), &side)?;
            let along = film_along(self.loaded, &solution, &own)?;
            let length = solution.groove.front.value - solution.groove.back.value;
            Ok::<_, Failure>((Friction::of(&solution, &along).mu, length))
        };
        // Side by side: each is too small for two processors.
        let (harder, softer) = rayon::join(|| harder(HARDNESS_STEP), || harder(-HARDNESS_STEP));
        let ((above, long), (below, short)) = (harder?, softer?);
        let over = 2.0 * HARDNESS_STEP;
        let hardness = Measure {
            value: (above.value / below.value).ln() / over,
            error: (above.error / above.value).hypot(below.error / below.value) / over,
        };
        let stretch = (long / short).ln() / over;
        let film = |change: &dyn Fn(&mut FilmConditions, f64), step: f64| {
            let side = |sign: f64| -> Result<f64, Failure> {
                let mut conditions = own;
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
        let boundary = match own.boundary {
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
        let [by_speed, by_temperature] = self.hardness_slopes(&groove.hardness, stretch)?;
        // The films are on one groove: the relative error of the friction holds for the
        // differences.
        let share = mu.error / mu.value;
        let with = |fixed: f64, by: f64| Measure {
            value: fixed + by * hardness.value,
            error: share * fixed.abs() + by.abs() * hardness.error,
        };
        let boundary = boundary.map(|both| both.map(|value| with(value, 0.0)));
        Ok(SensitivityResult {
            hardness: hardness.into(),
            speed: with(speed, by_speed).into(),
            viscosity: with(viscosity, 0.0).into(),
            roughness: boundary.map(|[roughness, _]| roughness.into()),
            boundary_shear: boundary.map(|[_, shear]| shear.into()),
            temperature: with(temperature, by_temperature).into(),
        })
    }

    /// d ln H/d ln V, and d ln H/dT [1/K], where the patch's length goes as the hardness to the
    /// power `stretch`.
    fn hardness_slopes(&self, hardness: &Hardness, stretch: f64) -> Result<[f64; 2], Failure> {
        let exponent = match hardness.from {
            HardnessFrom::TimeLaw => 1.0 / HARDNESS_EXPONENT,
            _ => 0.0,
        };
        let fed_back = 1.0 + exponent * stretch;
        let at = |step: f64| {
            let ice_c = self.sliding.ice_c + step;
            let found = self.law.at(ice_c, hardness.contact_time.value);
            let (pressure, _) = found.map_err(film_failure(self.loaded))?;
            Ok::<_, Failure>(pressure.ln())
        };
        let warmer = (at(TEMPERATURE_STEP)? - at(-TEMPERATURE_STEP)?) / (2.0 * TEMPERATURE_STEP);
        Ok([exponent / fed_back, warmer / fed_back])
    }
}
