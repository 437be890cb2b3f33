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

/// Step of amplitudes, installation errors and candidates, in the unit in which they are fitted.
const STEP: f64 = 0.01;

/// Columns of a run at every sample, by balance.
type RawColumns = [Vec<Vec<f64>>; BALANCES];

/// Indices of the first raw column of each kind, after the base parameters and the amplitudes.
struct RawIndices {
    /// Installation errors; the fitted combinations are formed from the whitened columns.
    errors: usize,
    /// Form errors of the lateral laws.
    form_errors: usize,
    /// Regular candidates.
    trials: usize,
    /// Local candidates.
    locals: usize,
    residual: usize,
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
        let (errors, splines) = (installation.fitted_count(), discrepancy.fitted_count());
        let whitened = installation.whitened();
        let form = std::iter::repeat_n(&0.0, self.form_errors());
        let random = whitened.iter().take(errors).chain(form);
        let random = random.chain(discrepancy.sizes.iter().take(splines));
        let mut prior = Prior::none(self.fitted_count());
        prior.smooth = splines;
        let flat = self.before_discrepancy() - errors - self.form_errors();
        for (k, at) in (flat..).zip(random) {
            (prior.precision[k], prior.at[k]) = (1.0, *at);
        }
        prior
    }

    /// Indices of the raw columns.
    fn indices(&self) -> RawIndices {
        let errors = BASE + self.residual_model.free().len();
        let form_errors = errors + self.residual_model.installation.fitted_count();
        let trials = form_errors + self.form_errors();
        let locals = trials + self.candidates.len();
        RawIndices {
            errors,
            form_errors,
            trials,
            locals,
            residual: locals + self.local.len(),
        }
    }

    /// Whitened columns of one run: levels, fitted parameters without the discrepancy, candidates;
    /// the last column is the residual given the discrepancy.
    pub fn columns(&self, frame: &Frame) -> DMatrix<f64> {
        self.columns_and_locals(frame).0
    }

    /// Whitened columns of one run as of [`columns`](Self::columns), and the columns of the local
    /// candidates acting everywhere.
    pub fn columns_and_locals(&self, frame: &Frame) -> (DMatrix<f64>, DMatrix<f64>) {
        let at = self.indices();
        let all = self.whitened(frame, &self.raw_columns(frame));
        let rows = all[0].len();
        // Friction has one parameter, grip those of both axles.
        let grip = |i: usize| all[1][i] + all[2][i] + all[3][i] + all[4][i];
        let grip: Vec<f64> = (0..rows).map(grip).collect();
        let installation = &self.residual_model.installation;
        let installed = installation.combined(&all[at.errors..at.form_errors]);
        let order: Vec<&Vec<f64>> = [&all[0], &grip]
            .into_iter()
            .chain(self.free_base.iter().map(|b| &all[*b]))
            .chain(&all[BASE..at.errors])
            .chain(&installed)
            .chain(&all[at.form_errors..at.locals])
            .chain([&all[at.residual]])
            .collect();
        let matrix = |columns: Vec<&Vec<f64>>| {
            let count = columns.len();
            DMatrix::from_iterator(rows, count, columns.into_iter().flatten().copied())
        };
        let mut columns = matrix(order);
        for (k, noise) in self.noise.into_iter().flatten().enumerate() {
            self.add_noise_gradient(
                noise,
                &all[at.residual],
                columns.column_mut(k).as_mut_slice(),
            );
        }
        (
            columns,
            matrix(all[at.locals..at.residual].iter().collect()),
        )
    }

    /// Raw columns of each balance at every sample: derivatives by the parameters, and the
    /// residual. A column is empty if the balance is not used.
    fn raw_columns(&self, frame: &Frame) -> RawColumns {
        /// Step of a base multiplier.
        const BASE_STEP: f64 = 1e-3;
        let model = self.residual_model;
        let at = self.indices();
        let with_steps: Vec<ResidualModel> = model
            .free()
            .into_iter()
            .map(|(e, p)| {
                let mut moved = model.clone();
                moved.effects.active[e].values[p] += STEP * model.scale(e, p);
                moved
            })
            .collect();
        let trials: Vec<(Active, Option<&[f64]>)> = self
            .candidates
            .iter()
            .chain(self.local)
            .map(|c| (c.active(STEP * c.typical), c.carried(frame)))
            .collect();
        // Delays and installation errors need the channels at other times.
        let delayed = |model: &ResidualModel| {
            let effects = model.effects.on_track(&frame.track);
            Shift::Delays(effects.delays())
        };
        let (mut shifted, mut steps, mut in_time) = (Vec::new(), Vec::new(), Vec::new());
        for (k, moved) in (BASE..).zip(&with_steps) {
            if moved.effects.delays() == model.effects.delays() {
                steps.push((k, ModelOnRun::new(moved, frame)));
            } else {
                shifted.push((k, delayed(moved)));
            }
        }
        shifted.extend((at.errors..at.form_errors).zip((0..).map(Shift::Installation)));
        for (k, (trial, carried)) in (at.trials..).zip(&trials) {
            if trial.is_late() {
                shifted.push((k, delayed(&model.with(trial.clone()))));
            } else {
                in_time.push((k, trial, carried));
            }
        }
        let mut raw: RawColumns = std::array::from_fn(|c| {
            let samples = if self.whitener.used[c] {
                frame.len()
            } else {
                0
            };
            vec![vec![0.0; samples]; at.residual + 1]
        });
        let mut instants = Vec::new();
        let corrects = in_time.iter().any(|(_, trial, _)| trial.moves_signals());
        let on_run = ModelOnRun::new(model, frame);
        for i in 0..frame.len() {
            let instant = on_run.instant(i);
            let jacobian = corrects
                .then(|| on_run.residual_jacobian(&instant))
                .flatten();
            let unchanged = instant.residuals();
            if !shifted.is_empty() {
                instants.push(instant);
            }
            let mut put = |k: usize, values: [f64; BALANCES], step: f64| {
                let by = 1.0 / step;
                for (c, raw) in raw.iter_mut().enumerate() {
                    if let Some(to) = raw[k].get_mut(i) {
                        *to = (unchanged[c] - values[c]) * by;
                    }
                }
            };
            let mut with_carried = instant;
            for (k, trial, carried) in &in_time {
                with_carried.seen.carried = carried.map_or(instant.seen.carried, |x| x[i]);
                let jacobian = jacobian.as_ref();
                let values = on_run.residuals_with_effect(i, trial, &with_carried, jacobian);
                put(*k, values, STEP);
            }
            for (k, other) in &steps {
                put(*k, other.residuals_reusing(i, &instant), STEP);
            }
            if self.form > 0.0 {
                let form = STEP * self.form;
                let with_errors = on_run.residuals_with_form_errors(&instant, form);
                for (k, values) in (at.form_errors..).zip(with_errors) {
                    put(k, values, STEP);
                }
            }
            for b in 0..BASE {
                let values = on_run.residuals_with_base_step(&instant, b, BASE_STEP);
                put(b, values, BASE_STEP);
            }
            for (raw, residual) in raw.iter_mut().zip(unchanged) {
                if let Some(to) = raw[at.residual].get_mut(i) {
                    *to = residual;
                }
            }
        }
        self.set_shifted_columns(frame, &shifted, &instants, &mut raw);
        raw
    }

    /// Low-passes, thins and whitens columns; the balances are stacked. The discrepancy is
    /// subtracted from the last column, the residual.
    fn whitened(&self, frame: &Frame, raw: &RawColumns) -> Vec<Vec<f64>> {
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
    fn add_noise_gradient(&self, noise: &Matrix3<f64>, residual: &[f64], column: &mut [f64]) {
        let used: Vec<usize> = self.whitener.channels().collect();
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

    /// Sets the columns of `shifted` parameters, which change readings or constants.
    ///
    /// Plain derivatives use the accelerations of the model: the measured ones contain the
    /// residual, and the columns would be correlated with it.
    fn set_shifted_columns(
        &self,
        frame: &Frame,
        shifted: &[(usize, Shift)],
        instants: &[Instant],
        raw: &mut RawColumns,
    ) {
        if shifted.is_empty() {
            return;
        }
        let predicted = self.noise.is_none().then(|| {
            let residuals: Vec<_> = instants.iter().map(Instant::residuals).collect();
            let rows = [0, 1, 2].map(|c| residuals.iter().map(|r| r[c]).collect());
            truth(frame, self.residual_model, &rows)
        });
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
                Shift::Installation(error) => readings.with_error_changed(*error, STEP),
                Shift::Delays(delays) => readings.with_delays(delays),
            };
            if differences.is_empty() {
                continue;
            }
            let to = raw.each_mut().map(|raw| raw[*k].as_mut_slice());
            differences.add_change(-1.0 / STEP, &jacobians, to);
        }
    }

    /// Products `X'X` of the columns of each run, and products of the windows' columns with them.
    pub fn products(&self, frames: &[Frame]) -> Vec<Products> {
        frames
            .par_iter()
            .map(|frame| {
                let (columns, locals) = self.columns_and_locals(frame);
                let full = self.squares(frame, &columns);
                let (windows, window_norms) = if self.windows.is_empty() {
                    (DMatrix::zeros(0, full.ncols()), Vec::new())
                } else {
                    let all = self.with_discrepancy(frame, &columns);
                    self.window_products(frame, &all, &locals)
                };
                let place = frame.rows(&frame.s);
                let share = |w: &Window| {
                    let is_inside =
                        |s: &&f64| w.track == frame.track && (w.from..w.to).contains(*s);
                    let inside = place.iter().filter(is_inside).count();
                    (w.local, inside as f64 / place.len().max(1) as f64)
                };
                let shares = self.windows.iter().map(share).collect();
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
        let own = self.windows.iter().enumerate();
        let own: Vec<_> = own.filter(|(_, w)| w.track == frame.track).collect();
        let Some((_, first)) = own.first() else {
            return (products, norms);
        };
        let (start, width) = (first.from, first.narrowest);
        let bin_of_edge = |edge: f64| ((edge - start) / width).round() as usize;
        let bins = own.iter().map(|(_, w)| bin_of_edge(w.to)).max();
        let bins = bins.unwrap_or(0);
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
            for (w, window) in own.iter().filter(|(_, window)| window.local == l) {
                let [from, to] = [window.from, window.to].map(bin_of_edge);
                norms[*w] = squares[to] - squares[from];
                for k in 0..m {
                    products[(*w, k)] = sums[to * m + k] - sums[from * m + k];
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
    /// The products from which scores are computed, minus the noise products.
    ///
    /// `noise` includes the local candidates last; the noise of a window is taken to be uniform
    /// along the run.
    pub fn corrected(&self, noise: &DMatrix<f64>) -> Gram {
        let m = self.full.ncols();
        let full = &self.full - noise.view((0, 0), (m, m));
        let mut windows = self.windows.clone();
        let mut norms = self.window_norms.clone();
        for (w, (local, share)) in self.shares.iter().enumerate() {
            if *share > 0.0 {
                norms[w] = (norms[w] - share * noise[(m + local, m + local)]).max(0.0);
                for k in 0..m {
                    windows[(w, k)] -= share * noise[(m + local, k)];
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
