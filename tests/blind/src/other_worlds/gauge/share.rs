//! Noise-free rides of a campaign, and the share of the noise's variance that an effect has in them.

use super::installation::{BASE, SLEDS, faults, faulty};
use super::inversion::{Balances, balances, conditions, minus, samples, stated};
use crate::other_worlds::hidden::{Acts, Hidden};
use crate::other_worlds::recorder::{Recorder, Row};
use crate::other_worlds::ride::{Plan, Truth, Way};
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
/// Steps from one compared row to the next.
const STEPS: usize = STRIDE * 2;
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
    /// What the hidden force adds at each compared row.
    added: Vec<[f64; 3]>,
    rows: Vec<Row>,
}

/// What everything is compared with: rides, the noise that they have, and what base and installation can imitate.
struct Still<'a> {
    rides: Vec<Ridden<'a>>,
    noise_sd: [f64; 4],
    columns: Vec<Vec<f64>>,
}

impl Gauge<'_> {
    /// The size of this effect that has a share of the noise's variance, and that share; it stays within its bounds.
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

    /// The share of the noise's variance that an effect has, in the channel of its two where it is larger.
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
        let left = ridge_out(&still.columns, &spreads, &self.effect(hidden, still));
        let used = self.used();
        let count = left.len() / used.len();
        let pair = if hidden.is_longitudinal() { [0, 1] } else { [2, 3] };
        used.iter()
            .zip(left.chunks(count))
            .filter(|(c, _)| pair.contains(*c))
            .map(|(_, left)| dot(left, left) / count as f64)
            .fold(0.0, f64::max)
    }

    /// Residual channels that can be looked at: without a track table the speed's derivative has nothing to be held against.
    fn used(&self) -> &'static [usize] {
        if self.wrong.bare { &[0, 2, 3] } else { &[0, 1, 2, 3] }
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
            if truths.iter().any(|t| !(t.beta.abs() < SLIDES_RAD)) {
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
        let left = minus(&of(&noisy), &of(&run.rows));
        let cutoff = [CUTOFF_HZ, SPEED_CUTOFF_HZ, CUTOFF_HZ, CUTOFF_HZ];
        std::array::from_fn(|c| {
            let mut values: Vec<f64> = left.iter().map(|at| at[c]).collect();
            low_pass(&mut values, cutoff[c]);
            let ends = ENDS.min(values.len() / 2);
            values[ends..values.len() - ends].to_vec()
        })
    }

    /// Residuals of a run at every so many rows, against a sled.
    fn residuals(&self, every: usize, run: &Ridden, rows: &[Row], sled: &Stated) -> Vec<Balances> {
        let slope = |s: f64| -self.roads[run.start.track].at(s).fall;
        let at = conditions(&run.start.plan);
        let left = residuals_every(every, sled, &at, &samples(rows), &slope);
        left.iter().map(balances).collect()
    }

    /// Stacks what was found at the compared rows of each run by channel, in units of the noise.
    fn stacked(&self, still: &Still, of: impl Fn(usize, &Ridden) -> Vec<Balances>) -> Vec<f64> {
        let runs = still.rides.iter().enumerate();
        let runs: Vec<Vec<Balances>> = runs.map(|(k, run)| of(k, run)).collect();
        let mut stack = Vec::new();
        for &c in self.used() {
            for run in &runs {
                let mut values: Vec<f64> = run.iter().map(|at| at[c]).collect();
                if c == 1 {
                    // The filter counts rows, of which there are fewer here.
                    low_pass(&mut values, SPEED_CUTOFF_HZ * STRIDE as f64);
                }
                let ends = (ENDS / STRIDE).min(values.len() / 2);
                let inside = &values[ends..values.len() - ends];
                stack.extend(inside.iter().map(|x| x / still.noise_sd[c]));
            }
        }
        stack
    }

    /// What a standard deviation of each tolerance leaves, and a step of each base parameter.
    fn columns(&self, still: &Still) -> Vec<Vec<f64>> {
        let own = |run: &Ridden| stated(self.sled, &run.start.plan);
        let base: Vec<Vec<Balances>> = still
            .rides
            .iter()
            .map(|run| self.residuals(STRIDE, run, &run.rows, &own(run)))
            .collect();
        let faults = faults().into_iter().map(|(fault, sd)| {
            self.stacked(still, |k, run| {
                let rows = faulty(&run.rows, fault, sd);
                minus(&self.residuals(STRIDE, run, &rows, &own(run)), &base[k])
            })
        });
        let sleds = SLEDS.iter().chain(&BASE).map(|change| {
            self.stacked(still, |k, run| {
                let mut sled = own(run);
                change(&mut sled);
                minus(&self.residuals(STRIDE, run, &run.rows, &sled), &base[k])
            })
        });
        faults.chain(sleds).collect()
    }

    /// What an effect leaves before anything is fitted: with it less without it, at the same motion.
    fn effect(&self, hidden: &Hidden, still: &Still) -> Vec<f64> {
        let full = self.sled.with(hidden);
        self.stacked(still, |_, run| {
            if hidden.is_force() {
                return pushed(run);
            }
            let plan = &run.start.plan;
            let of = |rows: &[Row], sled| self.residuals(STRIDE, run, rows, &stated(sled, plan));
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

/// What a force adds to the balances at the compared rows; the speed's has its part along the course.
fn pushed(run: &Ridden) -> Vec<Balances> {
    let truths = run.truths.iter().step_by(STEPS);
    let mut rows: Vec<Balances> = run
        .added
        .iter()
        .zip(truths)
        .map(|([x, y, turn], truth)| [*x, x * truth.beta.cos(), *y, *turn])
        .collect();
    rows.resize(run.rows.len().div_ceil(STRIDE), [0.0; 4]);
    rows
}
