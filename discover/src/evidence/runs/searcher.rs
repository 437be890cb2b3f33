//! Where a search over runs stands.

use kufe_sled::Model;

use crate::evidence::runs::candidates::candidate::Candidate;
use crate::evidence::runs::candidates::catalogue::Candidates;
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::fit::simulated_runs::TwinMaker;
use crate::evidence::runs::model::chain::{CHANNELS, Chain};
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::prepare::Data;
use crate::evidence::runs::screen::residual_screen::Look;
use crate::finding::report::{Detectable, Rival, Step};
use crate::options::Options;

/// Largest p-values of claims, by where they are made: within runs, in windows of distance, between sessions (twice:
/// friction and grip), between runs, beyond the catalogue, on the track. Together they leave a null a chance of about
/// 0.02 of being claimed: what a model lacks usually stands far beyond these, and chance does not.
pub const ALPHA: f64 = 0.005;
pub const ALPHA_LOCAL: f64 = 0.005;
pub const ALPHA_SESSIONS: f64 = 0.002;
pub const ALPHA_RUNS: f64 = 0.002;
pub const ALPHA_BEYOND: f64 = 0.001;
pub const ALPHA_TRACK: f64 = 0.0005;
/// The track channel is used where its runs agree within this many times what the sensors' noise scatters.
pub const AGREES_WITHIN: f64 = 3.0;
pub const MOST_STEPS: usize = 4;
/// Looks in all: several amplitudes or places of one effect belong to one step.
pub const MOST_LOOKS: usize = 8;

/// A search over runs.
pub struct Searcher<'a> {
    pub data: &'a Data,
    pub model: &'a Model,
    pub options: &'a Options,
    pub progress: &'a (dyn Fn(&str) + Sync),
    pub training: &'a [Frame],
    pub used: [bool; CHANNELS],
    pub candidates: &'a Candidates,
    pub steps: Vec<Step>,
    /// The step of each effect that was added.
    pub owners: Vec<usize>,
    pub depends: Vec<String>,
    pub remarks: Vec<String>,
    pub first: Option<Vec<Detectable>>,
    /// What the forces alone say of each candidate's size, with its standard error.
    pub by_forces: Vec<(Candidate, f64, f64)>,
}

/// What a look leads to.
pub struct Pick {
    /// What is claimed.
    pub candidate: Candidate,
    pub size: f64,
    pub class: Vec<String>,
    pub rivals: Vec<Rival>,
    pub p_value: f64,
    pub place: String,
    pub channel: usize,
    /// T that noisy inputs alone produce.
    pub bias_t: Option<f64>,
    /// Standard error of a size that comes from the track channel.
    pub track_error: Option<f64>,
}

/// Where a search stands: the model so far and what was made for it.
pub struct Stand<'a> {
    pub chain: &'a Chain,
    pub whitener: &'a Whitener,
    pub free: &'a [usize],
    pub maker: &'a TwinMaker,
}

impl<'a> Stand<'a> {
    pub fn design(&self, candidates: &'a [Candidate]) -> Design<'a> {
        Design {
            chain: self.chain,
            whitener: self.whitener,
            free_base: self.free,
            candidates,
            local: &[],
            windows: &[],
        }
    }
}

impl Searcher<'_> {
    pub fn maker(&self, chain: &Chain) -> TwinMaker {
        TwinMaker::new(
            self.training,
            chain,
            self.data.noise,
            self.used,
            self.options.seed,
        )
    }

    /// After a first name the next ones are held to half of the chance of an error.
    pub fn share(&self) -> f64 {
        if self.steps.is_empty() { 1.0 } else { 0.5 }
    }

    pub fn look_options(&self) -> Look {
        let share = self.share();
        Look {
            pairs: self.options.twins.div_ceil(40).max(1),
            flips: self.options.flips,
            alpha: share * ALPHA,
            alpha_local: share * ALPHA_LOCAL,
            alpha_beyond: share * ALPHA_BEYOND,
            trust: if self.data.noise_estimated {
                [0.5, 1.6]
            } else {
                [0.75, 1.3]
            },
            seed: self.options.seed,
        }
    }
}

/// Root mean square of rows.
pub fn scale_of(rows: &[f64]) -> f64 {
    (rows.iter().map(|x| x * x).sum::<f64>() / rows.len().max(1) as f64)
        .sqrt()
        .max(1e-300)
}

/// Root mean square of one channel over all runs.
pub fn gap_of(chain: &Chain, frames: &[Frame], channel: usize) -> f64 {
    let rows: Vec<f64> = residuals(chain, frames)
        .into_iter()
        .flat_map(|r| r[channel].clone())
        .collect();
    scale_of(&rows)
}
