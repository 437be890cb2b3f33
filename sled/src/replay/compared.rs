//! Comparison of a run with its replay, place by place.

use std::ops::Range;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::friction::GRAVITY;
use crate::replay::inputs::{Inputs, READ};
use crate::series::root_mean_square;
use crate::simulate::drive::Simulated;
use crate::simulate::dynamics::Instant;
use crate::track::spline::Spline;

/// Values of the run and of the model at one place.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// Distance [m].
    pub s_m: f64,
    /// Time in the run and in the model [s].
    pub t_s: [f64; 2],
    /// Speed, slip angle, yaw rate and roll split in the run and in the model [m/s, rad, rad/s,
    /// rad].
    pub values: [[f64; 2]; 4],
}

impl Compared {
    /// Kinetic energy of the run minus that of the model [J], from the speeds and the mass [kg].
    pub fn energy_gap(&self, mass_kg: f64) -> f64 {
        let [measured, model] = self.values[0];
        0.5 * mass_kg * (measured * measured - model * model)
    }
}

/// Difference of one column, run minus model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Difference {
    /// The column.
    pub column: String,
    /// Root mean square difference, in the column's unit.
    pub rms: f64,
    /// Difference at the end.
    pub end: f64,
    /// Largest difference by magnitude, with its sign.
    pub largest: f64,
    /// Distance of the largest difference [m].
    pub largest_at_m: f64,
}

/// Readings of the sensors of the model, in the order of [`READ`].
pub(crate) fn readings(instant: &Instant) -> [f64; 4] {
    let state = &instant.state;
    [
        state.v_mps,
        instant.alpha_sensor_rad,
        state.yaw_rate_radps,
        state.gamma_rad,
    ]
}

/// The readings within the distance of the model, each with the model's values at the same place;
/// and the stretches of them without a gap.
pub(crate) fn compare(
    inputs: &Inputs,
    simulated: &Simulated,
) -> (Vec<Compared>, Vec<Range<usize>>) {
    let mut ascending: Vec<&Instant> = Vec::with_capacity(simulated.instants.len());
    for instant in &simulated.instants {
        let before = ascending.last().map(|last| last.state.s_m);
        if before.is_none_or(|before| instant.state.s_m > before) {
            ascending.push(instant);
        }
    }
    let (mut compared, mut pieces) = (Vec::new(), Vec::new());
    if ascending.len() < 2 {
        return (compared, pieces);
    }
    let places: Vec<f64> = ascending.iter().map(|instant| instant.state.s_m).collect();
    let spline_of = |value: &dyn Fn(&Instant) -> f64| {
        let values: Vec<f64> = ascending.iter().map(|instant| value(instant)).collect();
        Spline::natural(&places, &values)
    };
    let time = spline_of(&|instant| instant.state.t_s);
    let values: [Spline; 4] = std::array::from_fn(|k| spline_of(&|instant| readings(instant)[k]));
    let simulated_range = places[0]..=places[places.len() - 1];
    for piece in &inputs.pieces {
        let start = compared.len();
        let readings = inputs.readings[piece.clone()].iter();
        let covered = readings.filter(|reading| simulated_range.contains(&reading.s_m));
        compared.extend(covered.map(|reading| Compared {
            s_m: reading.s_m,
            t_s: [reading.t_s, time.value(reading.s_m)],
            values: std::array::from_fn(|k| [reading.values[k], values[k].value(reading.s_m)]),
        }));
        if start < compared.len() {
            pieces.push(start..compared.len());
        }
    }
    (compared, pieces)
}

/// Differences of time, speed and the other recorded columns.
pub(crate) fn differences(compared: &[Compared], recorded: [bool; 4]) -> Vec<Difference> {
    let difference = |column: &str, gap: &dyn Fn(&Compared) -> f64| {
        let size = |at: &Compared| gap(at).abs();
        let largest = compared.iter().max_by(|a, b| size(a).total_cmp(&size(b)));
        Difference {
            column: column.to_owned(),
            rms: root_mean_square(compared.iter().map(gap)),
            end: compared.last().map_or(0.0, gap),
            largest: largest.map_or(0.0, gap),
            largest_at_m: largest.map_or(0.0, |at| at.s_m),
        }
    };
    let mut all = vec![difference("t_s", &|at| at.t_s[0] - at.t_s[1])];
    for (k, sensor) in READ.iter().enumerate().filter(|(k, _)| recorded[*k]) {
        all.push(difference(sensor.name(), &|at| {
            at.values[k][0] - at.values[k][1]
        }));
    }
    all
}

/// A section of the track with an exceptional difference between run and model.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Section {
    /// The column; for `v_mps` the section shows a force.
    pub column: String,
    /// Start of the section [m].
    pub from_m: f64,
    /// End of the section [m].
    pub to_m: f64,
    /// Size of the strongest window: for `v_mps` the force along the sled missing in the model [N],
    /// else the root mean square difference in the column's unit.
    pub size: f64,
    /// Ratio of `size` to the root mean square of all windows.
    pub times_rms: f64,
    /// Time that the run loses against the model on the section [s]; negative for a gain.
    pub lost_s: f64,
}

/// Length of a window [m]: about six sleds, and long enough to distinguish a force from noise of
/// the speed.
const WINDOW_M: usize = 20;
/// Length omitted from a reported window at each end [m]: a short event lies near the middles of
/// the windows that show it.
const EDGE_M: usize = 5;
/// Ratio to the root mean square of all windows above which a window is exceptional, as in the
/// other comparisons with runs.
const EXCEPTIONAL: f64 = 2.0;
/// Threshold in standard deviations of the noise, exceeded by noise once in 10^4 windows.
const NOISE_LIMIT: f64 = 4.0;
/// Ratio of force to weight below which a window is not reported: 1/50 of the friction on ice,
/// still above errors of steps and filters.
const MIN_MU: f64 = 1e-4;
/// Difference below which a window of another column is not reported, relative to the column's root
/// mean square.
const MIN_RATIO: f64 = 1e-3;
/// Largest number of sections per column.
const MAX_SECTIONS: usize = 5;

/// Up to [`MAX_SECTIONS`] sections per column, the strongest first.
///
/// A window of 20 m counts if its root mean square difference is at least twice that of all
/// windows. For the speed the mean force
///
/// ```text
/// F = ( E(s + 20 m) - E(s) ) / 20 m      E = m (v_run^2 - v_model^2) / 2
/// ```
///
/// takes the place of the difference, since it shows where the speeds diverge. Both must exceed
/// four standard deviations of their noise. Overlapping windows make one section; none extends
/// across a gap.
pub(crate) fn sections(
    compared: &[Compared],
    pieces: &[Range<usize>],
    inputs: &Inputs,
    mass_kg: f64,
) -> Vec<Section> {
    let mut found = Vec::new();
    for (k, sensor) in READ.iter().enumerate().filter(|(k, _)| inputs.recorded[*k]) {
        let of_piece = |piece: &Range<usize>| windows_of(&compared[piece.clone()], k, mass_kg);
        let mut windows: Vec<Window> = pieces.iter().flat_map(of_piece).collect();
        let rms = root_mean_square(windows.iter().map(|window| window.size));
        let noise = inputs.noise_sd[k];
        let column_rms = root_mean_square(compared.iter().map(|at| at.values[k][0]));
        let floor = |window: &Window| match k {
            0 => {
                let force = 2.0_f64.sqrt() * mass_kg * window.v_mps * noise / WINDOW_M as f64;
                (NOISE_LIMIT * force).max(MIN_MU * mass_kg * GRAVITY)
            }
            _ => (NOISE_LIMIT * noise).max(MIN_RATIO * column_rms),
        };
        windows.retain(|window| window.size.abs() > (EXCEPTIONAL * rms).max(floor(window)));
        let overlap =
            |a: &Window, b: &Window| b.from_m <= a.to_m && a.size.signum() == b.size.signum();
        let section = |windows: &[Window]| {
            let (first, last) = (&windows[0], &windows[windows.len() - 1]);
            let by_size = |a: &&Window, b: &&Window| a.size.abs().total_cmp(&b.size.abs());
            // The first of equals.
            let strongest = windows.iter().rev().max_by(by_size).unwrap_or(first);
            Section {
                column: sensor.name().to_owned(),
                from_m: first.from_m,
                to_m: last.to_m,
                size: strongest.size,
                times_rms: strongest.size.abs() / rms,
                lost_s: last.late_s[1] - first.late_s[0],
            }
        };
        let mut sections: Vec<Section> = windows.chunk_by(overlap).map(section).collect();
        sections.sort_by(|a, b| b.times_rms.total_cmp(&a.times_rms));
        sections.truncate(MAX_SECTIONS);
        found.extend(sections);
    }
    found
}

/// A window of the track; `from_m` to `to_m` is its middle half.
struct Window {
    from_m: f64,
    to_m: f64,
    /// Force [N], or root mean square difference.
    size: f64,
    /// Delay of the run relative to the model at `from_m` and `to_m` [s].
    late_s: [f64; 2],
    v_mps: f64,
}

/// Windows of column `k` at every metre of one stretch without a gap.
fn windows_of(compared: &[Compared], k: usize, mass_kg: f64) -> Vec<Window> {
    let (Some(first), Some(last)) = (compared.first(), compared.last()) else {
        return Vec::new();
    };
    let count = (last.s_m - first.s_m).max(0.0) as usize + 1;
    let mut place = 0;
    // Differences of the column, of the energy and of the time, and the speed, at every metre.
    let metres: Vec<[f64; 4]> = (0..count)
        .map(|metre| {
            let s = first.s_m + metre as f64;
            while place + 2 < compared.len() && compared[place + 1].s_m < s {
                place += 1;
            }
            let a = &compared[place];
            let b = compared.get(place + 1).unwrap_or(a);
            let way = b.s_m - a.s_m;
            let share = if way > 0.0 { (s - a.s_m) / way } else { 0.0 };
            let between = |of: &dyn Fn(&Compared) -> f64| of(a) + share * (of(b) - of(a));
            [
                between(&|at| at.values[k][0] - at.values[k][1]),
                between(&|at| at.energy_gap(mass_kg)),
                between(&|at| at.t_s[0] - at.t_s[1]),
                between(&|at| at.values[0][0]),
            ]
        })
        .collect();
    let window = |(start, window): (usize, &[[f64; 4]])| {
        let end = &window[WINDOW_M];
        let from_m = first.s_m + (start + EDGE_M) as f64;
        Window {
            from_m,
            to_m: from_m + (WINDOW_M - 2 * EDGE_M) as f64,
            size: match k {
                0 => (end[1] - window[0][1]) / WINDOW_M as f64,
                _ => root_mean_square(window.iter().map(|at| at[0])),
            },
            late_s: [window[EDGE_M][2], window[WINDOW_M - EDGE_M][2]],
            v_mps: window[0][3],
        }
    };
    let windows = metres.windows(WINDOW_M + 1).enumerate();
    windows.map(window).collect()
}
