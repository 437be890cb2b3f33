//! The model with what was found switched on.

use kufe_sled::Model;
use kufe_sled::effects::{Active, Channel, Kind};

use crate::evidence::runs::model::chain::Chain;

/// The given model with refitted base parameters and the chain's effects after the first `already` ones.
pub fn next_model(model: &Model, chain: &Chain, already: usize) -> Model {
    let mut next = model.clone();
    let [front, rear] = chain.laws();
    next.friction.front = front;
    next.friction.rear = rear;
    let keys = &mut next.friction.longitudinal;
    if let Some(mu) = keys.mu.as_mut() {
        *mu *= chain.base[0];
    } else {
        // mu scales with the three coefficients of the quadratic and its cap alike.
        for key in [&mut keys.b, &mut keys.c, &mut keys.d, &mut keys.mu_cap] {
            if let Some(value) = key.as_mut() {
                *value *= chain.base[0];
            }
        }
    }
    for (index, active) in chain.effects.active.iter().enumerate() {
        if index >= already || next.effects.contains_key(&active.name) {
            next.effects.insert(active.name.clone(), table(active));
        }
    }
    next
}

/// An active effect as its `[effects.NAME]` table.
pub fn table(active: &Active) -> toml::Table {
    let mut table = toml::Table::new();
    match &active.kind {
        Kind::Catalogue(effect) => {
            for (parameter, value) in effect.info().parameters.iter().zip(&active.values) {
                if *value != 0.0 || !parameter.is_amplitude() {
                    table.insert(parameter.name.to_owned(), (*value).into());
                }
            }
        }
        Kind::Custom(custom) => {
            let channel = match custom.channel {
                Channel::Longitudinal => "longitudinal",
                Channel::Lateral => "lateral",
                Channel::Friction => "friction",
                Channel::Grip => "grip",
            };
            table.insert("expression".to_owned(), custom.text.clone().into());
            table.insert("channel".to_owned(), channel.into());
            table.insert("unit".to_owned(), custom.unit.clone().into());
            table.insert("value".to_owned(), active.values[0].into());
            table.insert("low".to_owned(), custom.low.into());
            table.insert("high".to_owned(), custom.high.into());
        }
    }
    if let Some(track) = &active.track {
        table.insert("track".to_owned(), track.clone().into());
    }
    table
}
