//! The effects of the catalogue against their descriptions and examples.

use kufe_sled::effects::{ActsOn, CATALOGUE, Edge, Effect, Experiments, Judged, find};

use crate::example::Example;
use crate::state::{forces, point, signals, state};

/// The quantity that an effect changes, with these parameters.
fn outcome(
    effect: &Effect,
    parameters: &[f64],
) -> (
    f64,
    kufe_sled::effects::Forces,
    [kufe_sled::effects::Signals; 2],
    f64,
) {
    let (mut f, mut corrected, mut disturbed) = (forces(), signals(), signals());
    effect.act(parameters, &state(), &mut f);
    effect.correct(parameters, &mut corrected);
    effect.disturb(parameters, &mut disturbed);
    let mu = effect.coefficient(parameters, 0.004, &point());
    (
        mu,
        f,
        [corrected, disturbed],
        effect.slope(parameters, 20.0),
    )
}

#[test]
fn every_example_gives_its_value() {
    for effect in CATALOGUE.iter() {
        let name = effect.info.name;
        let example = Example::read(effect.info.example);
        let (expected, found) = (example.gives, example.outcome(effect));
        let error = (found - expected).abs();
        assert!(
            error <= 1e-12 * expected.abs().max(1.0),
            "{name}: {found}, expected {expected}"
        );
        let off = effect.info.off();
        assert_eq!(off.len(), example.parameters.len(), "{name}");
        assert_ne!(off, example.parameters, "{name}");
    }
}

#[test]
fn every_effect_is_off_at_its_defaults_and_acts_at_each_amplitude() {
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        let off = outcome(effect, &info.off());
        let nothing = (0.004, forces(), [signals(), signals()], 0.0);
        assert_eq!(off, nothing, "{}", info.name);
        for (index, parameter) in info.parameters.iter().enumerate() {
            if parameter.is_amplitude() {
                let mut on = info.off();
                on[index] = parameter.typical;
                assert_ne!(
                    outcome(effect, &on),
                    off,
                    "{} {}",
                    info.name,
                    parameter.name
                );
                assert_eq!(parameter.default, 0.0, "{}", info.name);
                assert!(parameter.low <= 0.0, "{}", info.name);
                assert!(parameter.typical < parameter.high, "{}", info.name);
            }
        }
    }
}

#[test]
fn every_effect_acts_only_on_its_stated_quantities() {
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        let on: Vec<f64> = info
            .parameters
            .iter()
            .map(|p| p.default + p.typical)
            .collect();
        let (mu, f, [corrected, disturbed], slope) = outcome(effect, &on);
        let stated = |what: ActsOn| info.acts_on.contains(&what);
        let name = info.name;
        assert_eq!(mu != 0.004, stated(ActsOn::Friction), "{name}: friction");
        let along = f.along != forces().along || f.body_along != forces().body_along;
        assert!(
            !along || stated(ActsOn::Along) || stated(ActsOn::Friction),
            "{name}: along"
        );
        let across = f.across != forces().across || f.body_across != 0.0;
        assert_eq!(across, stated(ActsOn::Across), "{name}: across");
        assert_eq!(
            disturbed != signals(),
            stated(ActsOn::Sensor),
            "{name}: sensors"
        );
        assert_eq!(
            corrected.sled != signals().sled,
            stated(ActsOn::Sled),
            "{name}: sled"
        );
        assert_eq!(slope != 0.0, stated(ActsOn::Track), "{name}: track");
    }
}

#[test]
fn names_are_unique_and_every_description_is_complete() {
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        assert_eq!(find(info.name).map(|e| e.info.name), Some(info.name));
        let same = CATALOGUE.iter().filter(|e| e.info.name == info.name);
        assert_eq!(same.count(), 1, "{}", info.name);
        for text in [
            info.summary,
            info.formula,
            info.signature,
            info.decides,
            info.source,
        ] {
            assert!(!text.is_empty(), "{}", info.name);
        }
        for other in info.looks_like {
            assert!(
                find(other).is_some() && *other != info.name,
                "{}: {other}",
                info.name
            );
        }
    }
    assert!(find("no-such-effect").is_none());
}

#[test]
fn only_local_effects_have_a_window() {
    for effect in CATALOGUE.iter() {
        let info = effect.info();
        let local = matches!(info.judged, Judged::InWindow | Judged::ByProfile);
        assert_eq!(info.window().is_some(), local, "{}", info.name);
        for parameter in info.parameters {
            match parameter.edge {
                Some(Edge::From) => assert_eq!(parameter.name, "from_m"),
                Some(Edge::To) => assert_eq!(parameter.name, "to_m"),
                None => assert!(!["from_m", "to_m"].contains(&parameter.name)),
            }
        }
        assert_ne!(info.judged, Judged::ByPressure, "{}", info.name);
        if info.experiments != Experiments::AsNeeded {
            assert!(effect.on_friction.is_some(), "{}", info.name);
        }
    }
}
