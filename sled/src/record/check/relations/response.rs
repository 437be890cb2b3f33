//! How a sled answers: what steering, roll-split and air must do, whatever their size.
//!
//! ```text
//! dr/dt = c_1 alpha + c_2 r/v + c_3 delta + c_4 gamma + c_5,    c_3 > 0: steering to the left turns left; c_4 < 0
//! a_y   = c_1 alpha + c_2 r/v + c_3 delta + c_4 gamma + c_5,    c_1 > 0: runners hold against slipping sideways
//! -a_x  = d rho v^2/2 + e a_z + f,                              d = c_d A/m > 0: air brakes; e holds a tilt of the sensor
//! ```
//!
//! Coefficients come by least squares with their errors by leaving out a twentieth of the run at a time.

use crate::column::COLUMNS;
use crate::fault::{Fault, FaultKind};
use crate::record::check::relations::judge::RelationRules;
use crate::record::check::relations::rigid_body::Slow;
use crate::record::check::relations::rigid_body::{Coefficient, coefficients};
use crate::record::run::Run;

/// Density of the air [kg/m3]: near enough for what is judged here.
const AIR: f64 = 1.2;

/// What the answers of these runs to steering, roll-split and air prove; the slow parts are those that are mended already.
pub fn response_faults(runs: &[(&Run, Slow)], rules: &RelationRules) -> Vec<Fault> {
    let mut faults = Vec::new();
    for answer in &ANSWERS {
        let name = COLUMNS[answer.channel];
        let each: Vec<Option<Coefficient>> =
            runs.iter().map(|(_, slow)| answer.found(slow)).collect();
        for (run, (c, error)) in wrong_way(runs, &each, rules) {
            let (what, unit, c) = (answer.what, answer.unit, answer.sign * c);
            faults.push(fault(
                run,
                name,
                (FaultKind::Sign, "the other sign"),
                format!(
                    "{what} answers with {c:.1} +- {error:.1} {unit}, good runs with the other sign"
                ),
                format!("sign = -1 for {name}"),
            ));
        }
    }
    let braking: Vec<Option<Coefficient>> =
        runs.iter().map(|(_, slow)| braking(slow, rules)).collect();
    let reversed = wrong_way(runs, &braking, rules);
    for (run, (c, error)) in &reversed {
        faults.push(fault(
            run,
            "ax_mps2",
            (FaultKind::Sign, "the other sign"),
            format!("air brakes with c_d A/m = {c:.1e} +- {error:.1e} m2/kg, a bobsled with 7e-4"),
            "sign = -1 for ax_mps2".to_string(),
        ));
    }
    for ((run, _), found) in runs.iter().zip(&braking) {
        if let Some((c, error)) = found
            && *c > 0.0
            && c + 4.0 * error < rules.least_drag
        {
            faults.push(fault(
                run,
                "ax_mps2",
                (FaultKind::Unit, "multiples of g"),
                format!(
                    "air brakes with c_d A/m = {c:.1e} +- {error:.1e} m2/kg, a bobsled with 7e-4"
                ),
                "unit = \"g\" for ax_mps2".to_string(),
            ));
        }
    }
    faults
}

fn fault(
    run: &Run,
    column: &str,
    what: (FaultKind, &str),
    evidence: String,
    mend: String,
) -> Fault {
    Fault {
        run: run.entry.run.clone(),
        file: run.entry.file.display().to_string(),
        columns: vec![column.to_string()],
        kind: what.0,
        proven: false,
        looks_like: what.1.to_string(),
        evidence,
        mend,
    }
}

/// The runs whose coefficient is negative, by themselves or because nearly all runs together show it.
///
/// By itself a run must answer as strongly as others do: a run that hits walls answers to them, a little and either way.
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

/// What a sled does when a channel says that it slips, is steered or turned.
struct Answer {
    /// The channel, by its place in [`COLUMNS`].
    channel: usize,
    /// Its place among slip, turning, steering and roll-split.
    place: usize,
    /// The sign that its coefficient has.
    sign: f64,
    /// What answers, and the unit of the coefficient.
    what: &'static str,
    unit: &'static str,
    response: fn(&Slow, usize) -> Option<f64>,
}

const ANSWERS: [Answer; 3] = [
    Answer {
        channel: 7,
        place: 0,
        sign: 1.0,
        what: "the acceleration sideways",
        unit: "m/s2",
        response: |slow, i| Some(slow.channels[1].as_ref()?[i]),
    },
    Answer {
        channel: 8,
        place: 2,
        sign: 1.0,
        what: "the yaw acceleration",
        unit: "1/s2",
        response: turning,
    },
    Answer {
        channel: 9,
        place: 3,
        sign: -1.0,
        what: "the yaw acceleration",
        unit: "1/s2",
        response: turning,
    },
];

/// Yaw acceleration [1/s2].
fn turning(slow: &Slow, i: usize) -> Option<f64> {
    let yaw = slow.channels[5].as_ref()?;
    Some((yaw[i + 1] - yaw[i - 1]) / (2.0 * slow.dt_s))
}

impl Answer {
    /// The coefficient times its sign: positive where the channel is right; `None` where one of the channels is not recorded.
    fn found(&self, slow: &Slow) -> Option<Coefficient> {
        let channel = |c: usize| {
            slow.channels[c]
                .as_ref()
                .filter(|x| x.iter().any(|y| *y != x[0]))
        };
        let (yaw, v) = (channel(5)?, channel(6)?);
        let turn: Vec<f64> = yaw.iter().zip(v).map(|(r, v)| r / v).collect();
        // Drivers turn the front part as they steer: without the roll-split its share would be taken for the steering's.
        let columns: [&[f64]; 4] = [channel(7)?, &turn, channel(8)?, channel(9)?];
        let inner = slow
            .pieces
            .iter()
            .flat_map(|piece| piece.start + 1..piece.end - 1);
        let rows: Vec<(usize, f64)> = inner
            .map(|i| Some((i, (self.response)(slow, i)?)))
            .collect::<Option<_>>()?;
        let (c, error) = *coefficients(&columns, &rows)?.get(self.place)?;
        Some((self.sign * c, error))
    }
}

/// The air's share of what brakes, c_d A/m [m2/kg]; `None` where something drives.
fn braking(slow: &Slow, rules: &RelationRules) -> Option<Coefficient> {
    let (ax, v) = (slow.channels[0].as_ref()?, slow.channels[6].as_ref()?);
    let mean = ax.iter().sum::<f64>() / ax.len() as f64;
    let spread = ax.iter().map(|a| (a - mean).powi(2)).sum::<f64>() / ax.len() as f64;
    if spread.sqrt() > rules.free {
        return None;
    }
    let pressure: Vec<f64> = v.iter().map(|v| 0.5 * AIR * v * v).collect();
    let mut columns: Vec<&[f64]> = vec![&pressure];
    columns.extend(slow.channels[2].as_deref());
    let rows: Vec<(usize, f64)> = ax.iter().map(|a| -a).enumerate().collect();
    coefficients(&columns, &rows)?.first().copied()
}
