//! Installation errors as random effects: delays, scales, biases, positions, mass and inertia, and
//! offsets by session of sensors that are mounted anew.
//!
//! Each error a is in units of its standard deviation, which `[tolerances]` states. With N its
//! columns and J those of the base, the fit is penalised least squares, equivalent to correlated
//! rows:
//!
//! ```text
//! min |r - J b - N a|^2 + |a|^2        V = 1 + N N'
//! ```
//!
//! With a surveyed track slope, the difference of the speed's derivative and the accelerometer
//! determines the accelerometer's tilt and bias without any friction. With its information K about
//! the sizes, and its scores k at sizes of 0, the prior for the forces is normal with the
//! covariance `S = inv(1 + K)` and the mean `S k`. Combinations are then those of independent b in
//! `a = S k + root(S) b`.
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

/// One installation error.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// Description.
    pub what: String,
    pub unit: &'static str,
    /// Stated standard deviation, in its unit.
    pub sd: f64,
    /// The only session in which it acts; `None`: all sessions.
    session: Option<String>,
    wrong: ErrorKind,
}

impl Part {
    /// Whether its effect on the longitudinal accelerometer is that of a slope.
    pub fn is_tilt(&self) -> bool {
        matches!(
            self.wrong,
            ErrorKind::Biased(Sensor::Ax) | ErrorKind::Misaligned(1 | 2)
        )
    }

    /// Whether it couples channels of the inertial unit.
    pub fn couples(&self) -> bool {
        matches!(
            self.wrong,
            ErrorKind::Misaligned(_) | ErrorKind::GSensitive(_)
        )
    }

    /// Whether it is a delay or a bias, which do not change the noise of the residuals.
    pub fn shifts(&self) -> bool {
        matches!(self.wrong, ErrorKind::Late(_) | ErrorKind::Biased(_))
    }

    pub fn acts_in(&self, session: &str) -> bool {
        self.session.as_ref().is_none_or(|own| own == session)
    }

    /// The sensor whose reading it changes.
    pub fn sensor(&self) -> Option<Sensor> {
        match self.wrong {
            ErrorKind::Late(sensor) | ErrorKind::Scaled(sensor) | ErrorKind::Biased(sensor) => {
                Some(sensor)
            }
            _ => None,
        }
    }
}

/// Information about the sizes from data other than the forces, in stated standard deviations.
#[derive(Clone, Debug, PartialEq)]
pub struct Information {
    /// Information K.
    pub precision: DMatrix<f64>,
    /// Scores k at sizes of 0.
    pub scores: DVector<f64>,
}

/// Normal prior of the sizes for the forces: `mean + root b` with independent b.
#[derive(Clone, Debug, Default, PartialEq)]
struct SizeLaw {
    mean: DVector<f64>,
    root: DMatrix<f64>,
    inverse_root: DMatrix<f64>,
}

impl SizeLaw {
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
    pub parts: Arc<[Part]>,
    /// Sizes in standard deviations.
    pub sizes: Vec<f64>,
    /// Whether the sizes are fixed in fits.
    pub fixed: bool,
    /// Prior of the sizes for the forces.
    law: Arc<SizeLaw>,
}

impl Installation {
    /// Errors that the tolerances allow in runs of these sessions; 0 excludes an error.
    pub fn new<'s>(tolerances: &Tolerances, sessions: impl IntoIterator<Item = &'s str>) -> Self {
        let t = tolerances;
        let gyros = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
        let accelerometers = [Sensor::Ax, Sensor::Ay, Sensor::Az];
        let mut parts = Vec::new();
        let mut add = |what: String, unit, sd, wrong| {
            if sd > 0.0 {
                parts.push(Part {
                    what,
                    unit,
                    sd,
                    session: None,
                    wrong,
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
        for (what, wrong) in places {
            add(what.to_owned(), "m", t.place_m, wrong);
        }
        add("mass, relative".to_owned(), "", t.mass, ErrorKind::Mass);
        let inertias = [
            ("pitch", ErrorKind::PitchInertia),
            ("yaw", ErrorKind::YawInertia),
        ];
        for (axis, wrong) in inertias {
            add(format!("{axis} inertia, relative"), "", t.inertia, wrong);
        }
        if t.session_offset_rad > 0.0 {
            let sessions: BTreeSet<&str> = sessions.into_iter().collect();
            for (session, s) in sessions
                .into_iter()
                .flat_map(|session| [Sensor::Slip, Sensor::Steering].map(|s| (session, s)))
            {
                parts.push(Part {
                    what: format!("offset of {} in session {session:?}", s.name()),
                    unit: "rad",
                    sd: t.session_offset_rad,
                    session: Some(session.to_owned()),
                    wrong: ErrorKind::Biased(s),
                });
            }
        }
        Self::of(parts.into(), None)
    }

    /// All errors at their means.
    fn of(parts: Arc<[Part]>, information: Option<Information>) -> Self {
        let law = SizeLaw::of(parts.len(), information.as_ref());
        Self {
            sizes: law.mean.iter().copied().collect(),
            fixed: false,
            law: Arc::new(law),
            parts,
        }
    }

    /// The stated installation with information from data other than the forces.
    pub fn informed(self, information: Information) -> Self {
        Self::of(self.parts, Some(information))
    }

    /// Independent errors b of the sizes.
    pub fn independent(&self) -> DVector<f64> {
        let sizes = DVector::from_column_slice(&self.sizes);
        &self.law.inverse_root * (sizes - &self.law.mean)
    }

    /// The same with some errors of 0.
    pub fn without(&self, are: impl Fn(&Part) -> bool) -> Self {
        let mut without = self.clone();
        let parts = self.parts.iter().zip(&mut without.sizes);
        for (_, size) in parts.filter(|(part, _)| are(part)) {
            *size = 0.0;
        }
        without
    }

    /// Number of errors that are fitted.
    pub fn fitted(&self) -> usize {
        match self.fixed {
            true => 0,
            false => self.parts.len(),
        }
    }

    /// The same with fixed or free sizes.
    pub fn with_fixed(&self, fixed: bool) -> Self {
        Self {
            fixed,
            ..self.clone()
        }
    }

    /// Negative log prior density of its sizes, relative to sizes of 0.
    pub fn cost(&self) -> f64 {
        let of_mean = &self.law.inverse_root * &self.law.mean;
        self.distance() - 0.5 * of_mean.norm_squared()
    }

    /// The same relative to the mean.
    pub fn distance(&self) -> f64 {
        0.5 * self.independent().norm_squared()
    }

    /// Changes all independent errors, in standard deviations.
    pub fn step(&mut self, by: &[f64]) {
        if !by.is_empty() {
            let shares = &self.law.root * DVector::from_column_slice(by);
            let sizes = self.sizes.iter_mut().zip(shares.iter());
            sizes.for_each(|(size, share)| *size += share);
        }
    }

    /// The same with one part changed by so many standard deviations.
    pub fn moved(&self, part: usize, by: f64) -> Self {
        let mut moved = self.clone();
        moved.sizes[part] += by;
        moved
    }

    /// The column of each independent error, from those of the parts.
    pub fn combined(&self, parts: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let combined = |k: usize| {
            let mut sum = vec![0.0; parts[0].len()];
            let shares = self.law.root.column(k);
            let acting = shares.iter().zip(parts).filter(|(by, _)| **by != 0.0);
            for (by, part) in acting {
                sum.iter_mut().zip(part).for_each(|(sum, x)| *sum += by * x);
            }
            sum
        };
        (0..self.fitted()).map(combined).collect()
    }

    /// Size and standard error of each part, in its unit, from the covariance of the independent
    /// errors.
    pub fn found(&self, covariance: &DMatrix<f64>) -> Vec<(f64, f64)> {
        let part = |(j, part): (usize, &Part)| {
            let own = self.law.root.row(j);
            let variance = (own * covariance * own.transpose())[(0, 0)];
            (part.sd * self.sizes[j], part.sd * variance.max(0.0).sqrt())
        };
        self.parts.iter().enumerate().map(part).collect()
    }

    /// Corrects the stated constants of a sled.
    pub fn correct_constants(&self, sled: &mut Sled) {
        for (part, size) in self.parts.iter().zip(&self.sizes) {
            let size = size * part.sd;
            match part.wrong {
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
        let parts = self.parts.iter().zip(&self.sizes);
        let late = parts.filter(|(part, _)| part.wrong == ErrorKind::Late(sensor));
        late.map(|(part, size)| part.sd * size).sum()
    }

    /// Corrects cross-sensitivity within the inertial unit, after each channel's own errors.
    pub fn correct_coupling(&self, channels: &mut Channels) {
        let parts = self.parts.iter().zip(&self.sizes).rev();
        for (part, size) in parts.filter(|(part, size)| part.couples() && **size != 0.0) {
            let size = size * part.sd;
            let gyros = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
            match part.wrong {
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
        let parts = self.parts.iter().zip(&self.sizes);
        let acts = |part: &Part| part.sensor() == Some(of) && part.acts_in(session);
        for (part, size) in parts.filter(|(part, size)| **size != 0.0 && acts(part)) {
            let size = size * part.sd;
            match part.wrong {
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
        assert_eq!(Installation::new(&EXACT, ["1"]).fitted(), 0);
        let delays = Tolerances {
            delay_s: 0.002,
            ..EXACT
        };
        let parts = Installation::new(&delays, []).parts;
        assert_eq!(parts.len(), Sensor::ALL.len());
        assert_eq!(parts[5].what, "delay of yaw_rate_radps");
    }

    #[test]
    fn an_offset_of_one_session_corrects_that_session_alone() {
        let remounted = Tolerances {
            session_offset_rad: 0.002,
            ..EXACT
        };
        let none = Installation::new(&remounted, ["b", "a", "b"]);
        let what: Vec<&str> = none.parts.iter().map(|part| part.what.as_str()).collect();
        let of = |sensor: &str, session: &str| format!("offset of {sensor} in session {session:?}");
        let expected =
            ["a", "b"].map(|s| ["alpha_rad", "delta_rad"].map(|of_sensor| of(of_sensor, s)));
        assert_eq!(what, expected.concat());
        let off = none.moved(2, 0.5);
        let of_part = |session: &str| off.parts[2].acts_in(session);
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
        let both = Installation::new(&stated, []).informed(information.clone());
        // At the prior of the forces the sizes have its mean and covariance, inv(1 + K).
        let prior = (DMatrix::identity(2, 2) + &information.precision)
            .try_inverse()
            .unwrap();
        let mean = &prior * &information.scores;
        let found = both.found(&DMatrix::identity(2, 2));
        for (k, ((size, error), part)) in found.iter().zip(both.parts.iter()).enumerate() {
            assert!((size / part.sd - mean[k]).abs() < 1e-12);
            assert!((error / part.sd - prior[(k, k)].sqrt()).abs() < 1e-12);
        }
        let mut moved = both.clone();
        moved.step(&[0.3, -0.2]);
        let change = moved.independent() - both.independent();
        assert!((change - DVector::from_column_slice(&[0.3, -0.2])).amax() < 1e-12);
    }
}
