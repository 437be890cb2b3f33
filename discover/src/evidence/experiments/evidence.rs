//! Friction experiments as evidence.
//!
//! The base is `mu = 1e-3 (b p^2 - c p + d)`, p in MPa, a constant if the model has a fixed mu, or
//! the melt film on each row's contact times a factor. It is refitted with the variance `mu_sd^2 +
//! (dmu/dp p_sd)^2`; specimens and sessions have random offsets. A candidate adds one parameter. Its t
//! in the joint fit is compared with the largest |t| over all candidates in simulated tables (both
//! errors are drawn, that of p included) and under permutations of the residuals. A candidate that
//! differs mainly between sessions is compared under permutations of the sessions.

use std::path::Path;

use kufe::plot::number4;
use kufe_sled::Model;
use kufe_sled::effects::{Effects, find};

use crate::error::{Error, Result};
use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::candidates::{FrictionChange, list};
use crate::evidence::experiments::fit::{Between, Fit, Offsets, Setting, between, fit};
use crate::evidence::experiments::known::ModelEffects;
use crate::evidence::experiments::outcome::bins;
use crate::evidence::experiments::pictures::pictures;
use crate::evidence::experiments::rows::{Row, Untestable, read, set_films};
use crate::evidence::experiments::screen::screen_table;
use crate::finding::{ChannelGap, ModelKind, Report, Step, held_out};
use crate::input::table::Table;
use crate::null::clusters::members;
use crate::options::{OUTSIDE_CATALOGUE, Options};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{
    Account, Choice, Description, Evidence, ExtendedFit, HeldOutResults, Meaning, SUPERFLUOUS,
    Screen, Selection, Unexplained,
};
use crate::procedure::misfit_decrease::Decrease;
use crate::procedure::search::{Found, search_evidence};
use crate::procedure::shared_effects::ScreenEstimate;

/// Rows of friction experiments and the model that they are compared with.
pub struct Experiments<'a> {
    pub model: &'a Model,
    pub options: &'a Options,
    /// Candidates, known effects and base law.
    pub setting: Setting,
    pub training: Vec<Row>,
    pub held_out: Vec<Row>,
    pub untestable: Untestable,
    /// Effects of the model that do not act on a coefficient of friction.
    pub others: Vec<String>,
    /// The strongest candidate that was not selected.
    pub next_best: Option<usize>,
    /// Estimates and p-values of the last screen.
    pub screen_estimates: Vec<ScreenEstimate>,
}

impl<'a> Experiments<'a> {
    /// Reads an `experiments.csv` and holds out a part of its rows.
    ///
    /// # Errors
    /// [`Error::Cell`], [`Error::MissingColumn`], [`Error::Duplicate`], [`Error::TooFew`] below
    /// five rows.
    pub fn read(path: &Path, model: &'a Model, options: &'a Options) -> Result<Self> {
        let table = Table::read(path)?;
        let (mut rows, unreadable) = read(&table, model.sled.cda_m2)?;
        let base = Base::of(model)?;
        let needed = base.len() + 2;
        if rows.len() < needed {
            return Err(Error::TooFew {
                what: format!("{}: rows", table.file),
                found: rows.len(),
                needed,
            });
        }
        let effects = Effects::from_tables(&model.effects)?;
        let (known, others) = ModelEffects::new(&effects, &table, base)?;
        if base == Base::Film {
            set_films(&mut rows, &table, known.boundary_shear)?;
        }
        let (mut candidates, mut untestable) = list(&rows, &table, &effects, base);
        untestable.extend(unreadable);
        let is_requested = |effect: &str| {
            let is_outside = effect.starts_with("unknown:");
            options.includes(if is_outside {
                OUTSIDE_CATALOGUE
            } else {
                effect
            })
        };
        candidates.retain(|c| is_requested(&c.effect));
        untestable.retain(|(effect, _)| is_requested(effect));
        let locked = options.rules.lock.rows(rows.len());
        let pick = |which: &[usize]| which.iter().map(|i| rows[*i].clone()).collect();
        let training: Vec<Row> = pick(&locked.training);
        let mut setting = Setting {
            candidates,
            known,
            base,
            between: Between::default(),
        };
        setting.between = between(&setting, &training, &[]);
        Ok(Self {
            model,
            options,
            training,
            held_out: pick(&locked.held_out),
            setting,
            untestable,
            others,
            next_best: None,
            screen_estimates: Vec::new(),
        })
    }

    /// Fits these candidates.
    pub fn fitted(&self, chosen: &[usize]) -> Fit {
        fit(&self.setting, &self.training, chosen)
    }

    /// Fits these candidates, with new estimates of the deviations between specimens and sessions.
    fn fitted_anew(&mut self, chosen: &[usize]) -> Fit {
        self.setting.between = between(&self.setting, &self.training, chosen);
        self.fitted(chosen)
    }

    fn rows(&self) -> usize {
        self.training.len() + self.held_out.len()
    }

    /// Whether chi2 per degree of freedom is below the limit of a clean residual.
    fn is_clean(&self, fit: &Fit) -> bool {
        fit.chi2 < self.options.rules.experiments.unclean * fit.freedom()
    }

    /// chi2 and degrees of freedom of the base.
    fn of_base(&self, base: &Fit) -> String {
        let freedom = self.training.len() - self.setting.base.len();
        format!("chi2 = {:.1} on {freedom} degrees of freedom", base.chi2)
    }

    fn channel_misfit(&self, before: f64, after: f64) -> ChannelGap {
        let squares = self.training.iter().map(|r| r.mu_sd * r.mu_sd);
        ChannelGap {
            channel: "mu".to_owned(),
            unit: String::new(),
            before,
            after,
            noise: f64::sqrt(squares.sum::<f64>() / self.training.len() as f64),
        }
    }
}

impl Evidence for Experiments<'_> {
    type Act = FrictionChange;
    type Fit = Fit;

    fn fit_base(&mut self, account: &mut Account) -> Result<Fit> {
        let remarks = &mut account.remarks;
        remarks.extend(self.options.restriction_remark());
        if !self.others.is_empty() {
            remarks.push(format!(
                "effects of the model that these data do not depend on: {}",
                self.others.join(", ")
            ));
        }
        if self.held_out.is_empty() {
            remarks.push(format!(
                "{} rows are too few to hold any out: the misfit is that of the training rows",
                self.rows()
            ));
        }
        let Between {
            specimens,
            sessions,
        } = self.setting.between;
        for (what, sd) in [("specimens", specimens), ("sessions", sessions)] {
            if sd > 0.0 {
                remarks.push(format!(
                    "{what} differ by a standard deviation of {} in mu in addition to the deviations of their rows",
                    number4(sd)
                ));
            }
        }
        let base = self.fitted(&[]);
        remarks.push(format!("base fit: {}", self.of_base(&base)));
        Ok(base)
    }

    fn screen(&mut self, fit: &Fit, _: &mut Account) -> Result<Screen<FrictionChange>> {
        let is_enough = self.training.len() > fit.step.len() + 2;
        let rules = &self.options.rules.experiments;
        let screen = screen_table(&self.setting, &self.training, fit.clone(), self.options);
        let selection = screen.select(rules).filter(|_| is_enough);
        let next_best = screen
            .largest()
            .filter(|_| is_enough && selection.is_none());
        let screened = Screen {
            detectable: screen.detectable(),
            selection,
        };
        self.screen_estimates = screen.screen_estimates();
        self.next_best = next_best;
        Ok(screened)
    }

    fn add(
        &mut self,
        fit: &Fit,
        selection: &Selection<FrictionChange>,
        _: usize,
    ) -> Result<ExtendedFit<Fit>> {
        let named = |c: &Candidate<FrictionChange>| c.effect == selection.candidate.effect;
        let place = self.setting.candidates.iter().position(named);
        let chosen: Vec<usize> = fit.chosen.iter().copied().chain(place).collect();
        let next = self.fitted_anew(&chosen);
        Ok(ExtendedFit {
            rms: [fit.rms, next.rms],
            fit: next,
            is_writable: true,
            place: None,
        })
    }

    fn remove_superfluous(&mut self, mut fit: Fit, account: &mut Account) -> Result<Fit> {
        let min_t = self.options.rules.search.superfluous_t;
        while fit.chosen.len() > 1 {
            let is_weak = |k: &usize| fit.t(&self.setting, *k).abs() < min_t;
            let Some(weak) = (0..fit.chosen.len()).find(is_weak) else {
                break;
            };
            account.remove_step(weak, SUPERFLUOUS);
            fit = self.without(&fit, weak)?;
        }
        if account.steps.is_empty() && !self.is_clean(&fit) {
            account.unexplained = Some(Unexplained {
                reason: format!("the model's friction has {}", self.of_base(&fit)),
                decides: "a law over pressure (b, c, d) where the model has one mu, columns for what else differed from \
                          row to row, or mu_sd equal to the scatter of repeated rows"
                    .to_owned(),
            });
        }
        Ok(fit)
    }

    fn without(&mut self, fit: &Fit, step: usize) -> Result<Fit> {
        let mut chosen = fit.chosen.clone();
        chosen.remove(step);
        Ok(self.fitted_anew(&chosen))
    }

    fn misfit_decrease(&self, from: &Fit, to: &Fit) -> Result<Option<Decrease>> {
        let setting = &self.setting;
        let offsets = [from, to].map(|fit| fit.offsets(setting, &self.training));
        // An effect within sessions and specimens is visible in residuals given their offsets, an
        // effect between them in residuals without offsets.
        let decrease = |row: &Row| {
            let squares = |of: &Fit, offsets: &Offsets| {
                let residual = of.residual(setting, row);
                let given = (residual - offsets.of(row)) / from.own_deviation(setting, row);
                let alone = residual / from.deviation(setting, row);
                [given, alone].map(|r| r * r)
            };
            let [before, after] = [squares(from, &offsets[0]), squares(to, &offsets[1])];
            [before[0] - after[0], before[1] - after[1]]
        };
        let decreases: Vec<[f64; 2]> = self.held_out.iter().map(decrease).collect();
        if setting.between.both() == 0.0 {
            let without_offsets: Vec<f64> = decreases.iter().map(|by| by[1]).collect();
            return Ok(Decrease::over(&without_offsets));
        }
        let training: Vec<[f64; 2]> = self.training.iter().map(decrease).collect();
        Ok(Decrease::over_channels(
            ["mu given specimen and session", "mu"],
            &decreases,
            &training,
        ))
    }

    fn compare(&mut self, base: &Fit, last: &Fit, steps: &[Step]) -> Result<HeldOutResults> {
        let [before, after] = [base, last].map(|fit| fit.rms_of(&self.setting, &self.held_out));
        Ok(HeldOutResults {
            held_out: held_out(
                "row",
                self.held_out.iter().map(|row| &row.name),
                self.channel_misfit(before, after),
            ),
            closed: vec![self.closed(base, last); steps.len()],
        })
    }

    fn choose(&mut self, _: &Fit, last: Fit, _: &mut Account) -> Result<Choice<Fit>> {
        let candidates = &self.setting.candidates;
        let is_written = |c: &usize| candidates[*c].act.table.is_some();
        Ok(Choice {
            written: if last.chosen.iter().any(is_written) {
                ModelKind::WithEffect
            } else {
                ModelKind::Refitted
            },
            fit: last,
            baselines: Vec::new(),
            withheld: Vec::new(),
        })
    }

    fn describe(&mut self, base: &Fit, last: &Fit, account: &mut Account) -> Result<Description> {
        let (setting, rows) = (&self.setting, &self.training);
        let rules = &self.options.rules;
        let quantile = rules.search.interval + rules.experiments.interval_few / last.freedom();
        let amounts = (0..last.chosen.len()).map(|k| last.amount(setting, k));
        let effects = setting.candidates.iter().map(|c| Meaning {
            name: c.effect.clone(),
            summary: find(&c.effect).map_or(String::new(), |e| e.info.summary.to_owned()),
            decides: c.decides.clone(),
        });
        let sessions = members(rows.iter().map(|row| row.session.as_str())).len();
        let laws = last
            .chosen
            .iter()
            .map(|c| setting.candidates[*c].act.law.clone());
        Ok(Description {
            report: Report {
                data: "friction experiments".to_owned(),
                training: vec![self.channel_misfit(base.rms, last.rms)],
                base: self.base_parameters(last, quantile),
                bins: bins(setting, rows, base),
                bins_after: bins(setting, rows, last),
                pictures: pictures(setting, rows, base, last),
                clean: self.is_clean(last),
                untestable: self.untestable.clone(),
                ..Report::default()
            },
            parameters: amounts.map(|a| vec![a.fitted(quantile)]).collect(),
            effects: effects.collect(),
            nothing: format!(
                "Nothing found with {} points: the base fit has {}, and no effect is significant.",
                self.rows(),
                self.of_base(base)
            ),
            next_after_nothing: format!(
                "each specimen measured again in {} at two pressures, which would halve the smallest sizes that can be found; the {} rows have {} degrees of freedom",
                if sessions == rows.len() {
                    "three more sessions, stated in a column session".to_owned()
                } else {
                    format!("{} more sessions", 3 * sessions)
                },
                self.rows(),
                base.freedom()
            ),
            next_model: self.next_model(last, account).to_toml(),
            laws: laws.collect(),
            ..Description::default()
        })
    }
}

/// Searches an `experiments.csv`.
///
/// # Errors
/// [`Error::Cell`], [`Error::MissingColumn`], [`Error::Duplicate`], [`Error::TooFew`] below five
/// rows.
pub fn search(
    path: &Path,
    model: &Model,
    options: &Options,
    progress: &(dyn Fn(&str) + Sync),
) -> Result<Found> {
    options.check_names(Some(model))?;
    let mut experiments = Experiments::read(path, model, options)?;
    search_evidence(&mut experiments, options, progress)
}
