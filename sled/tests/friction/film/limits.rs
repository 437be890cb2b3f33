//! Closed forms: melting against squeeze-out, cold ice at low speed, the start at the leading edge.

use super::closed_form::{
    cold_friction, film_pressure, melt_and_squeeze_friction, melt_and_squeeze_thickness,
    self_similar_start, squeeze_out_rate,
};
use super::patches::{INSULATED, STEEL_INSULATED, WATER, hertz, solved};
use kufe_sled::friction::film::{FilmConditions, FilmOptions, Properties, Strip, film};
use statrs::function::beta::beta;

#[test]
fn long_insulated_strip_melts_against_squeeze_out_within_one_percent() {
    for (v, width, pressure) in [
        (5.0, 1.0e-3, 17.7e6),
        (30.0, 0.6e-3, 9.0e6),
        (40.0, 3.0e-3, 15.0e6),
    ] {
        let conditions = FilmConditions::new(v, 0.0);
        let strip = Strip::uniform(1.0, width, pressure).expect("a strip");
        let film = solved(&strip, &conditions, &INSULATED);
        let thickness = melt_and_squeeze_thickness(width, pressure, &conditions, &INSULATED);
        let end = film.stations.last().expect("an end").thickness;
        assert!((end / thickness - 1.0).abs() < 1e-6, "{end} {thickness}");
        let friction = melt_and_squeeze_friction(width, pressure, &conditions, &INSULATED);
        let error = film.totals.friction / friction - 1.0;
        // The start is thinner. It adds the ratio of the melt length (some mm) to the length of 1
        // m.
        assert!((0.0..0.01).contains(&error), "{error}");
    }
}

#[test]
fn closed_forms_of_melting_and_squeezing_balance_heat_and_water() {
    let conditions = FilmConditions::new(25.0, -3.0);
    let (w, p) = (1.2e-3, 12.0e6);
    let h = melt_and_squeeze_thickness(w, p, &conditions, &WATER);
    let mu = WATER.water_viscosity;
    let melted = mu * 25.0 * 25.0 / (WATER.heat_of_water() * h);
    assert!((squeeze_out_rate(p, h, w, mu) / melted - 1.0).abs() < 1e-12);
    let friction = melt_and_squeeze_friction(w, p, &conditions, &WATER);
    let powers = (mu * 25.0).sqrt() * WATER.heat_of_water().powf(0.25) * p.powf(-0.75) / w.sqrt();
    assert!((friction / powers - 1.0).abs() < 1e-12);
}

#[test]
fn insulated_hertz_patch_has_the_friction_of_the_beta_function_within_one_percent() {
    // Melting balances squeeze-out at each position. The drag is proportional to p^(1/4) w^(1/2),
    // with both p and w proportional to (1 - X^2)^(1/2).
    let (length, width, peak) = (2.0, 1.0e-3, 20.0e6);
    let conditions = FilmConditions::new(20.0, 0.0);
    let film = solved(&hertz(length, 200, width, peak), &conditions, &INSULATED);
    let pi = std::f64::consts::PI;
    let mean = 0.25 * pi * peak;
    let middle = melt_and_squeeze_friction(width, mean, &conditions, &INSULATED) * mean * width;
    let drag = 0.5 * length * middle * beta(0.5, 1.0 + 0.375);
    assert!(
        (film.totals.viscous_drag / drag - 1.0).abs() < 0.01,
        "{:?}",
        film.totals
    );
    let load = 0.5 * length * mean * width * beta(0.5, 2.0);
    assert!((film.totals.load / load - 1.0).abs() < 1e-3);
}

#[test]
fn slow_runner_on_cold_ice_heats_the_ice_within_one_percent() {
    for (v, ice, length) in [
        (1.0e-3, -10.0, 0.05),
        (1.0e-3, -30.0, 0.1),
        (1.0e-4, -5.0, 0.02),
    ] {
        let conditions = FilmConditions::new(v, ice);
        let strip = Strip::uniform(length, 1.0e-3, 10.0e6).expect("a strip");
        let film = solved(&strip, &conditions, &STEEL_INSULATED);
        let cold = cold_friction(length, 10.0e6, &conditions, &STEEL_INSULATED);
        assert!(
            (film.totals.friction / cold - 1.0).abs() < 0.01,
            "{} {cold}",
            film.totals.friction
        );
        assert!((film.totals.into_ice / film.totals.dissipated - 1.0).abs() < 0.01);
        let thicker = FilmConditions {
            viscosity_factor: 2.0,
            ..conditions
        };
        let other = solved(&strip, &thicker, &STEEL_INSULATED);
        assert!((other.totals.friction / film.totals.friction - 1.0).abs() < 0.01);
    }
}

#[test]
fn film_without_squeeze_out_is_self_similar() {
    for (v, ice) in [(30.0, -5.0), (0.5, -20.0), (20.0, 0.0)] {
        let conditions = FilmConditions::new(v, ice);
        // A strip 1 km wide has no squeeze-out. At 0 C the pressure lowers the melting point, and
        // the ice supplies heat.
        let strip = Strip::new(
            vec![0.0, 1.0e-6, 0.01, 0.06],
            vec![1.0e3; 4],
            vec![8.0e6; 4],
        );
        let film = solved(&strip.expect("a strip"), &conditions, &STEEL_INSULATED);
        let a = self_similar_start(8.0e6, &conditions, &STEEL_INSULATED);
        for station in &film.stations {
            let start = a * station.xi.sqrt();
            assert!(
                (station.thickness / start - 1.0).abs() < 1e-8,
                "{station:?} {start}"
            );
        }
    }
}

#[test]
fn film_of_a_runner_starts_with_the_closed_form() {
    let conditions = FilmConditions::new(30.0, -5.0);
    let strip = Strip::new(
        vec![0.0, 1.0e-6, 1.0e-5, 0.06],
        vec![1.0e-3; 4],
        vec![17.7e6; 4],
    );
    let film = solved(&strip.expect("a strip"), &conditions, &WATER);
    let a = self_similar_start(17.7e6, &conditions, &WATER);
    let ratio = film.stations[0].thickness / (a * 1.0e-3);
    assert!((ratio - 1.0).abs() < 0.01, "{ratio}");
    // Further along, squeeze-out reduces the thickness.
    assert!(film.stations[2].thickness < 0.5 * a * 0.06_f64.sqrt());
}

#[test]
fn closed_form_of_the_start_satisfies_the_film_equation() {
    for ice in [-40.0, -5.0, 0.0] {
        let conditions = FilmConditions {
            viscosity_factor: 3.0,
            ..FilmConditions::new(12.0, ice)
        };
        let a = self_similar_start(5.0e6, &conditions, &WATER);
        let kappa = WATER.ice_conductivity / (917.0 * 2050.0);
        let q = WATER.ice_conductivity
            * (-7.4e-8 * 5.0e6 - ice)
            * (12.0 / (std::f64::consts::PI * kappa)).sqrt();
        let right = (3.0 * 1.79e-3 * 144.0 / a - q) / (999.8 * 3.34e5);
        assert!(
            (0.25 * 12.0 * a / right - 1.0).abs() < 1e-9,
            "{ice}: {a} {right}"
        );
    }
}

#[test]
fn mean_film_pressure_across_a_strip_equals_the_contact_pressure() {
    let (h, w, mu, p) = (0.7e-6, 1.4e-3, 1.79e-3, 13.0e6);
    let s = squeeze_out_rate(p, h, w, mu);
    let n = 2000;
    let at = |i: usize| w * ((i as f64 + 0.5) / n as f64 - 0.5);
    let mean = (0..n)
        .map(|i| film_pressure(at(i), s, h, w, mu))
        .sum::<f64>()
        / n as f64;
    assert!((mean / p - 1.0).abs() < 1e-6);
    assert!((film_pressure(0.0, s, h, w, mu) / p - 1.5).abs() < 1e-12);
    assert!(film_pressure(0.5 * w, s, h, w, mu).abs() < 1e-6 * p);
}

#[test]
fn radau_agrees_with_runge_kutta_of_small_steps() {
    let conditions = FilmConditions {
        steel_c: -9.0,
        ..FilmConditions::new(15.0, -6.0)
    };
    let (p, w, length) = (9.0e6, 0.8e-3, 0.04);
    let film = solved(
        &Strip::uniform(length, w, p).expect("a strip"),
        &conditions,
        &WATER,
    );
    let pi = std::f64::consts::PI;
    let (v, mu, heat) = (15.0, WATER.water_viscosity, WATER.heat_of_water());
    let melting = -7.4e-8 * p;
    let ice = 2.2 * (melting + 6.0) / (pi * 2.2 / (917.0 * 2050.0) / v).sqrt();
    let steel = (45.0 * 3.6e6 / (pi * 10.0_f64)).sqrt() * (melting + 9.0);
    // In s = sqrt(xi), from the self-similar start.
    let slope = |s: f64, h: f64| {
        let melt = (mu * v * v * s / h - ice - steel * s) / heat;
        4.0 / v * (melt - s * p * h.powi(3) / (mu * w * w))
    };
    let (mut s, end) = (1.0e-6, length.sqrt());
    let mut h = self_similar_start(p, &conditions, &WATER) * s;
    while s < end {
        let step = (0.02 * s).min(2.0e-6).min(end - s);
        let k1 = slope(s, h);
        let k2 = slope(s + 0.5 * step, h + 0.5 * step * k1);
        let k3 = slope(s + 0.5 * step, h + 0.5 * step * k2);
        let k4 = slope(s + step, h + step * k3);
        h += step / 6.0 * (k1 + 2.0 * k2 + 2.0 * k3 + k4);
        s += step;
    }
    let reached = film.stations[0].thickness;
    assert!((reached / h - 1.0).abs() < 1e-6, "{reached} {h}");
}

#[test]
fn stated_errors_cover_the_true_ones() {
    let conditions = FilmConditions::new(25.0, -4.0);
    let strip = hertz(0.07, 40, 1.0e-3, 20.0e6);
    let at = |accuracy: f64| {
        film(
            &strip,
            &conditions,
            &Properties::WATER_AND_ICE,
            &FilmOptions { accuracy },
        )
        .expect("a film")
    };
    let exact = at(1e-10);
    for accuracy in [1e-2, 1e-4, 1e-6] {
        let rough = at(accuracy);
        let pairs = [
            (
                rough.totals.viscous_drag,
                exact.totals.viscous_drag,
                rough.errors.viscous_drag,
            ),
            (
                rough.totals.melted,
                exact.totals.melted,
                rough.errors.melted,
            ),
            (
                rough.totals.mean_thickness,
                exact.totals.mean_thickness,
                rough.errors.mean_thickness,
            ),
        ];
        for (value, truth, error) in pairs {
            assert!(
                (value - truth).abs() <= error + 1e-9 * truth,
                "{accuracy}: {value} {truth} {error}"
            );
            assert!(error <= accuracy * truth.abs() * 1.5);
        }
    }
    assert!(exact.steps > at(1e-4).steps);
}
