//! Runners whose friction coefficient is interpolated in a table over load, curvature, speed and
//! ice temperature.

use std::path::Path;

use kufe_lut::{Axes, AxisKind, Figures, Quantity, Table};
use kufe_sled::one_track::forward;
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Conditions, Driver, Model, SimulateOptions, Simulated, State, TrackShape, Vehicle,
    outside_tables, simulate,
};

/// Powers of load and speed and an exponential of the temperature, which the smooth mode
/// interpolates exactly.
fn law(fz: f64, speed: f64, ice_c: f64) -> f64 {
    1.5e-3 * (fz / 1000.0).powf(-0.2) * speed.powf(0.35) * (-0.03 * ice_c).exp()
}

pub fn write_table(path: &Path, fastest: f64, slides: bool) {
    let axes = Axes::new(vec![50.0, 20_000.0], vec![-0.2, 0.2]).unwrap();
    let axes = match slides {
        true => axes
            .with(AxisKind::Speed, vec![0.5, 8.0, fastest])
            .and_then(|axes| axes.with(AxisKind::IceTemperature, vec![-20.0, -9.0, -1.0]))
            .unwrap(),
        false => axes,
    };
    let nodes = axes.points().into_iter().map(|point| {
        let mu = law(
            point.fz,
            point.speed.unwrap_or(1.0),
            point.ice_c.unwrap_or(-1.0),
        );
        let rest = Figures::at_rest([1.7e7, 1.2e7, 1e-4, 0.05, 2e-3, 1e-5]);
        let rest = rest.with_error(Quantity::PMax, 0.0);
        if !slides {
            return rest;
        }
        rest.with(Quantity::Mu, mu)
            .with_error(Quantity::Mu, 0.0)
            .with(Quantity::MuPloughing, 0.2 * mu)
            .with(Quantity::MuViscous, 0.7 * mu)
            .with(Quantity::MuBoundary, 0.1 * mu)
            .with(Quantity::GrooveDepth, 3e-5)
            .with(Quantity::FilmMean, 5e-7)
    });
    let nodes: Vec<Figures> = nodes.collect();
    let table = Table::new(axes, &nodes, vec![]).unwrap();
    table
        .write(&mut std::fs::File::create(path).unwrap())
        .unwrap();
}

/// The published sled with these lines in `[friction.longitudinal]`.
fn model(folder: &Path, longitudinal: &str) -> Result<Model, kufe_sled::Error> {
    let text = Model::published().to_toml();
    let text = text.replace("mu = 0.004\n", longitudinal);
    assert!(text.contains(longitudinal));
    let path = folder.join("model.toml");
    std::fs::write(&path, text).unwrap();
    Model::load(&path)
}

const TABLES: &str = "front_table = \"mu.lut\"\nrear_table = \"mu.lut\"\n";

#[test]
fn a_table_over_ice_temperature_needs_the_temperature() {
    let folder = tempfile::tempdir().unwrap();
    write_table(&folder.path().join("mu.lut"), 50.0, true);
    let vehicle = Vehicle::new(&model(folder.path(), TABLES).unwrap()).unwrap();
    let mut options = SimulateOptions::default();
    options.conditions.ice_c = f64::NAN;
    let track = TrackShape::new(&sample_track("east"));
    let error = simulate(&vehicle, &track, &Driver::of_skill(0.9), &options);
    let error = error.unwrap_err().to_string();
    assert!(
        error.contains("mu.lut") && error.contains("ice_c"),
        "{error}"
    );
}

fn driven(vehicle: &Vehicle, ice_c: f64) -> Simulated {
    let mut options = SimulateOptions::default();
    options.conditions.ice_c = ice_c;
    let track = TrackShape::new(&sample_track("east"));
    simulate(vehicle, &track, &Driver::of_skill(0.9), &options).unwrap()
}

#[test]
fn friction_coefficients_follow_load_speed_and_ice_temperature() {
    let folder = tempfile::tempdir().unwrap();
    write_table(&folder.path().join("mu.lut"), 50.0, true);
    for (further, factor) in [("", 1.0), ("zeta = 1.25\n", 1.25)] {
        let model = model(folder.path(), &format!("{TABLES}{further}")).unwrap();
        let vehicle = Vehicle::new(&model).unwrap();
        for (v_mps, ice_c, gamma_rad) in
            [(3.0, -2.0, 0.0), (21.0, -11.0, 0.01), (38.0, -6.0, -0.02)]
        {
            let state = State {
                v_mps,
                conditions: Conditions {
                    ice_c,
                    ..Conditions::UNSTATED
                },
                gamma_rad,
                curvature_1pm: 0.03,
                alpha_f_rad: 0.004,
                alpha_r_rad: -0.002,
                fz_f0_n: 2400.0,
                fz_r_n: 3100.0,
                ..State::default()
            };
            let forces = forward(&vehicle, &state);
            let [front, rear] = [(forces.front, 0.004f64), (forces.rear, -0.002f64)];
            for (force, slip) in [front, rear] {
                let expected = -factor * law(force[2], v_mps, ice_c) * force[2] * slip.cos();
                assert!(
                    (force[0] / expected - 1.0).abs() < 1e-9,
                    "{} {expected}",
                    force[0]
                );
            }
        }
    }
}

#[test]
fn simulated_friction_follows_the_table_and_instants_outside_are_counted() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mu.lut");
    write_table(&file, 50.0, true);
    let model = model(folder.path(), TABLES).unwrap();
    let vehicle = Vehicle::new(&model).unwrap();
    let (warm, cold) = (driven(&vehicle, -2.0), driven(&vehicle, -15.0));
    for (run, ice_c) in [(&warm, -2.0), (&cold, -15.0)] {
        for instant in run.instants.iter().step_by(500) {
            let force = instant.forces.rear;
            let expected = law(force[2], instant.state.v_mps, ice_c) * force[2];
            let slip = instant.state.alpha_r_rad.cos();
            assert!((force[0] / (-expected * slip) - 1.0).abs() < 1e-6);
        }
    }
    assert!(cold.instants.len() > warm.instants.len());
    let states = warm.instants.iter().map(|instant| &instant.state);
    assert_eq!(outside_tables(&vehicle, states.clone()), []);
    // The same law in a table that ends at 20 m/s.
    write_table(&file, 20.0, true);
    let slow = Vehicle::new(&model).unwrap();
    let above = states.clone().filter(|state| state.v_mps > 20.0).count();
    let outside = outside_tables(&slow, states.clone());
    assert!(above > 1000);
    assert_eq!(outside.len(), 2);
    for (outside, runner) in outside.iter().zip(["front", "rear"]) {
        assert_eq!(
            (outside.runner.as_str(), outside.samples, outside.of),
            (runner, above, states.clone().count())
        );
        assert!(outside.to_string().contains("mu.lut"));
    }
}

#[test]
fn the_film_effect_blends_a_constant_with_the_table_by_its_share() {
    let folder = tempfile::tempdir().unwrap();
    write_table(&folder.path().join("mu.lut"), 50.0, true);
    // The mean over the nodes of the table: 2 loads, 3 speeds, 3 temperatures. Both curvatures have
    // the same values.
    let mut mean = 0.0;
    for fz in [50.0, 20_000.0] {
        for speed in [0.5, 8.0, 50.0] {
            for ice_c in [-20.0, -9.0, -1.0] {
                mean += law(fz, speed, ice_c) / 18.0;
            }
        }
    }
    for share in [0.0, 0.6, 1.0] {
        let mut model = model(folder.path(), &format!("mu = 0.005\n{TABLES}")).unwrap();
        let film = toml::toml! { share = share };
        model.effects.insert("film".to_owned(), film);
        let vehicle = Vehicle::with_effects(&model).unwrap();
        for (v_mps, ice_c) in [(3.0, -2.0), (21.0, -11.0)] {
            let state = State {
                v_mps,
                conditions: Conditions {
                    ice_c,
                    ..Conditions::UNSTATED
                },
                fz_f0_n: 2400.0,
                fz_r_n: 3100.0,
                ..State::default()
            };
            let forces = forward(&vehicle, &state);
            for force in [forces.front, forces.rear] {
                let over_mean = law(force[2], v_mps, ice_c) / mean;
                let expected = -0.005 * (1.0 + share * (over_mean - 1.0)) * force[2];
                let off = (force[0] / expected - 1.0).abs();
                assert!(off < 1e-9, "{share}: {} {expected}", force[0]);
            }
        }
    }
    let mut constant = model(folder.path(), "mu = 0.005\n").unwrap();
    let film = toml::toml! { share = 1.0 };
    constant.effects.insert("film".to_owned(), film);
    let error = Vehicle::with_effects(&constant).unwrap_err().to_string();
    assert!(error.contains("film"), "{error}");
}

#[test]
fn invalid_tables_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("mu.lut");
    let reported = |longitudinal: &str| {
        let vehicle = model(folder.path(), longitudinal).and_then(|model| Vehicle::new(&model));
        vehicle.unwrap_err().to_string()
    };
    write_table(&file, 50.0, false);
    let text = reported(TABLES);
    assert!(
        text.contains("mu.lut") && text.contains("at rest"),
        "{text}"
    );
    write_table(&file, 50.0, true);
    let text = reported("front_table = \"mu.lut\"\n");
    assert!(text.contains("rear_table is missing"), "{text}");
    let text = reported(&format!("{TABLES}zeta = -1.0\n"));
    assert!(text.contains("zeta"), "{text}");
    let text = reported(&format!("{TABLES}b = 0.088\n"));
    assert!(text.contains("c is missing"), "{text}");
    let text = reported("front_table = \"none.lut\"\nrear_table = \"none.lut\"\n");
    assert!(text.contains("none.lut"), "{text}");
}

#[test]
fn a_model_with_tables_can_be_written_to_another_folder() {
    let folder = tempfile::tempdir().unwrap();
    write_table(&folder.path().join("mu.lut"), 50.0, true);
    let model = model(folder.path(), TABLES).unwrap();
    let other = tempfile::tempdir().unwrap();
    let path = other.path().join("model.next.toml");
    std::fs::write(&path, model.to_toml()).unwrap();
    assert!(Vehicle::new(&Model::load(&path).unwrap()).is_ok());
}
