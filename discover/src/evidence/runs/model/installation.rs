//! Installation errors as random effects: delays, scales, biases, positions, mass and inertia, and
//! offsets by session of sensors that are mounted anew.
//!
//! Each error a is in units of its standard deviation, which `[tolerances]` states. With N the
//! columns of the errors and J the columns of the base parameters b, the fit is penalised least
//! squares, which is equivalent to generalised least squares without the errors a and with rows of
//! covariance V (best linear unbiased prediction):
//!
//! ```text
//! min |r - J b - N a|^2 + |a|^2        V = 1 + N N'
//! ```
//!
//! With a surveyed track slope, the difference of the speed's derivative and the accelerometer
//! determines the accelerometer's tilt and bias without any friction. With its information matrix K
//! of the sizes a, and its scores k at sizes of 0, the prior of a in the fit to the forces is
//! normal with covariance `S = inv(1 + K)` and mean `S k`. The fitted parameters are then whitened
//! coordinates u, independent with unit variance: `a = S k + root(S) u`.
//!
//! Source: G. K. Robinson, That BLUP is a good thing: the estimation of random effects, Statistical
//! Science 6 (1991) 15.

use std::collections::BTreeSet;
use std::sync::Arc;

use kufe_sled::effects::{Fault, Sensor};
use kufe_sled::{Sled, Tolerances};
use nalgebra::{DMatrix, DVector};

use crate::evidence::runs::model::channels::Channels;

/// Kind of an installation error.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ErrorKind {
    /// A delay of a channel.
    Late(Sensor),
    /// A relative scale error.
    Scaled(Sensor),
    /// A bias.
    Biased(Sensor),
    /// A rotation of the inertial unit about an axis: roll, pitch, yaw.
    Misaligned(usize),
    /// Sensitivity of a gyroscope's axis to the vertical acceleration.
    GSensitive(usize),
    /// Position of the accelerometer along an axis.
    Accelerometer(usize),
    /// Longitudinal position of the slip sensor.
    SlipSensor,
    /// Longitudinal position of the centre of gravity.
    Centre,
    /// Relative error of the sled's mass.
    Mass,
    /// Relative error of its pitch inertia.
    PitchInertia,
    /// Relative error of its yaw inertia.
    YawInertia,
}

/// One possible installation error.
#[derive(Clone, Debug, PartialEq)]
pub struct InstallationError {
    /// Description.
    pub what: String,
    pub unit: &'static str,
    /// Stated standard deviation, in its unit.
    pub sd: f64,
    /// The only session in which it acts; `None`: all sessions.
    session: Option<String>,
    kind: ErrorKind,
}

impl InstallationError {
    /// Whether its effect on the longitudinal accelerometer is that of a slope.
    pub fn is_tilt(&self) -> bool {
        matches!(
            self.kind,
            ErrorKind::Biased(Sensor::Ax) | ErrorKind::Misaligned(1 | 2)
        )
    }

    /// Whether it couples channels of the inertial unit.
    pub fn couples(&self) -> bool {
        matches!(
            self.kind,
            ErrorKind::Misaligned(_) | ErrorKind::GSensitive(_)
        )
    }

    /// Whether it is a delay or a bias: these do not scale the noise of the residuals.
    pub fn is_additive(&self) -> bool {
        matches!(self.kind, ErrorKind::Late(_) | ErrorKind::Biased(_))
    }

    pub fn acts_in(&self, session: &str) -> bool {
        self.session.as_ref().is_none_or(|own| own == session)
    }

    /// The sensor whose reading it changes.
    pub fn sensor(&self) -> Option<Sensor> {
        match self.kind {
            ErrorKind::Late(sensor) | ErrorKind::Scaled(sensor) | ErrorKind::Biased(sensor) => {
                Some(sensor)
            }
            _ => None,
        }
    }
}

/// Information about the sizes from data other than the forces; sizes in stated standard
/// deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Information {
    /// Information matrix K.
    pub precision: DMatrix<f64>,
    /// Scores k at sizes of 0.
    pub scores: DVector<f64>,
}

/// Normal prior of the sizes in the fit to the forces: `mean + root u`, with u whitened.
#[derive(Clone, Debug, Default, PartialEq)]
struct SizePrior {
    mean: DVector<f64>,
    root: DMatrix<f64>,
    inverse_root: DMatrix<f64>,
}

impl SizePrior {
    fn of(count: usize, information: Option<&Information>) -> Self {
        let Some(information) = information else {
            return Self {
                mean: DVector::zeros(count),
                root: DMatrix::identity(count, count),
                inverse_root: DMatrix::identity(count, count),
            };
        };
        let eigen = information.precision.clone().symmetric_eigen();
        let power = |exponent: f64| {
            let diagonal = eigen
                .eigenvalues
                .map(|value| (1.0 + value.max(0.0)).powf(exponent));
            &eigen.eigenvectors * DMatrix::from_diagonal(&diagonal) * eigen.eigenvectors.transpose()
        };
        Self {
            mean: power(-1.0) * &information.scores,
            root: power(-0.5),
            inverse_root: power(0.5),
        }
    }
}

/// All installation errors with their sizes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Installation {
    pub errors: Arc<[InstallationError]>,
    /// Sizes in stated standard deviations.
    pub sizes: Vec<f64>,
    /// Whether the sizes are fixed in fits.
    pub fixed: bool,
    /// Prior of the sizes in the fit to the forces.
    prior: Arc<SizePrior>,
}

impl Installation {
    /// Errors that the tolerances allow in runs of these sessions; a tolerance of 0 excludes an
    /// error.
    pub fn new<'s>(tolerances: &Tolerances, sessions: impl IntoIterator<Item = &'s str>) -> Self {
        let t = tolerances;
        let gyros = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
        let accelerometers = [Sensor::Ax, Sensor::Ay, Sensor::Az];
        let mut errors = Vec::new();
        let mut add = |what: String, unit, sd, kind| {
            if sd > 0.0 {
                errors.push(InstallationError {
                    what,
                    unit,
                    sd,
                    session: None,
                    kind,
                });
            }
        };
        for s in Sensor::ALL {
            let what = format!("delay of {}", s.name());
            add(what, "s", t.delay_s, ErrorKind::Late(s));
        }
        for s in gyros {
            let name = s.name();
            add(
                format!("scale of {name}"),
                "",
                t.gyro_scale,
                ErrorKind::Scaled(s),
            );
            let (sd, what) = (t.gyro_bias_radps, format!("bias of {name}"));
            add(what, "rad/s", sd, ErrorKind::Biased(s));
        }
        for s in accelerometers {
            let name = s.name();
            add(
                format!("scale of {name}"),
                "",
                t.accel_scale,
                ErrorKind::Scaled(s),
            );
            let (sd, what) = (t.accel_bias_mps2, format!("bias of {name}"));
            add(what, "m/s2", sd, ErrorKind::Biased(s));
        }
        let steer = Sensor::Steering;
        let what = format!("scale of {}", steer.name());
        add(what, "", t.steer_scale, ErrorKind::Scaled(steer));
        for (axis, name) in ["roll", "pitch", "yaw"].into_iter().enumerate() {
            let what = format!("misalignment of the inertial unit, {name}");
            add(what, "rad", t.misalignment_rad, ErrorKind::Misaligned(axis));
        }
        for (axis, s) in gyros.into_iter().enumerate() {
            let (unit, sd) = ("rad/s per m/s2", t.gyro_g_sensitivity_radps_per_mps2);
            let what = format!("g-sensitivity of {}", s.name());
            add(what, unit, sd, ErrorKind::GSensitive(axis));
        }
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let what = format!("place of the accelerometer, {name}");
            add(what, "m", t.place_m, ErrorKind::Accelerometer(axis));
        }
        let places = [
            ("place of the slip sensor, x", ErrorKind::SlipSensor),
            ("place of the centre of gravity, x", ErrorKind::Centre),
        ];
        for (what, kind) in places {
            add(what.to_owned(), "m", t.place_m, kind);
        }
        add("mass, relative".to_owned(), "", t.mass, ErrorKind::Mass);
        let inertias = [
            ("pitch", ErrorKind::PitchInertia),
            ("yaw", ErrorKind::YawInertia),
        ];
        for (axis, kind) in inertias {
            add(format!("{axis} inertia, relative"), "", t.inertia, kind);
        }
        if t.session_offset_rad > 0.0 {
            let sessions: BTreeSet<&str> = sessions.into_iter().collect();
            for (session, s) in sessions
                .into_iter()
                .flat_map(|session| [Sensor::Slip, Sensor::Steering].map(|s| (session, s)))
            {
                errors.push(InstallationError {
                    what: format!("offset of {} in session {session:?}", s.name()),
                    unit: "rad",
                    sd: t.session_offset_rad,
                    session: Some(session.to_owned()),
                    kind: ErrorKind::Biased(s),
                });
            }
        }
        Self::of(errors.into(), None)
    }

    /// All errors at their prior means.
    fn of(errors: Arc<[InstallationError]>, information: Option<Information>) -> Self {
        let prior = SizePrior::of(errors.len(), information.as_ref());
        Self {
            sizes: prior.mean.iter().copied().collect(),
            fixed: false,
            prior: Arc::new(prior),
            errors,
        }
    }

    /// The installation with its prior updated by data other than the forces.
    pub fn with_information(self, information: Information) -> Self {
        Self::of(self.errors, Some(information))
    }

    /// Whitened coordinates u of the sizes.
    pub fn whitened(&self) -> DVector<f64> {
        let sizes = DVector::from_column_slice(&self.sizes);
        &self.prior.inverse_root * (sizes - &self.prior.mean)
    }

    /// The installation with the sizes of the errors that meet `predicate` set to 0.
    pub fn with_zeroed(&self, predicate: impl Fn(&InstallationError) -> bool) -> Self {
        let mut without = self.clone();
        let errors = self.errors.iter().zip(&mut without.sizes);
        for (_, size) in errors.filter(|(error, _)| predicate(error)) {
            *size = 0.0;
        }
        without
    }

    /// Number of errors that are fitted.
    pub fn fitted_count(&self) -> usize {
        match self.fixed {
            true => 0,
            false => self.errors.len(),
        }
    }

    /// The installation with fixed or free sizes.
    pub fn with_fixed(&self, fixed: bool) -> Self {
        Self {
            fixed,
            ..self.clone()
        }
    }

    /// Negative log prior density of the sizes, minus its value at sizes of 0.
    pub fn penalty_relative_to_zero(&self) -> f64 {
        let of_mean = &self.prior.inverse_root * &self.prior.mean;
        self.penalty() - 0.5 * of_mean.norm_squared()
    }

    /// Negative log prior density of the sizes, minus its value at the prior mean: `|u|^2 / 2`.
    pub fn penalty(&self) -> f64 {
        0.5 * self.whitened().norm_squared()
    }

    /// Adds a step to all whitened coordinates; an empty step changes nothing.
    pub fn step(&mut self, step: &[f64]) {
        if !step.is_empty() {
            let changes = &self.prior.root * DVector::from_column_slice(step);
            let sizes = self.sizes.iter_mut().zip(changes.iter());
            sizes.for_each(|(size, change)| *size += change);
        }
    }

    /// The installation with one error changed by `deviations` standard deviations.
    pub fn moved(&self, error: usize, deviations: f64) -> Self {
        let mut moved = self.clone();
        moved.sizes[error] += deviations;
        moved
    }

    /// The column of each whitened coordinate, from the column of each error.
    pub fn combined(&self, errors: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let combined = |k: usize| {
            let mut sum = vec![0.0; errors[0].len()];
            let weights = self.prior.root.column(k);
            let nonzero = weights.iter().zip(errors).filter(|(w, _)| **w != 0.0);
            for (weight, column) in nonzero {
                let both = sum.iter_mut().zip(column);
                both.for_each(|(sum, x)| *sum += weight * x);
            }
            sum
        };
        (0..self.fitted_count()).map(combined).collect()
    }

    /// Size and standard error of each error, in its unit, from the covariance of the whitened
    /// coordinates.
    pub fn estimates(&self, covariance: &DMatrix<f64>) -> Vec<(f64, f64)> {
        let error = |(j, error): (usize, &InstallationError)| {
            let weights = self.prior.root.row(j);
            let variance = (weights * covariance * weights.transpose())[(0, 0)];
            (
                error.sd * self.sizes[j],
                error.sd * variance.max(0.0).sqrt(),
            )
        };
        self.errors.iter().enumerate().map(error).collect()
    }

    /// Corrects the stated constants of a sled.
    pub fn correct_constants(&self, sled: &mut Sled) {
        for (error, size) in self.errors.iter().zip(&self.sizes) {
            let size = size * error.sd;
            match error.kind {
                ErrorKind::Accelerometer(0) => sled.accel_x_m += size,
                ErrorKind::Accelerometer(1) => sled.accel_y_m += size,
                ErrorKind::Accelerometer(_) => sled.accel_z_m += size,
                ErrorKind::SlipSensor => sled.slip_x_m += size,
                ErrorKind::Centre => {
                    sled.l_f_m -= size;
                    sled.l_r_m += size;
                    sled.accel_x_m -= size;
                    sled.slip_x_m -= size;
                }
                ErrorKind::Mass => sled.mass_kg *= 1.0 + size,
                ErrorKind::PitchInertia => sled.j_yy_kgm2 *= 1.0 + size,
                ErrorKind::YawInertia => sled.j_zz_kgm2 *= 1.0 + size,
                ErrorKind::Late(_) | ErrorKind::Scaled(_) | ErrorKind::Biased(_) => {}
                ErrorKind::Misaligned(_) | ErrorKind::GSensitive(_) => {}
            }
        }
    }

    /// Delay of a sensor [s].
    pub fn delay(&self, sensor: Sensor) -> f64 {
        let errors = self.errors.iter().zip(&self.sizes);
        let late = errors.filter(|(error, _)| error.kind == ErrorKind::Late(sensor));
        late.map(|(error, size)| error.sd * size).sum()
    }

    /// Corrects cross-sensitivity within the inertial unit, after each channel's own errors.
    pub fn correct_coupling(&self, channels: &mut Channels) {
        let errors = self.errors.iter().zip(&self.sizes).rev();
        for (error, size) in errors.filter(|(error, size)| error.couples() && **size != 0.0) {
            let size = size * error.sd;
            let gyros = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
            match error.kind {
                ErrorKind::Misaligned(axis) => {
                    for fault in Fault::misaligned(axis).iter().rev() {
                        channels.correct(fault, size);
                    }
                }
                ErrorKind::GSensitive(axis) => {
                    channels.correct(&Fault::picks_up(gyros[axis], Sensor::Az, 1.0, 0), size);
                }
                _ => {}
            }
        }
    }

    /// Corrects a sensor's reading in a session: installation errors, then a delay by effects [s].
    pub fn correct(&self, of: Sensor, session: &str, delay_s: f64, channels: &mut Channels) {
        let errors = self.errors.iter().zip(&self.sizes);
        let acts = |error: &InstallationError| error.sensor() == Some(of) && error.acts_in(session);
        for (error, size) in errors.filter(|(error, size)| **size != 0.0 && acts(error)) {
            let size = size * error.sd;
            match error.kind {
                ErrorKind::Late(sensor) => channels.correct_delay(sensor, size),
                ErrorKind::Biased(sensor) => channels.correct_bias(sensor, size),
                ErrorKind::Scaled(sensor) => channels.correct_scale(sensor, 1.0 + size),
                ErrorKind::Misaligned(_)
                | ErrorKind::GSensitive(_)
                | ErrorKind::Accelerometer(_) => {}
                ErrorKind::SlipSensor | ErrorKind::Centre => {}
                ErrorKind::Mass | ErrorKind::PitchInertia | ErrorKind::YawInertia => {}
            }
        }
        if delay_s != 0.0 {
            channels.correct_delay(of, delay_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An installation without errors.
    const EXACT: Tolerances = Tolerances {
        delay_s: 0.0,
        place_m: 0.0,
        gyro_scale: 0.0,
        gyro_bias_radps: 0.0,
        accel_scale: 0.0,
        accel_bias_mps2: 0.0,
        mass: 0.0,
        inertia: 0.0,
        steer_scale: 0.0,
        misalignment_rad: 0.0,
        gyro_g_sensitivity_radps_per_mps2: 0.0,
        session_offset_rad: 0.0,
        lateral_form: 0.0,
    };

    #[test]
    fn every_error_with_a_tolerance_is_one_part() {
        assert_eq!(Installation::new(&EXACT, ["1"]).fitted_count(), 0);
        let delays = Tolerances {
            delay_s: 0.002,
            ..EXACT
        };
        let errors = Installation::new(&delays, []).errors;
        assert_eq!(errors.len(), Sensor::ALL.len());
        assert_eq!(errors[5].what, "delay of yaw_rate_radps");
    }

    #[test]
    fn an_offset_of_one_session_corrects_that_session_alone() {
        let remounted = Tolerances {
            session_offset_rad: 0.002,
            ..EXACT
        };
        let none = Installation::new(&remounted, ["b", "a", "b"]);
        let what: Vec<&str> = none
            .errors
            .iter()
            .map(|error| error.what.as_str())
            .collect();
        let of = |sensor: &str, session: &str| format!("offset of {sensor} in session {session:?}");
        let expected =
            ["a", "b"].map(|s| ["alpha_rad", "delta_rad"].map(|of_sensor| of(of_sensor, s)));
        assert_eq!(what, expected.concat());
        let off = none.moved(2, 0.5);
        let of_part = |session: &str| off.errors[2].acts_in(session);
        assert_eq!((of_part("a"), of_part("b")), (false, true));
    }

    #[test]
    fn errors_of_the_parts_are_those_of_their_combinations() {
        let stated = Tolerances {
            mass: 0.01,
            steer_scale: 0.03,
            ..EXACT
        };
        let information = Information {
            precision: DMatrix::from_row_slice(2, 2, &[3.0, 1.0, 1.0, 2.0]),
            scores: DVector::from_column_slice(&[2.0, -1.0]),
        };
        let both = Installation::new(&stated, []).with_information(information.clone());
        // At the prior of the forces the sizes have its mean and covariance, inv(1 + K).
        let prior = (DMatrix::identity(2, 2) + &information.precision)
            .try_inverse()
            .unwrap();
        let mean = &prior * &information.scores;
        let found = both.estimates(&DMatrix::identity(2, 2));
        for (k, ((size, se), error)) in found.iter().zip(both.errors.iter()).enumerate() {
            assert!((size / error.sd - mean[k]).abs() < 1e-12);
            assert!((se / error.sd - prior[(k, k)].sqrt()).abs() < 1e-12);
        }
        let mut moved = both.clone();
        moved.step(&[0.3, -0.2]);
        let change = moved.whitened() - both.whitened();
        assert!((change - DVector::from_column_slice(&[0.3, -0.2])).amax() < 1e-12);
    }
}
