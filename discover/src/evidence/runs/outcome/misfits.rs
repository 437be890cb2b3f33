//! Misfit before and after: root mean square residual by channel, and mean residual by run and
//! session. In the track channel residuals are rates of the speed between the halves of bins.
//!
//! Differences between sessions are tested by a one-way analysis of variance of the runs' means:
//! F(G - 1, R - G) for R runs in G sessions. Source: R.A. Fisher, Statistical Methods for Research
//! Workers (1925).

use crate::evidence::runs::campaign::Campaign;
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::fit::simulated_runs::RunSimulator;
use crate::evidence::runs::model::residual_model::{
    CHANNEL_NAMES, CHANNELS, ChannelRows, ResidualModel, TRACK,
};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::levels::{f_test, group};
use crate::evidence::runs::screen::track::bins::rates;
use crate::finding::{ByRun, ChannelGap, RunMean};

impl Campaign<'_> {
    /// Residuals of runs as they are compared; for the track channel rates within bins.
    pub fn comparison_rows(&self, model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
        let mut runs = residuals(model, frames);
        for (rows, frame) in runs.iter_mut().zip(frames) {
            rows[TRACK] = rates(frame, &rows[TRACK], self.rules().track_bin_m);
        }
        runs
    }

    /// Root mean square by used channel before and after.
    pub fn channel_gaps(
        &self,
        before: &ResidualModel,
        after: &ResidualModel,
        frames: &[Frame],
        simulator: &RunSimulator,
    ) -> Vec<ChannelGap> {
        let rms = |residual_model: &ResidualModel, frames: &[Frame]| -> [f64; CHANNELS] {
            let runs = self.comparison_rows(residual_model, frames);
            std::array::from_fn(|c| {
                let rows = runs.iter().flat_map(|rows| &rows[c]);
                let (sum, count) = rows.fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
                f64::sqrt(sum / f64::max(count, 1.0))
            })
        };
        let quiet = simulator.sensors_only();
        let sensors = quiet.simulated(frames, after, 2_000_003);
        let [before, noise] = [(before, frames), (after, &sensors)].map(|(m, f)| rms(m, f));
        let after = rms(after, frames);
        (0..CHANNELS)
            .filter(|c| self.used[*c])
            .map(|c| ChannelGap {
                channel: CHANNEL_NAMES[c].0.to_owned(),
                unit: CHANNEL_NAMES[c].1.to_owned(),
                before: before[c],
                after: after[c],
                noise: noise[c],
            })
            .collect()
    }

    /// Mean residuals by used channel, runs in the order of their sessions.
    pub fn by_run(&self, before: &ResidualModel, after: &ResidualModel) -> Vec<ByRun> {
        let frames = &self.training;
        let sessions = group(frames);
        // In chronological order, if the index is.
        let mut ordered: Vec<&Vec<usize>> = sessions.values().collect();
        ordered.sort();
        let rows = [residuals(before, frames), residuals(after, frames)];
        (0..CHANNELS)
            .filter(|c| self.used[*c])
            .map(|c| {
                let mean =
                    |run: &ChannelRows| run[c].iter().sum::<f64>() / run[c].len().max(1) as f64;
                let [before, after] = rows
                    .each_ref()
                    .map(|rows| rows.iter().map(mean).collect::<Vec<f64>>());
                let runs = ordered.iter().copied().flatten().map(|&i| RunMean {
                    run: frames[i].name.clone(),
                    session: frames[i].session.clone(),
                    track: frames[i].track.clone(),
                    before: before[i],
                    after: after[i],
                });
                ByRun {
                    channel: CHANNEL_NAMES[c].0.to_owned(),
                    unit: CHANNEL_NAMES[c].1.to_owned(),
                    sessions_differ_before: f_test(&before, &sessions),
                    sessions_differ_after: f_test(&after, &sessions),
                    runs: runs.collect(),
                }
            })
            .collect()
    }
}
