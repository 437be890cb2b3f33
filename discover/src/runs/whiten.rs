//! Rows made comparable: each channel's own correlation in time and its deviation taken out.

use super::chain::{CHANNELS, Rows};

/// What turns residuals into rows of unit, nearly independent noise.
///
/// Each channel passes an AR(2) filter fitted to its residual (Yule-Walker); yaw then loses what side predicts of it.
#[derive(Clone, Debug)]
pub struct Whitener {
    ar: [[f64; 2]; CHANNELS],
    /// Innovation deviation by channel, in the channel's unit.
    pub sd: [f64; CHANNELS],
    rho: f64,
    /// Which channels take part; the track channel is treated by itself.
    pub used: [bool; CHANNELS],
}

impl Whitener {
    /// From the residuals of all runs.
    pub fn estimate(rows: &[Rows], used: [bool; CHANNELS]) -> Self {
        let mut whitener = Self {
            ar: [[0.0; 2]; CHANNELS],
            sd: [1.0; CHANNELS],
            rho: 0.0,
            used,
        };
        for (channel, _) in used.iter().enumerate().filter(|(_, used)| **used) {
            let lag = |k: usize| -> f64 {
                let (mut sum, mut count) = (0.0, 0.0);
                for run in rows {
                    let x = &run[channel];
                    for i in k..x.len() {
                        sum += x[i] * x[i - k];
                        count += 1.0;
                    }
                }
                if count > 0.0 { sum / count } else { 0.0 }
            };
            let (c0, c1, c2) = (lag(0), lag(1), lag(2));
            if c0 > 0.0 {
                let (r1, r2) = (c1 / c0, c2 / c0);
                let determinant = (1.0 - r1 * r1).max(1e-6);
                let (a, b) = (r1 * (1.0 - r2) / determinant, (r2 - r1 * r1) / determinant);
                whitener.ar[channel] = [a, b];
                whitener.sd[channel] = (c0 * (1.0 - a * r1 - b * r2).max(1e-6)).sqrt();
            }
        }
        if used[1] && used[2] {
            let (mut xy, mut xx, mut yy) = (0.0, 0.0, 0.0);
            for run in rows {
                let (x, y) = (whitener.filtered(run, 1), whitener.filtered(run, 2));
                for (x, y) in x.iter().zip(&y) {
                    xy += x * y;
                    xx += x * x;
                    yy += y * y;
                }
            }
            whitener.rho = (xy / (xx * yy).sqrt().max(1e-300)).clamp(-0.98, 0.98);
        }
        whitener
    }

    fn filtered(&self, rows: &Rows, channel: usize) -> Vec<f64> {
        let [a, b] = self.ar[channel];
        let x = &rows[channel];
        (2..x.len())
            .map(|i| (x[i] - a * x[i - 1] - b * x[i - 2]) / self.sd[channel])
            .collect()
    }

    /// All used channels of one run, one after the other, each without its first two samples.
    pub fn apply(&self, rows: &Rows) -> Vec<f64> {
        let mut out = Vec::new();
        let side = if self.used[1] {
            self.filtered(rows, 1)
        } else {
            Vec::new()
        };
        for channel in 0..3 {
            if !self.used[channel] {
                continue;
            }
            match channel {
                1 => out.extend_from_slice(&side),
                2 => {
                    let yaw = self.filtered(rows, 2);
                    let scale = 1.0 / (1.0 - self.rho * self.rho).sqrt();
                    if side.is_empty() {
                        out.extend(yaw);
                    } else {
                        out.extend(
                            yaw.iter()
                                .zip(&side)
                                .map(|(y, x)| (y - self.rho * x) * scale),
                        );
                    }
                }
                _ => out.extend(self.filtered(rows, channel)),
            }
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
