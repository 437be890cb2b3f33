//! The tail of the largest statistic beyond the simulated range.

/// Upper tail probability of a Gumbel distribution fitted by moments to simulated maxima.
///
/// P(M >= t) = 1 - exp(-exp(-(t - a)/b)), b = sd sqrt(6)/pi, a = mean - 0.5772 b. Maxima over many
/// candidates are close to it, and its tail reaches below 1/(number of simulations).
pub fn gumbel_tail(maxima: &[f64], t: f64) -> f64 {
    let n = maxima.len() as f64;
    let mean = maxima.iter().sum::<f64>() / n;
    let sd = (maxima.iter().map(|m| (m - mean).powi(2)).sum::<f64>() / (n - 1.0)).sqrt();
    let scale = (sd * 6.0_f64.sqrt() / std::f64::consts::PI).max(1e-9);
    let location = mean - 0.577_215_664_9 * scale;
    -(-(-(t - location) / scale).exp()).exp_m1()
}
