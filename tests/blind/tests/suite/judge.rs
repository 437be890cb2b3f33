//! What counts as a false claim, a wrong firm name, a hit, and a place.

use kufe_blind::answer::{Answer, Hides};
use kufe_blind::score::{Outcome, judge};
use serde_json::json;

fn answer(hidden: &[(&str, &[&str])], places: Vec<(String, f64, f64)>) -> Answer {
    Answer {
        family: "made-up".into(),
        name: "made-up".into(),
        wanted_share: None,
        seed: 1,
        data: "runs.csv".into(),
        model: Some("model.toml".into()),
        hides: hidden
            .iter()
            .map(|(name, class)| Hides {
                effect: (*name).into(),
                class: class.iter().map(|c| (*c).to_owned()).collect(),
                key: "slope_per_k".into(),
                size: -0.02,
                unit: "1/K".into(),
                share: 0.02,
                places: places.clone(),
            })
            .collect(),
        tolerated: vec!["track-profile".into()],
        too_little_to_name: false,
        base: Vec::new(),
    }
}

fn judged(answer: &Answer, verdict: &str, steps: serde_json::Value) -> Outcome {
    let mut outcome = Outcome {
        id: String::new(),
        family: String::new(),
        share: None,
        seed: 1,
        failure: None,
        verdict: String::new(),
        claims: Vec::new(),
        false_claim: false,
        wrong_firm: false,
        overconfident: false,
        found: Vec::new(),
        base: Vec::new(),
        seconds: 0.0,
        cpu_seconds: None,
        adequate: None,
        fresh: None,
    };
    judge(
        &json!({ "verdict": verdict, "steps": steps }),
        answer,
        &mut outcome,
    );
    outcome
}

#[test]
fn any_name_on_a_null_is_false_unless_tolerated() {
    let null = answer(&[], Vec::new());
    assert!(!judged(&null, "none", json!([])).false_claim);
    for verdict in ["located", "inadequate"] {
        assert!(judged(&null, verdict, json!([])).false_claim);
    }
    assert!(
        judged(
            &null,
            "named",
            json!([{ "effect": "speed", "class": ["speed"] }])
        )
        .false_claim
    );
    let tolerated = judged(
        &null,
        "named",
        json!([{ "effect": "track-profile", "class": ["track-profile"] }]),
    );
    assert!(!tolerated.false_claim && !tolerated.wrong_firm);
}

#[test]
fn a_class_that_holds_the_truth_is_a_hit_and_never_a_firm_name() {
    let case = answer(&[("temperature", &["humidity"])], Vec::new());
    let outcome = judged(
        &case,
        "one-of",
        json!([{ "effect": "humidity", "class": ["humidity", "temperature"] }]),
    );
    assert!(!outcome.false_claim && !outcome.wrong_firm);
    assert!(!outcome.found[0].exact && outcome.found[0].in_class);
    assert_eq!(outcome.found[0].class_size, Some(2));
}

#[test]
fn a_firm_name_of_an_indistinguishable_rival_is_wrong() {
    let case = answer(&[("temperature", &["humidity"])], Vec::new());
    let outcome = judged(
        &case,
        "named",
        json!([{ "effect": "humidity", "class": ["humidity"] }]),
    );
    assert!(outcome.wrong_firm && !outcome.false_claim);
}

#[test]
fn intervals_are_compared_by_the_parameters_key() {
    let case = answer(&[("temperature", &[])], Vec::new());
    let step = |low: f64, high: f64| {
        json!([{ "effect": "temperature", "class": ["temperature"],
            "parameters": [{ "name": "slope_per_k", "value": low, "low": low, "high": high, "unit": "1/K" }] }])
    };
    assert_eq!(
        judged(&case, "named", step(-0.03, -0.01)).found[0].parameter_inside,
        Some(true)
    );
    assert_eq!(
        judged(&case, "named", step(-0.01, 0.01)).found[0].parameter_inside,
        Some(false)
    );
}

#[test]
fn overlap_is_intersection_over_union() {
    let case = answer(
        &[("wall-contact", &[])],
        vec![("aalen".into(), 200.0, 300.0)],
    );
    let outcome = judged(
        &case,
        "named",
        json!([{ "effect": "wall-contact", "class": ["wall-contact"], "where": "track aalen, s 250-350 m" }]),
    );
    let overlap = outcome.found[0].overlap.unwrap();
    // 50 m of 150 m, on a grid of 0.1 m
    assert!((overlap - 1.0 / 3.0).abs() < 0.005, "{overlap}");
}
