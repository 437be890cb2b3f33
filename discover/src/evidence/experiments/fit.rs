//! Weighted least squares of mu by the base law and selected effects.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use nalgebra::{DMatrix, DVector};

use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::candidates::FrictionChange;
use crate::evidence::experiments::known::ModelEffects;
use crate::evidence::experiments::rows::Row;
use crate::null::clusters::members;
use crate::procedure::candidate::Candidate;
use crate::procedure::shared_effects::Amount;
use crate::regression::inverse::ridge_inverse;

const ROUNDS: usize = 8;

/// Candidates, known effects and base law.
#[derive(Clone)]
pub struct Setting {
    pub candidates: Vec<Candidate<FrictionChange>>,
    /// Effects of the model.
    pub known: ModelEffects,
    pub base: Base,
    pub between: Between,
}

/// Standard deviations of mu between specimens and between sessions, in addition to the deviations
/// of the rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Between {
    pub specimens: f64,
    pub sessions: f64,
}

impl Between {
    /// Standard deviation of the sum of both offsets.
    pub fn both(&self) -> f64 {
        self.specimens.hypot(self.sessions)
    }
}

/// Whitening of rows whose specimens and sessions have random offsets.
///
/// Let sd_i be the standard deviation of row i and s the standard deviation between specimens (or
/// between sessions, whichever are more). The covariance of a specimen's rows is `diag(sd^2) + s^2
/// 1 1'`. With `a = s / sd`, its inverse root is
///
/// ```text
/// R = (1 - (1 - 1 / sqrt(1 + |a|^2)) a a' / |a|^2) diag(1 / sd)
/// ```
///
/// Let g be the standard deviation between the other groups, Z their indicator columns and `g^2 R Z
/// Z' R' = U L U'`. The inverse root of the covariance of all rows is
///
/// ```text
/// (1 - U (1 - 1 / sqrt(1 + L)) U') R
/// ```
#[derive(Clone)]
pub struct Whitening {
    weights: Vec<f64>,
    /// Rows of each specimen or session, with their a.
    blocks: Vec<(Vec<usize>, Vec<f64>)>,
    /// Eigenvectors U.
    directions: DMatrix<f64>,
    /// Eigenvalues L.
    variances: DVector<f64>,
}

impl Whitening {
    fn new(groups: &Groups, weights: Vec<f64>, between: Between) -> Self {
        let n = weights.len();
        let mut effects = vec![
            (&groups.specimens, between.specimens),
            (&groups.sessions, between.sessions),
        ];
        effects.retain(|(_, sd)| *sd > 0.0);
        effects.sort_by_key(|(groups, _)| Reverse(groups.len()));
        let mut effects = effects.into_iter();
        let blocks = effects.next().map_or(Vec::new(), |(groups, sd)| {
            let block = |own: &Vec<usize>| {
                let a = own.iter().map(|i| sd * weights[*i]);
                (own.clone(), a.collect())
            };
            groups.iter().map(block).collect()
        });
        let by_block = Self {
            blocks,
            weights,
            directions: DMatrix::zeros(n, 0),
            variances: DVector::zeros(0),
        };
        let Some((others, sd)) = effects.next() else {
            return by_block;
        };
        let mut offsets = DMatrix::zeros(n, others.len());
        for (s, own) in others.iter().enumerate() {
            let mut offset = DVector::zeros(n);
            own.iter().for_each(|i| offset[*i] = sd);
            offsets.set_column(s, &by_block.apply(&offset));
        }
        let eigen = offsets.tr_mul(&offsets).symmetric_eigen();
        let mut directions = offsets * eigen.eigenvectors;
        let variances = eigen.eigenvalues.map(|variance| variance.max(1e-300));
        for (mut direction, variance) in directions.column_iter_mut().zip(&variances) {
            direction /= variance.sqrt();
        }
        Self {
            directions,
            variances,
            ..by_block
        }
    }

    /// Whitens a value per row.
    pub fn apply(&self, values: &DVector<f64>) -> DVector<f64> {
        let weights = DVector::from_column_slice(&self.weights);
        self.without_directions(self.without_blocks(values.component_mul(&weights)))
    }

    /// The transpose of [`apply`](Self::apply).
    fn apply_transpose(&self, values: &DVector<f64>) -> DVector<f64> {
        let weights = DVector::from_column_slice(&self.weights);
        let white = self.without_blocks(self.without_directions(values.clone()));
        white.component_mul(&weights)
    }

    fn without_blocks(&self, mut white: DVector<f64>) -> DVector<f64> {
        for (own, a) in &self.blocks {
            let norm = a.iter().map(|a| a * a).sum::<f64>();
            let along: f64 = own.iter().zip(a).map(|(i, a)| a * white[*i]).sum();
            let share = (1.0 - 1.0 / (1.0 + norm).sqrt()) * along / norm;
            own.iter().zip(a).for_each(|(i, a)| white[*i] -= share * a);
        }
        white
    }

    fn without_directions(&self, white: DVector<f64>) -> DVector<f64> {
        let shares = self.variances.map(|l| 1.0 - 1.0 / (1.0 + l).sqrt());
        let along = self.directions.tr_mul(&white).component_mul(&shares);
        white - &self.directions * along
    }

    /// Logarithm of the covariance's determinant.
    fn log_determinant(&self) -> f64 {
        let rows: f64 = self.weights.iter().map(|w| -2.0 * w.ln()).sum();
        let of_block = |(_, a): &(Vec<usize>, Vec<f64>)| a.iter().map(|a| a * a).sum::<f64>();
        let variances = self.blocks.iter().map(of_block);
        let variances = variances.chain(self.variances.iter().copied());
        rows + variances.map(f64::ln_1p).sum::<f64>()
    }
}

/// Rows of each specimen and of each session.
struct Groups {
    specimens: Vec<Vec<usize>>,
    sessions: Vec<Vec<usize>>,
}

impl Groups {
    fn of(rows: &[Row]) -> Self {
        let of = |name: fn(&Row) -> &String| {
            let members = members(rows.iter().map(|row| name(row).as_str()));
            members.into_values().collect()
        };
        Self {
            specimens: of(|row| &row.name),
            sessions: of(|row| &row.session),
        }
    }
}

/// A fit of the base law and selected candidates.
#[derive(Clone)]
pub struct Fit {
    /// The candidates.
    pub chosen: Vec<usize>,
    /// Estimates: coefficients of the base, then sizes of candidates in units of `typical`.
    pub step: DVector<f64>,
    /// Standard errors of `step`, scaled by sqrt(chi2 / degrees of freedom) where that exceeds 1.
    pub errors: Vec<f64>,
    /// Weighted sum of squares of the residuals.
    pub chi2: f64,
    /// Root mean square of the residual of mu.
    pub rms: f64,
    /// Whitened residuals.
    pub rest: DVector<f64>,
    /// Whitened columns of the design matrix.
    pub columns: DMatrix<f64>,
    pub whitening: Whitening,
}

/// Predicted offsets of specimens and of sessions (best linear unbiased predictions). With r the
/// residual and V its covariance, the offsets of sessions of standard deviation g are `g^2 Z'
/// inv(V) r`.
pub struct Offsets<'a>([BTreeMap<&'a str, f64>; 2]);

impl Offsets<'_> {
    /// The offset of mu of a row; 0 for unknown specimens and sessions.
    pub fn of(&self, row: &Row) -> f64 {
        let [specimens, sessions] = &self.0;
        let known = [
            specimens.get(row.name.as_str()),
            sessions.get(row.session.as_str()),
        ];
        known.into_iter().flatten().sum()
    }
}

impl Fit {
    /// The offsets of the specimens and sessions of the rows that it was fitted to.
    pub fn offsets<'a>(&self, setting: &Setting, rows: &'a [Row]) -> Offsets<'a> {
        let white = self.whitening.apply_transpose(&self.rest);
        let Between {
            specimens,
            sessions,
        } = setting.between;
        let mut offsets = [BTreeMap::new(), BTreeMap::new()];
        for (row, r) in rows.iter().zip(&white) {
            *offsets[0].entry(row.name.as_str()).or_default() += specimens * specimens * r;
            *offsets[1].entry(row.session.as_str()).or_default() += sessions * sessions * r;
        }
        Offsets(offsets)
    }

    /// Degrees of freedom: number of rows minus number of parameters, at least 1.
    pub fn freedom(&self) -> f64 {
        (self.rest.len() as f64 - self.step.len() as f64).max(1.0)
    }

    /// mu of a row by the base law alone.
    pub fn base_law(&self, setting: &Setting, row: &Row) -> f64 {
        base_law(setting.base, row, &self.step)
    }

    /// mu of a row with the known and selected effects.
    pub fn predict(&self, setting: &Setting, row: &Row) -> f64 {
        let base = self.base_law(setting, row);
        let changes = (0..self.chosen.len()).map(|k| self.added(setting, row, k));
        let selected: f64 = changes.sum();
        base + setting.known.add(row, base.max(MIN_MU)) + selected
    }

    /// Measured minus predicted mu of a row.
    pub fn residual(&self, setting: &Setting, row: &Row) -> f64 {
        row.mu - self.predict(setting, row)
    }

    /// Contribution of the `k`-th selected effect to mu of a row.
    pub fn added(&self, setting: &Setting, row: &Row, k: usize) -> f64 {
        let base = self.base_law(setting, row);
        let size = self.step[setting.base.len() + k];
        setting.candidates[self.chosen[k]].change(row, base.max(MIN_MU), size)
    }

    /// t of the `k`-th selected effect; 0 if it is not determined.
    pub fn t(&self, setting: &Setting, k: usize) -> f64 {
        let at = setting.base.len() + k;
        let t = self.step[at] / self.errors[at].max(1e-300);
        if t.is_finite() { t } else { 0.0 }
    }

    /// Size of the `k`-th selected effect.
    pub fn amount(&self, setting: &Setting, k: usize) -> Amount {
        let candidate = &setting.candidates[self.chosen[k]];
        let [value, error] = [self.step.as_slice(), &self.errors]
            .map(|of| of[setting.base.len() + k] * candidate.typical);
        Amount::of(candidate, value, error)
    }

    /// Standard deviation of mu of a row given its specimen and session: measurement and pressure.
    pub fn own_deviation(&self, setting: &Setting, row: &Row) -> f64 {
        deviation(row, &self.step, setting.base)
    }

    /// Standard deviation of mu of a row: measurement, pressure, specimen and session.
    pub fn deviation(&self, setting: &Setting, row: &Row) -> f64 {
        self.own_deviation(setting, row)
            .hypot(setting.between.both())
    }

    /// Root mean square of the residual of these rows.
    pub fn rms_of(&self, setting: &Setting, rows: &[Row]) -> f64 {
        let squares = rows.iter().map(|row| self.residual(setting, row).powi(2));
        (squares.sum::<f64>() / rows.len().max(1) as f64).sqrt()
    }
}

/// Smallest mu for which changes by effects are computed.
const MIN_MU: f64 = 1e-5;

fn base_law(base: Base, row: &Row, step: &DVector<f64>) -> f64 {
    let columns = base.columns(row);
    columns.iter().zip(step.iter()).map(|(a, b)| a * b).sum()
}

fn deviation(row: &Row, step: &DVector<f64>, base: Base) -> f64 {
    let slope = base.pressure_slope(row, step.as_slice());
    row.mu_sd.hypot(slope * row.pressure_sd / 1e6)
}

/// Fits base and selected candidates jointly; weights and effects are updated in each iteration.
pub fn fit(setting: &Setting, rows: &[Row], chosen: &[usize]) -> Fit {
    let base = setting.base;
    let n = rows.len();
    let m = base.len() + chosen.len();
    let groups = Groups::of(rows);
    let mut step = DVector::zeros(m);
    let mut fit = None;
    for round in 0..ROUNDS {
        let mut columns = DMatrix::zeros(n, m);
        let mut y = DVector::zeros(n);
        for (i, row) in rows.iter().enumerate() {
            let mu = match round {
                0 => row.mu,
                _ => base_law(base, row, &step),
            };
            let mu = mu.max(MIN_MU);
            for (k, x) in base.columns(row).into_iter().enumerate() {
                columns[(i, k)] = x;
            }
            y[i] = row.mu - setting.known.add(row, mu);
            for (k, c) in chosen.iter().enumerate() {
                let (candidate, at) = (&setting.candidates[*c], base.len() + k);
                y[i] -= candidate.change(row, mu, step[at]);
                // An effect whose bounds coincide is fixed.
                if candidate.low < candidate.high {
                    let slope = candidate.slope(row, mu, step[at]);
                    columns[(i, at)] = slope;
                    y[i] += slope * step[at];
                }
            }
        }
        let weights = rows.iter().map(|row| 1.0 / deviation(row, &step, base));
        let whitening = Whitening::new(&groups, weights.collect(), setting.between);
        let (plain_columns, plain_y) = (columns.clone(), y.clone());
        for k in 0..m {
            let white = whitening.apply(&columns.column(k).into_owned());
            columns.set_column(k, &white);
        }
        let y = whitening.apply(&y);
        let inverse = ridge_inverse(columns.tr_mul(&columns));
        step = &inverse * columns.tr_mul(&y);
        for (c, size) in chosen.iter().zip(step.iter_mut().skip(base.len())) {
            // Far outside their bounds some effects are undefined.
            let candidate = &setting.candidates[*c];
            let [low, high] = [candidate.low, candidate.high].map(|end| end / candidate.typical);
            *size = size.clamp(low, high);
        }
        let rest = &y - &columns * &step;
        let chi2 = rest.norm_squared();
        let excess = (chi2 / (n as f64 - m as f64).max(1.0)).max(1.0);
        fit = Some(Fit {
            chosen: chosen.to_vec(),
            step: step.clone(),
            errors: (0..m)
                .map(|k| (inverse[(k, k)].max(0.0) * excess).sqrt())
                .collect(),
            chi2,
            rms: (&plain_y - &plain_columns * &step).norm() / (n as f64).sqrt(),
            rest,
            columns,
            whitening,
        });
    }
    fit.expect("at least one iteration")
}

/// Restricted maximum likelihood estimates of the standard deviations of mu between specimens and
/// between sessions, given these candidates.
///
/// 0 for fewer than three groups, and if almost no group was measured repeatedly.
pub fn between(setting: &Setting, rows: &[Row], chosen: &[usize]) -> Between {
    /// Largest trial deviation, in units of the rows' mean deviation, and number of trials.
    const MAX_RATIO: f64 = 10.0;
    const TRIALS: i32 = 60;
    /// Largest number of sessions: with specimens, a matrix with as many columns as sessions may be
    /// diagonalised in every fit.
    const MAX_SESSIONS: usize = 200;
    /// Estimates of each deviation given the other.
    const ROUNDS: usize = 2;
    let groups = Groups::of(rows);
    let repeats = |groups: &[Vec<usize>]| groups.len() >= 3 && rows.len() >= groups.len() + 3;
    let mean_sd = rows.iter().map(|row| row.mu_sd).sum::<f64>() / rows.len() as f64;
    let cost = |between: Between| {
        let setting = Setting {
            between,
            ..setting.clone()
        };
        let fit = fit(&setting, rows, chosen);
        let information = fit.columns.tr_mul(&fit.columns).determinant().max(1e-300);
        fit.chi2 + fit.whitening.log_determinant() + information.ln()
    };
    let minimise = |with: &dyn Fn(f64) -> Between| {
        let share = |k| (f64::from(k) / f64::from(TRIALS)).powi(2);
        let trials = (0..=TRIALS).map(|k| mean_sd * MAX_RATIO * share(k));
        let costs = trials.map(|sd| (cost(with(sd)), with(sd)));
        let best = costs.min_by(|a, b| a.0.total_cmp(&b.0));
        best.map_or(with(0.0), |(_, between)| between)
    };
    let mut between = Between::default();
    for round in 0..ROUNDS {
        // Given no specimens the sessions were estimated in the first round.
        if round > 0 && between.specimens == 0.0 {
            break;
        }
        if repeats(&groups.sessions) && groups.sessions.len() <= MAX_SESSIONS {
            let specimens = between.specimens;
            between = minimise(&|sessions| Between {
                specimens,
                sessions,
            });
        }
        if repeats(&groups.specimens) {
            let sessions = between.sessions;
            between = minimise(&|specimens| Between {
                specimens,
                sessions,
            });
        }
    }
    between
}

#[cfg(test)]
mod tests {
    use kufe_sled::effects::Effects;

    use super::*;
    use crate::input::table::Table;
    use crate::null::random::{normal, stream};

    /// Ten specimens of six rows in as many sessions, with a scatter of 0.1e-3, `between` specimens
    /// and `by_day` between sessions.
    fn rows(between: f64, by_day: f64) -> Vec<Row> {
        let mut rng = stream(3, 3, 3);
        let days: Vec<f64> = (0..6).map(|_| by_day * normal(&mut rng)).collect();
        let mut text = String::from("specimen,session,p_max_pa,p_max_sd_pa,mu,mu_sd\n");
        for specimen in 0..10 {
            let offset = between * normal(&mut rng);
            for (k, day) in days.iter().enumerate() {
                let mu = 4e-3 + offset + day + 1e-4 * normal(&mut rng);
                let pressure = 8e6 + 1e5 * f64::from(specimen + 10 * k as i32);
                text += &format!("s{specimen},d{k},{pressure},1e3,{mu:.8},1e-4\n");
            }
        }
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("experiments.csv");
        std::fs::write(&path, text).unwrap();
        crate::evidence::experiments::rows::read(&Table::read(&path).unwrap(), 0.0)
            .unwrap()
            .0
    }

    fn setting(rows: &[Row]) -> Setting {
        let table = Table {
            file: String::new(),
            header: Vec::new(),
            rows: Vec::new(),
            lines: Vec::new(),
        };
        let mut setting = Setting {
            candidates: Vec::new(),
            known: ModelEffects::new(&Effects::default(), &table, Base::Fixed)
                .unwrap()
                .0,
            base: Base::Fixed,
            between: Between::default(),
        };
        setting.between = between(&setting, rows, &[]);
        setting
    }

    /// The mean of ten specimens has a tenth of their variance.
    #[test]
    fn different_specimens_widen_the_error_of_their_mean() {
        let rows = rows(5e-4, 0.0);
        let setting = setting(&rows);
        let Between {
            specimens,
            sessions,
        } = setting.between;
        assert!((3e-4..8e-4).contains(&specimens), "{specimens}");
        assert!(sessions < 0.6e-4, "{sessions}");
        let fit = fit(&setting, &rows, &[]);
        let expected = (specimens.powi(2) / 10.0 + 1e-8 / 60.0).sqrt();
        let ratio = fit.errors[0] / expected;
        assert!((ratio - 1.0).abs() < 0.2, "{ratio}");
        assert!((0.5..1.6).contains(&(fit.chi2 / 59.0)), "{}", fit.chi2);
    }

    #[test]
    fn equal_specimens_have_no_variance_between_them() {
        let setting = setting(&rows(0.0, 0.0));
        assert!(setting.between.both() < 0.8e-4, "{:?}", setting.between);
    }

    /// Six rows of a day, and ten days of a specimen, leave a few per cent of an offset's variance.
    #[test]
    fn offsets_of_days_are_those_that_were_drawn() {
        let rows = rows(0.0, 5e-4);
        let setting = setting(&rows);
        let offsets = fit(&setting, &rows, &[]).offsets(&setting, &rows);
        let mean = rows.iter().map(|row| row.mu).sum::<f64>() / 60.0;
        for day in 0..6 {
            let own = rows.iter().filter(|row| row.session == format!("d{day}"));
            let expected = own.map(|row| (row.mu - mean) / 10.0).sum::<f64>();
            let found = offsets.of(&rows[day]);
            assert!((found - expected).abs() < 5e-5, "{found} {expected}");
        }
    }

    /// Against the covariance written out: `R' R` is its inverse.
    #[test]
    fn specimens_and_sessions_are_whitened_together() {
        let rows = rows(5e-4, 4e-4);
        let setting = setting(&rows);
        let Between {
            specimens,
            sessions,
        } = setting.between;
        assert!((2e-4..8e-4).contains(&sessions), "{sessions}");
        let whitening = fit(&setting, &rows, &[]).whitening;
        let same = |same: bool, sd: f64| if same { sd * sd } else { 0.0 };
        let covariance = DMatrix::from_fn(60, 60, |i, k| {
            let [a, b] = [&rows[i], &rows[k]];
            same(i == k, 1.0 / whitening.weights[i])
                + same(a.name == b.name, specimens)
                + same(a.session == b.session, sessions)
        });
        let unit = DMatrix::<f64>::identity(60, 60);
        let mut root = unit.clone();
        for k in 0..60 {
            root.set_column(k, &whitening.apply(&unit.column(k).into_owned()));
        }
        let found = root.tr_mul(&root) * &covariance;
        assert!((found - &unit).amax() < 1e-9);
        let log: f64 = 2.0
            * covariance
                .cholesky()
                .unwrap()
                .l()
                .diagonal()
                .map(f64::ln)
                .sum();
        assert!((whitening.log_determinant() - log).abs() < 1e-9);
    }
}
