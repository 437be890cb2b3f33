//! A preview of candidates on a few of the runs: what is far from leaving little enough there is not fitted on all of them.

use crate::evidence::runs::campaign::{Campaign, Current};
use crate::evidence::runs::fit::gauss_newton::Effort;
use crate::evidence::runs::fit::refit::RunPart;
use crate::evidence::runs::model::residual_model::ResidualModel;
use crate::evidence::runs::recordings::frame::Frame;

/// One of so many runs is examined.
const EVERY: usize = 3;
/// Fewest runs of a preview.
const FEWEST: usize = 4;

impl Campaign<'_> {
    /// Whether a model with one effect more than `at` is far from leaving no more than `beat`: on a few of the runs it takes off less than
    /// a stated part of their share of that. Where there are too few runs for a preview, nothing is.
    pub fn out_of_reach(&self, at: &Current, with: &ResidualModel, beat: f64) -> bool {
        if beat == f64::INFINITY || self.training.len() < FEWEST * EVERY {
            return false;
        }
        let Some(whole) = self.refitted_alone(at) else {
            return false;
        };
        let Some(few) = at.refits.on_few(|| self.few_runs(at)) else {
            return false;
        };
        let share = few.frames.len() as f64 / self.training.len() as f64;
        let enough = few.misfit - self.rules().leads * share * (whole.misfit - beat);
        let found = self.beside_either_on(&few.frames, with, (Effort::COMPARED, enough));
        found.is_none_or(|found| found.misfit > enough)
    }

    fn few_runs(&self, at: &Current) -> Option<RunPart> {
        let frames: Vec<Frame> = self.training.iter().step_by(EVERY).cloned().collect();
        let (model, effort) = (at.residual_model, (Effort::COMPARED, f64::INFINITY));
        let misfit = self.beside_either_on(&frames, model, effort)?.misfit;
        Some(RunPart { frames, misfit })
    }
}
