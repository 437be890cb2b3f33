//! Losses of a driver by stretch of the track, in energy and time.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::evaluate::driving::RunEvaluation;
use crate::motion::state::State;
use crate::series::distinct;
use crate::sled::Sled;

/// Length of the stretches [m], about a third of a curve. They begin at multiples of it.
const STRETCH_M: f64 = 25.0;

/// Losses on a stretch of the track relative to a straight glide.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct TrackLoss {
    /// Start of the stretch [m].
    pub from_m: f64,
    /// End of the stretch [m].
    pub to_m: f64,
    /// Energy lost at the front runner [J].
    pub front_j: f64,
    /// Energy lost at the rear runner [J].
    pub rear_j: f64,
    /// Energy lost to the air [J].
    pub aero_j: f64,
    /// Time by which this energy delays the end of the run [s].
    pub lost_s: f64,
}

/// The losses of a driver on a track, means over the driver's runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct DriverLosses {
    /// Driver.
    pub driver: String,
    /// Track.
    pub track: String,
    /// Number of runs.
    pub runs: usize,
    /// Sum over the stretches [s].
    pub lost_s: f64,
    /// Mean losses by stretch, over the runs that measured it.
    pub stretches: Vec<TrackLoss>,
}

/// Delay at the last state per joule lost at each state [s/J].
///
/// A loss of energy E lowers the speed by `E / (m v)` until the end. A slower sled has less drag,
/// so that the loss decays:
///
/// ```text
/// dt/ds = E / (m v^3)        dE/ds = - (rho c_d A / m) E
/// ```
///
/// Friction is assumed equal at both speeds.
pub(crate) fn seconds_per_joule(sled: &Sled, states: &[State]) -> Vec<f64> {
    let mut delay_per_j = vec![0.0; states.len()];
    for i in (1..states.len()).rev() {
        let [before, after] = [&states[i - 1], &states[i]];
        let step_s = after.t_s - before.t_s;
        let v_mps = 0.5 * (before.v_mps + after.v_mps);
        let decay = before.air_density_kgpm3 * sled.cda_m2 / sled.mass_kg;
        let local = step_s / (sled.mass_kg * v_mps * v_mps);
        let share = (-decay * v_mps * step_s).exp();
        delay_per_j[i - 1] = 0.5 * local * (1.0 + share) + share * delay_per_j[i];
    }
    delay_per_j
}

impl TrackLoss {
    fn at(number: i64) -> TrackLoss {
        TrackLoss {
            from_m: STRETCH_M * number as f64,
            to_m: STRETCH_M * (number + 1) as f64,
            ..TrackLoss::default()
        }
    }

    fn add(&mut self, [front_j, rear_j, aero_j, lost_s]: [f64; 4]) {
        self.front_j += front_j;
        self.rear_j += rear_j;
        self.aero_j += aero_j;
        self.lost_s += lost_s;
    }
}

/// Stretches by their number from distance 0.
pub(crate) type Stretches = BTreeMap<i64, TrackLoss>;

/// Adds losses [J] of front runner, rear runner and air at the distance `s_m` to its stretch.
pub(crate) fn add_loss(stretches: &mut Stretches, s_m: f64, lost_j: [f64; 3], delay_per_j: f64) {
    let number = (s_m / STRETCH_M).floor() as i64;
    let stretch = stretches.entry(number);
    let stretch = stretch.or_insert_with(|| TrackLoss::at(number));
    let [front, rear, aero] = lost_j;
    stretch.add([front, rear, aero, delay_per_j * (front + rear + aero)]);
}

/// The losses of each driver on each track, in the order of the runs.
pub fn losses_by_driver(runs: &[RunEvaluation]) -> Vec<DriverLosses> {
    let pairs = runs.iter().map(|run| (&run.track, &run.driver));
    let mut all = Vec::new();
    for track in distinct(runs.iter().map(|run| &run.track)) {
        for pair in distinct(pairs.clone())
            .into_iter()
            .filter(|pair| pair.0 == track)
        {
            let members = runs.iter().filter(|run| (&run.track, &run.driver) == pair);
            all.push(mean(pair.1, track, &members.collect::<Vec<_>>()));
        }
    }
    all
}

fn mean(driver: &str, track: &str, runs: &[&RunEvaluation]) -> DriverLosses {
    let mut sums: BTreeMap<i64, (TrackLoss, f64)> = BTreeMap::new();
    for one in runs.iter().flat_map(|run| &run.losses) {
        let number = (one.from_m / STRETCH_M).round() as i64;
        let stretch = sums.entry(number);
        let (sum, count) = stretch.or_insert_with(|| (TrackLoss::at(number), 0.0));
        sum.add([one.front_j, one.rear_j, one.aero_j, one.lost_s]);
        *count += 1.0;
    }
    let means = sums.into_values().map(|(sum, count)| TrackLoss {
        front_j: sum.front_j / count,
        rear_j: sum.rear_j / count,
        aero_j: sum.aero_j / count,
        lost_s: sum.lost_s / count,
        ..sum
    });
    let stretches: Vec<TrackLoss> = means.collect();
    DriverLosses {
        driver: driver.to_owned(),
        track: track.to_owned(),
        runs: runs.len(),
        lost_s: stretches.iter().map(|stretch| stretch.lost_s).sum(),
        stretches,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::model_toml::Model;

    /// A sled on a slope, integrated by small steps over the distance: its states every `keep`
    /// steps, with a force against the motion from 300 m to 325 m.
    fn driven(sled: &Sled, force_n: f64) -> Vec<State> {
        let (step, finish) = (0.01, 1000.0);
        let (mut v, mut t) = (10.0_f64, 0.0);
        let mut states = Vec::new();
        for i in 0..=(finish / step) as usize {
            let s = i as f64 * step;
            if i % 20 == 0 {
                states.push(State {
                    t_s: t,
                    s_m: s,
                    v_mps: v,
                    air_density_kgpm3: 1.25,
                    ..State::default()
                });
            }
            let extra = if (300.0..325.0).contains(&s) {
                force_n
            } else {
                0.0
            };
            let drag = 0.5 * 1.25 * sled.cda_m2 * v * v;
            let accel = 9.81 * 0.08 - (drag + extra) / sled.mass_kg;
            let next = (v * v + 2.0 * accel * step).sqrt();
            t += 2.0 * step / (v + next);
            v = next;
        }
        states
    }

    #[test]
    fn energy_lost_on_the_way_delays_the_finish_as_an_integrated_sled_is_delayed() {
        let sled = Model::published().sled;
        let force = 80.0;
        let [free, braked] = [0.0, force].map(|force| driven(&sled, force));
        let delay = braked[braked.len() - 1].t_s - free[free.len() - 1].t_s;
        let delay_per_j = seconds_per_joule(&sled, &free);
        let lost = free
            .iter()
            .zip(&delay_per_j)
            .filter(|(at, _)| (300.0..325.0).contains(&at.s_m));
        // Samples are 0.2 m apart.
        let stated: f64 = lost.map(|(_, delay_per_j)| force * 0.2 * delay_per_j).sum();
        // Of 80 N over 25 m the speed falls by some 1 %, of which the linear form omits the square.
        assert!((stated / delay - 1.0).abs() < 0.03, "{stated} s, {delay} s");
    }

    #[test]
    fn losses_go_to_the_stretch_of_their_place() {
        let mut stretches = Stretches::new();
        for (s_m, loss) in [(60.0, 1.0), (10.0, 2.0), (74.9, 4.0), (75.0, 8.0)] {
            add_loss(&mut stretches, s_m, [loss, 0.0, 2.0 * loss], 0.1);
        }
        let found: Vec<[f64; 4]> = stretches
            .values()
            .map(|one| [one.from_m, one.front_j, one.aero_j, one.lost_s])
            .collect();
        let expected = [
            [0.0, 2.0, 4.0, 0.6],
            [50.0, 5.0, 10.0, 1.5],
            [75.0, 8.0, 16.0, 2.4],
        ];
        for (found, expected) in found.iter().flatten().zip(expected.iter().flatten()) {
            assert!((found - expected).abs() < 1e-12, "{stretches:?}");
        }
        assert_eq!(stretches.len(), 3);
    }
}
