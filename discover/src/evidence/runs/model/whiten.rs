//! ChannelRows made comparable: each channel over its own deviation.
//!
//! Correlation in time is not filtered out: tests move whole runs, and errors are taken over runs, so that they stay right
//! whatever the correlation; a filter fitted to a residual that still holds an effect would remove the effect with it.

use crate::evidence::runs::model::residual_model::{CHANNELS, ChannelRows};

/// What turns residuals of several channels into rows of one scale.
#[derive(Clone, Debug)]
pub struct Whitener {
    /// Deviation by channel, in the channel's unit.
    pub sd: [f64; CHANNELS],
    /// Which channels take part; the track channel is treated by itself.
    pub used: [bool; CHANNELS],
}

impl Whitener {
    /// Each channel in its own unit.
    pub fn plain(used: [bool; CHANNELS]) -> Self {
        Self {
            sd: [1.0; CHANNELS],
            used,
        }
    }

    /// From the residuals of all runs.
    pub fn estimate(rows: &[ChannelRows], used: [bool; CHANNELS]) -> Self {
        let sd = std::array::from_fn(|c| {
            let (sum, count) = rows
                .iter()
                .flat_map(|run| run[c].iter())
                .fold((0.0, 0.0), |(s, n), x| (s + x * x, n + 1.0));
            if sum > 0.0 {
                f64::sqrt(sum / count)
            } else {
                1.0
            }
        });
        Self { sd, used }
    }

    /// All used channels of one run, one after the other.
    pub fn apply(&self, rows: &ChannelRows) -> Vec<f64> {
        let mut out = Vec::new();
        for channel in (0..3).filter(|c| self.used[*c]) {
            out.extend(rows[channel].iter().map(|x| x / self.sd[channel]));
        }
        out
    }

    /// Number of channels in [`Whitener::apply`].
    pub fn count(&self) -> usize {
        self.used[..3].iter().filter(|used| **used).count()
    }

    /// The channel of the `k`-th block of [`Whitener::apply`].
    pub fn channel(&self, k: usize) -> usize {
        (0..3)
            .filter(|c| self.used[*c])
            .nth(k)
            .expect("a used channel")
    }
}
