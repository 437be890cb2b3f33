//! The simulator against energy conservation, step refinement, the inverse model and repeatability.

use kufe_sled::RunnerLaw;
use kufe_sled::one_track::inverse;
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Model, Noise, PrepareOptions, Prepared, SimulateOptions, Simulated, Track, TrackShape,
    Vehicle, WallContact, prepare, record, simulate, simulated_entry,
};

fn vehicle() -> Vehicle {
    Vehicle::new(&Model::published()).unwrap()
}

fn driven(vehicle: &Vehicle, track: &Track, options: &SimulateOptions) -> Simulated {
    simulate(
        vehicle,
        &TrackShape::new(track),
        &Driver::of_skill(0.6),
        options,
    )
    .unwrap()
}

/// Hills and valleys without turns. The vertical curvature is the derivative of the slope.
fn rolling_track() -> Track {
    let s_m: Vec<f64> = (0..=800).map(f64::from).collect();
    let k = std::f64::consts::TAU / 160.0;
    Track {
        ice: kufe_sled::IceAlong::default(),
        name: "rolling".to_string(),
        slope_rad: s_m.iter().map(|s| 0.06 + 0.08 * (k * s).sin()).collect(),
        curvature_1pm: s_m.iter().map(|s| -0.08 * k * (k * s).cos()).collect(),
        bank_rad: vec![0.0; s_m.len()],
        s_m,
    }
}

#[test]
fn speed_without_friction_follows_from_altitude() {
    let mut vehicle = vehicle();
    vehicle.sled.cda_m2 = 0.0;
    for runner in [&mut vehicle.front, &mut vehicle.rear] {
        runner.longitudinal = RunnerLaw::Fixed(0.0);
        runner.lateral.k_n_per_rad = 1e-12;
    }
    let track = rolling_track();
    let run = simulate(
        &vehicle,
        &TrackShape::new(&track),
        &Driver::of_skill(1.0),
        &SimulateOptions::default(),
    )
    .unwrap();
    assert!(run.energy.relative_error() < 1e-9, "{:?}", run.energy);
    // Reference: altitude by Simpson's rule over the formula of the slope.
    let last = run.instants.last().unwrap().state;
    let slope = |s: f64| 0.06 + 0.08 * (std::f64::consts::TAU / 160.0 * s).sin();
    let n = 20_000;
    let h = last.s_m / n as f64;
    let drop: f64 = (0..n)
        .map(|i| {
            let a = i as f64 * h;
            h / 6.0 * (slope(a).sin() + 4.0 * slope(a + 0.5 * h).sin() + slope(a + h).sin())
        })
        .sum();
    let expected = (100.0 + 2.0 * kufe_sled::GRAVITY * drop).sqrt();
    let off = (last.v_mps / expected - 1.0).abs();
    assert!(
        off < 1e-6,
        "speed {} against {expected}: {off:.1e}",
        last.v_mps
    );
}

#[test]
fn work_of_gravity_depends_on_altitude_only() {
    let track = sample_track("east");
    let shape = TrackShape::new(&track);
    let cross = 0.25;
    let options = SimulateOptions {
        cross_curvature_1pm: cross,
        ..SimulateOptions::default()
    };
    let run = driven(&vehicle(), &track, &options);
    let (end, n) = (run.instants.last().unwrap(), run.offset_m.last().unwrap());
    let s = end.state.s_m;
    let offset = run
        .offset_m
        .iter()
        .fold(0.0, |most: f64, n| most.max(n.abs()));
    assert!(offset > 0.2, "the sled stays within {offset} m of the line");
    // Midpoint rule along the line, then across an arc of radius 1 / cross.
    let (from, cells) = (track.s_m[0], 200_000);
    let h = (s - from) / f64::from(cells);
    let fall: f64 = (0..cells)
        .map(|i| h * shape.slope.value(from + (f64::from(i) + 0.5) * h).sin())
        .sum();
    let bank = shape.bank.value(s);
    let rise = shape.slope.value(s).cos() * (bank.cos() - (bank + cross * n).cos()) / cross;
    let expected = vehicle().sled.mass_kg * kufe_sled::GRAVITY * (fall - rise);
    let off = (run.energy.gravity_j / expected - 1.0).abs();
    assert!(
        off < 1e-6,
        "{} J against {expected}: {off:.1e}",
        run.energy.gravity_j
    );
}

#[test]
fn energy_balance_with_friction_drag_and_wall_contact() {
    let options = SimulateOptions {
        contacts: vec![WallContact {
            s_m: 480.0,
            length_m: 15.0,
            force_n: 800.0,
            x_m: 0.3,
        }],
        ..SimulateOptions::default()
    };
    let run = driven(&vehicle(), &sample_track("east"), &options);
    assert!(run.finished);
    assert!(run.energy.relative_error() < 1e-6, "{:?}", run.energy);
    assert!(run.energy.ice_j < -1e3 && run.energy.air_j < -1e3 && run.energy.wall_j != 0.0);
}

#[test]
fn time_steps_converge_with_order_four() {
    let track = sample_track("east");
    let drive = |step_s: f64| {
        let options = SimulateOptions {
            step_s,
            rate_hz: 100.0,
            most_s: 25.0,
            ..SimulateOptions::default()
        };
        driven(&vehicle(), &track, &options).instants
    };
    let fine = drive(0.000_25);
    // RMS error of the rear slip angle over the run, relative to the RMS slip angle.
    let error = |step: f64| {
        let squares =
            |pick: &dyn Fn(usize) -> f64| (0..fine.len()).map(|i| pick(i).powi(2)).sum::<f64>();
        let coarse = drive(step);
        let off = squares(&|i| coarse[i].state.alpha_r_rad - fine[i].state.alpha_r_rad);
        (off / squares(&|i| fine[i].state.alpha_r_rad)).sqrt()
    };
    let errors = [0.01, 0.005, 0.0025].map(error);
    let order = (errors[0] / errors[2]).log2() / 2.0;
    println!("steps 10, 5, 2.5 ms: errors {errors:?}, order {order:.2}");
    assert!((order - 4.0).abs() < 0.3, "order {order} from {errors:?}");
    let real_time = error(0.001);
    println!("1 kHz: {real_time:.1e}");
    assert!(real_time < 1e-6, "1 kHz differs from 4 kHz by {real_time}");
}

/// A short sled with little yaw inertia: its time constant is below the step of 1 ms.
#[test]
fn a_stiff_sled_is_integrated_with_smaller_steps() {
    let track = sample_track("west");
    let mut stiff = vehicle();
    stiff.sled.j_zz_kgm2 = 1.0;
    let drive = |step_s: f64| {
        let options = SimulateOptions {
            step_s,
            start_speed_mps: 3.0,
            ..SimulateOptions::default()
        };
        driven(&stiff, &track, &options)
    };
    let [usual, fine] = [1e-3, 5e-5].map(drive);
    let times = [&usual, &fine].map(|run| run.instants.last().unwrap().state.t_s);
    assert!((times[0] - times[1]).abs() < 0.003, "{times:?}");
    let slip = |run: &Simulated| {
        let slips = run.instants.iter().map(|at| at.state.alpha_r_rad.abs());
        slips.fold(0.0, f64::max)
    };
    let slips = [&usual, &fine].map(slip);
    assert!((slips[0] / slips[1] - 1.0).abs() < 0.01, "{slips:?}");
    // With still less inertia no permitted step is stable.
    stiff.sled.j_zz_kgm2 = 1e-3;
    let options = SimulateOptions::default();
    let driver = Driver::of_skill(0.9);
    let error = simulate(&stiff, &TrackShape::new(&track), &driver, &options).unwrap_err();
    assert!(error.to_string().contains("no step of"), "{error}");
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_another_run() {
    let track = sample_track("west");
    let speed = |seed| {
        let options = SimulateOptions {
            seed,
            ..SimulateOptions::default()
        };
        driven(&vehicle(), &track, &options)
            .instants
            .last()
            .unwrap()
            .state
            .v_mps
    };
    assert_eq!(speed(3).to_bits(), speed(3).to_bits());
    assert_ne!(speed(3), speed(4));
}

fn recorded(
    simulated: &Simulated,
    vehicle: &Vehicle,
    track: &Track,
    noise: Option<&Noise>,
) -> Prepared {
    let options = SimulateOptions::default();
    let entry = simulated_entry("r", track, "d", options.conditions);
    let run = record(simulated, vehicle, noise, entry, 1);
    let raw = PrepareOptions {
        rate_hz: 1e4,
        cutoff_hz: 1e4,
        ..PrepareOptions::default()
    };
    prepare(&run, vehicle, Some(&Noise::default()), &raw).unwrap()
}

#[test]
fn inverse_recovers_the_simulated_forces_from_noise_free_sensors() {
    let mut model = Model::published();
    model.sled.accel_y_m = 0.07;
    let vehicle = Vehicle::new(&model).unwrap();
    let track = sample_track("east");
    let simulated = driven(&vehicle, &track, &SimulateOptions::default());
    // With the simulator's own accelerations the inverse model is exact.
    for instant in &simulated.instants {
        let back = inverse(&vehicle, &instant.state, &instant.motion);
        for (found, truth) in back
            .front
            .iter()
            .chain(&back.rear)
            .zip(instant.forces.front.iter().chain(&instant.forces.rear))
        {
            assert!(
                (found - truth).abs() < 1e-6 * instant.forces.front[2],
                "{found} against {truth}"
            );
        }
    }
    let prepared = recorded(&simulated, &vehicle, &track, None);
    let instants = prepared.states.iter().zip(&prepared.motions);
    let measured = instants.map(|(state, motion)| inverse(&vehicle, state, motion));
    let forces: Vec<_> = measured.collect();
    let mut worst = 0.0_f64;
    let most = |pick: &dyn Fn(&kufe_sled::AxleForces) -> f64| {
        simulated
            .instants
            .iter()
            .map(|i| pick(&i.forces).abs())
            .fold(0.0, f64::max)
    };
    let exercised = |pick: &dyn Fn(&kufe_sled::State) -> f64| {
        prepared
            .states
            .iter()
            .map(|s| pick(s).abs())
            .fold(0.0, f64::max)
    };
    assert!(exercised(&|s| s.delta_rad) > 0.02 && exercised(&|s| s.gamma_rad) > 0.02);
    assert!(exercised(&|s| s.roll_rate_radps) > 0.5 && exercised(&|s| s.roll_accel_radps2) > 1.0);
    for axis in 0..3 {
        for (name, front) in [("front", true), ("rear", false)] {
            let pick = |f: &kufe_sled::AxleForces| if front { f.front[axis] } else { f.rear[axis] };
            let scale = most(&pick);
            for (i, force) in forces.iter().enumerate().skip(4).take(forces.len() - 8) {
                let off = (pick(force) - pick(&simulated.instants[i].forces)).abs() / scale;
                worst = worst.max(off);
                // The residual comes from the derivative across the kinks in the track's third
                // derivative, at each metre of its table.
                assert!(
                    off < 5e-3,
                    "{name} axis {axis} at sample {i}: {off:.1e} of {scale:.0} N"
                );
            }
        }
    }
    println!("largest force error {worst:.1e} of the largest force");
}
