//! Invalid input of the film is refused with an error that names the quantity.

use super::patches::{WATER, strip};
use super::pressure_map::PressureMap;
use kufe_sled::Error;
use kufe_sled::friction::film::{
    BoundaryContact, FilmConditions, FilmOptions, Properties, Strip, film,
};

fn named<T: std::fmt::Debug>(result: Result<T, Error>) -> &'static str {
    match result {
        Err(Error::OutOfRange { name, .. }) => name,
        Err(Error::TooFew { .. }) => "too few",
        other => panic!("{other:?}"),
    }
}

#[test]
fn invalid_strips_are_refused() {
    let of = |xi: &[f64], w: &[f64], p: &[f64]| Strip::new(xi.to_vec(), w.to_vec(), p.to_vec());
    assert_eq!(named(of(&[0.0], &[1.0], &[1.0])), "too few");
    assert_eq!(named(of(&[0.0, 1.0], &[1.0], &[1.0, 1.0])), "too few");
    assert_eq!(
        named(of(&[0.0, 1.0], &[1.0, 1.0], &[1.0, 1.0, 1.0])),
        "too few"
    );
    assert_eq!(named(of(&[0.1, 1.0], &[1.0; 2], &[1.0; 2])), "xi");
    assert_eq!(named(of(&[0.0, 1.0, 1.0], &[1.0; 3], &[1.0; 3])), "xi");
    assert_eq!(named(of(&[0.0, f64::NAN], &[1.0; 2], &[1.0; 2])), "xi");
    assert_eq!(
        named(of(&[0.0, 1.0, 2.0], &[1.0, 0.0, 1.0], &[1.0; 3])),
        "width"
    );
    assert_eq!(named(of(&[0.0, 1.0], &[1.0, -1.0], &[1.0; 2])), "width");
    assert_eq!(
        named(of(&[0.0, 1.0], &[1.0; 2], &[1.0, f64::INFINITY])),
        "pressure"
    );
    assert_eq!(named(of(&[0.0, 1.0], &[1.0; 2], &[-1.0, 1.0])), "pressure");
    assert_eq!(named(of(&[0.0, 1.0], &[1.0; 2], &[0.0; 2])), "pressure");
    assert!(of(&[0.0, 1.0, 2.0], &[0.0, 1.0, 0.0], &[0.0, 1.0, 0.0]).is_ok());
}

#[test]
fn conditions_properties_and_accuracy_out_of_range_are_named() {
    let patch = Strip::uniform(0.05, 1.0e-3, 1.0e7).expect("a strip");
    let base = FilmConditions::new(20.0, -5.0);
    let on = |conditions: FilmConditions, properties: Properties, accuracy: f64| {
        named(film(
            &patch,
            &conditions,
            &properties,
            &FilmOptions { accuracy },
        ))
    };
    assert_eq!(on(FilmConditions { v: 0.0, ..base }, WATER, 1e-6), "v");
    assert_eq!(
        on(
            FilmConditions {
                v: f64::NAN,
                ..base
            },
            WATER,
            1e-6
        ),
        "v"
    );
    assert_eq!(
        on(FilmConditions { ice_c: 0.1, ..base }, WATER, 1e-6),
        "ice_c"
    );
    assert_eq!(
        on(
            FilmConditions {
                steel_c: 101.0,
                ..base
            },
            WATER,
            1e-6
        ),
        "steel_c"
    );
    assert_eq!(
        on(
            FilmConditions {
                sliding_time: 0.0,
                ..base
            },
            WATER,
            1e-6
        ),
        "sliding_time"
    );
    assert_eq!(
        on(
            FilmConditions {
                viscosity_factor: -1.0,
                ..base
            },
            WATER,
            1e-6
        ),
        "viscosity_factor"
    );
    for (roughness, shear, name) in [
        (-1e-9, 0.0, "roughness"),
        (f64::NAN, 0.0, "roughness"),
        (0.0, -1.0, "boundary_shear"),
        (0.0, f64::INFINITY, "boundary_shear"),
    ] {
        let boundary = BoundaryContact { roughness, shear };
        assert_eq!(on(FilmConditions { boundary, ..base }, WATER, 1e-6), name);
    }
    assert_eq!(
        on(
            base,
            Properties {
                latent_heat: 0.0,
                ..WATER
            },
            1e-6
        ),
        "latent_heat"
    );
    assert_eq!(
        on(
            base,
            Properties {
                melting_slope: f64::NAN,
                ..WATER
            },
            1e-6
        ),
        "melting_slope"
    );
    assert_eq!(on(base, WATER, 0.0), "accuracy");
}

#[test]
fn strips_of_maps_carry_the_same_load() {
    let row = [0.0, 2.0e6, 4.0e6, 0.0];
    let mut cells = vec![0.0; 4];
    cells.extend(row);
    cells.extend([1.0e6, 3.0e6, 3.0e6, 1.0e6]);
    cells.extend(row);
    cells.extend([0.0; 4]);
    let map = PressureMap::new(1.0e-3, 0.1e-3, 4, cells);
    assert_eq!((map.rows(), map.rows_before()), (3, 1));
    let strip = map.strip().expect("a strip");
    let expected = [0.0, 0.5e-3, 1.5e-3, 2.5e-3, 3.0e-3];
    assert!(
        strip
            .xi()
            .iter()
            .zip(expected)
            .all(|(a, b)| (a - b).abs() < 1e-15)
    );
    assert_eq!(&strip.pressure()[1..4], &[3.0e6, 2.0e6, 3.0e6]);
    assert!((strip.width()[2] / 0.4e-3 - 1.0).abs() < 1e-12);
    assert_eq!(strip.width()[0], 0.0);
    assert!((strip.length() - 3.0e-3).abs() < 1e-15 && strip.aspect() > 7.0);
}

#[test]
fn coarser_strip_retains_its_ends() {
    let fine = strip(0.05, 11, |_| 1.0e-3, |at| 1.0e7 * (1.0 + at));
    let coarse = fine.every_second().expect("stations enough");
    assert_eq!(coarse.xi().len(), 7);
    assert_eq!((coarse.xi()[0], coarse.length()), (0.0, fine.length()));
    assert!(
        Strip::uniform(0.05, 1.0e-3, 1.0e7)
            .expect("a strip")
            .every_second()
            .is_none()
    );
}
