//! Share of the repeatable misfit that remains with a model.
//!
//! The repeatable misfit R is a mean product of different runs ([`Means`]). The repeatable bias of
//! noisy inputs, from simulated runs of the model, is subtracted. Standard errors are by the
//! jackknife over runs (B. Efron, C. Stein, The Annals of Statistics 9 (1981) 586).

use rayon::prelude::*;

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::model::repeatable::Means;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNEL_NAMES, ChannelRows, ResidualModel,
};
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{Interval, Remaining};

/// Sets of simulated runs for the bias of noisy inputs.
const SETS: u64 = 2;

impl Campaign<'_> {
    /// Remaining repeatable misfit of each balance with a fit including its installation errors,
    /// relative to the refitted base; empty if a track has a single run.
    pub fn remaining(&self, base: &RunFit, last: &RunFit) -> Vec<Remaining> {
        let frames: Vec<Frame> = self.whole().iter().chain(&self.held_out).cloned().collect();
        let width = self.rules().track_bin_m;
        let rows = |model: &ResidualModel| -> Vec<ChannelRows> {
            frames
                .par_iter()
                .map(|frame| model.residuals(frame))
                .collect()
        };
        let model = &last.residual_model;
        let [before, after] = [&base.residual_model, model].map(rows);
        let simulator = self.simulator(model);
        let simulated: Vec<Vec<ChannelRows>> = (0..SETS)
            .map(|set| simulator.residuals(&frames, model, 6_000_011 + set))
            .collect();
        let quantile = self.options.rules.search.interval;
        let of_channel = |c: usize| {
            let means = |rows: &[ChannelRows]| Means::new(c, &frames, rows, width);
            let own = means(&after);
            if own.places.is_empty() {
                return None;
            }
            let by_inputs = simulated.iter().map(|rows| means(rows).repeatable(None));
            let by_inputs = f64::max(by_inputs.sum::<f64>() / SETS as f64, 0.0);
            let first = (means(&before).repeatable(None) - by_inputs).max(0.0);
            let value = own.repeatable(None) - by_inputs;
            let n = own.runs as f64;
            let without: Vec<f64> = (0..own.runs).map(|i| own.repeatable(Some(i))).collect();
            let mean = without.iter().sum::<f64>() / n;
            let squares: f64 = without.iter().map(|r| (r - mean).powi(2)).sum();
            let half = quantile * ((n - 1.0) / n * squares).sqrt();
            let share = |of: f64| {
                let share = |x: f64| (x / of.max(1e-300)).clamp(0.0, 1.0);
                Interval {
                    value: share(value),
                    low: share(value - half),
                    high: share(value + half),
                }
            };
            let of_misfit = share(own.mean_square);
            Some(Remaining {
                channel: CHANNEL_NAMES[c].0.to_owned(),
                unit: CHANNEL_NAMES[c].1.to_owned(),
                repeatable: value.max(0.0).sqrt(),
                share: share(first),
                is_small: of_misfit.low <= self.options.rules.search.adequate,
                places: if of_misfit.low > 0.0 {
                    own.largest_places(width)
                } else {
                    Vec::new()
                },
                of_misfit,
            })
        };
        let used = (0..BALANCES).filter(|c| self.used[*c]);
        used.filter_map(of_channel).collect()
    }
}
