//! Installation errors: one Newton step of all parts on corrected scores.

use nalgebra::{DMatrix, DVector};

use crate::error::Error;
use crate::evidence::runs::campaign::{Campaign, INSTALLATION_PAIRS, RunFit};
use crate::evidence::runs::contacts::own::without_contacts;
use crate::evidence::runs::fit::estimate::{FIRST_ROUND, solve};
use crate::evidence::runs::fit::gauss_newton::{residuals, stepped};
use crate::evidence::runs::fit::noise_products::{corrected, fitted_products, mean_noise_products};
use crate::evidence::runs::fit::row_noise::model_error;
use crate::evidence::runs::model::design::{Design, OWN_LEVELS, Products};
use crate::evidence::runs::model::discrepancy::Discrepancy;
use crate::evidence::runs::model::installation::Installation;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::gram::Gram;
use crate::regression::inverse::ridge_inverse;
use crate::regression::prior::Prior;
use crate::regression::scores::cross_information;

/// Products of all fitted columns, with each installation error in its stated standard deviation.
struct PartProducts {
    /// Products of base, amplitudes, parts and residual by run, and their bias by noise.
    by_run: Vec<[DMatrix<f64>; 2]>,
    /// Plain products of the parts given the base; 0 for those that equal a fitted amplitude.
    free_products: DMatrix<f64>,
}

impl Campaign<'_> {
    /// A fit from the given base with new installation errors, discrepancy and model error.
    pub fn fitted_anew(&self, model: &ResidualModel, owners: Vec<usize>) -> Result<RunFit, Error> {
        const ROUND: u64 = 6_500_003;
        let bare = ResidualModel {
            base: self.given.base,
            installation: Installation::default(),
            ..model.without_discrepancy()
        };
        let mut fit = self.installed(&self.least_squares(&bare, owners)?)?;
        let model = &fit.residual_model;
        let residual = residuals(model, &self.training);
        let by_inputs = self
            .simulator(model)
            .residuals(&self.training, model, ROUND);
        let discrepancy = Discrepancy::estimate(
            &self.training,
            [&residual, &by_inputs],
            &self.used,
            self.rules().discrepancy_m,
        );
        let model = ResidualModel {
            discrepancy,
            ..model.with_fixed(false)
        };
        fit = self.fitted(&model, fit.owners)?;
        let model_error = model_error(&fit.residual_model, &self.training);
        for model in [&mut fit.residual_model, &mut fit.settled] {
            model.model_error = model_error;
        }
        Ok(fit)
    }

    /// A fitted model with its installation errors, as far as the training rows determine them:
    /// combinations of which one standard deviation changes a statistic by its own or more.
    pub fn installed(&self, fit: &RunFit) -> Result<RunFit, Error> {
        const LEAST: f64 = 1.0;
        let mut stated = self.stated_installation(&self.training);
        if stated.fitted() == 0 {
            return Ok(fit.clone());
        }
        if let Some(information) = self.track_information(&fit.residual_model, &stated) {
            stated = stated.informed(information);
        }
        let without = ResidualModel {
            installation: stated.clone(),
            ..fit.residual_model.clone()
        };
        let plain = self.least_squares(&without, fit.owners.clone())?;
        let products = self.part_products(&plain);
        let installation = stated.determined_by(&products.free_products, LEAST);
        let start = ResidualModel {
            installation,
            ..plain.residual_model.clone()
        };
        let at = start.with_fixed(true);
        let plain = RunFit {
            settled: at.clone(),
            residual_model: at,
            ..plain
        };
        let installation = &start.installation;
        let directions = &installation.directions;
        if directions.is_empty() {
            return Ok(plain);
        }
        // From parts to combinations; the columns before and after them are unchanged.
        let count = installation.parts.len();
        let all = (products.by_run.first()).map_or(0, |[products, _]| products.ncols());
        let first = all - 1 - count;
        let mut combined = DMatrix::zeros(all, first + directions.len() + 1);
        (0..first).for_each(|k| combined[(k, k)] = 1.0);
        combined[(all - 1, first + directions.len())] = 1.0;
        for (k, direction) in directions.iter().enumerate() {
            for (j, share) in installation.shares(direction).iter().enumerate() {
                combined[(first + j, first + k)] = *share;
            }
        }
        let of = |products: &DMatrix<f64>| combined.tr_mul(&(products * &combined));
        let runs = products.by_run.iter().map(|both| both.each_ref().map(of));
        let start = start.with_fixed(false);
        let prior = self.fit_design(&start, &plain.whitener).prior();
        let step = solve(&corrected(&runs.collect::<Vec<_>>(), &prior), &prior).0;
        self.with_installation(plain, &stepped(&start, &self.free, step.as_slice(), 1.0))
    }

    /// Installation errors that the tolerances allow in these runs.
    fn stated_installation(&self, frames: &[Frame]) -> Installation {
        let sessions = frames.iter().map(|frame| frame.session.as_str());
        Installation::new(&self.model.tolerances.unwrap_or_default(), sessions)
    }

    /// The model with the installation errors and the discrepancy of these runs.
    ///
    /// Both have their priors; base and effects are given. Installation errors of other runs are
    /// not used, since sensors are mounted anew.
    pub fn installed_in(
        &self,
        model: &ResidualModel,
        whitener: &Whitener,
        frames: &[Frame],
    ) -> ResidualModel {
        /// Newton steps: delays are not linear.
        const STEPS: u64 = 2;
        let frames: Vec<Frame> = frames.iter().map(without_contacts).collect();
        let mut stated = self.stated_installation(&frames);
        if frames.is_empty() || stated.fitted() == 0 {
            return model.clone();
        }
        if let Some(information) = self.track_information(model, &stated) {
            stated = stated.informed(information);
        }
        let effects = model.effects.active.iter();
        let mut given = ResidualModel {
            installation: stated,
            discrepancy: model.discrepancy.with_fixed(false).at_zero(),
            frozen: effects.map(|effect| effect.name.clone()).collect(),
            ..model.clone()
        };
        for _ in 0..STEPS {
            let design = Design {
                free_base: &[],
                ..self.fit_design(&given, whitener)
            };
            let products = design.products(&frames);
            let noise = self.noise_of(&design, &frames);
            let prior = design.prior();
            let runs = corrected(&fitted_products(&design, &products, &noise), &prior);
            let step = solve(&runs, &prior).0;
            given = stepped(&given, &[], step.as_slice(), 1.0);
        }
        ResidualModel {
            frozen: model.frozen.clone(),
            ..given.with_fixed(true)
        }
    }

    /// Products for a fit whose installation errors the forces do not determine.
    fn part_products(&self, plain: &RunFit) -> PartProducts {
        let model = plain.residual_model.with_fixed(false);
        let design = self.fit_design(&model, &plain.whitener);
        let products = design.products(&self.training);
        let noise = self.noise_of(&design, &self.training);
        let mut free_products = products_given_base(&design, &products);
        let total = corrected_total(&products, &noise);
        for (_, part) in named(&total, self.free.len(), free_products.ncols()) {
            free_products.row_mut(part).fill(0.0);
            free_products.column_mut(part).fill(0.0);
        }
        PartProducts {
            by_run: fitted_products(&design, &products, &noise),
            free_products,
        }
    }

    /// Covariance of base and amplitudes due to undetermined combinations of installation errors.
    ///
    /// With J the columns of base and amplitudes, N those of the parts and P the projection on the
    /// undetermined combinations, `inv(J'J) J'N P N'J inv(J'J)`. A part that equals a named
    /// amplitude, such as the scale of a sensor, does not contribute.
    pub fn undetermined(&self, model: &ResidualModel, whitener: &Whitener) -> DMatrix<f64> {
        let installation = &model.installation;
        let count = installation.parts.len();
        let all = ResidualModel {
            installation: installation.part_by_part(),
            ..model.without_discrepancy()
        };
        let design = self.fit_design(&all, whitener);
        let known = design.fitted() - count;
        let products = design.products(&self.training);
        // As for the estimates, a run's own level is not taken out.
        let zero = DMatrix::zeros(
            design.fitted() + OWN_LEVELS + 1,
            design.fitted() + OWN_LEVELS + 1,
        );
        let whole = products.iter().fold(zero, |sum, run| sum + &run.full);
        let own = whole.view((OWN_LEVELS, OWN_LEVELS), (known, known));
        let cross = whole.view((OWN_LEVELS, OWN_LEVELS + known), (known, count));
        let mut moved = ridge_inverse(own.into_owned()) * cross;
        if known > self.free.len() {
            let total = corrected_total(&products, &self.noise_of(&design, &self.training));
            for (amplitude, part) in named(&total, self.free.len(), count) {
                moved[(amplitude, part)] = 0.0;
            }
        }
        let mut open = DMatrix::identity(count, count);
        for direction in &installation.directions {
            let direction = DVector::from_column_slice(direction);
            open -= &direction * direction.transpose();
        }
        let moved = moved * installation.root();
        &moved * open * moved.transpose()
    }

    /// Bias of the products of a design's columns by noisy inputs, by run.
    fn noise_of(&self, design: &Design, frames: &[Frame]) -> Vec<DMatrix<f64>> {
        mean_noise_products(
            design,
            frames,
            &self.simulator(design.residual_model),
            FIRST_ROUND..FIRST_ROUND + INSTALLATION_PAIRS,
        )
    }

    /// Derivatives of the rows for the fitted parameters of a model.
    fn fit_design<'d>(
        &'d self,
        residual_model: &'d ResidualModel,
        whitener: &'d Whitener,
    ) -> Design<'d> {
        Design {
            residual_model,
            whitener,
            free_base: &self.free,
            candidates: &[],
            local: &[],
            windows: &[],
        }
    }
}

/// Products of installation errors after projection on the complement of the base.
fn products_given_base(design: &Design, products: &[Products]) -> DMatrix<f64> {
    let grams: Vec<Gram> = products.iter().map(Products::plain).collect();
    let base = Prior::none(design.fitted() - design.residual_model.installation.fitted());
    // The installation's columns take the place of those of candidates.
    cross_information(&grams, &base)
}

/// Products of base, amplitudes, parts and residual over all runs, less run levels and noise.
fn corrected_total(products: &[Products], noise: &[DMatrix<f64>]) -> DMatrix<f64> {
    let both = products.iter().zip(noise);
    let grams = both.map(|(run, noise)| run.corrected(noise, 1.0).g);
    grams.reduce(|sum, gram| sum + gram).unwrap_or_default()
}

/// Amplitudes, with indices after the base, that equal an installation error: a named effect is not
/// a tolerance, and the two are not separable.
fn named(total: &DMatrix<f64>, base: usize, parts: usize) -> Vec<(usize, usize)> {
    /// Squared cosine above which both are the same, allowing for the change by a large effect:
    /// 0.995 for an inertia that is doubled, 0.93 at most for others (a scale and a bias of the
    /// vertical acceleration). Chosen.
    const SAME: f64 = 0.97;
    let known = total.ncols().saturating_sub(parts + 1);
    let pairs = (base..known).flat_map(|k| (0..parts).map(move |j| (k, j)));
    let same = |(k, j): &(usize, usize)| {
        let squares = total[(*k, *k)] * total[(known + j, known + j)];
        total[(*k, known + j)].powi(2) > SAME * squares
    };
    pairs.filter(same).collect()
}
