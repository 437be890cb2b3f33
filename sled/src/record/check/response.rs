//! Response of a sled to steering, roll split and air: its signs, whatever its size.
//!
//! ```text
//! dr/dt = c_1 alpha + c_2 r/v + c_3 delta + c_4 gamma + c_5     c_3 > 0: steers to the left; c_4 < 0
//! a_y   = c_1 alpha + c_2 r/v + c_3 delta + c_4 gamma + c_5     c_1 > 0: runners oppose the slip
//! -a_x  = d rho v^2/2 + e a_z + f                               d = c_d A/m > 0: air brakes
//! ```
//!
//! e contains a tilt of the sensor.

use crate::column::Sensor;
use crate::fault::Fault;
use crate::record::check::corrections::{G, OTHER_SIGN};
use crate::record::check::faults::RelationRules;
use crate::record::check::relations::{Coefficient, SlowChannels, coefficients};
use crate::record::run::Run;
use crate::series::{median, root_mean_square};

/// Density of the air [kg/m3]; these checks need no better value.
const AIR_DENSITY: f64 = 1.2;

/// Channel, its response, and sign and unit of the coefficient if the channel is right.
const RESPONSES: [(Sensor, &str, f64, &str); 4] = [
    (Sensor::Slip, "acceleration sideways", 1.0, "m/s2"),
    (Sensor::Steering, "yaw acceleration", 1.0, "1/s2"),
    (Sensor::RollSplit, "yaw acceleration", -1.0, "1/s2"),
    (Sensor::Ax, "braking by the air", 1.0, "m2/kg"),
];

/// Faults by the response of these runs to steering, roll split and air. The low-passed channels
/// have been corrected.
pub(super) fn response_faults(runs: &[(&Run, &SlowChannels)], rules: &RelationRules) -> Vec<Fault> {
    let mut faults = Vec::new();
    for (sensor, output, sign, unit) in RESPONSES {
        let found = runs.iter().map(|(_, slow)| {
            let (c, error) = response(slow, sensor, rules)?;
            Some((sign * c, error))
        });
        let found: Vec<Option<Coefficient>> = found.collect();
        let has_wrong_sign = sign_test(&found, rules);
        for ((run, _), found) in runs.iter().zip(&found) {
            let Some((c, error)) = *found else { continue };
            // An accelerometer in g shows a tenth of the drag.
            let is_weak = sensor == Sensor::Ax && c > 0.0 && c + 4.0 * error < rules.min_drag;
            let (scale, expected) = if has_wrong_sign(c, error) {
                (OTHER_SIGN, "good runs with the other sign")
            } else if is_weak {
                (G, "a bobsled with 7e-4")
            } else {
                continue;
            };
            let c = sign * c;
            let evidence =
                format!("the {output} responds with {c:.1e} +- {error:.1e} {unit}, {expected}");
            let fault = scale.fault(run, &[sensor.name()], evidence);
            faults.push(fault.proven_if(false));
        }
    }
    faults
}

/// A test whether the coefficient of a run is negative, by this run alone or by nearly all runs
/// together.
///
/// A single run must respond about as strongly as the others: contacts with walls cause weak
/// responses of either sign.
fn sign_test(each: &[Option<Coefficient>], rules: &RelationRules) -> impl Fn(f64, f64) -> bool {
    let known = || each.iter().flatten().filter(|(_, error)| *error > 0.0);
    let weights: f64 = known().map(|(_, error)| error.powi(-2)).sum();
    let t = known().map(|(c, error)| c / error.powi(2)).sum::<f64>() / weights.sqrt().max(1e-300);
    let negative = known().filter(|(c, _)| *c < 0.0).count();
    let by_all =
        t < -rules.min_t && negative as f64 >= rules.min_run_share * known().count() as f64;
    let strong = rules.min_relative_response * median(known().map(|(c, _)| c.abs())).unwrap_or(0.0);
    move |c, error| c < -strong && c < -rules.min_t * error || by_all && c < 0.0
}

/// The coefficient of a channel in its response; `None` if a channel is not recorded or is constant.
fn response(slow: &SlowChannels, sensor: Sensor, rules: &RelationRules) -> Option<Coefficient> {
    if sensor == Sensor::Ax {
        return drag(slow, rules);
    }
    let channel = |sensor: Sensor| {
        let recorded = slow[sensor].as_ref();
        recorded.filter(|x| x.iter().any(|y| *y != x[0]))
    };
    let (yaw, v) = (channel(Sensor::YawRate)?, channel(Sensor::Speed)?);
    let turn: Vec<f64> = yaw.iter().zip(v).map(|(r, v)| r / v).collect();
    // Drivers roll the front part as they steer: without the roll split its effect would be
    // attributed to the steering.
    let columns = [
        channel(Sensor::Slip)?,
        &turn,
        channel(Sensor::Steering)?,
        channel(Sensor::RollSplit)?,
    ];
    let (place, output) = match sensor {
        Sensor::Slip => (0, slow[Sensor::Ay].clone()?),
        Sensor::Steering => (2, slow.rate(yaw)),
        _ => (3, slow.rate(yaw)),
    };
    let inner = |x: &Vec<f64>| slow.inner().map(|i| x[i]).collect::<Vec<f64>>();
    let columns = columns.map(inner);
    let columns = columns.each_ref().map(Vec::as_slice);
    Some(coefficients(&columns, &inner(&output))?[place])
}

/// Drag area over mass, c_d A/m [m2/kg]; `None` if the vehicle is driven or braked.
fn drag(slow: &SlowChannels, rules: &RelationRules) -> Option<Coefficient> {
    let (ax, v) = (slow[Sensor::Ax].as_ref()?, slow[Sensor::Speed].as_ref()?);
    let mean = ax.iter().sum::<f64>() / ax.len() as f64;
    if root_mean_square(ax.iter().map(|a| a - mean)) > rules.max_coasting_sd {
        return None;
    }
    let pressure: Vec<f64> = v.iter().map(|v| 0.5 * AIR_DENSITY * v * v).collect();
    let mut columns: Vec<&[f64]> = vec![&pressure];
    columns.extend(slow[Sensor::Az].as_deref());
    let brakes: Vec<f64> = ax.iter().map(|a| -a).collect();
    coefficients(&columns, &brakes)?.first().copied()
}
