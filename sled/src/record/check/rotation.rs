//! A sensor box that is turned: one rotation of its accelerometer and its gyroscope.
//!
//! The sled moves with the speed v along e, the axis forward as the box has it. Gravity is the same
//! in any axes, so that
//!
//! ```text
//! D a = D D (v e),   D x = dx/dt + w x x                  [m/s3]
//! ```
//!
//! in the axes of the box, for its specific force a and rates w. The equation is linear in e: least
//! squares give it. Its length is 1 where all units are right. The axis up is that of the mean
//! specific force across e: the forces of the runners across a sled are small compared with those up.
//!
//! In 44 simulated runs of a bobsled e is found within 0.13 degrees a run, the roll within 0.01.

use std::f64::consts::FRAC_PI_2;

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::column::Sensor;
use crate::fault::{Fault, FaultKind};
use crate::record::check::judge::RelationRules;
use crate::record::check::relations::{Agreement, Slow, coefficients};
use crate::record::run::Run;

/// Least angle of the forward axis that is reported [rad]: 3 degrees. Boxes are mounted within less,
/// which is undone all the same before single channels are judged: gravity along a box that is
/// pitched by it exceeds what the speed explains, and resembles another sign.
const LEAST_FORWARD: f64 = 0.052;
/// Least roll that is reported [rad], where the forward axis is right: a track that turns to one
/// side more than to the other turns the mean force.
const LEAST_ROLL: f64 = 0.5;
/// Least angle that is proved [rad]: less may be a box that is not quite aligned.
const LEAST_PROVEN: f64 = 0.5;
/// Share by which the length of e may differ from 1: noise of the rates makes it shorter.
const LENGTH: f64 = 0.15;
/// Angle from a quarter turn that is no finding [rad]: the forward axis is known within about 0.005,
/// the roll less well.
const QUARTER_TURN: f64 = 0.02;
/// Least mean specific force across e [m/s2].
const LEAST_FORCE: f64 = 2.0;

/// From the axes of a sensor box to those of the sled.
pub(super) struct BoxRotation {
    rotation: Rotation3<f64>,
    /// Standard error of the forward axis [rad].
    error: f64,
    /// Whether it is a finding, not the usual accuracy of a mount.
    reported: bool,
    proven: bool,
}

impl BoxRotation {
    /// The rotation that all of these runs agree on; `None` where there is none.
    pub fn of(runs: &[&Slow], rules: &RelationRules) -> Option<BoxRotation> {
        let complete = runs.iter().copied().filter(|slow| is_complete(slow));
        let runs: Vec<&Slow> = complete.collect();
        let (forward, error) = forward_axis(&runs)?;
        if (forward.norm() - 1.0).abs() > LENGTH {
            return None;
        }
        let forward = forward.normalize();
        let angle = forward.angle(&Vector3::x());
        let turned = angle > rules.least_t * error;
        let forward = if turned { forward } else { Vector3::x() };
        let forces = runs.iter().map(|slow| mean_force(slow));
        let force = forces.sum::<Vector3<f64>>() / runs.len() as f64;
        let across = force - forward * force.dot(&forward);
        let up = across.try_normalize(LEAST_FORCE)?;
        let rows = [forward, up.cross(&forward), up].map(|axis| axis.transpose());
        let rotation = Rotation3::from_matrix_unchecked(Matrix3::from_rows(&rows));
        if !turned && rotation.angle() < LEAST_ROLL {
            return None;
        }
        let mut found = BoxRotation {
            rotation,
            error,
            reported: !turned || angle > LEAST_FORWARD,
            proven: false,
        };
        // The relations do not know the roll; the forward axis shows in them.
        let gain = rules.least_gain * if turned { 1.0 } else { -1.0 };
        let mends = |slow: &&&Slow| {
            let (before, after) = (Agreement::of(slow), Agreement::of(&found.applied(slow)));
            after.is_below(rules.holds) && before.score() - after.score() >= gain
        };
        let share = runs.iter().filter(mends).count() as f64 / runs.len() as f64;
        found.proven = share == 1.0 && found.rotation.angle() > LEAST_PROVEN;
        (share >= rules.agree).then_some(found)
    }

    /// The channels in the axes of the sled.
    fn applied(&self, slow: &Slow) -> Slow {
        let mut turned = slow.clone();
        for axes in [Sensor::ACCELEROMETER, Sensor::GYROSCOPE] {
            for (i, own) in slow.vectors(axes, [0.0; 3]).iter().enumerate() {
                let sled = self.rotation * own;
                for (sensor, x) in axes.iter().zip(&sled) {
                    if let Some(values) = &mut turned[*sensor] {
                        values[i] = *x;
                    }
                }
            }
        }
        turned
    }

    /// Turns the channels of a run where all are recorded; the fault, where it is a finding.
    pub fn correct(&self, run: &Run, slow: &mut Slow) -> Option<Fault> {
        if !is_complete(slow) {
            return None;
        }
        let turned = self.applied(slow);
        let before = std::mem::replace(slow, turned);
        let evidence = Agreement::of(&before).compared(&Agreement::of(slow));
        self.reported.then(|| self.fault(run, &evidence))
    }

    /// The fault of one run, with what the relations say of it.
    fn fault(&self, run: &Run, relations: &str) -> Fault {
        let names = Sensor::ACCELEROMETER.iter().chain(&Sensor::GYROSCOPE);
        let names: Vec<&str> = names.map(|sensor| sensor.name()).collect();
        let angles: [f64; 3] = self.rotation.euler_angles().into();
        let angles = angles.map(|angle| {
            let quarter = (angle / FRAC_PI_2).round() * FRAC_PI_2;
            let is_quarter = (angle - quarter).abs() < QUARTER_TURN;
            // Not -0.
            (1e4 * if is_quarter { quarter } else { angle }).round() / 1e4 + 0.0
        });
        let [x, y, z] = [0, 1, 2].map(|axis| self.rotation.matrix()[(0, axis)]);
        let evidence = format!(
            "the motion is along ({x:.3}, {y:.3}, {z:.3}) of the box, within {:.3} rad; {relations}",
            self.error
        );
        let [roll, pitch, yaw] = angles;
        let mend = format!(
            "rotation = [{roll:.4}, {pitch:.4}, {yaw:.4}] in [logger.NAME] of these channels"
        );
        let (kind, looks_like) = (FaultKind::Rotation, "the axes of a box that is turned");
        let fault = Fault::proven(run, &names, kind, looks_like, mend, evidence);
        fault.proven_if(self.proven)
    }
}

/// Whether a run has an accelerometer, a gyroscope and the speed.
fn is_complete(slow: &Slow) -> bool {
    let boxes = [Sensor::ACCELEROMETER, Sensor::GYROSCOPE].concat();
    slow.has(&boxes) && slow.has(&[Sensor::Speed])
}

fn mean_force(slow: &Slow) -> Vector3<f64> {
    let forces = slow.vectors(Sensor::ACCELEROMETER, [0.0; 3]);
    forces.iter().sum::<Vector3<f64>>() / slow.len().max(1) as f64
}

/// The forward axis in the box and the standard error of its direction [rad].
fn forward_axis(runs: &[&Slow]) -> Option<(Vector3<f64>, f64)> {
    let (mut columns, mut forces): ([Vec<f64>; 3], Vec<f64>) = Default::default();
    for slow in runs {
        let force = slow.outside_rate(&slow.vectors(Sensor::ACCELEROMETER, [0.0; 3]));
        let along = [Vector3::x(), Vector3::y(), Vector3::z()].map(|axis| {
            let speed = slow[Sensor::Speed].iter().flatten();
            let velocity: Vec<Vector3<f64>> = speed.map(|v| axis * *v).collect();
            slow.outside_rate(&slow.outside_rate(&velocity))
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
    let errors = Vector3::from_fn(|k, _| found[k].1);
    Some((axis, errors.norm() / axis.norm()))
}
