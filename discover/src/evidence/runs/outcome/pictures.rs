//! Pictures of a search over runs: residuals along the track, and effects over columns.

use std::collections::BTreeSet;

use kufe_sled::effects::{Active, Kind};

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::residual_model::{CHANNEL_NAMES, ChannelRows, ResidualModel};
use crate::evidence::runs::outcome::bins::COLUMNS;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{
    ChannelGap, Curve, Picture, Place, Plot, Scatter, Series, Step, Strip, StripRun,
};

/// Largest number of places of a strip along a track.
const MAX_PLACES: usize = 240;
/// Smallest distance between two places [m].
const MIN_STEP_M: f64 = 2.0;
/// Largest number of channels that are drawn along the track.
const MAX_CHANNELS: usize = 2;
/// Number of bins of a column, with equal numbers of rows.
const BINS: usize = 16;
/// Smallest number of rows of a bin that is drawn.
const MIN_ROWS: usize = 20;

/// Conditions, usually one value per run.
const STATED: [&str; 4] = ["ice_c", "air_c", "humidity_pct", "distance_m"];

impl Campaign<'_> {
    /// Residuals along each track of the given and of the written model, then each effect that acts
    /// everywhere over its strongest column.
    /// `given` has the installation errors of the training runs.
    pub fn pictures(
        &self,
        last: &RunFit,
        steps: &[Step],
        gaps: &[ChannelGap],
        given: &ResidualModel,
    ) -> Vec<Picture> {
        let frames: Vec<Frame> = self.whole().iter().chain(&self.held_out).cloned().collect();
        let parts = [self.whole(), &self.held_out];
        let models = [given, &last.final_model].map(|model| {
            let held_out = self.installed_in(model, &self.held_out);
            [model.clone(), held_out]
        });
        let rows_of = |models: &[ResidualModel; 2]| -> Vec<ChannelRows> {
            let [a, b] = [0, 1].map(|k| residuals(&models[k], parts[k]));
            [a, b].concat()
        };
        let rows = models.each_ref().map(rows_of);
        let shown = shown_channels(steps, gaps);
        let mut pictures = strips(last, &shown, &frames, &rows);
        let active = last.final_model.effects.active.iter().enumerate();
        for ((e, active), owner) in active.skip(last.already()).zip(&last.owners) {
            let step = &steps[*owner];
            let channel = CHANNEL_NAMES.iter().position(|c| c.0 == step.channel);
            if let (None, Some(channel)) = (window(active), channel) {
                let without = models[1].clone().map(|mut model| {
                    model.effects.active.remove(e);
                    model
                });
                let rows = [&rows_of(&without), &rows[1]];
                pictures.extend(effect_picture(active.effect_name(), channel, &frames, rows));
            }
        }
        pictures
    }
}

/// Residuals of the `shown` channels along each track, before and after.
fn strips(
    last: &RunFit,
    shown: &[usize],
    frames: &[Frame],
    rows: &[Vec<ChannelRows>; 2],
) -> Vec<Picture> {
    let tracks: BTreeSet<&str> = frames.iter().map(|f| f.track.as_str()).collect();
    let added = &last.final_model.effects.active[last.already()..];
    let mut strips = Vec::new();
    for &c in shown {
        for track in &tracks {
            let on: Vec<usize> = (0..frames.len())
                .filter(|&i| frames[i].track == **track && !rows[0][i][c].is_empty())
                .collect();
            let Some((from, to)) = extent(&on, frames) else {
                continue;
            };
            let step_m = ((to - from) / MAX_PLACES as f64).max(MIN_STEP_M);
            let along = |rows: &ChannelRows, frame: &Frame| {
                means_along(&frame.rows(&frame.s), &rows[c], from, step_m, to)
            };
            let places = added.iter().filter(|a| a.acts_on(track)).filter_map(|a| {
                let [from, to] = window(a)?;
                Some(Place {
                    effect: a.effect_name().to_owned(),
                    from,
                    to,
                })
            });
            let (channel, unit) = CHANNEL_NAMES[c];
            strips.push(Picture {
                title: format!("{channel} on track {track}"),
                caption: String::new(),
                plot: Plot::Strip(Strip {
                    channel: channel.to_owned(),
                    unit: unit.to_owned(),
                    track: (*track).to_owned(),
                    from_m: from,
                    step_m,
                    places: places.collect(),
                    discrepancy: {
                        let count = ((to - from) / step_m).ceil() as usize;
                        let at = (0..count).map(|k| from + step_m * (k as f64 + 0.5));
                        let discrepancy = &last.final_model.discrepancy;
                        discrepancy.along(track, c, at).unwrap_or_default()
                    },
                    runs: on
                        .iter()
                        .map(|&i| StripRun {
                            run: frames[i].name.clone(),
                            session: frames[i].session.clone(),
                            before: along(&rows[0][i], &frames[i]),
                            after: along(&rows[1][i], &frames[i]),
                        })
                        .collect(),
                }),
            });
        }
    }
    strips
}

/// The channels of the steps, or without steps the one farthest above its noise.
fn shown_channels(steps: &[Step], gaps: &[ChannelGap]) -> Vec<usize> {
    let place = |channel: &str| CHANNEL_NAMES.iter().position(|c| c.0 == channel);
    let mut shown: Vec<usize> = Vec::new();
    for step in steps {
        shown.extend(place(&step.channel).filter(|c| !shown.contains(c)));
    }
    if shown.is_empty() {
        let above = |misfit: &&ChannelGap| misfit.before / misfit.noise;
        // The ratio of a channel without rows is NaN.
        let known = gaps.iter().filter(|misfit| !above(misfit).is_nan());
        let most = known.max_by(|a, b| above(a).total_cmp(&above(b)));
        shown.extend(most.and_then(|misfit| place(&misfit.channel)));
    }
    shown.truncate(MAX_CHANNELS);
    shown
}

/// Interval of an effect along the track [m]; `None` if it acts everywhere.
fn window(active: &Active) -> Option<[f64; 2]> {
    match &active.kind {
        Kind::Catalogue(effect) => Some(effect.info.window()?.map(|k| active.values[k])),
        Kind::Custom(_) => None,
    }
}

/// First and last place of some runs along their track [m].
fn extent(on: &[usize], frames: &[Frame]) -> Option<(f64, f64)> {
    let places = || on.iter().flat_map(|&i| &frames[i].s).copied();
    let from = places().reduce(f64::min)?;
    let to = places().reduce(f64::max)?;
    (to > from).then_some((from, to))
}

/// Means of rows over intervals of equal length [m]; NaN without rows.
fn means_along(s: &[f64], rows: &[f64], from: f64, step: f64, to: f64) -> Vec<f64> {
    let count = ((to - from) / step).ceil().max(1.0) as usize;
    let mut sums = vec![(0.0, 0.0); count];
    for (s, row) in s.iter().zip(rows) {
        let cell = &mut sums[(((s - from) / step) as usize).min(count - 1)];
        *cell = (cell.0 + row, cell.1 + 1.0);
    }
    sums.iter().map(|(sum, n)| sum / n).collect()
}

/// Contribution of an effect to one channel over its strongest column, with the residual of the
/// model without the effect.
///
/// The column is the one of [`COLUMNS`] and [`STATED`] with the largest correlation ratio: the
/// share of the contribution's variance between its bins.
fn effect_picture(
    effect: &str,
    channel: usize,
    frames: &[Frame],
    [partial, with]: [&Vec<ChannelRows>; 2],
) -> Option<Picture> {
    let recorded = COLUMNS.iter().filter(|(name, _)| *name != "s_m");
    let recorded = recorded.map(|(name, of)| -> (_, Vec<Vec<f64>>) {
        (*name, frames.iter().map(|f| f.rows(of(f))).collect())
    });
    let stated = STATED.map(|name| -> (_, Vec<Vec<f64>>) {
        let rows = frames.iter().map(|f| f.rows(&f.condition(name)));
        (name, rows.collect())
    });
    let (name, bins) = recorded
        .chain(stated)
        .filter_map(|(name, columns)| {
            let mut rows: Vec<Row> = Vec::new();
            for (i, x) in columns.iter().enumerate() {
                for ((x, partial), with) in
                    x.iter().zip(&partial[i][channel]).zip(&with[i][channel])
                {
                    let contribution = partial - with;
                    let finite = x.is_finite() && partial.is_finite() && contribution.is_finite();
                    rows.extend(finite.then_some(Row {
                        run: i,
                        x: *x,
                        partial: *partial,
                        contribution,
                    }));
                }
            }
            (rows.len() >= BINS * MIN_ROWS).then(|| (name, bins(rows)))
        })
        .max_by(|a, b| between(&a.1).total_cmp(&between(&b.1)))?;
    let (quantity, unit) = CHANNEL_NAMES[channel];
    let means = |of: fn(&Row) -> f64| -> Vec<f64> {
        bins.iter().map(|bin| mean(bin.iter().map(of))).collect()
    };
    let x = means(|row| row.x);
    Some(Picture {
        title: format!("{effect} over {name}"),
        caption: format!(
            "Points: mean residual of the model without {effect}, with one standard error over runs. Line: what it adds."
        ),
        plot: Plot::Scatter(Scatter {
            label: format!("residual of {quantity} without {effect}"),
            x_name: name.to_owned(),
            y_name: format!("{quantity} without it [{unit}]"),
            x: x.clone(),
            series: vec![Series {
                name: "measured".to_owned(),
                y: means(|row| row.partial),
                sd: bins.iter().map(|b| error_over_runs(b)).collect(),
            }],
            curve: Some(Curve {
                name: "the effect".to_owned(),
                y: means(|row| row.contribution),
                x,
            }),
        }),
    })
}

struct Row {
    run: usize,
    x: f64,
    partial: f64,
    contribution: f64,
}

/// Bins of equal numbers of rows, sorted by their column.
fn bins(mut rows: Vec<Row>) -> Vec<Vec<Row>> {
    rows.sort_by(|a, b| a.x.total_cmp(&b.x));
    let count = rows.len();
    let mut bins: Vec<Vec<Row>> = (0..BINS).map(|_| Vec::new()).collect();
    for (k, row) in rows.into_iter().enumerate() {
        bins[k * BINS / count].push(row);
    }
    bins
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), x| (s + x, n + 1.0));
    sum / count
}

/// Variance of the bins' mean contributions; the total is the same for all columns.
fn between(bins: &[Vec<Row>]) -> f64 {
    let means = || bins.iter().map(|b| mean(b.iter().map(|r| r.contribution)));
    let centre = mean(means());
    mean(means().map(|m| (m - centre).powi(2)))
}

/// Standard error of a bin's mean over runs, whose rows are not independent.
fn error_over_runs(bin: &[Row]) -> f64 {
    let runs: BTreeSet<usize> = bin.iter().map(|r| r.run).collect();
    let means: Vec<f64> = runs
        .iter()
        .map(|run| mean(bin.iter().filter(|r| r.run == *run).map(|r| r.partial)))
        .collect();
    if means.len() < 2 {
        return 0.0;
    }
    let centre = mean(means.iter().copied());
    let squares: f64 = means.iter().map(|m| (m - centre).powi(2)).sum();
    (squares / (means.len() - 1) as f64 / means.len() as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_along_the_track_are_those_of_their_stretch_and_no_value_where_nothing_is() {
        let means = means_along(&[0.0, 1.0, 4.5, 6.0], &[1.0, 3.0, 5.0, 7.0], 0.0, 2.0, 6.0);
        assert_eq!(means[0], 2.0);
        assert!(means[1].is_nan());
        assert_eq!(means[2], 6.0);
    }

    #[test]
    fn without_steps_the_channel_farthest_above_its_noise_is_shown_and_none_without_rows() {
        let misfit = |c: usize, before: f64, noise: f64| ChannelGap {
            channel: CHANNEL_NAMES[c].0.to_owned(),
            unit: String::new(),
            before,
            after: before,
            noise,
        };
        let gaps = [
            misfit(0, 3.0, 2.0),
            misfit(1, 5.0, 2.0),
            misfit(3, 0.0, 0.0),
        ];
        assert_eq!(shown_channels(&[], &gaps), [1]);
        assert!(shown_channels(&[], &gaps[2..]).is_empty());
    }

    /// The means of two runs differ by 2: the standard error is 1, however many rows there are.
    #[test]
    fn the_error_of_a_bin_is_that_over_runs() {
        let rows = (0..100).map(|k| Row {
            run: k % 2,
            x: 0.0,
            partial: 2.0 * (k % 2) as f64,
            contribution: 0.0,
        });
        let bin: Vec<Row> = rows.collect();
        assert!((error_over_runs(&bin) - 1.0).abs() < 1e-12);
    }
}
