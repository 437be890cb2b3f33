//! What the model's own effects add to a coefficient of friction.

use kufe_friction::effects::{Effect, find};
use kufe_sled::effects::{Channel, Custom, Effects, Kind};

use crate::error::Error;
use crate::evidence::experiments::rows::Row;
use crate::input::table::Table;

/// Whether a model's effect is switched on and no candidate.
pub fn is_on(active: &kufe_sled::effects::Active) -> bool {
    match &active.kind {
        Kind::Custom(_) => active.values[0] != 0.0,
        Kind::Catalogue(effect) => {
            let parameters = effect.info().parameters.iter();
            parameters
                .zip(&active.values)
                .any(|(p, v)| p.is_amplitude() && *v != 0.0)
        }
    }
}

/// What the effects that the model has switched on add to mu.
pub struct Known {
    effects: Vec<(Part, Vec<f64>)>,
}

enum Part {
    Catalogue(&'static dyn Effect),
    Own(Custom),
}

impl Known {
    /// The model's effects on the friction coefficient, and the names of its others, which a table of friction
    /// coefficients says nothing about.
    ///
    /// # Errors
    /// [`Error::MissingColumn`] where one needs a column that the table lacks.
    pub fn new(model: &Effects, table: &Table) -> Result<(Self, Vec<String>), Error> {
        let (mut effects, mut others) = (Vec::new(), Vec::new());
        for active in model.active.iter().filter(|a| is_on(a)) {
            let (part, needed): (Part, Vec<&str>) = match &active.kind {
                Kind::Custom(custom) if custom.channel == Channel::Friction => {
                    let names = custom.expression.names();
                    (
                        Part::Own(custom.clone()),
                        names.iter().map(String::as_str).collect(),
                    )
                }
                Kind::Catalogue(_) => match find(active.effect_name()) {
                    Some(effect) => (
                        Part::Catalogue(effect),
                        effect.info().needs.iter().map(|c| c.name()).collect(),
                    ),
                    None => {
                        others.push(active.name.clone());
                        continue;
                    }
                },
                Kind::Custom(_) => {
                    others.push(active.name.clone());
                    continue;
                }
            };
            if let Some(column) = needed.into_iter().find(|c| table.place(c).is_none()) {
                return Err(Error::MissingColumn {
                    file: table.file.clone(),
                    column: column.to_owned(),
                    found: format!(
                        "{} (the model's effect {} needs it)",
                        table.header.join(", "),
                        active.name
                    ),
                });
            }
            effects.push((part, active.values.clone()));
        }
        Ok((Known { effects }, others))
    }

    /// What they add to the coefficient `mu` of a row.
    pub fn add(&self, row: &Row, mu: f64) -> f64 {
        let mut with = mu;
        for (part, values) in &self.effects {
            match part {
                Part::Catalogue(effect) => {
                    with = effect.coefficient(values, with, &row.conditions);
                }
                Part::Own(custom) => with += custom.coefficient(values[0], &row.conditions),
            }
        }
        with - mu
    }
}
