//! Mean residuals by run and session, before and after.
//!
//! Differences between sessions are tested by a one-way analysis of variance of the runs' means:
//! F(G - 1, R - G) for R runs in G sessions. Source: R.A. Fisher, Statistical Methods for Research
//! Workers (1925).

use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, CHANNELS, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::levels::{f_test, group};
use crate::finding::{ByRun, RunMean};

/// One entry per used channel, runs in the order of their sessions.
pub fn by_run(
    before: &ResidualModel,
    after: &ResidualModel,
    frames: &[Frame],
    used: [bool; CHANNELS],
) -> Vec<ByRun> {
    let sessions = group(frames);
    // In chronological order, if the index is.
    let mut ordered: Vec<&Vec<usize>> = sessions.values().collect();
    ordered.sort();
    let rows = [residuals(before, frames), residuals(after, frames)];
    (0..CHANNELS)
        .filter(|c| used[*c])
        .map(|c| {
            let means = rows.each_ref().map(|rows| -> Vec<f64> {
                rows.iter()
                    .map(|run| run[c].iter().sum::<f64>() / run[c].len().max(1) as f64)
                    .collect()
            });
            let [before_p, after_p] = means.each_ref().map(|m| f_test(m, &sessions));
            ByRun {
                channel: CHANNEL_NAMES[c].0.to_owned(),
                unit: CHANNEL_NAMES[c].1.to_owned(),
                sessions_differ_before: before_p,
                sessions_differ_after: after_p,
                runs: ordered
                    .iter()
                    .flat_map(|runs| runs.iter())
                    .map(|i| RunMean {
                        run: frames[*i].name.clone(),
                        session: frames[*i].session.clone(),
                        track: frames[*i].track.clone(),
                        before: means[0][*i],
                        after: means[1][*i],
                    })
                    .collect(),
            }
        })
        .collect()
}
