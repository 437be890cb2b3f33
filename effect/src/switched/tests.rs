use super::*;

fn state() -> State {
    State {
        conditions: Conditions {
            t: 3.0,
            s: 20.0,
            v: 21.0,
            fz: 0.0,
            ice_c: -9.0,
            air_c: 2.0,
            air_pa: 94_000.0,
            humidity_pct: 60.0,
            distance: 900.0,
            air_density: 1.2,
            drag_area: 0.28,
        },
        slip: [0.01, -0.008],
        slip_rate: [0.1, 0.2],
        load: [1800.0, 2500.0],
        chassis_slip: 0.003,
        steering: 0.01,
        roll_split: -0.02,
        roll_rate: 0.3,
        roll_acceleration: 1.5,
        yaw_rate: 0.4,
        acceleration: [-0.3, 4.0, 15.0],
        mass: 390.0,
    }
}

fn forces() -> Forces {
    Forces {
        along: [-7.0, -10.0],
        across: [90.0, -310.0],
        stiffness: [9000.0, 35_000.0],
        body_along: -80.0,
        body_across: 0.0,
    }
}

fn measured() -> Measured {
    Measured {
        acceleration: [-0.3, 4.0, 15.0],
        slip: 0.01,
        slip_rate: 0.2,
        steering: 0.02,
        accelerometer: [-0.35, 0.0, 0.12],
        mass: 390.0,
    }
}

#[test]
fn every_effect_is_off_at_default_and_acts_at_each_amplitude() {
    for effect in CATALOGUE {
        let info = effect.info();
        let off: Vec<f64> = info.parameters.iter().map(|p| p.default).collect();
        let outcome = |parameters: &[f64]| {
            let (mut f, mut m) = (forces(), measured());
            effect.act(parameters, &state(), &mut f);
            effect.correct(parameters, &mut m);
            (f, m, effect.slope(parameters, 20.0))
        };
        assert_eq!(outcome(&off), (forces(), measured(), 0.0), "{}", info.name);
        for (index, parameter) in info.parameters.iter().enumerate() {
            if parameter.is_amplitude() {
                let mut on = off.clone();
                on[index] = parameter.typical;
                assert_ne!(
                    outcome(&on),
                    outcome(&off),
                    "{} {}",
                    info.name,
                    parameter.name
                );
                assert!(parameter.low <= 0.0, "{}", info.name);
                assert!(parameter.typical < parameter.high, "{}", info.name);
            }
        }
    }
}

#[test]
fn what_disturb_does_correct_undoes() {
    for effect in CATALOGUE {
        let info = effect.info();
        if ["lever-arm", "mass"].contains(&info.name) {
            continue; // these change what is known of the sled, not a signal
        }
        let on: Vec<f64> = info
            .parameters
            .iter()
            .map(|p| p.default + p.typical)
            .collect();
        let mut m = measured();
        effect.disturb(&on, &mut m);
        effect.correct(&on, &mut m);
        let error = (0..3)
            .map(|i| (m.acceleration[i] - measured().acceleration[i]).abs())
            .sum::<f64>()
            + (m.slip - measured().slip).abs()
            + (m.steering - measured().steering).abs();
        assert!(error < 1e-12, "{}: {error}", info.name);
    }
}

fn tables(text: &str) -> std::collections::BTreeMap<String, toml::Table> {
    let table: toml::Table = text.parse().unwrap();
    let effects = table["effects"].as_table().unwrap();
    let pairs = effects
        .iter()
        .map(|(k, v)| (k.clone(), v.as_table().unwrap().clone()));
    pairs.collect()
}

#[test]
fn local_effects_act_in_their_window_on_their_track() {
    let text =
        "[effects.\"wall-contact@1\"]\nforce_n = 500.0\nfrom_m = 10.0\nto_m = 30.0\ntrack = \"a\"";
    let effects = Effects::from_tables(&tables(text)).unwrap();
    assert_eq!(effects.active[0].effect_name(), "wall-contact");
    let mut f = forces();
    effects.act("a", &state(), &mut f);
    assert_eq!(f.body_across, 500.0);
    effects.act("b", &state(), &mut f);
    assert_eq!(f.body_across, 500.0);
    let mut later = state();
    later.conditions.s = 31.0;
    effects.act("a", &later, &mut f);
    assert_eq!(f.body_across, 500.0);
}

#[test]
fn effects_of_ones_own_are_expressions_of_columns() {
    let text = "[effects.mine]\nexpression = \"v_mps^2 * abs(delta_rad)\"\nchannel = \"longitudinal\"\nvalue = -2.0";
    let effects = Effects::from_tables(&tables(text)).unwrap();
    let mut f = forces();
    effects.act("a", &state(), &mut f);
    let expected = -80.0 - 2.0 * 21.0 * 21.0 * 0.01;
    assert!((f.body_along - expected).abs() < 1e-12);
}

#[test]
fn mistakes_are_named_with_effect_key_and_bounds() {
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
            &["channel", "absent"],
        ),
    ] {
        let message = Effects::from_tables(&tables(text))
            .err()
            .unwrap()
            .to_string();
        for word in words {
            assert!(message.contains(word), "{message:?} lacks {word:?}");
        }
    }
}
