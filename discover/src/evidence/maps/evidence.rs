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

use crate::error::Error;
use crate::evidence::maps::bins::bins;
use crate::evidence::maps::line::LineSearch;
use crate::evidence::maps::measured::file::{Measured, file_error};
use crate::evidence::maps::measured::remarks::{remarks_on, typical_noise, untestable};
use crate::evidence::maps::measured::rows::Row;
use crate::evidence::maps::next_case::next_case;
use crate::evidence::maps::pictures::pictures;
use crate::evidence::maps::polish::polish;
use crate::evidence::maps::screen::{Steps, detectable, screen_maps};
use crate::evidence::maps::selection::{place, select};
use crate::evidence::maps::simulate::{Misfit, Simulations};
use crate::evidence::maps::sized::SizedEffects;
use crate::finding::{ChannelGap, Fitted, HeldOut, Interval, Step, Tolerated};
use crate::options::Options;
use crate::procedure::closed::ClosedGap;
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Meaning, SUPERFLUOUS, Screen,
    Selection, Words,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::rules::MapRules;
use crate::procedure::search::{Found, search_evidence};
use crate::procedure::shared_effects::SharesEffects;

/// Measured maps and peaks, and the case that they are compared with.
pub struct Maps<'a> {
    model: &'a Path,
    text: String,
    rows: &'a [Row],
    remarks: &'a [String],
    options: &'a Options,
    progress: &'a (dyn Fn(&str) + Sync),
    training: Simulations<'a>,
    held_out: Simulations<'a>,
    start: Misfit,
    first_steps: Steps,
    /// The effect that would lower the misfit most given those found, selected or not.
    next: Option<(&'static Effect, f64)>,
    screens: usize,
}

/// Effects at their sizes and the misfit.
#[derive(Clone)]
pub struct MapFit {
    active: SizedEffects,
    errors: Vec<f64>,
    misfit: Misfit,
}

/// Pieces of the residuals over which misfits are compared.
const PIECES: usize = 16;

impl<'a> Maps<'a> {
    /// Holds out the last map and solves all rows on two meshes.
    pub fn new(
        measured: &'a Measured,
        model: &'a Path,
        options: &'a Options,
        progress: &'a (dyn Fn(&str) + Sync),
    ) -> Result<Self, Error> {
        let rows = &measured.rows;
        let locked = options.rules.lock.maps(rows.len());
        let pick = |which: &[usize]| which.iter().map(|i| &rows[*i]).collect();
        let training = Simulations::new(pick(&locked.training), &options.rules.maps)?;
        let held_out = Simulations::new(pick(&locked.held_out), &options.rules.maps)?;
        Ok(Self {
            model,
            text: measured.text.clone(),
            rows,
            remarks: &measured.remarks,
            options,
            progress,
            start: training.reporting(&SizedEffects::new())?,
            training,
            held_out,
            first_steps: Steps::new(),
            next: None,
            screens: 0,
        })
    }

    fn rules(&self) -> &MapRules {
        &self.options.rules.maps
    }

    fn unclean(&self, misfit: &Misfit) -> bool {
        misfit.in_contact > self.rules().unclean * misfit.count
    }

    /// Whether the best candidate of a screen may be selected.
    fn is_significant(&self, best: &LineSearch, before: f64, mean_square: f64) -> bool {
        let rules = self.rules();
        before - best.chi2() >= rules.least_drop
            && best.chi2() <= (1.0 - rules.least_share) * before
            && best.size().abs()
                >= self.options.rules.search.agree * best.error() * mean_square.sqrt()
    }

    /// A named effect is doubtful if most of the misfit above the noise remains.
    fn doubt(&self, last: &Misfit, steps: &[Step]) -> Option<String> {
        let [most, share] = self.rules().doubtful;
        let excess = |misfit: &Misfit| misfit.in_contact - misfit.count;
        let remaining = excess(last) / excess(&self.start).max(1e-9);
        let doubtful = last.in_contact > most * last.count && remaining > share;
        let names: Vec<&str> = steps.iter().map(|s| s.effect.as_str()).collect();
        (doubtful && !names.is_empty()).then(|| {
            format!(
                "{} would lower the misfit, but {:.0} % of the excess over the noise remains: not named",
                names.join(" and "),
                100.0 * remaining
            )
        })
    }

    fn polished(&self, active: &SizedEffects, errors: &[f64]) -> Result<MapFit, Error> {
        let polished = polish(&self.training, active, errors)?;
        Ok(MapFit {
            active: polished.active,
            errors: polished.errors,
            misfit: polished.misfit,
        })
    }

    /// Removes effects without which chi2 rises by less than a selected effect must lower it.
    fn remove_step(&self, fit: &mut MapFit, account: &mut Account) -> Result<(), Error> {
        let mut k = 0;
        while fit.active.len() > 1 && k < fit.active.len() {
            let (mut active, mut own) = (fit.active.clone(), fit.errors.clone());
            active.remove(k);
            own.remove(k);
            let mut without = self.polished(&active, &own)?;
            for _ in 0..2 {
                without = self.polished(&without.active, &without.errors)?;
            }
            let raised = without.misfit.chi2 - fit.misfit.chi2;
            if raised < self.rules().least_drop * fit.misfit.mean_square() {
                account.remove_step(k, SUPERFLUOUS);
                account.steps[0].gap_before = self.start.rms;
                *fit = without;
                if let Some(last) = account.steps.last_mut() {
                    last.gap_after = fit.misfit.rms;
                }
                k = 0;
            } else {
                k += 1;
            }
        }
        Ok(())
    }

    fn closed(&self, last: &MapFit) -> Result<Interval, Error> {
        let mut all = last.active.clone();
        all.extend(self.next);
        let change = |rows: &Simulations| -> Result<(Vec<f64>, Misfit), Error> {
            let before = rows.reporting(&SizedEffects::new())?;
            let least = match rows.reporting(&all) {
                Ok(least) => least,
                Err(_) => rows.reporting(&last.active)?,
            };
            let pairs = before.rest.iter().zip(&least.rest);
            Ok((pairs.map(|(a, b)| a - b).collect(), before))
        };
        let judged = match self.held_out.rows.is_empty() {
            true => &self.training,
            false => &self.held_out,
        };
        let (direction, before) = change(judged)?;
        Ok(ClosedGap {
            direction: &direction,
            before: &before.rest,
            after: &judged.reporting(&last.active)?.rest,
            fitted: &change(&self.training)?.0,
            spread: last.misfit.mean_square().sqrt(),
        }
        .closed())
    }

    fn gap(&self, before: &Misfit, after: &Misfit, rows: &[&Row]) -> ChannelGap {
        ChannelGap {
            channel: "p".to_owned(),
            unit: "Pa".to_owned(),
            before: before.rms,
            after: after.rms,
            noise: typical_noise(rows),
        }
    }

    /// Positions of the films that differ from zero: within the tolerance, or as a remark.
    fn within_tolerance(
        &self,
        last: &MapFit,
        account: &mut Account,
    ) -> Result<Vec<Tolerated>, Error> {
        let quantile = self.options.rules.search.interval;
        let cells = self.rules().reporting_cells;
        let mut within = Vec::new();
        for rows in [&self.training, &self.held_out] {
            let films = rows.registered(&last.active, cells)?;
            for (row, film) in rows.rows.iter().zip(films) {
                let Some(film) = film else { continue };
                let [along, across] = film.position.shift;
                let parts = [
                    ("shift of the film along", along, "m"),
                    ("shift of the film across", across, "m"),
                    ("rotation of the film", film.position.rotation, "rad"),
                ];
                for (k, (what, size, unit)) in parts.into_iter().enumerate() {
                    let (z, half) = (film.z[k].abs(), quantile * film.errors[k]);
                    if z > half + quantile {
                        account.remarks.push(format!(
                            "{what}, {}: {size:.2e} {unit}, {z:.1} standard deviations of its tolerance: it was corrected for and not named",
                            row.name
                        ));
                    } else if z > half {
                        within.push(Tolerated {
                            what: format!("{what}, {}", row.name),
                            size,
                            unit: unit.to_owned(),
                        });
                    }
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
                vec![Fitted {
                    name: info.name.to_owned(),
                    value: *size,
                    low: (size - half).max(info.low),
                    high: (size + half).min(info.high),
                    unit: info.unit.to_owned(),
                }]
            })
            .collect()
    }
}

impl Evidence for Maps<'_> {
    type Act = &'static Effect;
    type Fit = MapFit;

    fn fit_base(&mut self, account: &mut Account) -> Result<MapFit, Error> {
        account.remarks.extend(self.options.restriction_remark());
        account.remarks.extend(self.remarks.iter().cloned());
        account.remarks.extend(remarks_on(self.rows));
        Ok(MapFit {
            active: SizedEffects::new(),
            errors: Vec::new(),
            misfit: self.start.clone(),
        })
    }

    fn screen(&mut self, fit: &MapFit, _: &mut Account) -> Result<Screen<Self::Act>, Error> {
        let before = self.training.searching(&fit.active)?;
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
        self.next = None;
        let mut selection = None;
        if let Some(best) = lines.first() {
            let mean_square = best.misfit().mean_square();
            if self.is_significant(best, before.chi2, mean_square) {
                selection = Some(select(
                    &lines,
                    before.chi2,
                    mean_square,
                    &self.rules().rivals,
                ));
            } else {
                self.next = Some((best.effect, best.size()));
            }
        }
        Ok(Screen {
            selection,
            detectable: detectable(&lines, &self.options.rules),
        })
    }

    fn add(
        &mut self,
        fit: &MapFit,
        selection: &Selection<Self::Act>,
        _: usize,
    ) -> Result<ExtendedFit<MapFit>, Error> {
        (self.progress)(&format!("screen {}: finer meshes", self.screens));
        let before = self.training.searching(&fit.active)?;
        let (mut active, mut errors) = (fit.active.clone(), fit.errors.clone());
        active.push((selection.candidate.act, selection.size));
        errors.push(selection.error);
        let next = self.polished(&active, &errors)?;
        let after = self.training.searching(&next.active)?;
        Ok(ExtendedFit {
            gap: [fit.misfit.rms, next.misfit.rms],
            place: Some(place(&self.training, &before, &after)),
            fit: next,
            written: true,
        })
    }

    fn settle(&mut self, fit: MapFit, account: &mut Account) -> Result<MapFit, Error> {
        let mut fit = fit;
        self.remove_step(&mut fit, account)?;
        if let Some(doubt) = self.doubt(&fit.misfit, &account.steps) {
            account.remarks.push(doubt);
            account.steps.clear();
            fit.active.clear();
            fit.errors.clear();
            fit.misfit = self.start.clone();
        }
        if account.steps.is_empty() && self.unclean(&fit.misfit) {
            account.unexplained = Some("maps of the same runner at more loads and turned by a known angle, and a map of a ball of known radius, which separates the sensor from the runner".to_owned());
        }
        Ok(fit)
    }

    fn without(&mut self, fit: &MapFit, step: usize) -> Result<MapFit, Error> {
        let (mut active, mut errors) = (fit.active.clone(), fit.errors.clone());
        active.remove(step);
        errors.remove(step);
        self.polished(&active, &errors)
    }

    fn misfit_decrease(&self, from: &MapFit, to: &MapFit) -> Result<Option<Decrease>, Error> {
        if self.held_out.rows.is_empty() {
            return Ok(None);
        }
        let of = |fit: &MapFit| self.held_out.reporting(&fit.active);
        let falls = of(from)?.falls(&of(to)?, PIECES);
        Ok(Decrease::over(&falls, 0.0))
    }

    fn open(
        &mut self,
        _: &MapFit,
        last: &MapFit,
        account: &mut Account,
    ) -> Result<HeldOutResults, Error> {
        let before = self.held_out.reporting(&SizedEffects::new())?;
        let after = self.held_out.reporting(&last.active)?;
        let closed = match account.steps.is_empty() {
            true => Vec::new(),
            false => vec![self.closed(last)?; account.steps.len()],
        };
        Ok(HeldOutResults {
            held_out: HeldOut {
                what: "measurement".to_owned(),
                runs: self.held_out.rows.iter().map(|r| r.name.clone()).collect(),
                gap_before: before.rms,
                gap_after: after.rms,
                unit: "Pa".to_owned(),
                channels: match self.held_out.rows.is_empty() {
                    true => Vec::new(),
                    false => vec![self.gap(&before, &after, &self.held_out.rows)],
                },
            },
            closed,
        })
    }

    fn describe(
        &mut self,
        _: &MapFit,
        last: &MapFit,
        account: &mut Account,
    ) -> Result<Description, Error> {
        let infos = CATALOGUE.iter().map(|e| e.info());
        Ok(Description {
            data: "pressure measurements".to_owned(),
            training: vec![self.gap(&self.start, &last.misfit, &self.training.rows)],
            parameters: self.parameters(last),
            within_tolerance: self.within_tolerance(last, account)?,
            bins: bins(&self.training, &SizedEffects::new())?,
            bins_after: bins(&self.training, &last.active)?,
            pictures: pictures(&self.training, &self.held_out, &last.active)?,
            clean: !self.unclean(&last.misfit),
            untestable: untestable(self.rows),
            effects: infos
                .map(|i| Meaning {
                    name: i.name.to_owned(),
                    summary: i.summary.to_owned(),
                    decides: i.decides.to_owned(),
                })
                .collect(),
            words: Words {
                next_after_nothing:
                    "maps at several loads, on straight and curved track, reveal smaller effects"
                        .to_owned(),
                ..Words::default()
            },
            next_model: next_case(&self.text, &last.active)
                .map_err(|error| file_error(self.model, &error))?,
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
) -> Result<Found, Error> {
    options.check_names(None)?;
    let measured = Measured::read(path, model, &options.rules.maps)?;
    let mut maps = Maps::new(&measured, model, options, progress)?;
    search_evidence(&mut maps, options, progress)
}
