//! Experimental design: simulated runs that would discriminate between the members of a class.
//!
//! A class is a set of effects that the data so far cannot distinguish. Every plan is simulated
//! with each member at its fitted size, without noise, and evaluated with the model of every other
//! member (each model fitted to the data so far). With r the difference of the two models' whitened
//! residuals, U the columns of the unknown parameters in units of their standard deviations, and n
//! equal runs in one session, the expected log-likelihood ratio is
//!
//! ```text
//! 1/2 (n r'r  -  n^2 r'U (1 + n U'U)^-1 U'r)
//! ```
//!
//! which is `1/2 R' (1 + Z Z')^-1 R` with R and Z the n-fold stacked r and U (Woodbury): U u are
//! random effects with independent u of unit variance, common to the runs.
//!
//! U contains a session's level of friction and of grip, scaled by the standard deviation between
//! sessions, and the other model's parameters (base, installation, size), scaled by a root of their
//! posterior covariance. With training runs of a single session the standard deviation between
//! sessions is taken as 0: the levels then count as known, and the ratio is an upper bound. The
//! value of a plan is the smallest ratio of any two members that some plan discriminates. A
//! member's expected t is the square root of twice the ratio.

use std::collections::BTreeSet;

use kufe_sled::Noise;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::error::Result;
use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::design::OWN_LEVELS;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::outcome::run_plans::{Plan, RUNS, plans, simulated_run};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::levels::group;
use crate::finding::NextRuns;
use crate::finding::Step;
use crate::procedure::evidence::Evidence as _;
use crate::procedure::shared_effects::{Amount, SharesEffects as _};
use crate::regression::inverse::ridge_inverse;

/// A member of the class.
struct Member {
    effect: String,
    model: ResidualModel,
    /// A root X of the posterior covariance `X X'` of its parameters.
    covariance_root: DMatrix<f64>,
}

/// Indices of two members and the expected log-likelihood ratio between them.
type Pair = ([usize; 2], f64);

impl Campaign<'_> {
    /// Advice to make the runs that would halve the smallest detectable sizes, which are
    /// proportional to 1 / sqrt(runs).
    pub fn runs_to_halve(&self) -> String {
        let runs = self.training.len() + self.held_out.len();
        let tracks: BTreeSet<&str> = self.training.iter().map(|f| f.track.as_str()).collect();
        format!(
            "{} more runs on {}, which would halve the smallest sizes that can be found",
            3 * runs,
            Vec::from_iter(tracks).join(" and ")
        )
    }

    /// Plans for the first step whose class has several members, the best first; empty if no track
    /// is known or fewer than two members have a model.
    pub fn next_runs(&mut self, last: &RunFit, steps: &[Step]) -> Result<Vec<NextRuns>> {
        let several = steps.iter().position(|step| step.class.len() > 1);
        let Some(step) = several.filter(|_| !self.data.tracks.is_empty()) else {
            return Ok(Vec::new());
        };
        let members = self.members(last, step, &steps[step])?;
        if members.len() < 2 {
            return Ok(Vec::new());
        }
        let whitener = &last.whitener;
        let level_sd = self.between_sessions(last);
        let campaign = &*self;
        let evaluated: Vec<(Plan, Vec<Pair>)> = plans(self.data, &self.training, self.model)
            .into_par_iter()
            .filter_map(|plan| {
                let pairs = campaign.pairwise_evidence(&plan, &members, whitener, level_sd)?;
                Some((plan, pairs))
            })
            .collect();
        // Pairs that no plan discriminates do not affect the order, unless there are no others.
        let can_be_split = |pair: &Pair| {
            let of_plans = evaluated.iter().flat_map(|(_, pairs)| pairs);
            let mut same = of_plans.filter(|other| other.0 == pair.0);
            same.any(|other| campaign.discriminates(other.1))
        };
        let mut all = evaluated.iter().flat_map(|(_, pairs)| pairs);
        let any = all.any(can_be_split);
        let mut ranked: Vec<NextRuns> = evaluated
            .iter()
            .filter_map(|(plan, pairs)| {
                let counted = pairs.iter().filter(|pair| !any || can_be_split(pair));
                let weakest = counted.min_by(|a, b| a.1.total_cmp(&b.1))?;
                let names = weakest.0.map(|m| members[m].effect.as_str());
                Some(plan.next_runs(names, weakest.1, campaign.discriminates(weakest.1)))
            })
            .collect();
        ranked.sort_by(|a, b| b.expected_evidence.total_cmp(&a.expected_evidence));
        Ok(ranked)
    }

    /// Whether this expected log-likelihood ratio discriminates two members with a probability of
    /// 90 %.
    fn discriminates(&self, evidence: f64) -> bool {
        let (runs, levels) = (&self.rules().rivals, &self.rules().level_rivals);
        let needed = runs.needed_t.max(levels.needed_t);
        (2.0 * evidence).sqrt() >= needed + self.options.rules.search.nine_in_ten
    }

    /// The model with each member of a step's class in turn, fitted.
    fn members(&mut self, last: &RunFit, step: usize, reported: &Step) -> Result<Vec<Member>> {
        let without = self.without_step(last, step)?;
        let mut members = vec![self.member(&reported.effect, last)];
        for effect in &reported.class[1..] {
            let Some(rival) = reported.rivals.iter().find(|r| r.effect == *effect) else {
                continue;
            };
            let Some(selection) = self.select(&without, &Amount::of_rival(rival, 0.0)) else {
                continue;
            };
            let added = self.add(&without, &selection, reported.class.len() + step)?;
            members.push(self.member(effect, &added.fit));
        }
        Ok(members)
    }

    /// A member with the posterior covariance of its parameters.
    fn member(&self, effect: &str, fit: &RunFit) -> Member {
        let model = fit.residual_model.without_discrepancy().with_fixed(false);
        let design = self.design(&model, &fit.whitener, &[]);
        let fitted = design.fitted_count();
        let mut sum = DMatrix::zeros(fitted, fitted);
        for products in design.products(&self.training) {
            sum += products
                .full
                .view((OWN_LEVELS, OWN_LEVELS), (fitted, fitted));
        }
        let eigen = design.prior().inverse(sum).symmetric_eigen();
        let roots = eigen.eigenvalues.map(|value| value.max(0.0).sqrt());
        Member {
            effect: effect.to_owned(),
            covariance_root: eigen.eigenvectors * DMatrix::from_diagonal(&roots),
            model,
        }
    }

    /// Standard deviations of the sessions' mean levels of friction and of grip; 0 with a single
    /// session.
    fn between_sessions(&self, last: &RunFit) -> [f64; OWN_LEVELS] {
        let design = self.design(&last.residual_model, &last.whitener, &[]);
        let level_of = |frame: &Frame| {
            let columns = design.columns(frame);
            let levels = columns.columns(0, OWN_LEVELS);
            let residual = columns.column(columns.ncols() - 1);
            let level = ridge_inverse(levels.tr_mul(&levels)) * levels.tr_mul(&residual);
            [level[0], level[1]]
        };
        let levels: Vec<[f64; OWN_LEVELS]> = self.training.par_iter().map(level_of).collect();
        let sessions = group(&self.training);
        std::array::from_fn(|k| {
            let means: Vec<f64> = sessions
                .values()
                .map(|runs| runs.iter().map(|i| levels[*i][k]).sum::<f64>() / runs.len() as f64)
                .collect();
            let count = means.len() as f64;
            let mean = means.iter().sum::<f64>() / count;
            let squares: f64 = means.iter().map(|m| (m - mean).powi(2)).sum();
            (squares / (count - 1.0).max(1.0)).sqrt()
        })
    }

    /// Expected log-likelihood ratio of a plan for every pair of members, the smaller one of both
    /// directions; `None` if the plan cannot be simulated or a ratio is not finite.
    fn pairwise_evidence(
        &self,
        plan: &Plan,
        members: &[Member],
        whitener: &Whitener,
        level_sd: [f64; OWN_LEVELS],
    ) -> Option<Vec<Pair>> {
        let mut pairs: Vec<Pair> = Vec::new();
        for (a, truth) in members.iter().enumerate() {
            let simulate = |noise: Option<&Noise>| simulated_run(self, &truth.model, plan, noise);
            let frame = simulate(None)?;
            let whitener = match plan.noise {
                None => whitener.clone(),
                Some(better) => {
                    let usual = self.data.noise.sd();
                    let runs = [simulate(Some(&usual))?, simulate(Some(&better))?];
                    self.with_reduced_noise(whitener, &truth.model, runs)
                }
            };
            let columns_of =
                |member: &Member| self.design(&member.model, &whitener, &[]).columns(&frame);
            // The residual is the last column of a design.
            let residual =
                |columns: &DMatrix<f64>| columns.column(columns.ncols() - 1).into_owned();
            let of_truth = residual(&columns_of(truth));
            for (b, rival) in members.iter().enumerate().filter(|(b, _)| *b != a) {
                let columns = columns_of(rival);
                let level_sd = DMatrix::from_diagonal(&DVector::from_row_slice(&level_sd));
                let levels = columns.columns(0, OWN_LEVELS) * level_sd;
                let root = &rival.covariance_root;
                let fitted = columns.columns(OWN_LEVELS, root.nrows()) * root;
                let mut unknown = levels.insert_columns(OWN_LEVELS, fitted.ncols(), 0.0);
                let mut free = unknown.columns_mut(OWN_LEVELS, fitted.ncols());
                free.copy_from(&fitted);
                let difference = residual(&columns) - &of_truth;
                let evidence = expected_log_likelihood_ratio(&difference, &unknown);
                let pair = [a.min(b), a.max(b)];
                match pairs.iter_mut().find(|p| p.0 == pair) {
                    Some(known) => known.1 = known.1.min(evidence),
                    None => pairs.push((pair, evidence)),
                }
            }
        }
        let finite = pairs.iter().all(|pair| pair.1.is_finite());
        finite.then_some(pairs)
    }

    /// A whitening with less noise: the variance of each channel is reduced by the difference
    /// between the two simulated runs.
    fn with_reduced_noise(
        &self,
        whitener: &Whitener,
        model: &ResidualModel,
        [before, after]: [Frame; 2],
    ) -> Whitener {
        let sd = |frame: Frame| {
            let frames = [frame];
            Whitener::estimate(&frames, &residuals(model, &frames), whitener.used).sd
        };
        let (before, after) = (sd(before), sd(after));
        whitener.with_sd(std::array::from_fn(|c| {
            let sd = whitener.sd[c];
            // Model error is not reduced.
            let variance = sd * sd - before[c].powi(2) + after[c].powi(2);
            variance.max(after[c].powi(2)).sqrt().min(sd)
        }))
    }
}

/// Expected log-likelihood ratio of [`RUNS`] equal runs in one session, with the residual r of a
/// run and the columns U of unknown parameters.
fn expected_log_likelihood_ratio(r: &DVector<f64>, unknown: &DMatrix<f64>) -> f64 {
    let n = RUNS as f64;
    let count = unknown.ncols();
    let inner = DMatrix::identity(count, count) + unknown.tr_mul(unknown) * n;
    let projection = unknown.tr_mul(r);
    let explained = inner
        .lu()
        .solve(&projection)
        .map_or(0.0, |solved| projection.dot(&solved));
    0.5 * (n * r.norm_squared() - n * n * explained)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With known levels the ratio is half the sum of squares. With unknown levels a change that
    /// resembles one has no value, however often it is driven. In between it is the ratio of the
    /// marginal normal distribution, with its full covariance.
    #[test]
    fn the_expected_ratio_is_that_of_normal_rows_with_levels_of_their_own() {
        let own = DMatrix::from_fn(6, 2, |i, k| if k == 0 { 1.0 } else { i as f64 - 2.5 });
        let r = DVector::from_fn(6, |i, _| 0.3 + 0.1 * (i as f64).sin());
        let n = RUNS as f64;
        let spread = |sd: [f64; 2]| &own * DMatrix::from_diagonal(&DVector::from_row_slice(&sd));
        let known = expected_log_likelihood_ratio(&r, &spread([0.0, 0.0]));
        assert!((known - 0.5 * n * r.norm_squared()).abs() < 1e-12);
        let level = own.column(0).into_owned();
        assert!(expected_log_likelihood_ratio(&level, &spread([1e6, 1e6])) < 1e-6);
        let unknown = spread([0.4, 0.2]);
        let rows = 6 * RUNS;
        let all = DVector::from_fn(rows, |i, _| r[i % 6]);
        let levels = DMatrix::from_fn(rows, 2, |i, k| unknown[(i % 6, k)]);
        let covariance = DMatrix::identity(rows, rows) + &levels * levels.transpose();
        let full = 0.5 * all.dot(&covariance.lu().solve(&all).unwrap());
        assert!((expected_log_likelihood_ratio(&r, &unknown) / full - 1.0).abs() < 1e-12);
    }
}
