//! User-defined effects: expressions of columns.

use kufe_sled::effects::{Channel, Custom, Expression, OperatingPoint};

use crate::state::{forces, point, state};
use crate::tables::effects;

#[test]
fn user_defined_effects_are_expressions_of_columns() {
    let text = "[effects.mine]\nexpression = \"v_mps^2 * abs(delta_rad)\"\nchannel = \"longitudinal\"\nvalue = -2.0";
    let mut f = forces();
    effects(text).unwrap().act(&state(), &mut f);
    let expected = -80.0 - 2.0 * 21.0 * 21.0 * 0.01;
    assert!((f.body_along - expected).abs() < 1e-12);
}

#[test]
fn user_defined_effects_act_on_every_force() {
    let act = |channel: &str| {
        let custom = Custom::new(Channel::named(channel).unwrap(), "pitch_rate_radps", None);
        let mut f = forces();
        custom.unwrap().act(0.5, &state(), &mut f);
        f
    };
    assert_eq!(act("longitudinal").body_along, -80.1);
    assert_eq!(act("lateral").body_across, -0.1);
    assert_eq!(act("yaw").body_yaw, -0.1);
    assert_eq!(act("friction").along, [-7.0 + 180.0, -10.0 + 250.0]);
    assert_eq!(act("grip").across, [81.0, -279.0]);
    assert_eq!(act("sensor:v_mps"), forces());
}

#[test]
fn an_unknown_column_is_available_under_its_name() {
    assert!(Custom::new(Channel::Lateral, "runner_c", None).is_none());
    let name = "runner (left)";
    let text = format!("2 * {}", Expression::quoted(name));
    let custom = Custom::new(Channel::Lateral, &text, Some(name)).unwrap();
    let mut at = state();
    at.carried = -3.0;
    let mut f = forces();
    custom.act(1.0, &at, &mut f);
    assert_eq!(f.body_across, -6.0);
    assert_eq!(custom.names(), [name]);
}

#[test]
fn a_friction_experiment_has_only_conditions() {
    let on_ice = |text| Custom::new(Channel::Friction, text, None).unwrap();
    let at = OperatingPoint {
        fz: 2000.0,
        ..point()
    };
    assert_eq!(on_ice("fz_n / 1000").coefficient(1e-3, &at), 2e-3);
    assert!(on_ice("delta_rad").coefficient(1e-3, &at).is_nan());
}

#[test]
fn a_deeply_nested_formula_is_evaluated_correctly() {
    let deep = format!("{}1{}", "(1 + ".repeat(40), ")".repeat(40));
    let formula = Expression::parse(&deep).unwrap();
    assert_eq!(formula.evaluate(|_| f64::NAN), 41.0);
}
