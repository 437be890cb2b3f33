//! Line search for the size of one effect: Gauss-Newton with secants.
//!
//! Every point costs one solve of all rows and serves twice, as a misfit and for the next
//! derivative. The first step changes the maps by a few per cent, whatever the runner's dimensions.

use kufe::case::effects::Effect;

use crate::evidence::maps::simulate::{Misfit, Simulations};
use crate::evidence::maps::sized::SizedEffects;

/// Relative change of the maps by a first step.
const CHANGE: f64 = 0.04;
const CHANGES: std::ops::RangeInclusive<f64> = 0.008..=0.12;
/// Trials without a gain after which a search ends.
const FAILURES: usize = 3;

struct Point {
    /// Coordinate of the search: the size, or its square for a blur, in which the maps are linear.
    u: f64,
    misfit: Misfit,
}

/// A line search over the size of one effect.
pub struct LineSearch {
    pub effect: &'static Effect,
    points: Vec<Point>,
    best: usize,
    low: f64,
    high: f64,
    failures: usize,
    /// Whether the search has converged.
    pub settled: bool,
}

impl LineSearch {
    /// Evaluates the first two points; `None` if the effect changes nothing or cannot be solved.
    /// `step` is the first step of an earlier search of this effect.
    pub fn start(
        simulations: &Simulations,
        active: &SizedEffects,
        effect: &'static Effect,
        step: Option<f64>,
    ) -> Option<Self> {
        let info = effect.parameter();
        let mut line = LineSearch {
            effect,
            points: Vec::new(),
            best: 0,
            low: effect.search.along(info.low),
            high: effect.search.along(info.high),
            failures: 0,
            settled: false,
        };
        let from = beginning(simulations, effect);
        line.eval(simulations, active, from)?;
        let room = line.high - from;
        let mut step = step
            .unwrap_or_else(|| effect.search.along(info.typical))
            .min(0.5 * room);
        for round in 0..3 {
            let at = from + step;
            line.points.truncate(1);
            let tried = line.eval(simulations, active, at);
            let Some(()) = tried else {
                step *= 0.2;
                continue;
            };
            let moved = line.change();
            if CHANGES.contains(&moved) || round == 2 {
                break;
            }
            let factor = (CHANGE / moved.max(1e-9)).clamp(0.01, 30.0);
            let next = (step * factor).min(0.5 * room);
            if (next - step).abs() < 0.1 * step {
                break;
            }
            step = next;
        }
        let (jj, _) = line.slopes()?;
        if jj <= 0.0 || line.change() < 1e-5 {
            return None;
        }
        line.best = usize::from(line.points[1].misfit.chi2 < line.points[0].misfit.chi2);
        Some(line)
    }

    /// Continues with steps four times as long each until two have failed: for effects whose first
    /// derivative predicts little.
    pub fn march(&mut self, simulations: &Simulations, active: &SizedEffects) {
        let from = self.points[0].u;
        let mut step = self.points[1].u - from;
        let mut worse = 0;
        while worse < 2 {
            step *= 4.0;
            if from + step > self.high || self.eval(simulations, active, from + step).is_none() {
                return;
            }
            let last = self.points.len() - 1;
            if self.points[last].misfit.chi2 < self.chi2() {
                self.best = last;
                worse = 0;
            } else {
                worse += 1;
            }
        }
    }

    /// Distance of the first two points, for a later search of the same effect.
    pub fn first_step(&self) -> f64 {
        (self.points[1].u - self.points[0].u).abs()
    }

    /// Best size so far.
    pub fn size(&self) -> f64 {
        self.effect.search.back(self.points[self.best].u)
    }

    /// Misfit at the best size.
    pub fn misfit(&self) -> &Misfit {
        &self.points[self.best].misfit
    }

    /// Sum of squares at the best size.
    pub fn chi2(&self) -> f64 {
        self.misfit().chi2
    }

    /// Sum of squares predicted for the next step.
    pub fn predicted_chi2(&self) -> f64 {
        let Some((jj, jr)) = self.slopes() else {
            return self.chi2();
        };
        let here = self.points[self.best].u;
        let by = (here - jr / jj).clamp(self.low, self.high) - here;
        (self.chi2() + 2.0 * by * jr + by * by * jj).min(self.chi2())
    }

    pub fn error(&self) -> f64 {
        let Some((jj, _)) = self.slopes() else {
            return f64::INFINITY;
        };
        let error = 1.0 / jj.sqrt();
        let here = self.points[self.best].u;
        // From the search coordinate to the size; at the start of the line from the error itself.
        0.5 * (self.effect.search.back(here + error)
            - self.effect.search.back((here - error).max(self.low)))
    }

    /// Change of the weighted residuals by the first step.
    pub fn signature(&self) -> Vec<f64> {
        let [a, b] = [0, 1].map(|k| &self.points[k].misfit.rest);
        a.iter().zip(b).map(|(a, b)| b - a).collect()
    }

    /// Size at `errors` standard errors of the search coordinate from the start of the line.
    pub fn size_at(&self, errors: f64) -> f64 {
        let squares: f64 = self.signature().iter().map(|d| d * d).sum();
        let [from, to] = [0, 1].map(|k| self.points[k].u);
        self.effect
            .search
            .back(from + errors * (to - from).abs() / squares.sqrt().max(1e-300))
    }

    /// Evaluates one more point.
    pub fn advance(&mut self, simulations: &Simulations, active: &SizedEffects) {
        let Some((jj, jr)) = self.slopes() else {
            self.settled = true;
            return;
        };
        let here = self.points[self.best].u;
        let reach = self
            .points
            .iter()
            .fold(0.0_f64, |m, p| m.max((p.u - self.points[0].u).abs()));
        let by = match self.points.len() {
            2 => self.by_moments(here),
            _ => None,
        };
        let by = by.unwrap_or_else(|| (-jr / jj).clamp(-4.0 * reach, 4.0 * reach));
        let mut to = (here + by).clamp(self.low, self.high);
        if (to - here).abs() < 0.05 / jj.sqrt() {
            self.settled = true;
            return;
        }
        let guess = self.points.len() == 2;
        if self
            .points
            .iter()
            .any(|p| (p.u - to).abs() < 0.01 * by.abs())
        {
            // That point is known and no better: halves the step.
            to = here + 0.5 * (to - here);
        }
        let before = self.chi2();
        match self.eval(simulations, active, to) {
            None => {
                // That point cannot be solved: bounds the search at half the step.
                let wall = here + 0.5 * (to - here);
                if to > here {
                    self.high = wall;
                } else {
                    self.low = wall;
                }
                self.failures += 1;
            }
            Some(()) => {
                let last = self.points.len() - 1;
                if self.points[last].misfit.chi2 < before {
                    self.best = last;
                    self.settled = !guess && before - self.chi2() < 1e-3 * before;
                } else if !guess {
                    self.failures += 1;
                }
            }
        }
        self.settled |= self.failures >= FAILURES;
    }

    /// The step from `here` that matches sum, centre and spread of the maps; `None` without maps.
    fn by_moments(&self, here: f64) -> Option<f64> {
        let [a, b] = [0, 1].map(|k| &self.points[k]);
        let du = b.u - a.u;
        let pairs = a.misfit.moments.iter().zip(&b.misfit.moments);
        let (jj, jr) = pairs.fold((0.0, 0.0), |(jj, jr), (a, b)| {
            let j = (b - a) / du;
            (jj + j * j, jr + j * a)
        });
        (jj > 0.0).then(|| a.u - jr / jj - here)
    }

    fn eval(&mut self, simulations: &Simulations, active: &SizedEffects, u: f64) -> Option<()> {
        let mut with = active.clone();
        with.push((self.effect, self.effect.search.back(u)));
        let misfit = simulations.searching(&with).ok()?;
        self.points.push(Point { u, misfit });
        Some(())
    }

    fn neighbour(&self) -> Option<usize> {
        let here = self.points[self.best].u;
        (0..self.points.len())
            .filter(|k| *k != self.best)
            .min_by(|a, b| {
                let off = |k: usize| (self.points[k].u - here).abs();
                off(*a).total_cmp(&off(*b))
            })
    }

    /// J.J and J.r at the best point.
    fn slopes(&self) -> Option<(f64, f64)> {
        let other = self.neighbour()?;
        let (a, b) = (&self.points[self.best], &self.points[other]);
        let du = b.u - a.u;
        let pairs = a.misfit.rest.iter().zip(&b.misfit.rest);
        let (jj, jr) = pairs.fold((0.0, 0.0), |(jj, jr), (a, b)| {
            let j = (b - a) / du;
            (jj + j * j, jr + j * a)
        });
        (jj > 0.0).then_some((jj, jr))
    }

    /// Relative difference of the maps at the first two points.
    fn change(&self) -> f64 {
        let [a, b] = [0, 1].map(|k| &self.points[k].misfit);
        let squares: f64 = a
            .rest
            .iter()
            .zip(&b.rest)
            .map(|(a, b)| (a - b).powi(2))
            .sum();
        squares.sqrt() / a.size.max(1e-300)
    }
}

/// The size up to which an effect changes no row.
fn beginning(simulations: &Simulations, effect: &'static Effect) -> f64 {
    let Some(begins) = effect.search.begins else {
        return 0.0;
    };
    let rows = simulations.rows.iter();
    let largest = rows.clone().map(|r| r.p_max).fold(1.0, f64::max);
    rows.map(|r| begins(&r.problem, largest))
        .reduce(f64::min)
        .unwrap_or(0.0)
}
