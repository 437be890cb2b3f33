//! The generator's friction of groove and film against its closed forms.

use std::f64::consts::PI;

use kufe_blind::film::{Glide, Shape, film_drag_n, friction, hardness_pa, length_m};

const SHAPE: Shape = Shape {
    rocker_m: 30.0,
    section_m: 0.004,
};

#[test]
fn the_groove_bears_its_load_and_ploughs_its_section() {
    let (load, hardness) = (950.0, hardness_pa(-5.0));
    assert_eq!(hardness, 17.7e6);
    let length = length_m(SHAPE, load, hardness);
    // Half an ellipse of half axes l and l sqrt(r/R), and the figure that theory states of this
    // runner.
    let area = 0.5 * PI * length * length * (SHAPE.section_m / SHAPE.rocker_m).sqrt();
    assert!((area * hardness / load - 1.0).abs() < 1e-12);
    assert!((length - 54.4e-3).abs() < 0.05e-3);
    let [ploughing, _] = friction(SHAPE, load, 20.0, -5.0);
    assert!((ploughing - 0.77e-3).abs() < 0.005e-3);
    // Melting bounds the pressure of warm ice.
    assert!(hardness_pa(-0.5) < 7e6);
}

#[test]
fn a_long_wide_strip_is_melt_against_heat_and_a_narrow_one_melt_against_squeeze_out() {
    let (eta, melt) = (1.79e-3f64, 917.0 * 3.34e5);
    let (v, p, length) = (20.0f64, 10e6, 0.05f64);
    // Ice at its melting point takes no heat: a square-root film on a strip too wide to squeeze,
    // drag eta V w 2 sqrt(l)/a.
    let melting = -7.4e-8 * p;
    let a = 2.0 / v * (eta * v.powi(3) / melt).sqrt();
    let wide = 10.0;
    let drag = film_drag_n(&|_| wide, length, p, v, melting);
    assert!(
        (drag / (eta * v * wide * 2.0 * length.sqrt() / a) - 1.0).abs() < 1e-3,
        "{drag}"
    );
    // On a narrow strip the film is even: h = (eta^2 V^2 w^2 / (rho L p))^(1/4); its front is
    // thinner over a few per cent of the length.
    let narrow = 0.2e-3f64;
    let even = (eta * eta * v * v * narrow * narrow / (melt * p)).powf(0.25);
    let drag = film_drag_n(&|_| narrow, length, p, v, melting);
    let ratio = drag / (eta * v * narrow * length / even);
    assert!((1.0..1.05).contains(&ratio), "{ratio}");
    // Slow on cold ice: all of the shear's heat goes into the ice, F = 2 k dT w sqrt(l / (pi kappa
    // V)).
    let (slow, cold) = (0.5f64, -20.0);
    let drag = film_drag_n(&|_| wide, length, p, slow, cold);
    let heat = 2.0 * 2.2 * (melting - cold) * wide * (length / (PI * 1.17e-6 * slow)).sqrt();
    assert!((drag / heat - 1.0).abs() < 1e-2, "{}", drag / heat);
}

#[test]
fn the_ready_made_friction_is_that_of_the_equation() {
    let glide = Glide::new(SHAPE, -7.3);
    for (load, speed, curvature) in [
        (300.0, 5.0, 0.0),
        (1900.0, 22.0, 0.013),
        (4000.0, 37.0, -0.021),
    ] {
        let shape = Shape {
            rocker_m: 1.0 / (1.0 / SHAPE.rocker_m - curvature),
            ..SHAPE
        };
        let truth: f64 = friction(shape, load, speed, -7.3).iter().sum();
        let error = glide.mu(load, speed, curvature) / truth - 1.0;
        assert!(error.abs() < 5e-3, "{error}");
    }
}
