//! Weighted least squares of mu over pressure, with the effects that take part.

use nalgebra::{DMatrix, DVector};

use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::known::Known;
use crate::evidence::experiments::rows::Row;
use crate::procedure::candidate::Candidate;
use crate::regression::inverse::ridge_inverse;

/// Rounds of Gauss-Newton.
const ROUNDS: usize = 8;

/// What is fitted to.
pub struct Setting {
    /// What may take part.
    pub candidates: Vec<Candidate<FrictionChange>>,
    /// What the model has switched on.
    pub known: Known,
    /// Coefficients of the base: 3 (p^2, p, 1) or 1.
    pub base: usize,
}

/// A fit of base and chosen candidates.
#[derive(Clone)]
pub struct Fit {
    /// Base coefficients (of p^2, p, 1 in MPa, or of 1), then the candidates' in units of `typical`.
    pub step: DVector<f64>,
    /// Standard errors of `step`, scaled up where the rows scatter more than stated.
    pub errors: Vec<f64>,
    /// Sum of squares in units of the stated deviations.
    pub chi2: f64,
    /// Root mean square of the residual in mu.
    pub rms: f64,
    /// Whitened residual.
    pub rest: DVector<f64>,
    /// Whitened columns.
    pub columns: DMatrix<f64>,
}

impl Fit {
    /// A coefficient of the base as models state it, and its standard error.
    pub fn base_value(&self, k: usize, quadratic: bool) -> (f64, f64) {
        match (quadratic, k) {
            (true, 1) => (-1e3 * self.step[1], 1e3 * self.errors[1]),
            (true, _) => (1e3 * self.step[k], 1e3 * self.errors[k]),
            _ => (self.step[0], self.errors[0]),
        }
    }

    /// mu of a row by the base alone, and with the known and the chosen effects.
    pub fn predict(&self, setting: &Setting, row: &Row, chosen: &[usize]) -> (f64, f64) {
        let own: f64 = base_row(row, setting.base)
            .iter()
            .zip(self.step.iter())
            .map(|(a, b)| a * b)
            .sum();
        let mu = own.max(1e-5);
        let sizes = self.step.iter().skip(setting.base);
        let more: f64 = chosen
            .iter()
            .zip(sizes)
            .map(|(c, size)| setting.candidates[*c].change(row, mu, *size))
            .sum();
        (own, own + setting.known.add(row, mu) + more)
    }

    /// What the `k`-th chosen effect adds to a row's mu.
    pub fn added(&self, setting: &Setting, row: &Row, chosen: &[usize], k: usize) -> f64 {
        let (own, _) = self.predict(setting, row, &[]);
        let size = self.step[setting.base + k];
        setting.candidates[chosen[k]].change(row, own.max(1e-5), size)
    }

    /// Standard deviation of a row's mu, its own and that of its pressure.
    pub fn deviation(&self, setting: &Setting, row: &Row) -> f64 {
        deviation(row, &self.step, setting.base)
    }

    /// Root mean square of the residual of rows that may be others than the fitted.
    pub fn rms_of(&self, setting: &Setting, rows: &[Row], chosen: &[usize]) -> f64 {
        let squares = rows
            .iter()
            .map(|row| (row.mu - self.predict(setting, row, chosen).1).powi(2));
        (squares.sum::<f64>() / rows.len().max(1) as f64).sqrt()
    }
}

fn deviation(row: &Row, step: &DVector<f64>, base: usize) -> f64 {
    let slope = if base == 3 {
        2.0 * step[0] * row.pressure / 1e6 + step[1]
    } else {
        0.0
    };
    row.mu_sd.hypot(slope * row.pressure_sd / 1e6)
}

/// Columns of the base: p^2, p, 1 with p in MPa, or 1.
pub fn base_row(row: &Row, base: usize) -> Vec<f64> {
    let p = row.pressure / 1e6;
    if base == 3 {
        vec![p * p, p, 1.0]
    } else {
        vec![1.0]
    }
}

/// Fits base and chosen candidates together; weights and effects follow the fitted coefficient over a few rounds.
pub fn fit(setting: &Setting, rows: &[Row], chosen: &[usize]) -> Fit {
    let (candidates, base) = (&setting.candidates, setting.base);
    let n = rows.len();
    let m = base + chosen.len();
    let mut step = DVector::zeros(m);
    let mut fit = None;
    for round in 0..ROUNDS {
        let mut columns = DMatrix::zeros(n, m);
        let mut y = DVector::zeros(n);
        let mut weights = vec![0.0; n];
        for (i, row) in rows.iter().enumerate() {
            let own = base_row(row, base);
            let mu: f64 = if round == 0 {
                row.mu
            } else {
                own.iter().zip(step.iter()).map(|(a, b)| a * b).sum()
            };
            let sd = deviation(row, &step, base);
            weights[i] = 1.0 / sd;
            for (k, x) in own.iter().enumerate() {
                columns[(i, k)] = x / sd;
            }
            y[i] = (row.mu - setting.known.add(row, mu.max(1e-5))) / sd;
            for (k, c) in chosen.iter().enumerate() {
                let size: f64 = step[base + k];
                let slope = candidates[*c].slope(row, mu.max(1e-5), size);
                let change = candidates[*c].change(row, mu.max(1e-5), size);
                // An effect whose bounds meet is held at them.
                let free = candidates[*c].low < candidates[*c].high;
                columns[(i, base + k)] = if free { slope / sd } else { 0.0 };
                y[i] -= (change - if free { slope * size } else { 0.0 }) / sd;
            }
        }
        let inverse = ridge_inverse(columns.tr_mul(&columns));
        step = &inverse * columns.tr_mul(&y);
        for (k, c) in chosen.iter().enumerate() {
            // Far outside of their bounds effects are not even defined.
            let candidate = &candidates[*c];
            let (low, high) = (
                candidate.low / candidate.typical,
                candidate.high / candidate.typical,
            );
            step[base + k] = step[base + k].clamp(low, high);
        }
        let rest = &y - &columns * &step;
        let chi2 = rest.norm_squared();
        let excess = (chi2 / (n as f64 - m as f64).max(1.0)).max(1.0);
        fit = Some(Fit {
            step: step.clone(),
            errors: (0..m)
                .map(|k| (inverse[(k, k)].max(0.0) * excess).sqrt())
                .collect(),
            chi2,
            rms: (rest
                .iter()
                .zip(&weights)
                .map(|(r, w)| (r / w).powi(2))
                .sum::<f64>()
                / n as f64)
                .sqrt(),
            rest,
            columns,
        });
    }
    fit.expect("at least one round")
}
