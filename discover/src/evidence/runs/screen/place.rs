//! Place and strongest channel of a candidate.

use kufe_sled::effects::Kind;

use crate::evidence::runs::campaign::{Campaign, Current, scale_of};
use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::gauss_newton::residuals;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::residual_model::{
    BALANCES, CHANNELS, ChannelRows, ResidualModel,
};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;

impl Campaign<'_> {
    /// Where a candidate acts, in words.
    pub fn place_of(&self, candidate: &Candidate<Amplitude>, at: &Current) -> String {
        let track = candidate.act.track.as_ref();
        let on = track.map_or(String::new(), |t| format!(" on track {t}"));
        if let (Some(_), Some((from, to))) = (track, candidate.window()) {
            return format!("s {from:.0}-{to:.0} m{on}");
        }
        if candidate.is_column() {
            let form = match &candidate.act.kind {
                Kind::Custom(custom) => {
                    format!("; form {} on {}", custom.text, custom.channel.name())
                }
                Kind::Catalogue(_) => String::new(),
            };
            return format!("all runs{}", form.to_lowercase());
        }
        // The share of samples with half of the effect indicates where it acts.
        let Some(frame) = self.training.first() else {
            return "all runs".to_owned();
        };
        let rest = at.residual_model.sample_residuals(frame);
        let with = (at.residual_model).with(candidate.active(candidate.typical));
        let moved = with.sample_residuals(frame);
        let change = |c: usize, i: usize| (rest[c][i] - moved[c][i]) / at.whitener.sd[c];
        let square = |i: usize| (0..BALANCES).map(|c| change(c, i).powi(2)).sum::<f64>();
        let mut size: Vec<(f64, usize)> = frame.samples().map(|i| (square(i), i)).collect();
        let total: f64 = size.iter().map(|x| x.0).sum();
        size.sort_by(|a, b| b.0.total_cmp(&a.0));
        let (mut sum, mut count, mut speed, mut load) = (0.0, 0, 0.0, 0.0);
        for (x, i) in &size {
            if sum > 0.5 * total {
                break;
            }
            sum += x;
            count += 1;
            speed += frame.v[*i];
            load += frame.acceleration[2][*i];
        }
        let count_f = f64::from(count.max(1));
        format!(
            "all runs{on}; half of it in {:.0} % of the samples, around v = {:.1} m/s and a_z = {:.1} m/s2",
            100.0 * count_f / size.len() as f64,
            speed / count_f,
            load / count_f
        )
    }

    /// The channel that a candidate changes most, relative to the residual.
    pub fn strongest_channel(
        &self,
        residual_model: &ResidualModel,
        candidate: &Candidate<Amplitude>,
        size: f64,
    ) -> usize {
        let few = &self.training[..self.training.len().min(4)];
        let of_run = |frame: &Frame| -> [f64; CHANNELS] {
            let rest = residual_model.residuals(frame);
            let moved = residual_model.with(candidate.active(size)).residuals(frame);
            std::array::from_fn(|c| {
                let scale = scale_of(&rest[c]);
                let both = rest[c].iter().zip(&moved[c]);
                both.map(|(a, b)| ((a - b) / scale).powi(2)).sum()
            })
        };
        let energies: Vec<[f64; CHANNELS]> = match candidate.act.carrier {
            None => few.iter().map(of_run).collect(),
            // Simulations do not have its column.
            Some(_) => {
                let whitener = Whitener::estimate(few, &residuals(residual_model, few), self.used);
                let of_run = |frame: &Frame| {
                    let rows = self.direction(residual_model, &whitener, candidate, frame);
                    rows.map(|row| row.iter().map(|x| x * x).sum())
                };
                few.iter().map(of_run).collect()
            }
        };
        let of_channel = |c: usize| energies.iter().map(|of_run| of_run[c]).sum::<f64>();
        let energy = |c: usize| if self.used[c] { of_channel(c) } else { 0.0 };
        (0..CHANNELS)
            .max_by(|a, b| f64::total_cmp(&energy(*a), &energy(*b)))
            .unwrap_or(1)
    }

    /// First-order change of the whitened rows of each channel by a typical amplitude.
    pub fn direction(
        &self,
        residual_model: &ResidualModel,
        whitener: &Whitener,
        candidate: &Candidate<Amplitude>,
        frame: &Frame,
    ) -> ChannelRows {
        let design = Design {
            candidates: std::slice::from_ref(candidate),
            ..Design::new(residual_model, whitener, &self.free)
        };
        let columns = design.columns(frame);
        // The candidate, and the residual after it.
        let own = columns.column(columns.ncols() - 2);
        let mut used = own.as_slice().chunks_exact(frame.row_count().max(1));
        std::array::from_fn(|c| {
            let own = (c < BALANCES && self.used[c])
                .then(|| used.next())
                .flatten();
            own.map_or_else(Vec::new, <[f64]>::to_vec)
        })
    }
}
