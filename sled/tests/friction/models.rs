//! The friction models against closed forms, limits and finite differences.

use kufe_sled::friction::{
    Braghin, Longitudinal, LongitudinalKeys, MagicFormula, PressureLaw, ZetaActsOn,
};
use kufe_sled::{Model, Vehicle};

#[test]
fn published_law_has_the_minimum_of_the_paper() {
    let law = PressureLaw::PUBLISHED;
    let best = 11.42e6;
    let slope = |p_pa: f64| law.slope(p_pa);
    assert!(slope(best - 0.01e6) < 0.0 && slope(best + 0.01e6) > 0.0);
    assert!((law.mu(best) - 3.18e-3).abs() < 0.005e-3);
}

#[test]
fn cap_is_dimensionless_and_applies_at_both_ends() {
    let law = PressureLaw::PUBLISHED;
    assert_eq!(law.mu(0.0), 0.007);
    assert_eq!(law.mu(25e6), 0.007);
    assert_eq!(law.slope(25e6), 0.0);
}

#[test]
fn both_interpretations_of_zeta_agree_on_smooth_ice_only() {
    let smooth = PressureLaw::PUBLISHED;
    let on_pressure = PressureLaw {
        zeta_acts_on: ZetaActsOn::Pressure,
        ..smooth
    };
    assert_eq!(smooth.mu(9e6), on_pressure.mu(9e6));
    let on_mu = PressureLaw {
        zeta: 1.2,
        ..smooth
    };
    let on_pressure = PressureLaw {
        zeta: 1.2,
        ..on_pressure
    };
    assert!((on_mu.mu(9e6) / smooth.mu(9e6) - 1.2).abs() < 1e-12);
    assert!((on_pressure.mu(9e6) - smooth.mu(1.2 * 9e6)).abs() < 1e-15);
    // Below the pressure of minimum friction, rough ice has less friction by the text and more by
    // the formula.
    assert!(on_pressure.mu(9e6) < smooth.mu(9e6));
}

#[test]
fn pressure_slope_equals_finite_differences() {
    for zeta_acts_on in [ZetaActsOn::Mu, ZetaActsOn::Pressure] {
        let law = PressureLaw {
            zeta: 1.1,
            zeta_acts_on,
            ..PressureLaw::PUBLISHED
        };
        for p in [7e6, 9e6, 12e6, 14e6] {
            let h = 1e3;
            let slope = (law.mu(p + h) - law.mu(p - h)) / (2.0 * h);
            assert!((law.slope(p) - slope).abs() < 1e-15, "{p} {slope}");
        }
    }
}

#[test]
fn nan_pressure_propagates_through_the_cap() {
    assert!(PressureLaw::PUBLISHED.mu(f64::NAN).is_nan());
    assert_eq!(Longitudinal::Fixed(0.004).mu(f64::NAN), 0.004);
}

#[test]
fn model_keys_are_either_fixed_or_quadratic() {
    let model = |text: &str| {
        let keys = toml::from_str::<LongitudinalKeys>(text).map_err(|error| error.to_string())?;
        keys.model().map_err(|error| error.to_string())
    };
    assert_eq!(
        model("mu = 0.004").expect("fixed"),
        Longitudinal::Fixed(0.004)
    );
    let full = "b = 0.088\nc = 2.01\nd = 14.66\nmu_cap = 0.007\nzeta = 1.0\nzeta_acts_on = \"mu\"";
    assert_eq!(model(full).expect("quadratic"), Longitudinal::PUBLISHED);
    for (text, named) in [
        ("mu = 0.004\nb = 0.088", "exclude"),
        ("b = 0.088\nc = 2.01", "d is missing"),
        ("mu = -0.1", "mu = -0.1"),
        ("mu = nan", "NaN"),
        ("mu = 0.004\nmy = 3", "my"),
        ("b = 0.088\nc = 2.01\nd = 14.66\nmu_cap = 7.0", "mu_cap = 7"),
        (
            "b = 0.088\nc = 2.01\nd = 14.66\nzeta_acts_on = \"ice\"",
            "ice",
        ),
    ] {
        let reported = model(text).expect_err(text);
        assert!(reported.contains(named), "{text}: {reported}");
    }
    let written =
        toml::to_string(&LongitudinalKeys::from(PressureLaw::PUBLISHED)).expect("serialises");
    assert_eq!(model(&written).expect(&written), Longitudinal::PUBLISHED);
}

#[test]
fn a_film_law_is_valid_for_experiments_and_refused_for_a_sled() {
    let keys = |text: &str| toml::from_str::<LongitudinalKeys>(text).expect(text);
    assert_eq!(keys("film = true").film().expect("film"), Some(1.0));
    let scaled = keys("film = true\nzeta = 1.5").film();
    assert_eq!(scaled.expect("film"), Some(1.5));
    assert_eq!(keys("mu = 0.004").film().expect("no film"), None);
    let both = keys("film = true\nfront_table = \"a.lut\"").film();
    let reported = both.expect_err("two laws").to_string();
    assert!(reported.contains("film and front_table"), "{reported}");

    let mut model = Model::published();
    model.friction.longitudinal = keys("film = true");
    let read = Model::from_toml(&model.to_toml(), "model.toml").expect("a model");
    let reported = Vehicle::new(&read).expect_err("no law").to_string();
    assert!(reported.contains("front_table"), "{reported}");
}

#[test]
fn slope_at_zero_slip_is_the_cornering_stiffness_at_any_load() {
    for model in [MagicFormula::PUBLISHED_FRONT, MagicFormula::PUBLISHED_REAR] {
        for fz in [1.0, 500.0, 8000.0] {
            let slope = model.derivatives(0.0, fz).alpha;
            assert!((slope / model.k_n_per_rad - 1.0).abs() < 1e-12);
        }
    }
}

#[test]
fn lateral_force_is_odd_and_saturates_at_d_sin_c_half_pi() {
    let model = MagicFormula::PUBLISHED_REAR;
    let fz = 2000.0;
    assert_eq!(model.force(-0.02, fz), -model.force(0.02, fz));
    let end = model.mu_zeta * fz * (model.c * std::f64::consts::FRAC_PI_2).sin();
    assert!((model.force(1e9, fz) / end - 1.0).abs() < 1e-6);
}

#[test]
fn force_vanishes_with_the_load_without_nan() {
    let model = MagicFormula::PUBLISHED_FRONT;
    for alpha in [0.0, 1e-9, 0.05, -0.05] {
        for fz in [-10.0, 0.0, f64::MIN_POSITIVE, 1e-200, 1e-12] {
            let at = model.derivatives(alpha, fz);
            assert!(model.force(alpha, fz).abs() <= 0.1 * fz.max(0.0));
            for value in [
                at.fy,
                at.alpha,
                at.fz,
                at.mu_zeta,
                at.c,
                at.e,
                at.k_n_per_rad,
            ] {
                assert!(value.is_finite(), "{alpha} {fz} {at:?}");
            }
        }
    }
    let limit = model.mu_zeta * (model.c * std::f64::consts::FRAC_PI_2).sin();
    assert!((model.derivatives(0.05, 0.0).fz - limit).abs() < 1e-12);
    assert!((model.derivatives(0.05, 1e-9).fz / limit - 1.0).abs() < 1e-6);
}

#[test]
fn every_derivative_equals_finite_differences() {
    let tyre = MagicFormula {
        mu_zeta: 1.1,
        c: 1.4,
        e: -0.5,
        k_n_per_rad: 60e3,
    };
    for model in [
        MagicFormula::PUBLISHED_FRONT,
        MagicFormula::PUBLISHED_REAR,
        tyre,
    ] {
        for alpha in [-0.06, -0.004, 0.0007, 0.02] {
            for fz in [40.0, 900.0, 6000.0] {
                let at = model.derivatives(alpha, fz);
                assert!((at.fy - model.force(alpha, fz)).abs() < 1e-9);
                let difference =
                    |move_by: &dyn Fn(f64) -> f64| (move_by(1e-6) - move_by(-1e-6)) / 2e-6;
                // Relative steps: each derivative is multiplied by its own argument, so that all
                // are in newtons.
                let pairs = [
                    (
                        at.alpha * alpha,
                        difference(&|h| model.force(alpha * (1.0 + h), fz)),
                    ),
                    (
                        at.fz * fz,
                        difference(&|h| model.force(alpha, fz * (1.0 + h))),
                    ),
                    (
                        at.mu_zeta * model.mu_zeta,
                        difference(&|h| {
                            let mu_zeta = model.mu_zeta * (1.0 + h);
                            MagicFormula { mu_zeta, ..model }.force(alpha, fz)
                        }),
                    ),
                    (
                        at.c * model.c,
                        difference(&|h| {
                            let c = model.c * (1.0 + h);
                            MagicFormula { c, ..model }.force(alpha, fz)
                        }),
                    ),
                    (
                        at.e * model.e,
                        difference(&|h| {
                            let e = model.e * (1.0 + h);
                            MagicFormula { e, ..model }.force(alpha, fz)
                        }),
                    ),
                    (
                        at.k_n_per_rad * model.k_n_per_rad,
                        difference(&|h| {
                            let k_n_per_rad = model.k_n_per_rad * (1.0 + h);
                            MagicFormula {
                                k_n_per_rad,
                                ..model
                            }
                            .force(alpha, fz)
                        }),
                    ),
                ];
                let scale = 1.0 + at.fy.abs();
                for (k, (exact, numeric)) in pairs.into_iter().enumerate() {
                    let off = (exact - numeric).abs() / scale;
                    assert!(off < 1e-6, "{k}: {exact} {numeric} at {alpha} {fz}");
                }
            }
        }
    }
}

#[test]
fn braghin_has_its_published_slope_and_end() {
    let model = Braghin::PUBLISHED;
    let slope = model.force(1e-8, 1000.0) / 1e-8;
    let expected = 0.5 * 1000.0 * 2.0 / std::f64::consts::PI * 50.0;
    assert!((slope / expected - 1.0).abs() < 1e-9);
    assert!((model.force(1e9, 1000.0) - 500.0).abs() < 1e-3);
    assert_eq!(model.force(0.1, -5.0), 0.0);
}

mod at_any_point {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn lateral_force_is_odd_bounded_and_grows_with_slip(
            mu_zeta in 0.01..10.0f64,
            c in 0.001..1.0f64,
            e in -5.0..1.0f64,
            k_n_per_rad in 1.0..1e6f64,
            alpha in 0.0..1.5f64,
            fz in -100.0..1e5f64,
        ) {
            let model = MagicFormula { mu_zeta, c, e, k_n_per_rad };
            let force = model.force(alpha, fz);
            prop_assert_eq!(model.force(-alpha, fz), -force);
            prop_assert!(force >= 0.0 && force <= mu_zeta * fz.max(0.0) * (1.0 + 1e-12));
            prop_assert!(model.derivatives(alpha, fz).alpha >= 0.0);
        }

        #[test]
        fn friction_stays_between_zero_and_the_cap(
            b in 0.0..1.0f64,
            c in -5.0..5.0f64,
            d in -5.0..30.0f64,
            zeta in 0.1..3.0f64,
            p in 0.0..1e9f64,
        ) {
            for zeta_acts_on in [ZetaActsOn::Mu, ZetaActsOn::Pressure] {
                let law = PressureLaw { b, c, d, mu_cap: 0.007, zeta, zeta_acts_on };
                prop_assert!((0.0..=0.007).contains(&law.mu(p)));
            }
        }
    }
}
