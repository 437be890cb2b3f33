//! Runs simulated with known friction and recorded with noise: the fit recovers the friction.

use kufe_sled::friction::{LateralFit, MagicFormula};
use kufe_sled::one_track::inverse;
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Driver, Model, PrepareOptions, Run, SimulateOptions, TrackShape, Vehicle, fit, prepare_all,
    record, simulate, simulated_entry,
};

/// Eight runs of a driver with large steering angles, on a track without walls.
fn runs(model: &Model, seed: u64) -> Vec<Run> {
    let vehicle = Vehicle::new(model).unwrap();
    let track = sample_track("west");
    let shape = TrackShape::new(&track);
    let driver = Driver {
        noise_rad: 0.04,
        wander_m: 0.5,
        length_m: 14.0,
        ..Driver::of_skill(0.5)
    };
    (0..8)
        .map(|number| {
            let options = SimulateOptions {
                seed: 1000 * seed + number,
                ..SimulateOptions::default()
            };
            let simulated = simulate(&vehicle, &shape, &driver, &options).unwrap();
            let entry = simulated_entry(&format!("{number}"), &track, "d", options.conditions);
            record(
                &simulated,
                &vehicle,
                model.noise.as_ref(),
                entry,
                options.seed,
            )
        })
        .collect()
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn fits_of_twenty_seeds_are_within_five_percent_and_intervals_cover() {
    let mut model = Model::published();
    // All lever arms are nonzero.
    model.sled.accel_y_m = 0.05;
    // The fit starts from the friction of another sled, so the result depends on the data alone.
    let mut start = model.clone();
    start.friction.front = MagicFormula {
        mu_zeta: 1.0,
        c: 0.04,
        e: 0.99,
        k_n_per_rad: 2e4,
    };
    start.friction.rear = MagicFormula {
        mu_zeta: 1.0,
        c: 0.04,
        e: 0.99,
        k_n_per_rad: 2e4,
    };
    let vehicle = Vehicle::new(&start).unwrap();
    let mut within = [0; 4];
    let mut covered = [0; 4];
    let seeds = 20;
    for seed in 1..=seeds {
        let runs = runs(&model, seed);
        let prepared = prepare_all(
            &runs,
            &vehicle,
            model.noise.as_ref(),
            &PrepareOptions::default(),
        )
        .unwrap();
        let fitted = fit(&prepared, &vehicle, true).unwrap();
        let pairs = |fit: &LateralFit, truth: &MagicFormula| {
            [
                (fit.k_n_per_rad, truth.k_n_per_rad),
                (fit.mu_zeta_c, truth.mu_zeta_c()),
            ]
        };
        let found = pairs(&fitted.front, &model.friction.front)
            .into_iter()
            .chain(pairs(&fitted.rear, &model.friction.rear));
        for (i, (estimate, truth)) in found.enumerate() {
            let off = estimate.value / truth - 1.0;
            within[i] += usize::from(off.abs() < 0.05);
            let high = estimate.high.unwrap_or(f64::INFINITY);
            let covers = (estimate.low.unwrap()..=high).contains(&truth);
            covered[i] += usize::from(covers);
        }
    }
    let names = ["front K", "front mu_zeta c", "rear K", "rear mu_zeta c"];
    for i in 0..4 {
        println!(
            "{}: within 5 % {}/{seeds}, covered {}/{seeds}",
            names[i], within[i], covered[i]
        );
    }
    for i in 0..4 {
        assert!(
            within[i] >= 18,
            "{} within 5 % in {} of {seeds}",
            names[i],
            within[i]
        );
        assert!(
            covered[i] >= 18,
            "{} covered in {} of {seeds}",
            names[i],
            covered[i]
        );
    }
}

#[test]
fn measured_forces_are_within_one_percent_without_noise() {
    let mut model = Model::published();
    model.sled.accel_y_m = 0.05;
    let vehicle = Vehicle::new(&model).unwrap();
    let track = sample_track("west");
    let shape = TrackShape::new(&track);
    let driver = Driver {
        noise_rad: 0.03,
        ..Driver::of_skill(0.5)
    };
    let options = SimulateOptions {
        rate_hz: 500.0,
        ..SimulateOptions::default()
    };
    let simulated = simulate(&vehicle, &shape, &driver, &options).unwrap();
    let entry = simulated_entry("r", &track, "d", options.conditions);
    let run = record(&simulated, &vehicle, None, entry, 1);
    // The complete processing: low-pass filter, down-sampling, 20 Hz, derivatives, transfer,
    // inverse.
    let prepared = prepare_all(&[run], &vehicle, None, &PrepareOptions::default()).unwrap();
    let instants = prepared[0].states.iter().zip(&prepared[0].motions);
    let measured = instants.map(|(state, motion)| inverse(&vehicle, state, motion));
    let forces: Vec<_> = measured.collect();
    for (front, axis) in [(true, 1), (true, 2), (false, 1), (false, 2)] {
        let pick = |f: &kufe_sled::AxleForces| if front { f.front[axis] } else { f.rear[axis] };
        let (mut squares, mut size) = (0.0, 0.0);
        for (i, force) in forces.iter().enumerate().skip(20).take(forces.len() - 40) {
            let truth = pick(&simulated.instants[5 * i].forces);
            squares += (pick(force) - truth).powi(2);
            size += truth * truth;
        }
        let off = (squares / size).sqrt();
        println!("front {front} axis {axis}: {off:.1e}");
        assert!(off < 0.01, "front {front}, axis {axis}: {off}");
    }
}
