//! What the files of the catalogue say of themselves.

use std::path::Path;

use kufe::case::Case;
use kufe::case::effects::{CATALOGUE, Map, Measure, find};
use kufe_contact::Problem;

/// The problem of the examples.
fn problem() -> Problem {
    let case = Case::parse(
        "[runner]\n\
         shape = { kind = \"paraboloid\", rocker_radius_m = 30.0, section_radius_m = 0.005 }\n\
         [ice]\n\
         youngs_modulus_pa = 9.0e9\n\
         poissons_ratio = 0.33\n\
         thickness_m = \"half-space\"\n\
         [load]\n\
         fz_n = 1000.0\n",
    );
    case.unwrap().problem(Path::new("")).unwrap()
}

/// The map of the examples.
fn map() -> Map {
    let mut map = Map {
        nx: 41,
        ny: 31,
        x0: 0.0,
        y0: 0.0,
        dx: 1e-3,
        dy: 1e-3,
        pressure: vec![0.0; 41 * 31],
    };
    map.pressure[15 * 41 + 20] = 1e6;
    map
}

#[test]
fn every_example_gives_its_number_and_size_0_another() {
    for effect in CATALOGUE {
        let outcome = |size: f64| {
            let (mut problem, mut map) = (problem(), map());
            effect.alter(size, &mut problem);
            effect.sense(size, &mut map);
            match effect.example.measure {
                Measure::OfProblem(of) => of(&problem),
                Measure::OfMap(of) => of(&map),
            }
        };
        let (found, wanted) = (outcome(effect.example.size), effect.example.gives);
        let name = effect.info.name;
        assert!(
            (found - wanted).abs() < 1e-9 * wanted.abs(),
            "{name}: {found}, expected {wanted}"
        );
        assert_ne!(outcome(0.0), found, "{name}");
    }
}

#[test]
fn every_effect_is_off_at_0() {
    let heights = |problem: &Problem| -> Vec<u64> {
        let places = (0..9).map(|k| 0.002 * f64::from(k - 4));
        places
            .map(|x| problem.runner.underside.height(x, 0.3 * x).to_bits())
            .collect()
    };
    for effect in CATALOGUE {
        let (mut altered, mut sensed) = (problem(), map());
        effect.alter(0.0, &mut altered);
        effect.sense(0.0, &mut sensed);
        assert_eq!(sensed, map(), "{}", effect.info.name);
        assert_eq!(
            heights(&altered),
            heights(&problem()),
            "{}",
            effect.info.name
        );
        assert_eq!(altered.ice, problem().ice, "{}", effect.info.name);
        assert_eq!(altered.load, problem().load, "{}", effect.info.name);
        assert_eq!(effect.peak_factor(0.0), 1.0, "{}", effect.info.name);
    }
}

#[test]
fn a_blurred_map_keeps_its_sum_and_loses_its_peak() {
    let mut map = map();
    find("sensor-blur")
        .expect("in the catalogue")
        .sense(2e-3, &mut map);
    let sum: f64 = map.pressure.iter().sum();
    assert!((sum / 1e6 - 1.0).abs() < 1e-9, "{sum}");
    // A Gaussian of two pixels: peak 1/(2 pi 4).
    let peak = map.pressure.iter().copied().fold(0.0, f64::max);
    assert!(
        (peak / 1e6 * std::f64::consts::TAU * 4.0 - 1.0).abs() < 0.01,
        "{peak}"
    );
}

#[test]
fn names_are_unique_bounds_hold_zero_and_every_page_is_full() {
    for effect in CATALOGUE {
        let (info, p) = (effect.info(), effect.parameter());
        let same = CATALOGUE.iter().filter(|e| e.info.name == info.name);
        assert_eq!(same.count(), 1, "{}", info.name);
        assert_eq!(info.parameters.len(), 1, "{}", info.name);
        assert!(
            p.low <= 0.0 && p.high > p.typical && p.typical > 0.0,
            "{}",
            info.name
        );
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
}
