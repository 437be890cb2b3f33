//! The model with the effects found.

use kufe_sled::Model;

use crate::evidence::runs::model::residual_model::ResidualModel;

/// The given model with refitted base parameters and the effects after the first `already` ones.
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
        // mu is proportional to the three coefficients of the quadratic and its cap.
        for key in [&mut keys.b, &mut keys.c, &mut keys.d, &mut keys.mu_cap] {
            if let Some(value) = key.as_mut() {
                *value *= residual_model.base[0];
            }
        }
    }
    for (index, active) in residual_model.effects.active.iter().enumerate() {
        if index >= already || next.effects.contains_key(&active.name) {
            next.effects.insert(active.name.clone(), active.table());
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
            next.effects.insert(name, place.table());
        }
    }
    next
}

#[cfg(test)]
mod tests {
    use kufe_sled::Vehicle;
    use kufe_sled::effects::{Active, CATALOGUE, Effects, Kind};

    use super::*;

    #[test]
    fn a_model_with_any_effect_of_the_catalogue_is_read_back_as_it_was_written() {
        let model = Model::published();
        let bare = ResidualModel::new(
            Vehicle::new(&model).unwrap(),
            [1.3, 0.7, 1.1, 0.9, 1.2],
            Effects::default(),
        );
        for effect in CATALOGUE.iter() {
            for share in [0.0, 0.137, 1.0] {
                let parameters = effect.info.parameters.iter();
                let values = parameters.map(|p| {
                    if p.is_amplitude() {
                        p.low + share * (p.high - p.low)
                    } else {
                        p.default
                    }
                });
                let active = Active {
                    name: format!("{}@2", effect.info.name),
                    kind: Kind::Catalogue(effect),
                    values: values.collect(),
                    track: Some("east".to_owned()),
                };
                let text = next_model(&model, &bare.with(active.clone()), 0).to_toml();
                let next = Model::from_toml(&text, "model.next.toml").unwrap();
                let read = Effects::from_tables(&next.effects).unwrap();
                assert_eq!(read.active[0].values, active.values, "{}", active.name);
                assert_eq!(read.active[0].track, active.track);
                let mu = |model: &Model| model.friction.longitudinal.mu.unwrap();
                assert!((mu(&next) / mu(&model) - 1.3).abs() < 1e-12);
            }
        }
    }
}
