//! Effects of the given model on the coefficient of friction.

use kufe_sled::effects::{Active, Column, Effect, Effects, Experiments, Kind};

use crate::error::Result;
use crate::evidence::experiments::base::Base;
use crate::evidence::experiments::rows::Row;
use crate::input::table::Table;

/// The model's effects on mu.
#[derive(Clone)]
pub struct ModelEffects {
    effects: Vec<Active>,
    /// Shear stress of boundary contact in the film of the base law [Pa].
    pub boundary_shear: f64,
}

impl ModelEffects {
    /// The model's effects on mu, and the names of its other effects.
    ///
    /// # Errors
    /// [`Error::MissingColumn`](crate::error::Error::MissingColumn) if the table does not have a
    /// column that an effect needs.
    pub fn new(model: &Effects, table: &Table, base: Base) -> Result<(Self, Vec<String>)> {
        let not_stated = |effect: &Effect| match effect.info.experiments {
            Experiments::OverFilm => base != Base::Film,
            // The film of the sled's runners is not stated per row.
            _ => effect.info.needs.contains(&Column::Film),
        };
        let (mut effects, mut others) = (Vec::new(), Vec::new());
        let mut boundary_shear = 0.0;
        for active in model.active.iter().filter(|a| a.is_on()) {
            let needed: Vec<&str> = match &active.kind {
                Kind::Custom(custom) if custom.acts_on_friction() => active.columns(),
                Kind::Catalogue(effect) if effect.on_friction.is_some() && !not_stated(effect) => {
                    let needed = effect.info.needs_in_experiments().unwrap_or_default();
                    needed.iter().map(|c| c.name()).collect()
                }
                _ => {
                    others.push(active.name.clone());
                    continue;
                }
            };
            if let Some(column) = needed.into_iter().find(|c| table.place(c).is_none()) {
                let reason = format!(" (the model's effect {} needs it)", active.name);
                return Err(table.missing(column, &reason));
            }
            match &active.kind {
                Kind::Catalogue(effect) if effect.info.experiments == Experiments::OverFilm => {
                    boundary_shear = active.values[0];
                }
                _ => effects.push(active.clone()),
            }
        }
        let known = ModelEffects {
            effects,
            boundary_shear,
        };
        Ok((known, others))
    }

    /// Sum of the effects' changes of the coefficient `mu` of a row.
    pub fn add(&self, row: &Row, mu: f64) -> f64 {
        let with = self.effects.iter().fold(mu, |mu, effect| {
            effect.coefficient(mu, &row.conditions).unwrap_or(mu)
        });
        with - mu
    }
}
