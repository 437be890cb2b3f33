//! Design matrix: derivatives of the whitened rows by each parameter.

use kufe_sled::effects::{Active, SENSORS};
use nalgebra::{DMatrix, Matrix3};
use rayon::prelude::*;

use crate::evidence::runs::candidates::amplitude::Amplitude;
use crate::evidence::runs::fit::simulated_runs::truth;
use crate::evidence::runs::model::instant::Instant;
use crate::evidence::runs::model::on_run::{FORMS, ModelOnRun};
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
    Part(usize),
    /// Delays of the sensors by effects [s].
    Delays([f64; SENSORS]),
}

/// A model, its whitening and the candidates.
pub struct Design<'a> {
    pub residual_model: &'a ResidualModel,
    pub whitener: &'a Whitener,
    /// Base parameters with leverage, then the active effects' amplitudes.
    pub free_base: &'a [usize],
    /// Tolerance of the lateral laws' form, whose deviations are random effects; 0: none.
    pub form: f64,
    /// Regular candidates.
    pub candidates: &'a [Candidate<Amplitude>],
    /// Candidates that are searched in windows.
    pub local: &'a [Candidate<Amplitude>],
    pub windows: &'a [Window],
    /// Changes of the root of the residuals' noise by column
    /// ([`noise_gradients`](crate::evidence::runs::fit::row_noise::noise_gradients)): columns are
    /// then derivatives of the residual relative to its noise. `None`: plain derivatives at the
    /// accelerations of the model.
    pub noise: Option<&'a [Matrix3<f64>]>,
}

impl Design<'_> {
    /// Number of fitted parameters: base, amplitudes, installation, form, discrepancy.
    pub fn fitted(&self) -> usize {
        self.before_discrepancy() + self.residual_model.discrepancy.fitted()
    }

    /// Number of those before the discrepancy.
    fn before_discrepancy(&self) -> usize {
        self.free_base.len()
            + self.residual_model.free().len()
            + self.residual_model.installation.fitted()
            + self.forms()
    }

    /// Number of deviations of the lateral laws' form.
    fn forms(&self) -> usize {
        if self.form > 0.0 { FORMS } else { 0 }
    }

    /// Index of the discrepancy's first column.
    fn place_of_discrepancy(&self) -> usize {
        OWN_LEVELS + self.before_discrepancy()
    }

    /// Prior of the fitted parameters: flat for base and amplitudes.
    pub fn prior(&self) -> Prior {
        let ResidualModel {
            installation,
            discrepancy,
            ..
        } = self.residual_model;
        let random = installation.independent();
        let form = std::iter::repeat_n(0.0, self.forms());
        let random = random
            .iter()
            .take(installation.fitted())
            .copied()
            .chain(form);
        let smooth = discrepancy.sizes.iter().take(discrepancy.fitted()).copied();
        let mut prior = Prior::none(self.fitted());
        prior.smooth = discrepancy.fitted();
        let known = self.before_discrepancy() - installation.fitted() - self.forms();
        for (k, at) in (known..).zip(random.chain(smooth)) {
            (prior.precision[k], prior.at[k]) = (1.0, at);
        }
        prior
    }

    /// Whitened columns of one run: levels, fitted parameters without the discrepancy, candidates,
    /// and the residual given the discrepancy last.
    pub fn columns(&self, frame: &Frame) -> DMatrix<f64> {
        self.with_locals(frame, &[]).0
    }

    /// The same, and the columns of local candidates acting everywhere.
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
        let moved: Vec<ResidualModel> = residual_model
            .free()
            .into_iter()
            .map(|(e, p)| {
                let mut moved = residual_model.clone();
                moved.effects.active[e].values[p] += 0.01 * residual_model.scale(e, p);
                moved
            })
            .collect();
        // One column per part; the fitted combinations are formed from the rows.
        let installation = &residual_model.installation;
        let parts = match installation.fitted() {
            0 => 0,
            _ => installation.parts.len(),
        };
        let trials: Vec<(Active, Option<&[f64]>)> = self
            .candidates
            .iter()
            .chain(locals)
            .map(|c| (c.active(0.01 * c.typical), c.carried(frame)))
            .collect();
        let n = frame.len();
        let first_part = BASE + moved.len();
        let first_form = first_part + parts;
        let first_trial = first_form + self.forms();
        // Delays and installation errors need the channels at other times.
        let delays = residual_model.effects.delays();
        let late = |model: &ResidualModel| {
            let there = model.effects.on_track(&frame.track);
            Shift::Delays(there.delays())
        };
        let late_moved = (BASE..)
            .zip(&moved)
            .filter(|(_, other)| other.effects.delays() != delays)
            .map(|(k, other)| (k, late(other)));
        let late_trials = (first_trial..)
            .zip(&trials)
            .filter(|(_, (trial, _))| trial.is_late())
            .map(|(k, (trial, _))| (k, late(&residual_model.with(trial.clone()))));
        let shifted: Vec<(usize, Shift)> = late_moved
            .chain((first_part..).zip((0..parts).map(Shift::Part)))
            .chain(late_trials)
            .collect();
        let moved: Vec<(usize, ModelOnRun)> = (BASE..)
            .zip(&moved)
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
        let any_reads = in_time.iter().any(|(_, (trial, _))| trial.moves_signals());
        for i in 0..n {
            let at = on_run.instant(i, &on_run.measured(i));
            let own = on_run.forces(&at);
            let by = any_reads
                .then(|| on_run.residual_jacobian(&at, &own))
                .flatten();
            let rest = on_run.balances(&at, &own);
            if !shifted.is_empty() {
                instants.push(at);
            }
            let mut put = |k: usize, values: [f64; BALANCES], step: f64| {
                let by = 1.0 / step;
                for (c, raw) in raw.iter_mut().enumerate() {
                    if let Some(to) = raw[k].get_mut(i) {
                        *to = (rest[c] - values[c]) * by;
                    }
                }
            };
            let mut carrying = at;
            for (k, (trial, carried)) in &in_time {
                let moved = match carried {
                    None => on_run.balances_with(i, trial, &at, &own, by.as_ref()),
                    Some(x) => {
                        carrying.seen.carried = x[i];
                        on_run.balances_with(i, trial, &carrying, &own, by.as_ref())
                    }
                };
                put(*k, moved, 0.01);
            }
            for (k, other) in &moved {
                put(*k, other.balances_given(i, &at), 0.01);
            }
            if self.form > 0.0 {
                let deviating = on_run.balances_of_other_form(&at, &own, 0.01 * self.form);
                for (k, values) in (first_form..).zip(deviating) {
                    put(k, values, 0.01);
                }
            }
            for b in 0..BASE {
                put(b, on_run.balances_with_base(&at, b, STEP), STEP);
            }
            for (c, raw) in raw.iter_mut().enumerate() {
                if let Some(to) = raw[count - 1].get_mut(i) {
                    *to = rest[c];
                }
            }
            for (residual, rest) in residual.iter_mut().zip(rest) {
                residual.push(rest);
            }
        }
        self.put_shifted(frame, &shifted, (&instants, &residual), &mut raw);
        // Low-passed, thinned and whitened; the channels are stacked.
        let (rows, scales) = (
            frame.row_count() * self.whitener.count(),
            frame.row_scales(),
        );
        let white = |k: usize| {
            // Such as a part of another session.
            if raw.iter().all(|raw| raw[k].iter().all(|x| *x == 0.0)) {
                return vec![0.0; rows];
            }
            let mut white: [Vec<f64>; BALANCES] = std::array::from_fn(|c| frame.rows(&raw[c][k]));
            if k == count - 1 {
                residual_model.discrepancy.subtract(frame, &mut white);
            }
            self.whitener.whiten(&scales, &mut white);
            white.concat()
        };
        let all: Vec<Vec<f64>> = (0..count).map(white).collect();
        let grip: Vec<f64> = (0..rows)
            .map(|i| all[1][i] + all[2][i] + all[3][i] + all[4][i])
            .collect();
        let installed = installation.combined(&all[first_part..first_form]);
        let regular = first_trial + self.candidates.len();
        let order: Vec<&[f64]> = [all[0].as_slice(), grip.as_slice()]
            .into_iter()
            .chain(self.free_base.iter().map(|b| all[*b].as_slice()))
            .chain(all[BASE..first_part].iter().map(Vec::as_slice))
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

    /// Adds the change of the noise's root, `inv(L) dL r`, to a column of the whitened balances.
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

    /// The columns of models that use the channels at other times or places. `residual` is that of
    /// the balances at the run's instants.
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
            on_modelled.jacobian_of_readings(i, &at, &on_modelled.forces(&at))
        };
        let jacobians: Vec<ResidualJacobian> = instants.iter().enumerate().map(jacobian).collect();
        for (k, shift) in shifted {
            let reads = match shift {
                Shift::Part(part) => readings.with_part_moved(*part, 0.01),
                Shift::Delays(delays) => readings.with_delays(delays),
            };
            if reads.are_none() {
                continue;
            }
            let to = raw.each_mut().map(|raw| raw[*k].as_mut_slice());
            reads.add_change(-1.0 / 0.01, &jacobians, to);
        }
    }

    /// Plain products of the columns of all runs, and of their windows.
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

    /// Products of the columns with each other and with those of the discrepancy.
    pub fn squares(&self, frame: &Frame, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let at = self.place_of_discrepancy();
        let discrepancy = &self.residual_model.discrepancy;
        discrepancy.products(frame, self.whitener, columns, at)
    }

    /// Extends the noise products by zeros for the discrepancy, whose columns depend on place only
    /// and have negligible noise.
    pub fn without_noise(&self, added: DMatrix<f64>) -> DMatrix<f64> {
        let at = self.place_of_discrepancy();
        let count = self.residual_model.discrepancy.fitted();
        let rows = added.insert_rows(at, count, 0.0);
        rows.insert_columns(at, count, 0.0)
    }

    fn with_discrepancy(&self, frame: &Frame, columns: &DMatrix<f64>) -> DMatrix<f64> {
        let at = self.place_of_discrepancy();
        let discrepancy = &self.residual_model.discrepancy;
        let mut all = columns
            .clone()
            .insert_columns(at, discrepancy.fitted(), 0.0);
        if discrepancy.fitted() > 0 {
            let (first, own) = discrepancy.columns(frame, self.whitener);
            all.columns_mut(at + first, own.ncols()).copy_from(&own);
        }
        all
    }

    /// Products of the windows' columns with all columns: sums over bins, then over windows.
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

/// Products of one run's columns, levels first, and of its windows with them.
pub struct Products {
    pub full: DMatrix<f64>,
    /// Windows with columns, one row per window.
    pub windows: DMatrix<f64>,
    pub window_norms: Vec<f64>,
    /// Local candidate of each window and its share of the run's rows.
    pub shares: Vec<(usize, f64)>,
}

impl Products {
    /// The run's sums for scores, less `share` of the noise.
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

    /// Without noise correction; run levels are taken out.
    pub fn plain(&self) -> Gram {
        Gram::new(&self.full, OWN_LEVELS, &self.windows, &self.window_norms)
    }
}
