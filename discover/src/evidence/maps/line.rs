//! Line search for the size of one effect: Gauss-Newton with secants.
//!
//! Every point costs one solve of all rows and serves twice, as a misfit and for the next
//! derivative. The first step changes the maps by a few per cent, whatever the runner's dimensions.

use kufe::case::effects::Effect;

use crate::evidence::maps::simulate::{Misfit, Simulations, SizedEffects};
use crate::procedure::candidate::Candidate;
use crate::procedure::closed::change;

/// Relative change of the maps at which the first step aims.
const CHANGE: f64 = 0.04;
/// Range of the relative change in which a first step is accepted.
const CHANGES: std::ops::RangeInclusive<f64> = 0.008..=0.12;
/// Trials without a gain after which a search ends.
const FAILURES: usize = 3;

/// An evaluated point.
struct Point {
    /// Coordinate of the search: the size, or its square for a blur, in which the maps are linear.
    u: f64,
    misfit: Misfit,
}

/// A line search over the size of one effect.
pub struct LineSearch {
    pub candidate: Candidate<&'static Effect>,
    points: Vec<Point>,
    /// Index of the best point.
    best: usize,
    /// Bounds of the search coordinate.
    low: f64,
    high: f64,
    /// Number of trials without a gain.
    failures: usize,
    /// Whether the search has converged.
    pub converged: bool,
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
        let parameter = effect.parameter();
        let mut line = LineSearch {
            candidate: Candidate::of_catalogue(effect.info(), parameter, effect),
            points: Vec::new(),
            best: 0,
            low: effect.search.along(parameter.low),
            high: effect.search.along(parameter.high),
            failures: 0,
            converged: false,
        };
        let from = beginning(simulations, effect);
        line.eval(simulations, active, from)?;
        let max_step = 0.5 * (line.high - from);
        let step = step.unwrap_or_else(|| effect.search.along(parameter.typical));
        let mut step = step.min(max_step);
        for round in 0..3 {
            line.points.truncate(1);
            if line.eval(simulations, active, from + step).is_none() {
                step *= 0.2;
                continue;
            }
            let change = line.change();
            let next = step * (CHANGE / change.max(1e-9)).clamp(0.01, 30.0);
            let next = next.min(max_step);
            if CHANGES.contains(&change) || round == 2 || (next - step).abs() < 0.1 * step {
                break;
            }
            step = next;
        }
        line.slopes()?;
        if line.change() < 1e-5 {
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
            worse = if self.keep_if_better() { 0 } else { worse + 1 };
        }
    }

    /// Distance of the first two points, for a later search of the same effect.
    pub fn first_step(&self) -> f64 {
        (self.points[1].u - self.points[0].u).abs()
    }

    /// Best size so far.
    pub fn size(&self) -> f64 {
        self.size_of(self.points[self.best].u)
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

    /// Standard error of the size; infinite if the derivative is 0.
    pub fn error(&self) -> f64 {
        let Some((jj, _)) = self.slopes() else {
            return f64::INFINITY;
        };
        let error = 1.0 / jj.sqrt();
        let here = self.points[self.best].u;
        // Half the interval of one standard error in the search coordinate, as a size.
        0.5 * (self.size_of(here + error) - self.size_of((here - error).max(self.low)))
    }

    /// Change of the weighted residuals by the first step.
    fn signature(&self) -> Vec<f64> {
        change(
            &self.points[1].misfit.residuals,
            &self.points[0].misfit.residuals,
        )
    }

    /// Cosine between two effects' changes of the maps.
    pub fn correlation(&self, other: &LineSearch) -> f64 {
        let (a, b) = (self.signature(), other.signature());
        dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt().max(1e-300)
    }

    /// Size at `errors` standard errors of the search coordinate from the start of the line.
    pub fn size_at(&self, errors: f64) -> f64 {
        let signature = self.signature();
        let norm = dot(&signature, &signature).sqrt();
        self.size_of(self.points[0].u + errors * self.first_step() / norm.max(1e-300))
    }

    /// Evaluates one more point: a Gauss-Newton step, at first the step that matches moments.
    pub fn advance(&mut self, simulations: &Simulations, active: &SizedEffects) {
        let Some((jj, jr)) = self.slopes() else {
            self.converged = true;
            return;
        };
        let here = self.points[self.best].u;
        let start = self.points[0].u;
        let reach = self.points.iter().map(|p| (p.u - start).abs());
        let max_step = 4.0 * reach.fold(0.0, f64::max);
        let is_first = self.points.len() == 2;
        let by_moments = is_first.then(|| self.by_moments(here)).flatten();
        let by = by_moments.unwrap_or_else(|| (-jr / jj).clamp(-max_step, max_step));
        let mut to = (here + by).clamp(self.low, self.high);
        if (to - here).abs() < 0.05 / jj.sqrt() {
            self.converged = true;
            return;
        }
        let known = |p: &Point| (p.u - to).abs() < 0.01 * by.abs();
        if self.points.iter().any(known) {
            // The point was evaluated and is not better: halves the step.
            to = here + 0.5 * (to - here);
        }
        let before = self.chi2();
        if self.eval(simulations, active, to).is_none() {
            // The point cannot be solved: bounds the search at half the step.
            let end = if to > here {
                &mut self.high
            } else {
                &mut self.low
            };
            *end = here + 0.5 * (to - here);
            self.failures += 1;
        } else if self.keep_if_better() {
            self.converged = !is_first && before - self.chi2() < 1e-3 * before;
        } else if !is_first {
            self.failures += 1;
        }
        self.converged |= self.failures >= FAILURES;
    }

    /// The step from `here` that matches sum, centre and spread of the maps; `None` without maps.
    fn by_moments(&self, here: f64) -> Option<f64> {
        let [a, b] = [0, 1].map(|k| &self.points[k]);
        let (jj, jr) = products(&a.misfit.moments, &b.misfit.moments, b.u - a.u);
        (jj > 0.0).then(|| a.u - jr / jj - here)
    }

    /// Evaluates a point; `None` if it cannot be solved.
    fn eval(&mut self, simulations: &Simulations, active: &SizedEffects, u: f64) -> Option<()> {
        let mut with = active.clone();
        with.push((self.candidate.act, self.size_of(u)));
        let misfit = simulations.searching(&with).ok()?;
        self.points.push(Point { u, misfit });
        Some(())
    }

    /// Makes the last point the best one if its misfit is smaller; returns whether it is.
    fn keep_if_better(&mut self) -> bool {
        let last = self.points.len() - 1;
        let is_better = self.points[last].misfit.chi2 < self.chi2();
        if is_better {
            self.best = last;
        }
        is_better
    }

    /// The size at a coordinate of the search.
    fn size_of(&self, u: f64) -> f64 {
        self.candidate.act.search.back(u)
    }

    /// J.J and J.r at the best point, with the derivative J by a secant to its nearest neighbour;
    /// `None` if J is 0.
    fn slopes(&self) -> Option<(f64, f64)> {
        let best = &self.points[self.best];
        let others = self.points.iter().enumerate();
        let others = others.filter(|(k, _)| *k != self.best).map(|(_, p)| p);
        let off = |p: &&Point| (p.u - best.u).abs();
        let nearest = others.min_by(|a, b| off(a).total_cmp(&off(b)))?;
        let (jj, jr) = products(
            &best.misfit.residuals,
            &nearest.misfit.residuals,
            nearest.u - best.u,
        );
        (jj > 0.0).then_some((jj, jr))
    }

    /// Relative difference of the maps at the first two points.
    fn change(&self) -> f64 {
        let signature = self.signature();
        dot(&signature, &signature).sqrt() / self.points[0].misfit.size.max(1e-300)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

/// J.J and J.a with the derivative J = (b - a) / du.
fn products(a: &[f64], b: &[f64], du: f64) -> (f64, f64) {
    a.iter().zip(b).fold((0.0, 0.0), |(jj, ja), (a, b)| {
        let j = (b - a) / du;
        (jj + j * j, ja + j * a)
    })
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
