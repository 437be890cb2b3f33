//! Effects read from the tables of a model.

use std::collections::BTreeMap;

use kufe_sled::effects::Effects;

pub fn effects(text: &str) -> Result<Effects, kufe_sled::effects::EffectError> {
    let table: toml::Table = text.parse().unwrap();
    let effects = table["effects"].as_table().unwrap();
    let pairs = effects
        .iter()
        .map(|(k, v)| (k.clone(), v.as_table().unwrap().clone()));
    Effects::from_tables(&pairs.collect::<BTreeMap<_, _>>())
}

#[test]
fn errors_name_effect_key_and_bounds() {
    for (text, words) in [
        (
            "[effects.nonsense]\nx = 1",
            &["nonsense", "temperature-grip"][..],
        ),
        (
            "[effects.speed-grip]\nslope = 1",
            &["speed-grip", "slope", "slope_s_per_m"],
        ),
        (
            "[effects.speed-grip]\nslope_s_per_m = 7.0",
            &["slope_s_per_m", "7.0", "0.2"],
        ),
        (
            "[effects.speed-grip]\nslope_s_per_m = \"a\"",
            &["slope_s_per_m", "a number"],
        ),
        (
            "[effects.x]\nexpression = \"v_mps +\"\nchannel = \"grip\"",
            &["[effects.x]", "character 8"],
        ),
        (
            "[effects.x]\nexpression = \"velocity\"\nchannel = \"grip\"",
            &["velocity", "v_mps"],
        ),
        (
            "[effects.x]\nexpression = \"v_mps\"",
            &["channel", "absent", "sensor:COLUMN"],
        ),
        (
            "[effects.x]\nexpression = \"v_mps\"\nchannel = \"sensor:fz_n\"",
            &["[effects.x]", "sensor:fz_n", "yaw_rate_radps"],
        ),
        (
            "[effects.x]\nexpression = \"fz_f_n\"\nchannel = \"sensor:v_mps\"",
            &["[effects.x]", "the column fz_f_n", "yaw_rate_radps"],
        ),
    ] {
        let message = effects(text).err().unwrap().to_string();
        for word in words {
            assert!(
                message.contains(word),
                "{message:?} does not contain {word:?}"
            );
        }
    }
}

#[test]
fn effects_round_trip_through_toml() {
    let text = "[effects.\"wall-contact@1\"]\nforce_n = 500.0\nfrom_m = 10.0\nto_m = 30.0\nfriction = 0.0\nlever_m = 0.0\nspread_n = 0.0\nwithin_m = 0.0\ntrack = \"a\"\n\
                [effects.mine]\nexpression = \"v_mps * delta_rad\"\nchannel = \"sensor:yaw_rate_radps\"\nunit = \"1/m\"\nvalue = 0.5\nlow = -1.0\nhigh = 1.0\n";
    let table: toml::Table = text.parse().unwrap();
    for active in effects(text).unwrap().active {
        let written = toml::Value::Table(active.table());
        assert_eq!(Some(&written), table["effects"].get(&active.name));
    }
}

#[test]
fn a_missing_column_is_reported_with_its_effect_unless_the_effect_is_off() {
    let text = "[effects.wear]\nslope_per_km = 0.1\n[effects.humidity]\n[effects.mine]\nexpression = \"gamma_rad\"\nchannel = \"yaw\"\nvalue = 2.0";
    let effects = effects(text).unwrap();
    let message = effects.check_columns(&["v_mps", "gamma_rad"]);
    let message = message.unwrap_err().to_string();
    for word in ["[effects.wear]", "distance_m", "v_mps, gamma_rad"] {
        assert!(message.contains(word), "{message}");
    }
    let message = effects
        .check_columns(&["distance_m"])
        .unwrap_err()
        .to_string();
    assert!(
        message.contains("[effects.mine]") && message.contains("gamma_rad"),
        "{message}"
    );
    assert_eq!(effects.check_columns(&["distance_m", "gamma_rad"]), Ok(()));
}
