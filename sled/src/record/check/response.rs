//! Response of a sled to steering, roll split and air: its signs, whatever its size.
//!
//! ```text
//! dr/dt = c_1 alpha + c_2 r/v + c_3 delta + c_4 gamma + c_5     c_3 > 0: steers to the left; c_4 < 0
//! a_y   = c_1 alpha + c_2 r/v + c_3 delta + c_4 gamma + c_5     c_1 > 0: runners oppose the slip
//! -a_x  = d rho v^2/2 + e a_z + f                               d = c_d A/m > 0: air brakes
//! ```
//!
//! e contains a tilt of the sensor. Coefficients come by least squares, with their errors by
//! leaving out a twentieth of the run at a time.

use crate::column::Sensor;
use crate::fault::Fault;
use crate::record::check::judge::RelationRules;
use crate::record::check::remedies::{G, Mend};
use crate::record::check::rigid_body::{Coefficient, Slow, coefficients};
use crate::record::run::Run;
use crate::series::{median, root_mean_square};

/// Density of the air [kg/m3], as accurate as these judgements need it.
const AIR: f64 = 1.2;

/// A channel that a sled responds to, its place among slip, turning, steering and roll split, the
/// sign of its coefficient where the channel is right, and what responds.
type Response = (Sensor, usize, f64, &'static str);

const RESPONSES: [Response; 3] = [
    (Sensor::Slip, 0, 1.0, "acceleration sideways"),
    (Sensor::Steering, 2, 1.0, "yaw acceleration"),
    (Sensor::RollSplit, 3, -1.0, "yaw acceleration"),
];

/// Faults by the response of these runs to steering, roll split and air; the slow parts are mended
/// already.
pub(super) fn response_faults(runs: &[(&Run, &Slow)], rules: &RelationRules) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut suspect = |run: &Run, sensor: Sensor, mend: Mend, evidence: String| {
        let fault = Fault::proven(run, &[sensor.name()], mend, evidence);
        faults.push(fault.proven_if(false));
    };
    for (input, place, sign, output) in RESPONSES {
        let found = runs
            .iter()
            .map(|(_, slow)| response(slow, input, place, sign));
        let unit = if input == Sensor::Slip {
            "m/s2"
        } else {
            "1/s2"
        };
        for (run, (c, error)) in wrong_way(runs, &found.collect::<Vec<_>>(), rules) {
            let c = sign * c;
            let evidence = format!(
                "the {output} responds with {c:.1} +- {error:.1} {unit}, good runs with the other sign"
            );
            suspect(run, input, Mend::Negate, evidence);
        }
    }
    let braking: Vec<_> = runs.iter().map(|(_, slow)| braking(slow, rules)).collect();
    let drag = |(c, error): Coefficient| {
        format!("air brakes with c_d A/m = {c:.1e} +- {error:.1e} m2/kg, a bobsled with 7e-4")
    };
    for (run, found) in wrong_way(runs, &braking, rules) {
        suspect(run, Sensor::Ax, Mend::Negate, drag(found));
    }
    for ((run, _), found) in runs.iter().zip(&braking) {
        let weak = |(c, error): &Coefficient| *c > 0.0 && c + 4.0 * error < rules.least_drag;
        if let Some(found) = found.filter(weak) {
            suspect(run, Sensor::Ax, Mend::Convert(G), drag(found));
        }
    }
    faults
}

/// The runs whose coefficient is negative, by themselves or because nearly all runs together show
/// it.
///
/// By itself a run must respond as strongly as others do: a run that hits walls responds to them, a
/// little and either way.
fn wrong_way<'a>(
    runs: &[(&'a Run, &Slow)],
    each: &[Option<Coefficient>],
    rules: &RelationRules,
) -> Vec<(&'a Run, Coefficient)> {
    let known = || each.iter().flatten().filter(|(_, error)| *error > 0.0);
    let weights: f64 = known().map(|(_, error)| error.powi(-2)).sum();
    let t = known().map(|(c, error)| c / error.powi(2)).sum::<f64>() / weights.sqrt().max(1e-300);
    let below = known().filter(|(c, _)| *c < 0.0).count();
    let all = t < -rules.least_t && below as f64 >= rules.agree * known().count() as f64;
    let strong = rules.alike * median(known().map(|(c, _)| c.abs())).unwrap_or(0.0);
    let wrong =
        |(c, error): &Coefficient| *c < -strong && *c < -rules.least_t * error || (all && *c < 0.0);
    let pairs = runs.iter().zip(each);
    let wrong = pairs.filter_map(|((run, _), found)| Some((*run, found.filter(wrong)?)));
    wrong.collect()
}

/// The coefficient times its sign: positive where the channel is right; `None` where one of the
/// channels is not recorded. To slip the lateral acceleration responds, to the others the yaw
/// acceleration.
fn response(slow: &Slow, input: Sensor, place: usize, sign: f64) -> Option<Coefficient> {
    let channel = |sensor: Sensor| {
        let recorded = slow[sensor].as_ref();
        recorded.filter(|x| x.iter().any(|y| *y != x[0]))
    };
    let (yaw, v) = (channel(Sensor::YawRate)?, channel(Sensor::Speed)?);
    let turn: Vec<f64> = yaw.iter().zip(v).map(|(r, v)| r / v).collect();
    let (slip, steering) = (channel(Sensor::Slip)?, channel(Sensor::Steering)?);
    // Drivers turn the front part as they steer: without the roll split its share would be
    // attributed to the steering.
    let columns = [slip, &turn, steering, channel(Sensor::RollSplit)?];
    let output = match input {
        Sensor::Slip => slow[Sensor::Ay].clone()?,
        _ => slow.rate(yaw),
    };
    let inner = |x: &Vec<f64>| slow.inner(1).map(|i| x[i]).collect::<Vec<f64>>();
    let columns = columns.map(inner);
    let columns = columns.each_ref().map(Vec::as_slice);
    let (c, error) = *coefficients(&columns, &inner(&output))?.get(place)?;
    Some((sign * c, error))
}

/// The air's share of the braking, c_d A/m [m2/kg]; `None` where something drives.
fn braking(slow: &Slow, rules: &RelationRules) -> Option<Coefficient> {
    let (ax, v) = (slow[Sensor::Ax].as_ref()?, slow[Sensor::Speed].as_ref()?);
    let mean = ax.iter().sum::<f64>() / ax.len() as f64;
    if root_mean_square(ax.iter().map(|a| a - mean)) > rules.free {
        return None;
    }
    let pressure: Vec<f64> = v.iter().map(|v| 0.5 * AIR * v * v).collect();
    let mut columns: Vec<&[f64]> = vec![&pressure];
    columns.extend(slow[Sensor::Az].as_deref());
    let brakes: Vec<f64> = ax.iter().map(|a| -a).collect();
    coefficients(&columns, &brakes)?.first().copied()
}
