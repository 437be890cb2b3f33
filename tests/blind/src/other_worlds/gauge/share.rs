//! Noise-free rides of a campaign, and the share of the noise's variance that an effect has in
//! them.

use super::installation::{BASE, SLEDS, faults, faulty};
use super::inversion::{Balances, balances, conditions, minus, samples, stated};
use crate::other_worlds::hidden::{Acts, Hidden};
use crate::other_worlds::plan::Plan;
use crate::other_worlds::recorder::{ROWS_HZ, Recorder, Row};
use crate::other_worlds::ride::{Truth, Way};
use crate::other_worlds::road::Road;
use crate::other_worlds::runners::Sled;
use crate::other_worlds::wrong::{Fault, Wrong};
use crate::residuals::inverse::{low_pass, residuals_every};
use crate::residuals::least_squares::{dot, ridge_out, variance};
use crate::residuals::signature::{CUTOFF_HZ, ENDS, SPEED_CUTOFF_HZ, STRIDE};
use crate::residuals::sizing::{Wanted, sized};
use crate::world::noise::Source;
use crate::world::sled::Sled as Stated;

/// Steps a second of rides that nobody records.
const RATE_HZ: f64 = 200.0;
/// Steps a row.
const STEPS: usize = 2;
/// Relative error of a share that is let pass.
const WITHIN: f64 = 0.05;
/// Course against the sled's axis from which on it slides away [rad].
const SLIDES_RAD: f64 = 0.25;

/// A run as it is drawn, before it is ridden.
#[derive(Debug, Clone)]
pub struct Start {
    /// Its name.
    pub name: String,
    /// Which road.
    pub track: usize,
    /// What was drawn for it.
    pub plan: Plan,
}

/// A campaign without noise: rides of all its runs, and what they tell of an effect.
#[derive(Debug)]
pub struct Gauge<'a> {
    /// What is wrong in the world.
    pub wrong: &'a Wrong,
    /// The true sled without what is hidden.
    pub sled: &'a Sled,
    /// The roads.
    pub roads: &'a [Road; 2],
    /// The runs.
    pub starts: Vec<Start>,
    /// Longest run [s].
    pub seconds: f64,
    /// Seed of the noise that shares are measured by.
    pub seed: u64,
}

/// One run that was ridden.
struct Ridden<'a> {
    start: &'a Start,
    truths: Vec<Truth>,
    /// What the hidden force adds at each row.
    added: Vec<[f64; 3]>,
    rows: Vec<Row>,
}

/// What everything is compared with: rides, the noise that they have, and what base and
/// installation can imitate.
struct Still<'a> {
    rides: Vec<Ridden<'a>>,
    noise_sd: [f64; 4],
    columns: Vec<Vec<f64>>,
}

impl Gauge<'_> {
    /// The size of this effect that has a share of the noise's variance, and that share; it stays
    /// within its bounds.
    pub fn sized(&self, hidden: &Hidden, share: f64) -> (Hidden, f64) {
        let power = match hidden.effect.acts {
            Acts::Recorder(Fault::Saturating(_)) => -4.0,
            _ => 2.0,
        };
        let wanted = Wanted {
            share,
            within: WITHIN,
            bounds: hidden.bounds(),
        };
        let mut still = None;
        let (amount, share) = sized(hidden.amount(), power, wanted, |amount| {
            self.measured(&hidden.of_amount(amount), &mut still)
        });
        (hidden.of_amount(amount), share)
    }

    /// The share of the noise's variance that an effect has, in the channel of its two where it is
    /// larger.
    pub fn share(&self, hidden: &Hidden) -> f64 {
        self.measured(hidden, &mut None)
    }

    /// The same; what does not change with the size of a recorder's fault is kept.
    fn measured<'a>(&'a self, hidden: &Hidden, kept: &mut Option<Still<'a>>) -> f64 {
        if hidden.fault().is_none() {
            *kept = None;
        }
        let still = match kept {
            Some(still) => still,
            None => match self.still(hidden) {
                Some(still) => kept.insert(still),
                None => return f64::NAN,
            },
        };
        // Columns are in units of their own standard deviation; the base has none.
        let tolerances = still.columns.len() - BASE.len();
        let mut spreads = vec![1.0; tolerances];
        spreads.resize(still.columns.len(), f64::INFINITY);
        let effect = self.effect(hidden, still);
        let remaining = ridge_out(&still.columns, &spreads, &effect);
        // The least of the sum of squares with the tolerances' own is the effect's product with
        // what remains of it.
        let spent = (dot(&effect, &remaining) - dot(&remaining, &remaining)).max(0.0);
        let used = self.used();
        let count = remaining.len() / used.len();
        let pair = if hidden.is_longitudinal() {
            [0, 1]
        } else {
            [2, 3]
        };
        used.iter()
            .zip(remaining.chunks(count))
            .filter(|(c, _)| pair.contains(*c))
            .map(|(_, remaining)| (dot(remaining, remaining) + spent) / count as f64)
            .fold(0.0, f64::max)
    }

    /// Residual channels that can be looked at: without a track table the speed's derivative has
    /// nothing to be compared with.
    fn used(&self) -> &'static [usize] {
        if self.wrong.bare {
            &[0, 2, 3]
        } else {
            &[0, 1, 2, 3]
        }
    }

    fn still(&self, hidden: &Hidden) -> Option<Still<'_>> {
        let sled = self.sled.with(hidden);
        let recorder = self.recorder(&sled);
        let mut rides = Vec::new();
        let mut noise: [Vec<f64>; 4] = Default::default();
        let source = &mut Source::new(self.seed, "noise of the gauge");
        for start in &self.starts {
            let way = Way {
                sled: &sled,
                road: &self.roads[start.track],
                plan: &start.plan,
                rate_hz: RATE_HZ,
                seconds: self.seconds,
            };
            let felt = hidden.is_felt_on(start.track).then_some(hidden);
            let (truths, added) = way.parted(felt, STEPS);
            let holds = truths.iter().all(|t| t.beta.abs() < SLIDES_RAD);
            if !holds || truths.len() < 4 * ENDS * STEPS {
                return None;
            }
            let late = recorder.late(&truths, RATE_HZ);
            let rows = recorder.rows(&late, RATE_HZ);
            let run = Ridden {
                start,
                truths,
                added,
                rows,
            };
            let hiss = recorder.hiss(&late, RATE_HZ, source);
            for (all, run) in noise.iter_mut().zip(self.noise(&run, &hiss)) {
                all.extend(run);
            }
            rides.push(run);
        }
        let noise_sd = noise.map(|values| variance(&values).sqrt().max(1e-12));
        let mut still = Still {
            rides,
            noise_sd,
            columns: Vec::new(),
        };
        still.columns = self.columns(&still);
        Some(still)
    }

    fn recorder<'a>(&'a self, sled: &'a Sled) -> Recorder<'a> {
        Recorder {
            sled,
            wrong: self.wrong,
            fault: None,
        }
    }

    /// What noise leaves in the residuals of a run, low-passed.
    fn noise(&self, run: &Ridden, hiss: &[Row]) -> [Vec<f64>; 4] {
        let pairs = run.rows.iter().zip(hiss);
        let noisy: Vec<Row> = pairs
            .map(|(row, hiss)| std::array::from_fn(|c| row[c] + hiss[c]))
            .collect();
        let sled = stated(self.sled, &run.start.plan);
        let of = |rows: &[Row]| self.residuals(1, run, rows, &sled);
        let remaining = minus(&of(&noisy), &of(&run.rows));
        std::array::from_fn(|c| {
            let values = remaining.iter().map(|at| at[c]).collect();
            inside(values, c, 1)
        })
    }

    /// Residuals of a run at every so many rows, against a sled.
    fn residuals(&self, every: usize, run: &Ridden, rows: &[Row], sled: &Stated) -> Vec<Balances> {
        let slope = |s: f64| -self.roads[run.start.track].at(s).fall;
        let at = conditions(&run.start.plan);
        let remaining = residuals_every(every, sled, &at, &samples(rows), &slope);
        remaining.iter().map(balances).collect()
    }

    /// Stacks what every so many rows of each run show at the compared ones, by channel and in
    /// units of the noise.
    fn stacked(
        &self,
        every: usize,
        still: &Still,
        of: impl Fn(usize, &Ridden) -> Vec<Balances>,
    ) -> Vec<f64> {
        let runs = still.rides.iter().enumerate();
        let runs: Vec<Vec<Balances>> = runs.map(|(k, run)| of(k, run)).collect();
        let mut stack = Vec::new();
        for &c in self.used() {
            for run in &runs {
                let inside = inside(run.iter().map(|at| at[c]).collect(), c, every);
                let compared = inside.iter().step_by(STRIDE / every);
                stack.extend(compared.map(|x| x / still.noise_sd[c]));
            }
        }
        stack
    }

    /// What a standard deviation of each tolerance leaves, smooth enough to look at the compared
    /// rows alone, and a step of each base parameter.
    fn columns(&self, still: &Still) -> Vec<Vec<f64>> {
        let own = |run: &Ridden| stated(self.sled, &run.start.plan);
        let base: Vec<Vec<Balances>> = still
            .rides
            .iter()
            .map(|run| self.residuals(STRIDE, run, &run.rows, &own(run)))
            .collect();
        let faults = faults().into_iter().map(|(fault, sd)| {
            self.stacked(STRIDE, still, |k, run| {
                let rows = faulty(&run.rows, fault, sd);
                minus(&self.residuals(STRIDE, run, &rows, &own(run)), &base[k])
            })
        });
        let sleds = SLEDS.iter().chain(&BASE).map(|change| {
            self.stacked(STRIDE, still, |k, run| {
                let mut sled = own(run);
                change(&mut sled);
                minus(&self.residuals(STRIDE, run, &run.rows, &sled), &base[k])
            })
        });
        faults.chain(sleds).collect()
    }

    /// What an effect leaves before anything is fitted: with it less without it, at the same
    /// motion.
    fn effect(&self, hidden: &Hidden, still: &Still) -> Vec<f64> {
        let full = self.sled.with(hidden);
        self.stacked(1, still, |_, run| {
            if hidden.is_force() {
                return pushed(run);
            }
            let plan = &run.start.plan;
            let of = |rows: &[Row], sled| self.residuals(1, run, rows, &stated(sled, plan));
            let with = match hidden.fault() {
                Some(fault) => {
                    let mut recorder = self.recorder(self.sled);
                    recorder.fault = Some(fault);
                    let late = recorder.late(&run.truths, RATE_HZ);
                    of(&recorder.rows(&late, RATE_HZ), self.sled)
                }
                None => of(&run.rows, self.sled),
            };
            minus(&with, &of(&run.rows, &full))
        })
    }
}

/// One channel of every so many rows, low-passed as the share has it, less the ends that belong to
/// the filter.
fn inside(mut values: Vec<f64>, channel: usize, every: usize) -> Vec<f64> {
    // The filter counts rows.
    let cutoff_hz = every as f64 * [CUTOFF_HZ, SPEED_CUTOFF_HZ, CUTOFF_HZ, CUTOFF_HZ][channel];
    if cutoff_hz < 0.4 * ROWS_HZ {
        low_pass(&mut values, cutoff_hz);
    }
    let ends = (ENDS / every).min(values.len() / 2);
    values[ends..values.len() - ends].to_vec()
}

/// What a force adds to the balances; the speed's has its part along the course.
fn pushed(run: &Ridden) -> Vec<Balances> {
    let truths = run.truths.iter().step_by(STEPS);
    let of = |([x, y, turn], truth): (&[f64; 3], &Truth)| [*x, x * truth.beta.cos(), *y, *turn];
    let mut rows: Vec<Balances> = run.added.iter().zip(truths).map(of).collect();
    // Where nothing is felt nothing was added.
    rows.resize(run.rows.len(), [0.0; 4]);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::other_worlds::EFFECTS;
    use crate::other_worlds::wrong::World;

    /// Four short runs of a clean world.
    fn gauge<'a>(wrong: &'a Wrong, sled: &'a Sled, roads: &'a [Road; 2]) -> Gauge<'a> {
        let source = &mut Source::new(3, "starts");
        let starts = (0..4).map(|k| Start {
            name: format!("r{k}"),
            track: k % 2,
            plan: Plan::draw(0.0, &mut Source::new(4, "driver"), source),
        });
        Gauge {
            wrong,
            sled,
            roads,
            starts: starts.collect(),
            seconds: 12.0,
            seed: 3,
        }
    }

    fn world() -> (Wrong, Sled, [Road; 2]) {
        let source = &mut Source::new(3, "world");
        let wrong = Wrong::draw(World::Clean, source);
        let roads = ["a", "b"].map(|name| Road::draw(name, source));
        (wrong, Sled::published(), roads)
    }

    fn hidden(case: &str) -> Hidden {
        let effect = *EFFECTS.iter().find(|e| e.case == case).unwrap();
        Hidden {
            effect,
            size: effect.size,
            place_m: [120.0, 135.0],
            strength: 1.0,
        }
    }

    #[test]
    fn without_noise_and_effects_the_inversion_leaves_nothing_of_these_rides() {
        let (wrong, sled, roads) = world();
        let gauge = gauge(&wrong, &sled, &roads);
        let nothing = hidden("slip-offset").of_amount(0.0);
        let still = gauge.still(&nothing).unwrap();
        for run in &still.rides {
            let remaining = gauge.residuals(1, run, &run.rows, &stated(&sled, &run.start.plan));
            for c in 0..4 {
                let values = inside(remaining.iter().map(|at| at[c]).collect(), c, 1);
                let rms = (dot(&values, &values) / values.len() as f64).sqrt();
                // Steps of 5 ms and derivatives of rows.
                let noise = still.noise_sd[c];
                assert!(rms < 0.1 * noise, "channel {c}: {rms} of {noise}");
            }
        }
    }

    #[test]
    fn sizes_of_a_linear_effect_go_with_the_root_of_the_share() {
        let (wrong, sled, roads) = world();
        let gauge = gauge(&wrong, &sled, &roads);
        // The side force of camber bends the way, and with it what it adds.
        for (case, within) in [
            ("slip-offset", 0.02),
            ("speed-bias", 0.02),
            ("camber-thrust", 0.06),
        ] {
            let of = |share| gauge.sized(&hidden(case), share);
            let [(small, a), (large, b)] = [0.007, 0.06].map(of);
            assert!((a / 0.007 - 1.0).abs() < WITHIN && (b / 0.06 - 1.0).abs() < WITHIN);
            let grown = large.size / small.size;
            assert!(
                (grown / (b / a).sqrt() - 1.0).abs() < within,
                "{case} {grown}"
            );
        }
    }

    #[test]
    fn what_the_installation_imitates_costs_its_deviations_squared_and_stops_at_its_bound() {
        let (wrong, sled, roads) = world();
        let gauge = gauge(&wrong, &sled, &roads);
        assert!(gauge.share(&hidden("slip-offset")) > 1.0);
        let inertia = hidden("yaw-inertia");
        let still = gauge.still(&inertia).unwrap();
        let rows = still.columns[0].len() / gauge.used().len();
        // Imitated in full it would cost this; less of it, with something remaining, costs less
        // together.
        let most = (inertia.size / 0.05).powi(2) / rows as f64;
        let share = gauge.share(&inertia);
        assert!(share > 0.3 * most && share <= 1.01 * most, "{share} {most}");
        let (size, share) = gauge.sized(&inertia, 1e3);
        assert!(size.size == inertia.bounds()[1] && share < 1e3);
    }
}
