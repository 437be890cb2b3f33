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
use crate::fault::{Fault, FaultKind};
use crate::record::check::judge::RelationRules;
use crate::record::check::rigid_body::{Coefficient, Slow, coefficients};
use crate::record::run::Run;

/// Density of the air [kg/m3], as accurate as these judgements need it.
const AIR: f64 = 1.2;

/// Faults by the response of these runs to steering, roll split and air; the slow parts are mended
/// already.
pub(super) fn response_faults(runs: &[(&Run, Slow)], rules: &RelationRules) -> Vec<Fault> {
    let mut faults = Vec::new();
    let mut reverse = |run: &Run, name: &str, evidence: String| {
        let (kind, mend) = (FaultKind::Sign, format!("sign = -1 for {name}"));
        let fault = Fault::proven(run, &[name], kind, "the other sign", evidence, mend);
        faults.push(fault.proven_if(false));
    };
    for (input, place, sign) in RESPONSES {
        let found = runs
            .iter()
            .map(|(_, slow)| response(slow, input, place, sign));
        let (what, unit) = match input {
            Sensor::Slip => ("the acceleration sideways", "m/s2"),
            _ => ("the yaw acceleration", "1/s2"),
        };
        for (run, (c, error)) in wrong_way(runs, &found.collect::<Vec<_>>(), rules) {
            let c = sign * c;
            let evidence = format!(
                "{what} responds with {c:.1} +- {error:.1} {unit}, good runs with the other sign"
            );
            reverse(run, input.name(), evidence);
        }
    }
    let braking = runs.iter().map(|(_, slow)| braking(slow, rules));
    let braking: Vec<Option<Coefficient>> = braking.collect();
    let drag = |c: f64, error: f64| {
        format!("air brakes with c_d A/m = {c:.1e} +- {error:.1e} m2/kg, a bobsled with 7e-4")
    };
    for (run, (c, error)) in wrong_way(runs, &braking, rules) {
        reverse(run, Sensor::Ax.name(), drag(c, error));
    }
    for ((run, _), found) in runs.iter().zip(&braking) {
        if let Some((c, error)) = *found
            && c > 0.0
            && c + 4.0 * error < rules.least_drag
        {
            let (kind, name) = (FaultKind::Unit, Sensor::Ax.name());
            let mend = format!("unit = \"g\" for {name}");
            let evidence = drag(c, error);
            let fault = Fault::proven(run, &[name], kind, "multiples of g", evidence, mend);
            faults.push(fault.proven_if(false));
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
    runs: &[(&'a Run, Slow)],
    each: &[Option<Coefficient>],
    rules: &RelationRules,
) -> Vec<(&'a Run, Coefficient)> {
    let known = || each.iter().flatten().filter(|(_, error)| *error > 0.0);
    let weights: f64 = known().map(|(_, error)| error.powi(-2)).sum();
    let t = known().map(|(c, error)| c / error.powi(2)).sum::<f64>() / weights.sqrt().max(1e-300);
    let below = known().filter(|(c, _)| *c < 0.0).count();
    let all = t < -rules.least_t && below as f64 >= rules.agree * known().count() as f64;
    let mut sizes: Vec<f64> = known().map(|(c, _)| c.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let strong = rules.alike * sizes.get(sizes.len() / 2).unwrap_or(&0.0);
    let wrong =
        |(c, error): &Coefficient| *c < -strong && *c < -rules.least_t * error || (all && *c < 0.0);
    runs.iter()
        .zip(each)
        .filter_map(|((run, _), found)| Some((*run, found.filter(wrong)?)))
        .collect()
}

/// The channels that a sled responds to, their place among slip, turning, steering and roll split,
/// and the sign of the coefficient.
const RESPONSES: [(Sensor, usize, f64); 3] = [
    (Sensor::Slip, 0, 1.0),
    (Sensor::Steering, 2, 1.0),
    (Sensor::RollSplit, 3, -1.0),
];

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
    // Drivers turn the front part as they steer: without the roll split its share would be
    // attributed to the steering.
    let columns: [&[f64]; 4] = [
        channel(Sensor::Slip)?,
        &turn,
        channel(Sensor::Steering)?,
        channel(Sensor::RollSplit)?,
    ];
    let output = |i: usize| match input {
        Sensor::Slip => Some(slow[Sensor::Ay].as_ref()?[i]),
        _ => Some((yaw[i + 1] - yaw[i - 1]) / (2.0 * slow.dt_s)),
    };
    let inner = slow.pieces.iter().flat_map(|p| p.start + 1..p.end - 1);
    let rows: Option<Vec<(usize, f64)>> = inner.map(|i| Some((i, output(i)?))).collect();
    let (c, error) = *coefficients(&columns, &rows?)?.get(place)?;
    Some((sign * c, error))
}

/// The air's share of the braking, c_d A/m [m2/kg]; `None` where something drives.
fn braking(slow: &Slow, rules: &RelationRules) -> Option<Coefficient> {
    let (ax, v) = (slow[Sensor::Ax].as_ref()?, slow[Sensor::Speed].as_ref()?);
    let mean = ax.iter().sum::<f64>() / ax.len() as f64;
    let spread = ax.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / ax.len() as f64;
    if spread.sqrt() > rules.free {
        return None;
    }
    let pressure: Vec<f64> = v.iter().map(|v| 0.5 * AIR * v * v).collect();
    let mut columns: Vec<&[f64]> = vec![&pressure];
    columns.extend(slow[Sensor::Az].as_deref());
    let rows: Vec<(usize, f64)> = ax.iter().map(|a| -a).enumerate().collect();
    coefficients(&columns, &rows)?.first().copied()
}
