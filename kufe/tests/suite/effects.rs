//! The descriptions in the files of the catalogue.

use std::path::Path;

use kufe::case::Case;
use kufe::case::effects::{CATALOGUE, Map, find};
use kufe_contact::{Foundation, Problem};

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

/// A number that an effect of a size must give.
struct Example {
    name: &'static str,
    size: f64,
    measure: fn(&Problem, &Map) -> f64,
    gives: f64,
}

const EXAMPLES: [Example; 11] = [
    // Hardness [Pa].
    Example {
        name: "hardness",
        size: 2.0e-8,
        measure: |problem, _| problem.ice.hardness.unwrap_or(f64::NAN),
        gives: 5.0e7,
    },
    // Young's modulus of the ice [Pa].
    Example {
        name: "ice-modulus",
        size: 0.1,
        measure: |problem, _| problem.ice.youngs_modulus,
        gives: 9.9e9,
    },
    // Thickness of the layer [m].
    Example {
        name: "ice-thickness",
        size: 20.0,
        measure: |problem, _| match problem.ice.foundation {
            Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                thickness
            }
            Foundation::HalfSpace => f64::INFINITY,
        },
        gives: 0.05,
    },
    // Height of the underside at x = 25 mm [m].
    Example {
        name: "waviness",
        size: 1.0e-6,
        measure: |problem, _| problem.runner.underside.height(0.025, 0.0),
        gives: 8.416666666666667e-6,
    },
    // Height of the underside 6 mm ahead [m].
    Example {
        name: "pitch-offset",
        size: 0.1,
        measure: |problem, _| problem.runner.underside.height(0.006, 0.0),
        gives: -6.0140803251270e-4,
    },
    // Height of the underside at x = 0.1 m [m].
    Example {
        name: "rocker-radius",
        size: 0.02,
        measure: |problem, _| problem.runner.underside.height(0.1, 0.0),
        gives: 0.8e-3 / 3.0,
    },
    // Height of the underside 1 mm to the left [m].
    Example {
        name: "roll-tilt",
        size: 0.1,
        measure: |problem, _| problem.runner.underside.height(0.0, 0.001),
        gives: 2.0033467208545054e-4,
    },
    // Young's modulus of the ice [Pa].
    Example {
        name: "runner-compliance",
        size: 0.25,
        measure: |problem, _| problem.ice.youngs_modulus,
        gives: 7.2e9,
    },
    // Height of the underside at its lowest place [m].
    Example {
        name: "section-wear",
        size: 1.0e-5,
        measure: |problem, _| problem.runner.underside.height(0.0, 0.0),
        gives: 1.0024937810560446e-5,
    },
    // Largest pixel [Pa].
    Example {
        name: "sensor-blur",
        size: 2.0e-3,
        measure: |_, map| map.pressure.iter().copied().fold(0.0, f64::max),
        gives: 39_790.135_140_764_02,
    },
    // Sum of the pixels [Pa].
    Example {
        name: "sensor-gain",
        size: 0.1,
        measure: |_, map| map.pressure.iter().sum(),
        gives: 1.1e6,
    },
];

#[test]
fn every_effect_gives_the_number_of_its_example_and_size_0_another() {
    for effect in CATALOGUE.iter() {
        let name = effect.info.name;
        let example = EXAMPLES.iter().find(|e| e.name == name).expect(name);
        let outcome = |size: f64| {
            let (mut problem, mut map) = (problem(), map());
            effect.alter(size, &mut problem);
            effect.sense(size, &mut map);
            (example.measure)(&problem, &map)
        };
        let (found, wanted) = (outcome(example.size), example.gives);
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
    for effect in CATALOGUE.iter() {
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
    for effect in CATALOGUE.iter() {
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
