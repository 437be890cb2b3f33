//! Design matrix: derivatives of the whitened rows by each parameter.

use kufe_sled::effects::{Active, SENSORS};
use nalgebra::{DMatrix, Matrix3};
use rayon::prelude::*;

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::simulated_runs::truth;
use crate::evidence::runs::model::instant::Instant;
use crate::evidence::runs::model::on_run::{FORM_ERRORS, ModelOnRun};
use crate::evidence::runs::model::readings::Readings;
use crate::evidence::runs::model::residual_jacobian::ResidualJacobian;
use crate::evidence::runs::model::residual_model::{BALANCES, BASE, ResidualModel};
use crate::evidence::runs::model::whiten::Whitener;
use crate::evidence::runs::model::windows::Window;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::candidate::Candidate;
use crate::regression::gram::Gram;
use crate::regression::prior::Prior;

/// Columns of each run's own level: of friction and of lateral grip.
pub const OWN_LEVELS: usize = 2;

/// A change of sensor readings or of constants.
enum Shift {
    /// An installation error, by its index.
    Installation(usize),
    /// Delays of the sensors by effects [s].
    Delays([f64; SENSORS]),
}

/// A model, its whitening and the candidates.
pub struct Design<'a> {
    pub residual_model: &'a ResidualModel,
    pub whitener: &'a Whitener,
    /// Base parameters with leverage, then the active effects' amplitudes.
    pub free_base: &'a [usize],
    /// Tolerance of the lateral laws' form, whose errors are random effects; 0: no form errors.
    pub form: f64,
    /// Regular candidates.
    pub candidates: &'a [Candidate<Amplitude>],
    /// Candidates that are searched for in windows.
    pub local: &'a [Candidate<Amplitude>],
    pub windows: &'a [Window],
    /// Derivatives of the Cholesky factor of the noise covariance, by column
    /// ([`noise_gradients`](crate::evidence::runs::fit::row_noise::noise_gradients)): columns are
    /// then derivatives of the residual relative to its noise. `None`: plain derivatives at the
    /// accelerations of the model.
    pub noise: Option<&'a [Matrix3<f64>]>,
}

impl<'a> Design<'a> {
    /// Plain derivatives by the fitted parameters of a model, without candidates and form errors.
    pub fn new(
        residual_model: &'a ResidualModel,
        whitener: &'a Whitener,
        free_base: &'a [usize],
    ) -> Self {
        Self {
            residual_model,
            whitener,
            free_base,
            form: 0.0,
            candidates: &[],
            local: &[],
            windows: &[],
            noise: None,
        }
    }

    /// Number of fitted parameters: base, amplitudes, installation errors, form errors,
    /// discrepancy.
    pub fn fitted_count(&self) -> usize {
        self.before_discrepancy() + self.residual_model.discrepancy.fitted_count()
    }

    /// Number of fitted parameters before the discrepancy.
    fn before_discrepancy(&self) -> usize {
        self.free_base.len()
            + self.residual_model.free().len()
            + self.residual_model.installation.fitted_count()
            + self.form_errors()
    }

    /// Number of form errors of the lateral laws.
    fn form_errors(&self) -> usize {
        if self.form > 0.0 { FORM_ERRORS } else { 0 }
    }

    /// Index of the discrepancy's first column.
    fn discrepancy_index(&self) -> usize {
        OWN_LEVELS + self.before_discrepancy()
    }

    /// Prior of the fitted parameters: flat for base and amplitudes, standard normal for the
    /// others.
    pub fn prior(&self) -> Prior {
        let ResidualModel {
            installation,
            discrepancy,
            ..
        } = self.residual_model;
        let whitened = installation.whitened();
        let form = std::iter::repeat_n(0.0, self.form_errors());
        let random = whitened
            .iter()
            .take(installation.fitted_count())
            .copied()
            .chain(form);
        let smooth = discrepancy
            .sizes
            .iter()
            .take(discrepancy.fitted_count())
            .copied();
        let mut prior = Prior::none(self.fitted_count());
        prior.smooth = discrepancy.fitted_count();
        let flat = self.before_discrepancy() - installation.fitted_count() - self.form_errors();
        for (k, at) in (flat..).zip(random.chain(smooth)) {
            (prior.precision[k], prior.at[k]) = (1.0, at);
        }
        prior
    }

    /// Whitened columns of one run: levels, fitted parameters without the discrepancy, candidates;
    /// the last column is the residual given the discrepancy.
    pub fn columns(&self, frame: &Frame) -> DMatrix<f64> {
        self.with_locals(frame, &[]).0
    }

    /// Whitened columns of one run as of [`columns`](Self::columns), and the columns of the local
    /// candidates acting everywhere.
    pub fn columns_and_locals(&self, frame: &Frame) -> (DMatrix<f64>, DMatrix<f64>) {
        self.with_locals(frame, self.local)
    }

    fn with_locals(
        &self,
        frame: &Frame,
        locals: &[Candidate<Amplitude>],
    ) -> (DMatrix<f64>, DMatrix<f64>) {
        const STEP: f64 = 1e-3;
        let residual_model = self.residual_model;
        let on_run = ModelOnRun::new(residual_model, frame);
        let with_steps: Vec<ResidualModel> = residual_model
            .free()
            .into_iter()
            .map(|(e, p)| {
                let mut moved = residual_model.clone();
                moved.effects.active[e].values[p] += 0.01 * residual_model.scale(e, p);
                moved
            })
            .collect();
        // One column per installation error; the fitted combinations are formed from the rows.
        let installation = &residual_model.installation;
        let errors = match installation.fitted_count() {
            0 => 0,
            _ => installation.errors.len(),
        };
        let trials: Vec<(Active, Option<&[f64]>)> = self
            .candidates
            .iter()
            .chain(locals)
            .map(|c| (c.active(0.01 * c.typical), c.carried(frame)))
            .collect();
        let n = frame.len();
        let first_error = BASE + with_steps.len();
        let first_form = first_error + errors;
        let first_trial = first_form + self.form_errors();
        // Delays and installation errors need the channels at other times.
        let delays = residual_model.effects.delays();
        let delayed = |model: &ResidualModel| {
            let effects = model.effects.on_track(&frame.track);
            Shift::Delays(effects.delays())
        };
        let delayed_steps = (BASE..)
            .zip(&with_steps)
            .filter(|(_, other)| other.effects.delays() != delays)
            .map(|(k, other)| (k, delayed(other)));
        let delayed_trials = (first_trial..)
            .zip(&trials)
            .filter(|(_, (trial, _))| trial.is_late())
            .map(|(k, (trial, _))| (k, delayed(&residual_model.with(trial.clone()))));
        let shifted: Vec<(usize, Shift)> = delayed_steps
            .chain((first_error..).zip((0..errors).map(Shift::Installation)))
            .chain(delayed_trials)
            .collect();
        let with_steps: Vec<(usize, ModelOnRun)> = (BASE..)
            .zip(&with_steps)
            .filter(|(_, other)| other.effects.delays() == delays)
            .map(|(k, other)| (k, ModelOnRun::new(other, frame)))
            .collect();
        let count = first_trial + trials.len() + 1;
        let mut raw: [Vec<Vec<f64>>; BALANCES] = std::array::from_fn(|c| {
            let samples = if self.whitener.used[c] { n } else { 0 };
            (0..count).map(|_| vec![0.0; samples]).collect()
        });
        let mut residual: [Vec<f64>; BALANCES] = std::array::from_fn(|_| Vec::with_capacity(n));
        let mut instants = Vec::with_capacity(if shifted.is_empty() { 0 } else { n });
        let in_time: Vec<_> = (first_trial..)
            .zip(&trials)
            .filter(|(_, (trial, _))| !trial.is_late())
            .collect();
        let any_corrects = in_time.iter().any(|(_, (trial, _))| trial.moves_signals());
        for i in 0..n {
            let at = on_run.instant(i);
            let jacobian = any_corrects
                .then(|| on_run.residual_jacobian(&at))
                .flatten();
            let unchanged = at.residuals();
            if !shifted.is_empty() {
                instants.push(at);
            }
            let mut put = |k: usize, values: [f64; BALANCES], step: f64| {
                let by = 1.0 / step;
                for (c, raw) in raw.iter_mut().enumerate() {
                    if let Some(to) = raw[k].get_mut(i) {
                        *to = (unchanged[c] - values[c]) * by;
                    }
                }
            };
            let mut with_carried = at;
            for (k, (trial, carried)) in &in_time {
                let at = match carried {
                    None => &at,
                    Some(x) => {
                        with_carried.seen.carried = x[i];
                        &with_carried
                    }
                };
                let jacobian = jacobian.as_ref();
                let values = on_run.residuals_with_effect(i, trial, at, jacobian);
                put(*k, values, 0.01);
            }
            for (k, other) in &with_steps {
                put(*k, other.residuals_reusing(i, &at), 0.01);
            }
            if self.form > 0.0 {
                let form = 0.01 * self.form;
                let with_errors = on_run.residuals_with_form_errors(&at, form);
                for (k, values) in (first_form..).zip(with_errors) {
                    put(k, values, 0.01);
                }
            }
            for b in 0..BASE {
                put(b, on_run.residuals_with_base_step(&at, b, STEP), STEP);
            }
            for (c, raw) in raw.iter_mut().enumerate() {
                if let Some(to) = raw[count - 1].get_mut(i) {
                    *to = unchanged[c];
                }
            }
            for (residual, value) in residual.iter_mut().zip(unchanged) {
                residual.push(value);
            }
        }
        self.put_shifted(frame, &shifted, (&instants, &residual), &mut raw);
        let all = self.whitened(frame, &raw);
        let rows = all[0].len();
        let grip: Vec<f64> = (0..rows)
            .map(|i| all[1][i] + all[2][i] + all[3][i] + all[4][i])
            .collect();
        let installed = installation.combined(&all[first_error..first_form]);
        let regular = first_trial + self.candidates.len();
        let order: Vec<&[f64]> = [all[0].as_slice(), grip.as_slice()]
            .into_iter()
            .chain(self.free_base.iter().map(|b| all[*b].as_slice()))
            .chain(all[BASE..first_error].iter().map(Vec::as_slice))
            .chain(installed.iter().map(Vec::as_slice))
            .chain(all[first_form..regular].iter().map(Vec::as_slice))
            .chain([all[count - 1].as_slice()])
            .collect();
        let gather = |columns: &[&[f64]]| {
            let mut matrix = DMatrix::zeros(rows, columns.len());
            for (k, column) in columns.iter().enumerate() {
                matrix.column_mut(k).copy_from_slice(column);
            }
            matrix
        };
        let locals: Vec<&[f64]> = all[regular..count - 1].iter().map(Vec::as_slice).collect();
        let mut columns = gather(&order);
        for (k, noise) in self.noise.into_iter().flatten().enumerate() {
            self.add_relative(noise, &all[count - 1], columns.column_mut(k).as_mut_slice());
        }
        (columns, gather(&locals))
    }

    /// Low-passes, thins and whitens columns; the balances are stacked. The discrepancy is
    /// subtracted from the last column, the residual.
    fn whitened(&self, frame: &Frame, raw: &[Vec<Vec<f64>>; BALANCES]) -> Vec<Vec<f64>> {
        let (count, scales) = (raw[0].len(), frame.row_scales());
        let column = |k: usize| {
            // Such as an installation error of another session.
            if raw.iter().all(|raw| raw[k].iter().all(|x| *x == 0.0)) {
                return vec![0.0; frame.row_count() * self.whitener.count()];
            }
            let mut rows: [Vec<f64>; BALANCES] = std::array::from_fn(|c| frame.rows(&raw[c][k]));
            if k == count - 1 {
                self.residual_model.discrepancy.subtract(frame, &mut rows);
            }
            self.whitener.whiten(&scales, &mut rows);
            rows.concat()
        };
        (0..count).map(column).collect()
    }

    /// Adds the change of the noise's Cholesky factor, `inv(L) dL r`, to a column of the whitened
    /// balances.
    fn add_relative(&self, noise: &Matrix3<f64>, residual: &[f64], column: &mut [f64]) {
        let used: Vec<usize> = (0..BALANCES).filter(|c| self.whitener.used[*c]).collect();
        let n = residual.len() / used.len().max(1);
        for (to, c) in used.iter().enumerate() {
            for (from, other) in used.iter().enumerate().take(to + 1) {
                let by = noise[(*c, *other)];
                let (to, from) = (to * n..(to + 1) * n, from * n..(from + 1) * n);
                let both = column[to].iter_mut().zip(&residual[from]);
                both.for_each(|(x, r)| *x += by * r);
            }
        }
    }

    /// Sets the columns of `shifted` parameters, which change readings or constants. `residual`
    /// contains the residuals of the balances at the run's instants.
    ///
    /// Plain derivatives use the accelerations of the model: the measured ones contain the
    /// residual, and the columns would be correlated with it.
    fn put_shifted(
        &self,
        frame: &Frame,
        shifted: &[(usize, Shift)],
        (instants, residual): (&[Instant], &[Vec<f64>; BALANCES]),
        raw: &mut [Vec<Vec<f64>>; BALANCES],
    ) {
        if shifted.is_empty() {
            return;
        }
        let predicted = match self.noise {
            None => Some(truth(frame, self.residual_model, residual)),
            Some(_) => None,
        };
        let modelled = predicted.as_ref().unwrap_or(frame);
        let on_modelled = ModelOnRun::new(self.residual_model, modelled);
        let readings = Readings::new(self.residual_model, modelled);
        let jacobian = |(i, known): (usize, &Instant)| {
            let at = on_modelled.instant_near(i, &on_modelled.measured(i), known);
            on_modelled.jacobian_of_readings(i, &at)
        };
        let jacobians: Vec<ResidualJacobian> = instants.iter().enumerate().map(jacobian).collect();
        for (k, shift) in shifted {
            let differences = match shift {
                Shift::Installation(error) => readings.with_error_moved(*error, 0.01),
                Shift::Delays(delays) => readings.with_delays(delays),
            };
            if differences.is_empty() {
                continue;
            }
            let to = raw.each_mut().map(|raw| raw[*k].as_mut_slice());
            differences.add_change(-1.0 / 0.01, &jacobians, to);
        }
    }

    /// Products `X'X` of the columns of each run, and products of the windows' columns with them.
    pub fn products(&self, frames: &[Frame]) -> Vec<Products> {
        frames
            .par_iter()
            .map(|frame| {
                let (columns, locals) = self.columns_and_locals(frame);
                let full = self.squares(frame, &columns);
                let (windows, window_norms) = match self.windows.is_empty() {
                    true => (DMatrix::zeros(0, full.ncols()), Vec::new()),
                    false => {
                        let all = self.with_discrepancy(frame, &columns);
                        self.window_products(frame, &all, &locals)
                    }
                };
                let place = frame.rows(&frame.s);
                let shares = self
                    .windows
                    .iter()
                    .map(|w| {
                        let inside = place.iter().filter(|s| (w.from..w.to).contains(*s));
                        let there = w.track == frame.track;
                        let count = if there { inside.count() } else { 0 };
                        (w.local, count as f64 / place.len().max(1) as f64)
                    })
                    .collect();
                Products {
                    full,
                    windows,
                    window_norms,
                    shares,
                }
            })
            .collect()
    }

    /// Products `X'X` of the columns, with the columns of the discrepancy inserted.
    pub fn squares(&self, frame: &Frame, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let at = self.discrepancy_index();
        let discrepancy = &self.residual_model.discrepancy;
        discrepancy.products(frame, self.whitener, columns, at)
    }

    /// Extends the noise products by zeros for the discrepancy, whose columns depend on place only
    /// and have negligible noise.
    pub fn with_noiseless_discrepancy(&self, noise: DMatrix<f64>) -> DMatrix<f64> {
        let at = self.discrepancy_index();
        let count = self.residual_model.discrepancy.fitted_count();
        let rows = noise.insert_rows(at, count, 0.0);
        rows.insert_columns(at, count, 0.0)
    }

    fn with_discrepancy(&self, frame: &Frame, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let at = self.discrepancy_index();
        let discrepancy = &self.residual_model.discrepancy;
        let mut all = columns
            .clone()
            .insert_columns(at, discrepancy.fitted_count(), 0.0);
        if discrepancy.fitted_count() > 0 {
            let (first, own) = discrepancy.columns(frame, self.whitener);
            all.columns_mut(at + first, own.ncols()).copy_from(&own);
        }
        all
    }

    /// Products of the windows' columns with all columns, and the squared norms of the windows'
    /// columns, from cumulative sums over bins.
    fn window_products(
        &self,
        frame: &Frame,
        columns: &DMatrix<f64>,
        locals: &DMatrix<f64>,
    ) -> (DMatrix<f64>, Vec<f64>) {
        let m = columns.ncols();
        let mut products = DMatrix::zeros(self.windows.len(), m);
        let mut norms = vec![0.0; self.windows.len()];
        let own = |w: &&Window| w.track == frame.track;
        let first = self.windows.iter().find(own);
        let Some((start, width)) = first.map(|w| (w.from, w.narrowest)) else {
            return (products, norms);
        };
        let bins = self
            .windows
            .iter()
            .filter(own)
            .map(|w| ((w.to - start) / width).round() as usize)
            .max()
            .unwrap_or(0);
        let place = frame.rows(&frame.s);
        for l in 0..locals.ncols() {
            let mut sums = vec![0.0; (bins + 1) * m];
            let mut squares = vec![0.0; bins + 1];
            for (row, c) in locals.column(l).iter().enumerate() {
                let at = (place[row % place.len()] - start) / width;
                if *c == 0.0 || !(0.0..bins as f64).contains(&at) {
                    continue;
                }
                let bin = at as usize;
                squares[bin + 1] += c * c;
                let sum = &mut sums[(bin + 1) * m..(bin + 2) * m];
                for (k, sum) in sum.iter_mut().enumerate() {
                    *sum += c * columns[(row, k)];
                }
            }
            for bin in 1..=bins {
                squares[bin] += squares[bin - 1];
                for k in 0..m {
                    sums[bin * m + k] += sums[(bin - 1) * m + k];
                }
            }
            for (w, window) in self.windows.iter().enumerate() {
                if window.local != l || window.track != frame.track {
                    continue;
                }
                let from = ((window.from - start) / width).round() as usize;
                let to = ((window.to - start) / width).round() as usize;
                norms[w] = squares[to] - squares[from];
                for k in 0..m {
                    products[(w, k)] = sums[to * m + k] - sums[from * m + k];
                }
            }
        }
        (products, norms)
    }
}

/// Products of one run's columns, levels first, and of its windows' columns with them.
pub struct Products {
    pub full: DMatrix<f64>,
    /// Products of windows with columns, one row per window.
    pub windows: DMatrix<f64>,
    /// Squared norms of the windows' columns.
    pub window_norms: Vec<f64>,
    /// Local candidate of each window and its share of the run's rows.
    pub shares: Vec<(usize, f64)>,
}

impl Products {
    /// The products from which scores are computed, minus `share` times the noise products.
    ///
    /// `noise` includes the local candidates last; the noise of a window is taken to be uniform
    /// along the run.
    pub fn corrected(&self, noise: &DMatrix<f64>, share: f64) -> Gram {
        let m = self.full.ncols();
        let mut full = noise.view((0, 0), (m, m)) * -share;
        full += &self.full;
        let mut windows = self.windows.clone();
        let mut norms = self.window_norms.clone();
        for (w, (local, part)) in self.shares.iter().enumerate() {
            let part = part * share;
            if part > 0.0 {
                norms[w] = (norms[w] - part * noise[(m + local, m + local)]).max(0.0);
                for k in 0..m {
                    windows[(w, k)] -= part * noise[(m + local, k)];
                }
            }
        }
        Gram::new(&full, OWN_LEVELS, &windows, &norms)
    }

    /// The products from which scores are computed, without correction for noise.
    pub fn plain(&self) -> Gram {
        Gram::new(&self.full, OWN_LEVELS, &self.windows, &self.window_norms)
    }
}
