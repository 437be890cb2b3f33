//! Straight line by least squares with a standard error that allows for correlated errors.

/// A fitted line `y = level + slope (x - centre)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineFit {
    /// Slope.
    pub slope: f64,
    /// Standard error of the slope.
    pub slope_se: f64,
    /// Mean of x.
    pub centre: f64,
    /// Value at the mean of x.
    pub level: f64,
    /// Root mean square of the residuals.
    pub residual_rms: f64,
}

impl LineFit {
    /// Value of the line at `x`.
    pub fn at(&self, x: f64) -> f64 {
        self.level + self.slope * (x - self.centre)
    }
}

/// Fits a line to points in the order they were measured.
///
/// The standard error is that of Andrews and Monahan (Econometrica 60 (1992) 953): the products of deviation and residual
/// are whitened by a first-order autoregression (its coefficient r corrected by `(1 + 4 r)/n` after Kendall, Biometrika 41
/// (1954) 403, and held below 0.999), their long-run variance is taken with Bartlett weights over `4 (n/100)^(2/9)` lags, and
/// coloured back. It falls short where errors stay correlated over more than about a tenth of the points. `None` below three points or without spread in x.
pub fn fit_line(x: &[f64], y: &[f64]) -> Option<LineFit> {
    let n = x.len() as f64;
    let centre = x.iter().sum::<f64>() / n;
    let level = y.iter().sum::<f64>() / n;
    let spread: f64 = x.iter().map(|x| (x - centre).powi(2)).sum();
    if x.len() < 3 || x.len() != y.len() || spread.is_nan() || spread <= 0.0 {
        return None;
    }
    let slope = x
        .iter()
        .zip(y)
        .map(|(x, y)| (x - centre) * (y - level))
        .sum::<f64>()
        / spread;
    let residual: Vec<f64> = x
        .iter()
        .zip(y)
        .map(|(x, y)| y - level - slope * (x - centre))
        .collect();
    let product: Vec<f64> = x
        .iter()
        .zip(&residual)
        .map(|(x, r)| (x - centre) * r)
        .collect();
    let variance = long_run_variance(&product) * n / (n - 2.0);
    Some(LineFit {
        slope,
        slope_se: (n * variance).sqrt() / spread,
        centre,
        level,
        residual_rms: (residual.iter().map(|r| r * r).sum::<f64>() / n).sqrt(),
    })
}

/// Long-run variance of a series of mean zero.
fn long_run_variance(u: &[f64]) -> f64 {
    const STEEPEST: f64 = 0.999;
    let product_at = |w: &[f64], lag: usize| -> f64 {
        w.iter().zip(&w[lag..]).map(|(a, b)| a * b).sum::<f64>() / w.len() as f64
    };
    let own = product_at(u, 0);
    if own == 0.0 {
        return 0.0;
    }
    let seen = product_at(u, 1) / own;
    let keep = (seen + (1.0 + 4.0 * seen.max(0.0)) / u.len() as f64).clamp(-STEEPEST, STEEPEST);
    let white: Vec<f64> = u.windows(2).map(|pair| pair[1] - keep * pair[0]).collect();
    let lags = (4.0 * (white.len() as f64 / 100.0).powf(2.0 / 9.0)) as usize;
    let lags = lags.min(white.len() - 1);
    let mut variance = product_at(&white, 0);
    for lag in 1..=lags {
        let weight = 1.0 - lag as f64 / (lags as f64 + 1.0);
        variance += 2.0 * weight * product_at(&white, lag);
    }
    variance / (1.0 - keep).powi(2)
}
