//! Friction experiments as evidence.
//!
//! The base is `mu = 1e-3 (b p^2 - c p + d)`, p in MPa, a constant if the model has a fixed mu, or
//! the melt film on each row's contact times a factor. It is refitted with the variance `mu_sd^2 +
//! (dmu/dp p_sd)^2`. A candidate adds one parameter. Its t in the joint fit is compared with the
//! largest |t| over all candidates in simulated tables (both errors are drawn, that of p included)
//! and under permutations of the residuals. Columns that are constant within sessions are permuted
//! by session.

use std::path::Path;

use kufe::plot::number4;
use kufe_sled::Model;
use kufe_sled::effects::{Effects, find};

use crate::error::Error;
use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::bins::bins;
use crate::evidence::experiments::candidates::{FrictionChange, list};
use crate::evidence::experiments::compare::Comparison;
use crate::evidence::experiments::fit::{Fit, Setting, between_specimens, fit};
use crate::evidence::experiments::known::ModelEffects;
use crate::evidence::experiments::pictures::pictures;
use crate::evidence::experiments::rows::{Row, read, set_films};
use crate::evidence::experiments::screen::{TableScreen, screen_table};
use crate::finding::{ChannelGap, Fitted, HeldOut};
use crate::input::table::Table;
use crate::null::clusters::members;
use crate::options::{OUTSIDE_CATALOGUE, Options};
use crate::procedure::candidate::Candidate;
use crate::procedure::evidence::{
    Account, Description, Evidence, ExtendedFit, HeldOutResults, Meaning, Randomised, SUPERFLUOUS,
    Screen, Selection, Words,
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
    pub untestable: Vec<(String, String)>,
    /// Effects of the model that do not act on a coefficient of friction.
    pub others: Vec<String>,
    /// The strongest candidate that was not selected.
    pub next_best: Option<usize>,
    /// Estimates and p-values of the last screen.
    pub screen_estimates: Vec<ScreenEstimate>,
}

/// A fit and the candidates that it contains.
#[derive(Clone)]
pub struct TableFit {
    pub chosen: Vec<usize>,
    pub fit: Fit,
}

impl<'a> Experiments<'a> {
    /// Reads an `experiments.csv` and holds out a part of its rows.
    ///
    /// # Errors
    /// [`Error::Cell`], [`Error::MissingColumn`], [`Error::Duplicate`], [`Error::TooFew`] below
    /// five rows.
    pub fn read(path: &Path, model: &'a Model, options: &'a Options) -> Result<Self, Error> {
        let table = Table::read(path)?;
        let mut rows = read(&table, model.sled.cda_m2)?;
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
        candidates.retain(|c| match c.is_column() {
            true => options.looks_for(OUTSIDE_CATALOGUE),
            false => options.looks_for(&c.effect),
        });
        untestable.retain(|(name, _)| options.looks_for(name));
        let locked = options.rules.lock.rows(rows.len());
        let pick = |which: &[usize]| which.iter().map(|i| rows[*i].clone()).collect();
        let training: Vec<Row> = pick(&locked.training);
        let mut setting = Setting {
            candidates,
            known,
            base,
            between: 0.0,
        };
        setting.between = between_specimens(&setting, &training);
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
    pub fn fitted(&self, chosen: Vec<usize>) -> TableFit {
        let fit = fit(&self.setting, &self.training, &chosen);
        TableFit { chosen, fit }
    }

    fn rows(&self) -> usize {
        self.training.len() + self.held_out.len()
    }

    /// Whether chi2 per degree of freedom is below the limit of a clean residual.
    fn is_clean(&self, fit: &TableFit) -> bool {
        let freedom =
            self.training.len() as f64 - (self.setting.base.len() + fit.chosen.len()) as f64;
        fit.fit.chi2 < self.options.rules.experiments.unclean * freedom.max(1.0)
    }

    fn freedom(&self) -> usize {
        self.training.len() - self.setting.base.len()
    }

    fn gap(&self, before: f64, after: f64) -> ChannelGap {
        let squares = self.training.iter().map(|r| r.mu_sd * r.mu_sd);
        ChannelGap {
            channel: "mu".to_owned(),
            unit: String::new(),
            before,
            after,
            noise: f64::sqrt(squares.sum::<f64>() / self.training.len() as f64),
        }
    }

    fn select(&self, screen: &TableScreen, chosen: &[usize]) -> Option<Selection<FrictionChange>> {
        let compare = Comparison {
            setting: &self.setting,
            training: &self.training,
            screen,
            chosen,
            rules: &self.options.rules.experiments,
        };
        let named = compare.strongest()?;
        let (class, rivals) = compare.class(named);
        let candidate = self.setting.candidates[named].clone();
        Some(Selection {
            size: screen.size[named] * candidate.typical,
            error: screen.error[named] * candidate.typical,
            candidate,
            class,
            rivals,
            p_value: screen.p_value(named),
            randomised: Randomised::default(),
            place: "all rows".to_owned(),
            channel: ("mu", ""),
            remark: None,
            parameters: Vec::new(),
        })
    }
}

impl Evidence for Experiments<'_> {
    type Act = FrictionChange;
    type Fit = TableFit;

    fn fit_base(&mut self, account: &mut Account) -> Result<TableFit, Error> {
        account.remarks.extend(self.options.restriction_remark());
        if !self.others.is_empty() {
            account.remarks.push(format!(
                "effects of the model that these data do not depend on: {}",
                self.others.join(", ")
            ));
        }
        if self.held_out.is_empty() {
            account.remarks.push(format!(
                "{} rows are too few to hold any out: the misfit is that of the training rows",
                self.rows()
            ));
        }
        if self.setting.between > 0.0 {
            account.remarks.push(format!(
                "specimens differ by a standard deviation of {} in mu in addition to the deviations of their rows",
                number4(self.setting.between)
            ));
        }
        let base = self.fitted(Vec::new());
        account.remarks.push(format!(
            "base fit: chi2 = {:.1} on {} degrees of freedom",
            base.fit.chi2,
            self.freedom()
        ));
        Ok(base)
    }

    fn screen(&mut self, fit: &TableFit, _: &mut Account) -> Result<Screen<FrictionChange>, Error> {
        let too_few = self.training.len() <= self.setting.base.len() + fit.chosen.len() + 2;
        let screen = screen_table(&self.setting, &self.training, &fit.chosen, self.options);
        let selection = match too_few {
            true => None,
            false => self.select(&screen, &fit.chosen),
        };
        self.screen_estimates = screen.screen_estimates(&self.setting.candidates, &fit.chosen);
        self.next_best = match selection {
            None if !too_few => screen.largest(&fit.chosen),
            _ => None,
        };
        Ok(Screen {
            detectable: screen.detectable(&self.setting.candidates),
            selection,
        })
    }

    fn add(
        &mut self,
        fit: &TableFit,
        selection: &Selection<FrictionChange>,
        _: usize,
    ) -> Result<ExtendedFit<TableFit>, Error> {
        let named = |c: &Candidate<FrictionChange>| c.effect == selection.candidate.effect;
        let place = self.setting.candidates.iter().position(named);
        let chosen: Vec<usize> = fit.chosen.iter().copied().chain(place).collect();
        let next = self.fitted(chosen);
        Ok(ExtendedFit {
            gap: [fit.fit.rms, next.fit.rms],
            fit: next,
            written: true,
            place: None,
        })
    }

    fn settle(&mut self, fit: TableFit, account: &mut Account) -> Result<TableFit, Error> {
        let mut fit = fit;
        let least = self.options.rules.search.superfluous_t;
        while fit.chosen.len() > 1 {
            let t = |k: &usize| {
                let at = self.setting.base.len() + k;
                (fit.fit.step[at] / fit.fit.errors[at].max(1e-300)).abs()
            };
            let Some(weak) = (0..fit.chosen.len()).find(|k| t(k) < least) else {
                break;
            };
            account.remove_step(weak, SUPERFLUOUS);
            fit.chosen.remove(weak);
            fit = self.fitted(fit.chosen);
        }
        if account.steps.is_empty() && !self.is_clean(&fit) {
            account.unexplained = Some(format!(
                "the model's friction has chi2 = {:.1} on {} degrees of freedom; a law over pressure (b, c, d) where it has one mu, columns for what \
                 else differed from row to row, or mu_sd equal to the scatter of repeated rows would explain it",
                fit.fit.chi2,
                self.freedom()
            ));
        }
        Ok(fit)
    }

    fn without(&mut self, fit: &TableFit, step: usize) -> Result<TableFit, Error> {
        let mut chosen = fit.chosen.clone();
        chosen.remove(step);
        Ok(self.fitted(chosen))
    }

    fn misfit_decrease(&self, from: &TableFit, to: &TableFit) -> Result<Option<Decrease>, Error> {
        let falls: Vec<f64> = self
            .held_out
            .iter()
            .map(|row| {
                let square = |of: &TableFit| {
                    let residual = row.mu - of.fit.predict(&self.setting, row, &of.chosen).1;
                    (residual / from.fit.deviation(&self.setting, row)).powi(2)
                };
                square(from) - square(to)
            })
            .collect();
        Ok(Decrease::over(&falls, 0.0))
    }

    fn open(
        &mut self,
        base: &TableFit,
        last: &TableFit,
        account: &mut Account,
    ) -> Result<HeldOutResults, Error> {
        let closed = self.closed(base, last);
        let rms = |of: &TableFit| of.fit.rms_of(&self.setting, &self.held_out, &of.chosen);
        let (before, after) = (rms(base), rms(last));
        Ok(HeldOutResults {
            held_out: HeldOut {
                what: "row".to_owned(),
                runs: self.held_out.iter().map(|r| r.name.clone()).collect(),
                gap_before: before,
                gap_after: after,
                unit: String::new(),
                channels: match self.held_out.is_empty() {
                    true => Vec::new(),
                    false => vec![self.gap(before, after)],
                },
            },
            closed: vec![closed; account.steps.len()],
        })
    }

    fn describe(
        &mut self,
        base: &TableFit,
        last: &TableFit,
        account: &mut Account,
    ) -> Result<Description, Error> {
        let (first, setting, rows) = (&base.fit, &self.setting, &self.training);
        let freedom = self.freedom();
        let rules = &self.options.rules;
        let degrees = rows.len() as f64 - (setting.base.len() + last.chosen.len()) as f64;
        let quantile = rules.search.interval + rules.experiments.interval_few / degrees.max(1.0);
        let parameters: Vec<Vec<Fitted>> = (0..last.chosen.len())
            .map(|k| vec![self.size(last, k, quantile)])
            .collect();
        let effects = setting.candidates.iter().map(|c| Meaning {
            name: c.effect.clone(),
            summary: find(&c.effect).map_or(String::new(), |e| e.info.summary.to_owned()),
            decides: c.decides.clone(),
        });
        Ok(Description {
            data: "friction experiments".to_owned(),
            training: vec![self.gap(first.rms, last.fit.rms)],
            base: self.base_parameters(last, quantile),
            bins: bins(setting, rows, first, &[]),
            bins_after: bins(setting, rows, &last.fit, &last.chosen),
            pictures: pictures(setting, rows, first, (&last.fit, &last.chosen)),
            clean: self.is_clean(last),
            untestable: self.untestable.clone(),
            effects: effects.collect(),
            words: Words {
                nothing: format!(
                    "Nothing to be found with {} points: the base fit has chi2 {:.1} on {freedom} degrees of freedom, and no effect is significant.",
                    self.rows(),
                    first.chi2
                ),
                next_after_nothing: format!(
                    "each specimen measured again in {} more sessions at two pressures, which would halve the smallest sizes that can be found; the {} rows have {freedom} degrees of freedom",
                    3 * members(self.training.iter().map(|row| row.session.as_str())).len(),
                    self.rows()
                ),
            },
            next_model: self.next_model(last, &parameters, account).to_toml(),
            parameters,
            laws: last
                .chosen
                .iter()
                .map(|c| formula(&setting.candidates[*c]))
                .collect(),
            ..Description::default()
        })
    }
}

/// The formula of a law of a column in the next model.
fn formula(candidate: &Candidate<FrictionChange>) -> Option<String> {
    let table = candidate
        .act
        .table
        .as_ref()
        .filter(|_| candidate.is_column())?;
    Some(table.get("expression")?.as_str()?.to_owned())
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
) -> Result<Found, Error> {
    options.check_names(Some(model))?;
    let mut experiments = Experiments::read(path, model, options)?;
    search_evidence(&mut experiments, options, progress)
}
