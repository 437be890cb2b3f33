//! Heat and water balances; the influence of speed, temperature, load and viscosity.

use super::patches::{STEEL_INSULATED, WATER, hertz, solved, strip};
use kufe_sled::friction::film::{FilmConditions, FilmOptions, HeatIntoIce, Strip, film};

#[test]
fn heat_balance_within_1e_6() {
    for (v, ice) in [(30.0, -5.0), (3.0, -15.0), (30.0, 0.0)] {
        let conditions = FilmConditions {
            steel_c: -12.0,
            ..FilmConditions::new(v, ice)
        };
        let (width, pressure) = (1.0e-3, 14.0e6);
        let strip = Strip::uniform(0.06, width, pressure).expect("a strip");
        let film = solved(&strip, &conditions, &WATER);
        let totals = film.totals;
        // Outflow of water: sideways, and at the trailing edge with half the speed. It is computed
        // independently of the heat.
        let carried = 0.5 * v * width * film.stations[0].thickness;
        let melting = WATER.heat_of_water() * (totals.squeezed_out + carried);
        let walls = totals.into_ice + totals.into_steel;
        let missing = totals.dissipated - melting - walls;
        assert!(
            missing.abs() < 1e-6 * totals.dissipated,
            "{missing} of {totals:?}"
        );
        let molten = WATER.latent_heat * (totals.melted - totals.refrozen);
        assert!((totals.dissipated - molten - walls).abs() < 1e-6 * totals.dissipated);
        assert!((totals.dissipated / (v * totals.viscous_drag) - 1.0).abs() < 1e-12);
        assert!((totals.friction - totals.viscous_drag / totals.load).abs() < 1e-15);
    }
}

#[test]
fn totals_are_the_integrals_of_the_stations() {
    let conditions = FilmConditions::new(20.0, -5.0);
    // Stations uniform in sqrt(xi), in which all quantities are smooth.
    let n = 2000;
    let (length, width): (f64, f64) = (0.05, 0.9e-3);
    let xi: Vec<f64> = (0..=n)
        .map(|k| length * (k as f64 / n as f64).powi(2))
        .collect();
    let film = solved(
        &Strip::new(xi, vec![width; n + 1], vec![16.0e6; n + 1]).expect("a strip"),
        &conditions,
        &WATER,
    );
    let ends = length.sqrt() / n as f64;
    let sum = |of: &dyn Fn(usize) -> f64| -> f64 {
        let weight = |k: usize| if k + 1 == n { 0.5 } else { 1.0 };
        (0..n)
            .map(|k| weight(k) * of(k) * 2.0 * film.stations[k].xi.sqrt() * width * ends)
            .sum()
    };
    // Shear and heat times sqrt(xi) are finite at the leading edge. Half a step with the value of
    // the first station covers the edge.
    let edge = |of: f64| of * film.stations[0].xi.sqrt() * width * ends;
    let drag = sum(&|k| film.stations[k].shear) + edge(film.stations[0].shear);
    assert!(
        (drag / film.totals.viscous_drag - 1.0).abs() < 1e-3,
        "{drag} {:?}",
        film.totals
    );
    let ice = sum(&|k| film.stations[k].heat_into_ice) + edge(film.stations[0].heat_into_ice);
    assert!((ice / film.totals.into_ice - 1.0).abs() < 1e-3);
    let melt =
        sum(&|k| 917.0 * film.stations[k].melt_rate) + edge(917.0 * film.stations[0].melt_rate);
    let melted = film.totals.melted - film.totals.refrozen;
    assert!((melt / melted - 1.0).abs() < 1e-3);
    assert!((film.totals.load / (length * width * 16.0e6) - 1.0).abs() < 1e-9);
    for station in &film.stations {
        assert!((station.temperature + 7.4e-8 * 16.0e6).abs() < 1e-12);
    }
}

#[test]
fn film_depends_on_speed_viscosity_and_temperature_with_the_right_sign() {
    let strip = hertz(0.06, 60, 1.0e-3, 18.0e6);
    let at = |conditions: FilmConditions| solved(&strip, &conditions, &WATER).totals;
    let base = FilmConditions::new(20.0, -5.0);
    let faster = at(FilmConditions { v: 25.0, ..base });
    let thicker = at(FilmConditions {
        viscosity_factor: 1.2,
        ..base
    });
    let colder = at(FilmConditions {
        ice_c: -8.0,
        ..base
    });
    let warm_steel = at(FilmConditions {
        steel_c: 5.0,
        ..base
    });
    let base = at(base);
    assert!(faster.friction > base.friction && faster.mean_thickness > base.mean_thickness);
    assert!(thicker.friction > base.friction && thicker.mean_thickness > base.mean_thickness);
    assert!(colder.friction > base.friction && colder.mean_thickness < base.mean_thickness);
    assert!(warm_steel.friction < base.friction && warm_steel.into_steel < 0.0);
    let wider = solved(
        &hertz(0.06, 60, 1.3e-3, 18.0e6),
        &FilmConditions::new(20.0, -5.0),
        &WATER,
    );
    assert!(wider.totals.friction < base.friction);
    let heavier = solved(
        &hertz(0.06, 60, 1.0e-3, 22.0e6),
        &FilmConditions::new(20.0, -5.0),
        &WATER,
    );
    assert!(
        heavier.totals.friction < base.friction && heavier.totals.viscous_drag > base.viscous_drag
    );
}

#[test]
fn slow_film_on_cold_ice_is_below_a_nanometre_and_positive() {
    let strip = Strip::uniform(0.03, 1.0e-3, 12.0e6).expect("a strip");
    let mut last = f64::INFINITY;
    for v in [1.0, 0.1, 0.01, 1.0e-3] {
        let film = solved(&strip, &FilmConditions::new(v, -20.0), &WATER);
        let thinnest = film.thinnest().expect("a station").thickness;
        assert!(thinnest > 0.0 && thinnest < last);
        last = thinnest;
    }
    assert!(last < 0.3e-9, "{last}");
}

#[test]
fn film_freezes_where_the_pressure_decreases() {
    // In the middle the pressure drops to a tenth: the surface is 1 K warmer behind it.
    let fall = |at: f64| if at < 0.5 { 16.0e6 } else { 1.6e6 };
    let film = solved(
        &strip(0.04, 200, |_| 1.0e-3, fall),
        &FilmConditions::new(3.0, -3.0),
        &WATER,
    );
    let coldest = film
        .stations
        .iter()
        .map(|s| s.melt_rate)
        .fold(f64::INFINITY, f64::min);
    assert!(coldest < 0.0, "{coldest}");
    assert!(film.totals.refrozen > 0.0 && film.totals.refrozen < film.totals.melted);
    assert!(film.stations.iter().all(|s| s.thickness > 0.0));
}

#[test]
fn heat_into_ice_depends_on_the_history_of_the_melting_point() {
    let conditions = FilmConditions::new(20.0, -5.0);
    let even = Strip::uniform(0.05, 1.0e-3, 10.0e6).expect("a strip");
    let kappa = WATER.ice_diffusivity();
    let plain = |warmed: f64| 2.2 * warmed * (20.0 / (std::f64::consts::PI * kappa)).sqrt();
    let heat = HeatIntoIce::new(&even, &conditions, &WATER);
    for xi in [0.0, 1.0e-4, 0.05] {
        assert!((heat.scaled(xi) / plain(5.0 - 0.74) - 1.0).abs() < 1e-12);
    }
    // A surface temperature proportional to the distance, b xi, gives a heat flux proportional to 2
    // b sqrt(xi): twice that of a constant surface temperature of the same value.
    let falling = Strip::new(vec![0.0, 0.05], vec![1.0e-3; 2], vec![10.0e6, 0.0]).expect("a strip");
    let heat = HeatIntoIce::new(&falling, &conditions, &WATER);
    for xi in [0.01, 0.02, 0.05] {
        let expected = plain(5.0 - 0.74) + 2.0 * plain(0.74 * xi / 0.05);
        assert!((heat.scaled(xi) / expected - 1.0).abs() < 1e-12);
    }
}

#[test]
fn heat_into_steel_matters_only_at_low_speed_and_short_times() {
    let strip = Strip::uniform(0.05, 1.0e-3, 15.0e6).expect("a strip");
    let share = |v: f64, sliding_time: f64| {
        let conditions = FilmConditions {
            sliding_time,
            ..FilmConditions::new(v, -5.0)
        };
        let with = film(&strip, &conditions, &WATER, &FilmOptions::default()).expect("a film");
        let without = solved(&strip, &conditions, &STEEL_INSULATED);
        with.totals.friction / without.totals.friction - 1.0
    };
    assert!(
        (0.0..0.01).contains(&share(30.0, 10.0)),
        "{}",
        share(30.0, 10.0)
    );
    assert!(share(0.5, 0.1) > 5.0 * share(30.0, 10.0));
}
