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

use kufe_sled::effects::{Fault, SENSORS, Sensor};
use kufe_sled::{Sled, Tolerances};
use nalgebra::{DMatrix, DVector};

use crate::evidence::runs::model::channels::Channels;
use crate::evidence::runs::recordings::frame::Frame;

/// Kind of an installation error.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ErrorKind {
    /// A delay of a channel.
    Delay(Sensor),
    /// A relative scale error.
    Scale(Sensor),
    /// A bias.
    Bias(Sensor),
    /// A rotation of the inertial unit about an axis: roll, pitch, yaw.
    Misalignment(usize),
    /// Sensitivity of a gyroscope's axis to the vertical acceleration.
    GSensitivity(usize),
    /// Position of the accelerometer along an axis.
    AccelerometerPlace(usize),
    /// Longitudinal position of the slip sensor.
    SlipSensorPlace,
    /// Longitudinal position of the centre of gravity.
    CentreOfGravity,
    /// Relative error of the sled's mass.
    Mass,
    /// Relative error of its pitch inertia.
    PitchInertia,
    /// Relative error of its yaw inertia.
    YawInertia,
}

impl ErrorKind {
    /// Description and unit.
    fn description(self) -> (String, &'static str) {
        match self {
            Self::Delay(s) => (format!("delay of {}", s.name()), "s"),
            Self::Scale(s) => (format!("scale of {}", s.name()), ""),
            Self::Bias(s) => {
                let is_gyro = Sensor::GYROSCOPE.contains(&s);
                let unit = if is_gyro { "rad/s" } else { "m/s2" };
                (format!("bias of {}", s.name()), unit)
            }
            Self::Misalignment(axis) => {
                let name = ["roll", "pitch", "yaw"][axis];
                (format!("misalignment of the inertial unit, {name}"), "rad")
            }
            Self::GSensitivity(axis) => {
                let name = Sensor::GYROSCOPE[axis].name();
                (format!("g-sensitivity of {name}"), "rad/s per m/s2")
            }
            Self::AccelerometerPlace(axis) => {
                let name = ["x", "y", "z"][axis];
                (format!("place of the accelerometer, {name}"), "m")
            }
            Self::SlipSensorPlace => ("place of the slip sensor, x".to_owned(), "m"),
            Self::CentreOfGravity => ("place of the centre of gravity, x".to_owned(), "m"),
            Self::Mass => ("mass, relative".to_owned(), ""),
            Self::PitchInertia => ("pitch inertia, relative".to_owned(), ""),
            Self::YawInertia => ("yaw inertia, relative".to_owned(), ""),
        }
    }
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
    pub session: Option<String>,
    kind: ErrorKind,
}

impl InstallationError {
    /// Whether its effect on the longitudinal accelerometer is that of a slope.
    pub fn is_tilt(&self) -> bool {
        matches!(
            self.kind,
            ErrorKind::Bias(Sensor::Ax) | ErrorKind::Misalignment(1 | 2)
        )
    }

    /// Whether it couples channels of the inertial unit.
    pub fn couples(&self) -> bool {
        matches!(
            self.kind,
            ErrorKind::Misalignment(_) | ErrorKind::GSensitivity(_)
        )
    }

    /// Whether it is a delay or a bias: these do not scale the noise of the residuals.
    pub fn is_additive(&self) -> bool {
        matches!(self.kind, ErrorKind::Delay(_) | ErrorKind::Bias(_))
    }

    pub fn acts_in(&self, session: &str) -> bool {
        self.session.as_ref().is_none_or(|own| own == session)
    }

    /// The sensor whose reading it changes.
    pub fn sensor(&self) -> Option<Sensor> {
        match self.kind {
            ErrorKind::Delay(s) | ErrorKind::Scale(s) | ErrorKind::Bias(s) => Some(s),
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
    pub fn new<'s>(t: &Tolerances, sessions: impl IntoIterator<Item = &'s str>) -> Self {
        use ErrorKind::*;
        let scale_and_bias = |sensors: [Sensor; 3], [scale, bias]: [f64; 2]| {
            let of_sensor = move |s| [(Scale(s), scale), (Bias(s), bias)];
            sensors.into_iter().flat_map(of_sensor)
        };
        let g_sensitivity = t.gyro_g_sensitivity_radps_per_mps2;
        let gyroscope = [t.gyro_scale, t.gyro_bias_radps];
        let accelerometer = [t.accel_scale, t.accel_bias_mps2];
        let kinds = (Sensor::ALL.map(|s| (Delay(s), t.delay_s)).into_iter())
            .chain(scale_and_bias(Sensor::GYROSCOPE, gyroscope))
            .chain(scale_and_bias(Sensor::ACCELEROMETER, accelerometer))
            .chain([(Scale(Sensor::Steering), t.steer_scale)])
            .chain([0, 1, 2].map(|axis| (Misalignment(axis), t.misalignment_rad)))
            .chain([0, 1, 2].map(|axis| (GSensitivity(axis), g_sensitivity)))
            .chain([0, 1, 2].map(|axis| (AccelerometerPlace(axis), t.place_m)))
            .chain([(SlipSensorPlace, t.place_m), (CentreOfGravity, t.place_m)])
            .chain([(Mass, t.mass)])
            .chain([(PitchInertia, t.inertia), (YawInertia, t.inertia)]);
        let allowed = kinds.filter(|(_, sd)| *sd > 0.0);
        let mut errors: Vec<InstallationError> = allowed
            .map(|(kind, sd)| {
                let (what, unit) = kind.description();
                InstallationError {
                    what,
                    unit,
                    sd,
                    session: None,
                    kind,
                }
            })
            .collect();
        if t.session_offset_rad > 0.0 {
            let sessions: BTreeSet<&str> = sessions.into_iter().collect();
            for session in sessions {
                errors.extend([Sensor::Slip, Sensor::Steering].map(|s| InstallationError {
                    what: format!("offset of {} in session {session:?}", s.name()),
                    unit: "rad",
                    sd: t.session_offset_rad,
                    session: Some(session.to_owned()),
                    kind: Bias(s),
                }));
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
        if self.fixed { 0 } else { self.errors.len() }
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
    pub fn with_error_changed(&self, error: usize, deviations: f64) -> Self {
        let mut changed = self.clone();
        changed.sizes[error] += deviations;
        changed
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

    /// Errors and their sizes, each in its unit.
    fn sizes_in_units(&self) -> impl DoubleEndedIterator<Item = (&InstallationError, f64)> {
        let errors = self.errors.iter().zip(&self.sizes);
        errors.map(|(error, size)| (error, size * error.sd))
    }

    /// The stated constants of a sled, corrected.
    pub fn corrected_constants(&self, mut sled: Sled) -> Sled {
        for (error, size) in self.sizes_in_units() {
            match error.kind {
                ErrorKind::AccelerometerPlace(0) => sled.accel_x_m += size,
                ErrorKind::AccelerometerPlace(1) => sled.accel_y_m += size,
                ErrorKind::AccelerometerPlace(_) => sled.accel_z_m += size,
                ErrorKind::SlipSensorPlace => sled.slip_x_m += size,
                ErrorKind::CentreOfGravity => {
                    sled.l_f_m -= size;
                    sled.l_r_m += size;
                    sled.accel_x_m -= size;
                    sled.slip_x_m -= size;
                }
                ErrorKind::Mass => sled.mass_kg *= 1.0 + size,
                ErrorKind::PitchInertia => sled.j_yy_kgm2 *= 1.0 + size,
                ErrorKind::YawInertia => sled.j_zz_kgm2 *= 1.0 + size,
                _ => {}
            }
        }
        sled
    }

    /// Delay of a sensor [s].
    pub fn delay(&self, sensor: Sensor) -> f64 {
        let errors = self.sizes_in_units();
        let late = errors.filter(|(error, _)| error.kind == ErrorKind::Delay(sensor));
        late.map(|(_, size)| size).sum()
    }

    /// Channels of a run, of which `sensors` are corrected for their own installation errors and
    /// delays by effects [s].
    pub fn corrected_channels<'a>(
        &self,
        frame: &'a Frame,
        sensors: &[Sensor],
        delays: &[f64; SENSORS],
    ) -> Channels<'a> {
        let mut channels = Channels::new(frame);
        for sensor in sensors {
            let acts = |error: &InstallationError| {
                error.sensor() == Some(*sensor) && error.acts_in(&frame.session)
            };
            let errors = self.sizes_in_units();
            for (error, size) in errors.filter(|(error, size)| *size != 0.0 && acts(error)) {
                match error.kind {
                    ErrorKind::Delay(sensor) => channels.correct_delay(sensor, size),
                    ErrorKind::Bias(sensor) => channels.correct_bias(sensor, size),
                    ErrorKind::Scale(sensor) => channels.correct_scale(sensor, 1.0 + size),
                    _ => {}
                }
            }
            let delay_s = delays[*sensor as usize];
            if delay_s != 0.0 {
                channels.correct_delay(*sensor, delay_s);
            }
        }
        channels
    }

    /// Corrects cross-sensitivity within the inertial unit, after each channel's own errors.
    pub fn correct_coupling(&self, channels: &mut Channels) {
        for (error, size) in self.sizes_in_units().rev().filter(|(_, size)| *size != 0.0) {
            match error.kind {
                ErrorKind::Misalignment(axis) => {
                    for fault in Fault::misaligned(axis).iter().rev() {
                        channels.correct_cross_sensitivity(fault, size);
                    }
                }
                ErrorKind::GSensitivity(axis) => {
                    let gyro = Sensor::GYROSCOPE[axis];
                    let fault = Fault::picks_up(gyro, Sensor::Az, 1.0, 0);
                    channels.correct_cross_sensitivity(&fault, size);
                }
                _ => {}
            }
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
        let off = none.with_error_changed(2, 0.5);
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
