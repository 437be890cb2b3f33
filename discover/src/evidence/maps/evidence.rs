//! Pressure measurements as evidence: maps and peaks against contact solves.
//!
//! Each candidate of [`kufe::case::effects`] changes the problem or the map. Its size is fitted by
//! Gauss-Newton on all rows (`line`, every point a new solve of each row). Candidates are compared
//! by the sum of squares at their best size:
//!
//! ```text
//! chi2 = sum over pixels (p_measured - p_simulated)^2 / var / (pixels for one independent value)
//!      + sum over maps (film's position / tolerance)^2  +  peaks
//! ```
//!
//! Shift and rotation of each film are fitted in every comparison (`registration`). var is that of
//! `noise` plus the squared discretisation error of that pixel. A selected effect must lower chi2
//! by more than 30 and by a fifth. Its class contains every effect whose best fit is worse by less
//! than 9 in units of the best fit's mean square. A size within three standard errors of 0 is not
//! selected. Sizes are reported from finer meshes (`polish`).

use std::path::Path;

use kufe::case::effects::{CATALOGUE, Effect};
use kufe::plot::quantity;

use crate::error::{Error, Result};
use crate::evidence::maps::bins::bins;
use crate::evidence::maps::line::LineSearch;
use crate::evidence::maps::next_case::next_case;
use crate::evidence::maps::pictures::pictures;
use crate::evidence::maps::polish::{MapFit, polish};
use crate::evidence::maps::rows::{Measured, Row, remarks_on, typical_noise, untestable};
use crate::evidence::maps::screen::{Steps, detectable, place, screen_maps, select};
use crate::evidence::maps::simulate::{Misfit, PIECES, Simulations, SizedEffects};
use crate::finding::{ChannelGap, Fitted, Interval, Report, Step, Tolerated, fitted, held_out};
use crate::options::Options;
use crate::procedure::closed::{ClosedMisfit, change};
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Meaning, NO_SIZE, SUPERFLUOUS,
    Screen, Selection, Unexplained,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::search::{Found, search_evidence};
use crate::procedure::shared_effects::SharesEffects;

/// Measured maps and peaks, and the case that they are compared with.
pub struct Maps<'a> {
    model: &'a Path,
    measured: &'a Measured,
    options: &'a Options,
    progress: &'a (dyn Fn(&str) + Sync),
    training: Simulations<'a>,
    held_out: Simulations<'a>,
    /// The fit without effects.
    start: MapFit,
    first_steps: Steps,
    /// The effect that would lower the misfit most given those found, selected or not.
    next: Option<(&'static Effect, f64)>,
    screens: usize,
}

impl<'a> Maps<'a> {
    /// Holds out the last map and solves all rows on two meshes.
    pub fn new(
        measured: &'a Measured,
        model: &'a Path,
        options: &'a Options,
        progress: &'a (dyn Fn(&str) + Sync),
    ) -> Result<Self> {
        let rules = &options.rules;
        let locked = rules.lock.maps(measured.rows.len());
        let pick = |which: &[usize]| which.iter().map(|i| &measured.rows[*i]).collect();
        let training = Simulations::new(pick(&locked.training), &rules.maps)?;
        Ok(Self {
            model,
            measured,
            options,
            progress,
            start: MapFit {
                active: SizedEffects::new(),
                errors: Vec::new(),
                misfit: training.reporting(&SizedEffects::new())?,
            },
            training,
            held_out: Simulations::new(pick(&locked.held_out), &rules.maps)?,
            first_steps: Steps::new(),
            next: None,
            screens: 0,
        })
    }

    fn is_clean(&self, misfit: &Misfit) -> bool {
        misfit.in_contact <= self.options.rules.maps.unclean * misfit.count
    }

    /// Whether the best candidate of a screen may be selected.
    fn is_significant(&self, best: &LineSearch, before: f64) -> bool {
        let rules = &self.options.rules;
        let error = best.error() * best.misfit().mean_square().sqrt();
        before - best.chi2() >= rules.maps.least_drop
            && best.chi2() <= (1.0 - rules.maps.least_share) * before
            && best.size().abs() >= rules.search.agree * error
    }

    /// Why named effects are doubtful: most of the misfit above the noise remains; `None` if they
    /// are not.
    fn doubt(&self, last: &Misfit, steps: &[Step]) -> Option<String> {
        let [most, share] = self.options.rules.maps.doubtful;
        let excess = |misfit: &Misfit| misfit.in_contact - misfit.count;
        let remaining = excess(last) / excess(&self.start.misfit).max(1e-9);
        if steps.is_empty() || last.in_contact <= most * last.count || remaining <= share {
            return None;
        }
        let names: Vec<&str> = steps.iter().map(|s| s.effect.as_str()).collect();
        Some(format!(
            "{} would lower the misfit, but {:.0} % of the excess over the noise remains: not named",
            names.join(" and "),
            100.0 * remaining
        ))
    }

    /// Removes effects without which chi2 increases by less than a selected effect must lower it.
    fn remove_steps(&mut self, mut fit: MapFit, account: &mut Account) -> Result<MapFit> {
        let min_decrease =
            |misfit: &Misfit| self.options.rules.maps.least_drop * misfit.mean_square();
        // On the finer meshes the misfit must decrease as well, relative to its errors and in Pa.
        let start = &self.start.misfit;
        let is_lower =
            start.chi2 - fit.misfit.chi2 >= min_decrease(&fit.misfit) && start.rms > fit.misfit.rms;
        if let ([only], false) = (&account.steps[..], is_lower) {
            let [before, after] = [start.rms, fit.misfit.rms].map(|rms| quantity(rms, "Pa"));
            account.remarks.push(format!(
                "{} lowers the misfit on the meshes of the search, not on finer ones ({before} before, {after} after): not named",
                only.effect
            ));
            account.steps.clear();
            return Ok(self.start.clone());
        }
        let has_no_size = |p: &Vec<Fitted>| p[0].low <= 0.0 && p[0].high >= 0.0;
        while let Some(k) = self.parameters(&fit).iter().position(has_no_size) {
            account.remove_step(k, NO_SIZE);
            fit = if account.steps.is_empty() {
                self.start.clone()
            } else {
                self.without(&fit, k)?
            };
        }
        let mut k = 0;
        while fit.active.len() > 1 && k < fit.active.len() {
            let mut without = self.without(&fit, k)?;
            for _ in 0..2 {
                without = polish(&self.training, &without.active, &without.errors)?;
            }
            let increase = without.misfit.chi2 - fit.misfit.chi2;
            if increase < min_decrease(&fit.misfit) {
                account.remove_step(k, SUPERFLUOUS);
                account.steps[0].gap_before = self.start.misfit.rms;
                fit = without;
                if let Some(last) = account.steps.last_mut() {
                    last.gap_after = fit.misfit.rms;
                }
                k = 0;
            } else {
                k += 1;
            }
        }
        Ok(fit)
    }

    /// Closed share of the explainable misfit, on the held-out rows if there are any.
    fn closed(&self, last: &MapFit) -> Result<Interval> {
        let mut all = last.active.clone();
        all.extend(self.next);
        let explained = |rows: &Simulations, before: &Misfit| -> Result<Vec<f64>> {
            let after = match rows.reporting(&all) {
                Ok(after) => after,
                Err(_) => rows.reporting(&last.active)?,
            };
            Ok(change(&before.residuals, &after.residuals))
        };
        let judged = if self.held_out.rows.is_empty() {
            &self.training
        } else {
            &self.held_out
        };
        let before = judged.reporting(&self.start.active)?;
        Ok(ClosedMisfit {
            direction: &explained(judged, &before)?,
            before: &before.residuals,
            after: &judged.reporting(&last.active)?.residuals,
            fitted: &explained(&self.training, &self.start.misfit)?,
            spread: last.misfit.mean_square().sqrt(),
        }
        .closed())
    }

    fn channel_misfit(&self, before: &Misfit, after: &Misfit, rows: &[&Row]) -> ChannelGap {
        ChannelGap {
            channel: "p".to_owned(),
            unit: "Pa".to_owned(),
            before: before.rms,
            after: after.rms,
            noise: typical_noise(rows),
        }
    }

    /// Positions of the films that differ from zero: within the tolerance, or as a remark.
    fn within_tolerance(&self, last: &MapFit, account: &mut Account) -> Result<Vec<Tolerated>> {
        let rules = &self.options.rules;
        let mut within = Vec::new();
        for rows in [&self.training, &self.held_out] {
            let films = rows.registered(&last.active, rules.maps.reporting_cells)?;
            for (row, film) in rows.rows.iter().zip(films) {
                let Some(film) = film else { continue };
                let parts = [
                    ("shift of the film along", row.film.shift, "m"),
                    ("shift of the film across", row.film.shift, "m"),
                    ("rotation of the film", row.film.rotation, "rad"),
                ];
                for (k, (what, sd, unit)) in parts.into_iter().enumerate() {
                    let what = format!("{what}, {}", row.name);
                    let numbers = [sd * film.z[k], sd * film.errors[k], sd];
                    let quantile = rules.search.interval;
                    within.extend(account.tolerated(what, unit, numbers, quantile));
                }
            }
        }
        Ok(within)
    }

    fn parameters(&self, last: &MapFit) -> Vec<Vec<Fitted>> {
        let spread = last.misfit.mean_square().sqrt();
        let quantile = self.options.rules.search.interval;
        let sizes = last.active.iter().zip(&last.errors);
        sizes
            .map(|((effect, size), error)| {
                let info = effect.parameter();
                let half = quantile * (error * spread).hypot(effect.form_error() * size);
                let whole = fitted(info.name, info.unit, *size, half);
                vec![Fitted {
                    low: whole.low.max(info.low),
                    high: whole.high.min(info.high),
                    ..whole
                }]
            })
            .collect()
    }
}

impl Evidence for Maps<'_> {
    type Act = &'static Effect;
    type Fit = MapFit;

    fn fit_base(&mut self, account: &mut Account) -> Result<MapFit> {
        let remarks = &mut account.remarks;
        remarks.extend(self.options.restriction_remark());
        remarks.extend(self.measured.remarks.iter().cloned());
        remarks.extend(remarks_on(&self.measured.rows));
        Ok(self.start.clone())
    }

    fn screen(&mut self, fit: &MapFit, _: &mut Account) -> Result<Screen<Self::Act>> {
        let before = self.training.searching(&fit.active)?.chi2;
        self.screens += 1;
        let number = self.screens;
        let progress = self.progress;
        let lines = screen_maps(
            &self.training,
            &fit.active,
            &mut self.first_steps,
            self.options,
            &|name| progress(&format!("screen {number}: {name}")),
        );
        let best = lines.first();
        let is_selected = best.is_some_and(|best| self.is_significant(best, before));
        self.next = best
            .filter(|_| !is_selected)
            .map(|best| (best.candidate.act, best.size()));
        let rules = &self.options.rules;
        Ok(Screen {
            selection: best.filter(|_| is_selected).map(|best| {
                let mean_square = best.misfit().mean_square();
                select(&lines, before, mean_square, &rules.maps.rivals)
            }),
            detectable: detectable(&lines, rules),
        })
    }

    fn add(
        &mut self,
        fit: &MapFit,
        selection: &Selection<Self::Act>,
        _: usize,
    ) -> Result<ExtendedFit<MapFit>> {
        (self.progress)(&format!("screen {}: finer meshes", self.screens));
        let before = self.training.searching(&fit.active)?;
        let added = (selection.candidate.act, selection.size);
        let active = [fit.active.as_slice(), &[added]].concat();
        let errors = [fit.errors.as_slice(), &[selection.error]].concat();
        let next = polish(&self.training, &active, &errors)?;
        let after = self.training.searching(&next.active)?;
        Ok(ExtendedFit {
            rms: [fit.misfit.rms, next.misfit.rms],
            place: Some(place(&self.training, &before, &after)),
            fit: next,
            is_writable: true,
        })
    }

    fn remove_superfluous(&mut self, fit: MapFit, account: &mut Account) -> Result<MapFit> {
        let mut fit = self.remove_steps(fit, account)?;
        if let Some(doubt) = self.doubt(&fit.misfit, &account.steps) {
            account.remarks.push(doubt);
            account.steps.clear();
            fit = self.start.clone();
        }
        if account.steps.is_empty() && !self.is_clean(&fit.misfit) {
            account.unexplained = Some(Unexplained {
                reason: "no effect of the catalogue explains the difference of the maps".to_owned(),
                decides: "maps of the same runner at more loads and turned by a known angle, and a map of a ball of known radius, which separates the sensor from the runner".to_owned(),
            });
        }
        Ok(fit)
    }

    fn without(&mut self, fit: &MapFit, step: usize) -> Result<MapFit> {
        let (mut active, mut errors) = (fit.active.clone(), fit.errors.clone());
        active.remove(step);
        errors.remove(step);
        polish(&self.training, &active, &errors)
    }

    fn misfit_decrease(&self, from: &MapFit, to: &MapFit) -> Result<Option<Decrease>> {
        if self.held_out.rows.is_empty() {
            return Ok(None);
        }
        let of = |fit: &MapFit| self.held_out.reporting(&fit.active);
        let (before, after) = (of(from)?, of(to)?);
        // Relative to its errors and in Pa.
        let falls = if after.rms < before.rms {
            before.decreases(&after)
        } else {
            vec![0.0; PIECES]
        };
        Ok(Decrease::over(&falls))
    }

    fn compare(&mut self, _: &MapFit, last: &MapFit, steps: &[Step]) -> Result<HeldOutResults> {
        let rows = &self.held_out.rows;
        let before = self.held_out.reporting(&self.start.active)?;
        let after = self.held_out.reporting(&last.active)?;
        Ok(HeldOutResults {
            held_out: held_out(
                "measurement",
                rows.iter().map(|row| &row.name),
                self.channel_misfit(&before, &after, rows),
            ),
            closed: if steps.is_empty() {
                Vec::new()
            } else {
                vec![self.closed(last)?; steps.len()]
            },
        })
    }

    fn describe(
        &mut self,
        _: &MapFit,
        last: &MapFit,
        account: &mut Account,
    ) -> Result<Description> {
        let (start, rows) = (&self.start, &self.training.rows);
        Ok(Description {
            report: Report {
                data: "pressure measurements".to_owned(),
                training: vec![self.channel_misfit(&start.misfit, &last.misfit, rows)],
                within_tolerance: self.within_tolerance(last, account)?,
                bins: bins(&self.training, &start.active)?,
                bins_after: bins(&self.training, &last.active)?,
                pictures: pictures([&self.training, &self.held_out], &last.active)?,
                clean: self.is_clean(&last.misfit),
                untestable: untestable(&self.measured.rows),
                ..Report::default()
            },
            parameters: self.parameters(last),
            effects: CATALOGUE.iter().map(|e| Meaning::of(e.info())).collect(),
            next_after_nothing:
                "maps at several loads, on straight and curved track, reveal smaller effects"
                    .to_owned(),
            next_model: next_case(&self.measured.text, &last.active)
                .map_err(|error| Error::file(self.model, error))?,
            ..Description::default()
        })
    }
}

impl SharesEffects for Maps<'_> {}

/// Searches a `pressures.csv`; `model` is the case file to improve.
///
/// # Errors
/// [`Error::Cell`], [`Error::MissingColumn`], [`Error::File`], those of the case and of the solver.
pub fn search(
    path: &Path,
    model: &Path,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found> {
    options.check_names(None)?;
    let measured = Measured::read(path, model, &options.rules.maps)?;
    let mut maps = Maps::new(&measured, model, options, progress)?;
    search_evidence(&mut maps, options, progress)
}
