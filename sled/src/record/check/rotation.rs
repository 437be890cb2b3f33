//! A sensor box that is turned: one rotation of its accelerometer and its gyroscope.
//!
//! The sled moves with the speed v along e, its forward axis in the axes of the box. Gravity is
//! constant, so that
//!
//! ```text
//! D a = D D (v e),   D x = dx/dt + w x x                  [m/s3]
//! ```
//!
//! for the specific force a and the rotation rates w in the axes of the box. The equation is linear
//! in e, which follows by least squares. Its length is 1 if all units are right. The axis up is that
//! of the mean specific force across e: the lateral forces of the runners are small compared with the
//! vertical ones.
//!
//! In 44 simulated runs of a bobsled e is found within 0.13 degrees a run, the roll within 0.01.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::column::Sensor;
use crate::fault::{Fault, FaultKind};
use crate::record::check::faults::RelationRules;
use crate::record::check::relations::{Consistency, SlowChannels, coefficients};
use crate::record::run::Run;

/// Smallest angle of the forward axis that is reported [rad]: 3 degrees. Boxes are mounted within
/// this angle. A smaller angle is corrected all the same before the relations are checked: gravity
/// along a pitched box exceeds what the speed explains, and looks like a wrong sign.
const MIN_REPORTED_ANGLE: f64 = 0.052;
/// Smallest roll that is reported [rad], if the forward axis is right: more curves to one side than
/// to the other turn the mean force.
const MIN_REPORTED_ROLL: f64 = 0.5;
/// Smallest angle that is proved [rad]: a smaller one may be an inaccurate mount.
const MIN_PROVED_ANGLE: f64 = 0.5;
/// Largest deviation of the length of e from 1: noise of the rates makes it shorter.
const MAX_LENGTH_DEVIATION: f64 = 0.15;
/// An angle this close to a quarter turn is reported as one [rad]: the forward axis is known within
/// about 0.005, the roll less well.
const QUARTER_TURN_TOLERANCE: f64 = 0.02;
/// Standard deviation of the forward axis by what the equation neglects, such as the place of the
/// accelerometer [rad]: 0.007 to 0.012 in 36 runs of an independent simulator.
const MODEL_ERROR: f64 = 0.01;
/// Smallest mean specific force across e [m/s2].
const MIN_FORCE: f64 = 2.0;

/// The rotation of a sensor box in the sled.
pub(super) struct BoxRotation {
    /// From the axes of the box to those of the sled.
    rotation: Rotation3<f64>,
    /// Standard error of the forward axis [rad].
    error: f64,
    /// Whether it exceeds the usual accuracy of a mount.
    is_reported: bool,
    is_proven: bool,
}

impl BoxRotation {
    /// The common rotation of these runs; `None` if none is significant.
    pub fn of(runs: &[&SlowChannels], rules: &RelationRules) -> Option<BoxRotation> {
        let complete = runs.iter().copied().filter(|slow| is_complete(slow));
        let runs: Vec<&SlowChannels> = complete.collect();
        let (forward, error) = forward_axis(&runs)?;
        if (forward.norm() - 1.0).abs() > MAX_LENGTH_DEVIATION {
            return None;
        }
        let forward = forward.normalize();
        let angle = forward.angle(&Vector3::x());
        let is_turned = angle > rules.min_t * error;
        let forward = if is_turned { forward } else { Vector3::x() };
        let forces = runs.iter().map(|slow| mean_force(slow));
        let force = forces.sum::<Vector3<f64>>() / runs.len() as f64;
        let across = force - forward * force.dot(&forward);
        let up = across.try_normalize(MIN_FORCE)?;
        let rows = [forward, up.cross(&forward), up].map(|axis| axis.transpose());
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
        if !is_turned && rotation.angle() < MIN_REPORTED_ROLL {
            return None;
        }
        let mut found = BoxRotation {
            rotation,
            error,
            is_reported: !is_turned || angle > MIN_REPORTED_ANGLE,
            is_proven: false,
        };
        // A roll does not change the relations; a wrong forward axis violates them.
        let min_gain = rules.min_gain * if is_turned { 1.0 } else { -1.0 };
        let is_better = |slow: &&&SlowChannels| {
            let (before, after) = (
                Consistency::of(slow),
                Consistency::of(&slow.rotated(&found.rotation)),
            );
            after.is_below(rules.satisfied_below)
                && before.disagreement() - after.disagreement() >= min_gain
        };
        let share = runs.iter().filter(is_better).count() as f64 / runs.len() as f64;
        found.is_proven = share == 1.0 && found.rotation.angle() > MIN_PROVED_ANGLE;
        (share >= rules.min_run_share).then_some(found)
    }

    /// Rotates the channels of a run if all are recorded. Returns the fault if it is reported.
    pub fn correct(&self, run: &Run, slow: &mut SlowChannels) -> Option<Fault> {
        if !is_complete(slow) {
            return None;
        }
        let turned = slow.rotated(&self.rotation);
        let before = std::mem::replace(slow, turned);
        let evidence = Consistency::of(&before).describe_change(&Consistency::of(slow));
        self.is_reported.then(|| self.fault(run, &evidence))
    }

    /// The fault of one run, with the evidence by the `relations`.
    fn fault(&self, run: &Run, relations: &str) -> Fault {
        let names = Sensor::ACCELEROMETER.iter().chain(&Sensor::GYROSCOPE);
        let names: Vec<&str> = names.map(|sensor| sensor.name()).collect();
        let angles: [f64; 3] = self.rotation.euler_angles().into();
        let angles = angles.map(|angle| {
            let quarter = (angle / FRAC_PI_2).round() * FRAC_PI_2;
            let is_quarter = (angle - quarter).abs() < QUARTER_TURN_TOLERANCE;
            // Not -0.
            (1e4 * if is_quarter { quarter } else { angle }).round() / 1e4 + 0.0
        });
        let [x, y, z] = [0, 1, 2].map(|axis| self.rotation.matrix()[(0, axis)]);
        let evidence = format!(
            "the motion is along ({x:.3}, {y:.3}, {z:.3}) of the box, within {:.3} rad; {relations}",
            self.error.hypot(MODEL_ERROR)
        );
        let [roll, pitch, yaw] = angles;
        let mend = format!(
            "rotation = [{roll:.4}, {pitch:.4}, {yaw:.4}] in [logger.NAME] of these channels, after the rotation that is there, if any"
        );
        let (kind, looks_like) = (FaultKind::Rotation, "the axes of a box that is turned");
        let fault = Fault::proven(run, &names, kind, looks_like, mend, evidence);
        fault.proven_if(self.is_proven)
    }
}

/// Whether a run has an accelerometer, a gyroscope and the speed.
fn is_complete(slow: &SlowChannels) -> bool {
    slow.has_box() && slow.has(&[Sensor::Speed])
}

fn mean_force(slow: &SlowChannels) -> Vector3<f64> {
    let forces = slow.vectors(Sensor::ACCELEROMETER, [0.0; 3]);
    forces.iter().sum::<Vector3<f64>>() / slow.len().max(1) as f64
}

/// The forward axis in the box and the standard error of its direction [rad].
fn forward_axis(runs: &[&SlowChannels]) -> Option<(Vector3<f64>, f64)> {
    let (mut columns, mut forces): ([Vec<f64>; 3], Vec<f64>) = Default::default();
    for slow in runs {
        let force = slow.inertial_rate(&slow.vectors(Sensor::ACCELEROMETER, [0.0; 3]));
        let along = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
            let speed = slow[Sensor::Speed].iter().flatten();
            let velocity: Vec<Vector3<f64>> = speed.map(|v| axis * *v).collect();
            slow.inertial_rate(&slow.inertial_rate(&velocity))
        });
        for i in slow.inner() {
            forces.extend(&force[i]);
            for (column, along) in columns.iter_mut().zip(&along) {
                column.extend(&along[i]);
            }
        }
    }
    let found = coefficients(&columns.each_ref().map(Vec::as_slice), &forces)?;
    let axis = Vector3::from_fn(|k, _| found[k].0);
    let variances = Vector3::from_fn(|k, _| found[k].1.powi(2));
    // An error along the axis changes its length only.
    let across = axis.normalize().map(|share| 1.0 - share * share);
    Some((axis, variances.dot(&across).sqrt() / axis.norm()))
}
