//! The case with the effects found.

use kufe::case::effects::Effect;

use crate::evidence::maps::rows::number;

/// The case's text with these effects added to its `[effects]`; sizes of the same effect are
/// composed.
///
/// # Errors
/// The message of the TOML parser.
pub fn next_case(text: &str, active: &[(&'static Effect, f64)]) -> Result<String, String> {
    if active.is_empty() {
        return Ok(text.to_owned());
    }
    let mut next: toml::Table = text
        .parse()
        .map_err(|error: toml::de::Error| error.to_string())?;
    let effects = next
        .entry("effects")
        .or_insert_with(|| toml::Table::new().into());
    if let toml::Value::Table(effects) = effects {
        for (effect, size) in active {
            let (name, key) = (effect.info().name, effect.parameter().name);
            let own = effects.get(name).and_then(|one| number(one.get(key)?));
            let size = effect.search.together(own.unwrap_or(0.0), *size);
            let one = toml::Table::from_iter([(key.to_owned(), size.into())]);
            effects.insert(name.to_owned(), one.into());
        }
    }
    Ok(next.to_string())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe::case::effects::{Map, find};

    #[test]
    fn an_effect_that_the_case_has_already_is_added_to() -> Result<(), String> {
        let text = "[load]\nfz_n = 1.0\n[effects.roll-tilt]\nangle_rad = 0.01\n";
        let found = ["roll-tilt", "hardness"].map(|name| find(name).expect("in the catalogue"));
        let next = next_case(text, &[(found[0], 0.02), (found[1], 1e-8)])?;
        let table: toml::Table = next.parse().map_err(|error| format!("{error}"))?;
        let angle = table["effects"]["roll-tilt"]["angle_rad"].as_float();
        assert!((angle.unwrap_or(0.0) - 0.03).abs() < 1e-15);
        assert_eq!(
            table["effects"]["hardness"]["inverse_per_pa"].as_float(),
            Some(1e-8)
        );
        Ok(())
    }

    #[test]
    fn sizes_of_a_sensor_add_up_as_its_effects_do() {
        let mut map = Map {
            nx: 64,
            ny: 64,
            x0: 0.0,
            y0: 0.0,
            dx: 1.0,
            dy: 1.0,
            pressure: (0..64 * 64)
                .map(|k| if k == 32 * 64 + 32 { 1.0 } else { 0.0 })
                .collect(),
        };
        for (name, first, second) in [("sensor-blur", 2.0, 3.0), ("sensor-gain", 0.2, -0.3)] {
            let effect = find(name).expect("in the catalogue");
            let mut one = map.clone();
            effect.sense(first, &mut one);
            effect.sense(second, &mut one);
            let mut both = map.clone();
            effect.sense(effect.search.together(first, second), &mut both);
            let off = one.pressure.iter().zip(&both.pressure);
            let worst = off.fold(0.0_f64, |m, (a, b)| m.max((a - b).abs()));
            // The tails of sampled Gaussians are cut at four deviations.
            assert!(worst < 1e-4, "{name}: {worst}");
            map = one;
        }
    }
}
