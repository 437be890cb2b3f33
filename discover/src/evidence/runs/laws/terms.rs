//! Terms of laws on all training runs, with the noise of their products.

use kufe_sled::effects::Channel;
use nalgebra::DMatrix;
use rayon::prelude::*;

use crate::evidence::runs::fit::piece::piece;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::laws::sums::LawSums;
use crate::evidence::runs::laws::term::{COLUMNS, Term, TermsOnRun};
use crate::evidence::runs::model::design::{Design, OWN_LEVELS};
use crate::evidence::runs::recordings::frame::Frame;
use crate::regression::gram::squares;

/// A run with simulations of a piece of it.
struct OfRun<'a> {
    frame: &'a Frame,
    own: TermsOnRun,
    /// Simulations with noise of either sign, and without noise.
    simulations: [(Frame, TermsOnRun); 3],
    /// Ratio of the run's number of rows to the piece's.
    share: f64,
}

/// All training runs.
pub struct Terms<'a> {
    design: &'a Design<'a>,
    runs: Vec<OfRun<'a>>,
    /// Names of the columns, by index.
    pub names: Vec<String>,
}

impl<'a> Terms<'a> {
    /// Prepares all runs; `extra` lists recorded columns outside the model.
    pub fn new(
        design: &'a Design<'a>,
        frames: &'a [Frame],
        simulator: &RunSimulator,
        channels: &[Channel],
        extra: &[String],
    ) -> Self {
        const ROUND: u64 = 7_000_003;
        let on = |frame: &Frame| TermsOnRun::new(design, frame, channels, extra);
        let of_run = |(i, frame): (usize, &'a Frame)| {
            let piece = piece(frame, simulator.piece_s, ROUND, i);
            let pair = simulator.pair(&piece, design.residual_model, ROUND, i);
            OfRun {
                own: on(frame),
                share: frame.row_count() as f64 / piece.row_count().max(1) as f64,
                simulations: [pair.plus, pair.minus, pair.truth].map(|frame| {
                    let terms = on(&frame);
                    (frame, terms)
                }),
                frame,
            }
        };
        let names = COLUMNS.iter().map(|(name, _)| (*name).to_owned());
        Self {
            design,
            runs: frames.par_iter().enumerate().map(of_run).collect(),
            names: names.chain(extra.iter().cloned()).collect(),
        }
    }

    /// Names of some columns.
    pub fn names_of(&self, columns: &[usize]) -> Vec<&str> {
        columns.iter().map(|x| self.names[*x].as_str()).collect()
    }

    /// All values of a column, sorted.
    pub fn sorted(&self, column: usize) -> Vec<f64> {
        let mut all: Vec<f64> = self
            .runs
            .iter()
            .flat_map(|run| run.own.column(column).iter().copied())
            .collect();
        all.sort_by(f64::total_cmp);
        all
    }

    /// Sums by group of terms, without products between groups, at these shares of the noise.
    pub fn sums_of_parts(&self, parts: &[&[Term]], shares: &[f64]) -> Vec<LawSums> {
        let mut each: Vec<Vec<LawSums>> = vec![Vec::new(); shares.len()];
        for part in parts.iter().filter(|part| !part.is_empty()) {
            for (list, mut sums) in each.iter_mut().zip(self.sums(part, shares)) {
                sums.truncate(part.len());
                list.push(sums);
            }
        }
        each.iter()
            .map(|list| LawSums::concatenated(list))
            .collect()
    }

    /// Sums of the terms, then of the named candidates, with these shares of the noise correction.
    pub fn sums(&self, terms: &[Term], shares: &[f64]) -> Vec<LawSums> {
        let products: Vec<[DMatrix<f64>; 2]> = self
            .runs
            .par_iter()
            .map(|run| {
                let with = |frame: &Frame, on: &TermsOnRun| on.with(self.design, frame, terms);
                let simulations = run.simulations.each_ref();
                let [plus, minus, truth] = simulations.map(|(f, on)| squares(&with(f, on)));
                let noise = ((plus + minus) * 0.5 - truth) * run.share;
                let own = with(run.frame, &run.own);
                let products = self.design.squares(run.frame, &own);
                [products, self.design.with_noiseless_discrepancy(noise)]
            })
            .collect();
        let prior = self.design.prior();
        shares
            .iter()
            .map(|share| {
                let runs = products.iter().map(|[plain, noise]| plain - noise * *share);
                let runs: Vec<DMatrix<f64>> = runs.collect();
                LawSums::new(&runs, OWN_LEVELS, &prior)
            })
            .collect()
    }
}
