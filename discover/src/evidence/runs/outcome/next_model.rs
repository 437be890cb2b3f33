//! The model with what was found switched on.

use kufe_sled::Model;
use kufe_sled::effects::Active;

use crate::evidence::runs::model::residual_model::ResidualModel;

/// The given model with refitted base parameters and the model's effects after the first `already` ones.
pub fn next_model(model: &Model, residual_model: &ResidualModel, already: usize) -> Model {
    let mut next = model.clone();
    let [front, rear] = residual_model.laws();
    next.friction.front = front;
    next.friction.rear = rear;
    let keys = &mut next.friction.longitudinal;
    if let Ok(Some(factor)) = keys.tabled() {
        keys.zeta = Some(factor * residual_model.base[0]);
    } else if let Some(mu) = keys.mu.as_mut() {
        *mu *= residual_model.base[0];
    } else {
        // mu scales with the three coefficients of the quadratic and its cap alike.
        for key in [&mut keys.b, &mut keys.c, &mut keys.d, &mut keys.mu_cap] {
            if let Some(value) = key.as_mut() {
                *value *= residual_model.base[0];
            }
        }
    }
    for (index, active) in residual_model.effects.active.iter().enumerate() {
        if index >= already || next.effects.contains_key(&active.name) {
            next.effects.insert(active.name.clone(), table(active));
        }
    }
    if let Some(contacts) = &residual_model.contacts
        && contacts.step.is_some()
    {
        for place in &contacts.places {
            let mut name = place.name.clone();
            let mut k = 1;
            while next.effects.contains_key(&name) {
                k += 1;
                name = format!("{}@{k}", place.name);
            }
            next.effects.insert(name, table(place));
        }
    }
    next
}

/// An active effect as its `[effects.NAME]` table.
pub fn table(active: &Active) -> toml::Table {
    active.table()
}
