//! Compares a report with the answer.

use serde_json::Value;

use crate::cases::answer::{Answer, Hides};
use crate::score::outcome::{BaseFound, Claim, Found, Outcome};

fn triple(value: &Value) -> Option<[f64; 3]> {
    Some([
        value["value"].as_f64()?,
        value["low"].as_f64()?,
        value["high"].as_f64()?,
    ])
}

/// Compares a report with the answer.
pub fn judge(report: &Value, answer: &Answer, outcome: &mut Outcome) {
    outcome.verdict = report["verdict"].as_str().unwrap_or("").to_owned();
    let empty = Vec::new();
    let steps = report["steps"].as_array().unwrap_or(&empty);
    for step in steps {
        let effect = step["effect"].as_str().unwrap_or("").to_owned();
        let mut class: Vec<String> = step["class"]
            .as_array()
            .map(|names| {
                names
                    .iter()
                    .filter_map(|n| n.as_str().map(str::to_owned))
                    .collect()
            })
            .unwrap_or_default();
        if !class.contains(&effect) {
            class.push(effect.clone());
        }
        outcome.claims.push(Claim {
            effect,
            class,
            closed: triple(&step["explainable_gap_closed"]),
        });
    }
    let true_name = |name: &str| answer.hides.iter().any(|h| h.effect == name);
    let fair = |name: &str| {
        true_name(name)
            || answer.tolerated.iter().any(|t| t == name)
            || answer
                .hides
                .iter()
                .any(|h| h.class.iter().any(|c| c == name))
    };
    // a class is a fair claim when any of its names is
    outcome.false_claim = outcome
        .claims
        .iter()
        .any(|claim| !claim.class.iter().any(|name| fair(name)))
        || (answer.hides.is_empty()
            && outcome.claims.is_empty()
            && ["located", "inadequate"].contains(&outcome.verdict.as_str()));
    outcome.wrong_firm = outcome.claims.iter().any(|claim| {
        claim.class.len() == 1
            && !claim.effect.starts_with("unknown:")
            && !true_name(&claim.effect)
            && !answer.tolerated.contains(&claim.effect)
    });
    outcome.overconfident =
        answer.too_little_to_name && outcome.claims.iter().any(|claim| claim.class.len() == 1);
    for hides in &answer.hides {
        let exact = outcome
            .claims
            .iter()
            .position(|claim| claim.effect == hides.effect);
        let at = exact.or_else(|| {
            outcome
                .claims
                .iter()
                .position(|claim| claim.class.contains(&hides.effect))
        });
        let claim = at.map(|k| &outcome.claims[k]);
        outcome.found.push(Found {
            effect: hides.effect.clone(),
            share: Some(hides.share),
            exact: exact.is_some(),
            in_class: at.is_some(),
            installed: installed(report, hides),
            class_size: claim.map(|claim| claim.class.len()),
            closed: claim.and_then(|claim| claim.closed),
            parameter_inside: exact.and_then(|k| parameter_inside(&steps[k], hides)),
            overlap: at.and_then(|k| overlap(&steps[k], hides)),
        });
    }
}

/// Effects that an installation may be off by as well, with what reports call it.
const INSTALLED: [(&str, &str); 15] = [
    ("mass", "mass, relative"),
    ("yaw-inertia", "yaw inertia, relative"),
    ("cg-place", "place of the centre of gravity, x"),
    ("roll-rate-scale", "scale of roll_rate_radps"),
    ("pitch-rate-scale", "scale of pitch_rate_radps"),
    ("yaw-rate-scale", "scale of yaw_rate_radps"),
    ("yaw-rate-bias", "bias of yaw_rate_radps"),
    ("accelerometer-scale", "scale of ay_mps2"),
    ("accelerometer-bias", "bias of ay_mps2"),
    ("steer-scale", "scale of delta_rad"),
    ("yaw-rate-lag", "delay of yaw_rate_radps"),
    ("slip-lag", "delay of alpha_rad"),
    ("steer-lag", "delay of delta_rad"),
    ("speed-lag", "delay of v_mps"),
    ("roll-split-lag", "delay of gamma_rad"),
];

/// Whether the report tells the effect, or one of its class, as an error of the installation: under
/// `within_tolerance`, or in a remark as outside it.
fn installed(report: &Value, hides: &Hides) -> bool {
    let list = |key: &str| report[key].as_array().cloned().unwrap_or_default();
    let (within, remarks) = (list("within_tolerance"), list("remarks"));
    INSTALLED.iter().any(|(name, what)| {
        let meant = hides.effect == *name || hides.class.iter().any(|c| c == name);
        let begins = format!("{what}: ");
        let remark = |r: &Value| r.as_str().is_some_and(|r| r.starts_with(&begins));
        meant && (within.iter().any(|w| w["what"] == *what) || remarks.iter().any(remark))
    })
}

/// Whether the interval of the parameter with the answer's key holds the truth.
fn parameter_inside(step: &Value, hides: &Hides) -> Option<bool> {
    let parameters = step["parameters"].as_array()?;
    let parameter = parameters
        .iter()
        .find(|p| p["name"].as_str() == Some(hides.key.as_str()))?;
    let (low, high) = (parameter["low"].as_f64()?, parameter["high"].as_f64()?);
    Some((low..=high).contains(&hides.size))
}

/// Stretches `s A-B m` of the report's `where`, or `from_m` and `to_m` among its parameters.
fn stretches(step: &Value) -> Vec<(f64, f64)> {
    let mut found = Vec::new();
    let text = step["where"].as_str().unwrap_or("");
    for part in text.split("s ").skip(1) {
        let mut numbers = part.splitn(2, ['-', '\u{2013}']);
        let (Some(from), Some(rest)) = (numbers.next(), numbers.next()) else {
            continue;
        };
        let to: String = rest
            .chars()
            .take_while(|c| c.is_ascii_digit() || *c == '.')
            .collect();
        if let (Ok(from), Ok(to)) = (from.trim().parse(), to.parse()) {
            found.push((from, to));
        }
    }
    if found.is_empty() {
        let of = |key: &str| {
            step["parameters"]
                .as_array()?
                .iter()
                .find(|p| p["name"].as_str() == Some(key))?["value"]
                .as_f64()
        };
        if let (Some(from), Some(to)) = (of("from_m"), of("to_m")) {
            found.push((from, to));
        }
    }
    found
}

/// Intersection over union, on a decimetre grid.
fn overlap(step: &Value, hides: &Hides) -> Option<f64> {
    if hides.places.is_empty() {
        return None;
    }
    let reported = stretches(step);
    let inside =
        |list: &[(f64, f64)], s: f64| list.iter().any(|(from, to)| (*from..=*to).contains(&s));
    let truth: Vec<(f64, f64)> = hides
        .places
        .iter()
        .map(|(_, from, to)| (*from, *to))
        .collect();
    let end = truth
        .iter()
        .chain(&reported)
        .map(|x| x.1)
        .fold(0.0, f64::max)
        .min(1e5);
    let (mut both, mut any) = (0.0, 0.0);
    for k in 0..=(end * 10.0) as usize {
        let s = k as f64 / 10.0;
        let (a, b) = (inside(&truth, s), inside(&reported, s));
        both += f64::from(u8::from(a && b));
        any += f64::from(u8::from(a || b));
    }
    Some(if any > 0.0 { both / any } else { 0.0 })
}

/// Base parameters that the next model (TOML) states, and whether their intervals in the report
/// hold the truth.
pub fn base_found(next: &str, report: &Value, answer: &Answer) -> Vec<BaseFound> {
    let Ok(model) = next.parse::<toml::Table>() else {
        return Vec::new();
    };
    let reported = report["base"].as_array().into_iter().flatten();
    let reported: Vec<&Value> = reported.collect();
    let found = |(key, truth): &(String, f64)| {
        let mut at = model.get(key.split('.').next()?)?;
        for part in key.split('.').skip(1) {
            at = at.get(part)?;
        }
        let value = at
            .as_float()
            .or_else(|| at.as_integer().map(|i| i as f64))?;
        let name = key.trim_start_matches("friction.").replace('.', " ");
        let interval = reported.iter().find(|base| base["name"] == name);
        let ends = interval.and_then(|base| base["low"].as_f64().zip(base["high"].as_f64()));
        Some(BaseFound {
            key: key.clone(),
            error: value / truth - 1.0,
            inside: ends.map(|(low, high)| (low..=high).contains(truth)),
        })
    };
    answer.base.iter().filter_map(found).collect()
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::*;

    #[test]
    fn an_effect_that_is_told_as_an_error_of_the_installation_is_installed_and_no_other() {
        let hides = |effect: &str, class: &[&str]| Hides {
            effect: effect.to_owned(),
            class: class.iter().map(|c| (*c).to_owned()).collect(),
            key: "factor".to_owned(),
            size: 0.1,
            unit: String::new(),
            share: 0.0,
            places: Vec::new(),
        };
        let within = json!({"within_tolerance": [{"what": "yaw inertia, relative", "size": 0.1, "unit": ""}]});
        assert!(installed(&within, &hides("yaw-inertia", &[])));
        assert!(installed(
            &within,
            &hides("yaw-rate-scale", &["yaw-inertia"])
        ));
        assert!(!installed(&within, &hides("mass", &[])));
        let outside = json!({"remarks": ["mass, relative: 4.0e-2  +- 1.0e-2, outside its tolerance of 0.01"]});
        assert!(installed(&outside, &hides("mass", &[])));
        assert!(!installed(&outside, &hides("speed-scale", &[])));
    }
}
