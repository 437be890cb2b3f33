//! Random patches and conditions: the result is finite, in balance and within the accuracy.

use super::patches::{WATER, rounding, strip};
use kufe_sled::friction::film::{BoundaryContact, FilmConditions, FilmOptions, Strip, film};
use proptest::prelude::*;

/// Patch shapes: uniform, round at both ends, yielding ice with a pointed end, stepwise decreasing
/// pressure.
fn patch(shape: usize, length: f64, n: usize, width: f64, p: f64) -> Strip {
    match shape {
        0 => strip(length, n, |_| width, |_| p),
        1 => strip(length, n, |at| width * rounding(at), |at| p * rounding(at)),
        2 => strip(length, n, |at| width * rounding(at), |_| p),
        3 => strip(length, n, |at| width * (1.0 - at), |_| p),
        _ => strip(
            length,
            n,
            |_| width,
            |at| p * (4.0 * (1.0 - at)).floor() / 4.0,
        ),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn film_of_random_patches_is_in_balance(
        shape in 0_usize..5,
        n in 2_usize..120,
        length in -3.0_f64..0.0,
        width in -4.5_f64..-2.0,
        p in 5.0_f64..7.7,
        v in -1.5_f64..2.0,
        ice in -40.0_f64..0.0,
        steel in -40.0_f64..5.0,
        time in -1.0_f64..3.0,
        factor in 0.0_f64..2.0,
        roughness in -8.0_f64..-5.0,
        shear in 3.0_f64..6.0,
        smooth in 0_usize..3,
        accuracy in -8.0_f64..-2.0,
    ) {
        let ten = |x: f64| 10.0_f64.powf(x);
        let conditions = FilmConditions {
            v: ten(v),
            ice_c: ice,
            steel_c: steel,
            sliding_time: ten(time),
            viscosity_factor: ten(factor),
            boundary: match smooth {
                0 => BoundaryContact::NONE,
                _ => BoundaryContact { roughness: ten(roughness), shear: ten(shear) },
            },
        };
        let accuracy = ten(accuracy);
        let strip = patch(shape, ten(length), n, ten(width), ten(p));
        let film = film(&strip, &conditions, &WATER, &FilmOptions { accuracy }).expect("a film");
        let totals = film.totals;
        prop_assert!(film.stations.iter().all(|s| s.thickness > 0.0 && s.thickness.is_finite()));
        prop_assert!(totals.friction > 0.0 && totals.friction.is_finite());
        prop_assert!(film.errors.viscous_drag <= accuracy * totals.viscous_drag);
        let molten = WATER.latent_heat * (totals.melted - totals.refrozen);
        let missing = totals.dissipated - molten - totals.into_ice - totals.into_steel;
        prop_assert!(missing.abs() <= 1e-6 * (totals.dissipated + totals.into_ice.abs() + totals.into_steel.abs()));
    }
}
