//! Statements of the paper about its runs, verified on the sample data.

use std::sync::LazyLock;

use kufe_sled::sample_data::{drive_sample, sample_plan};
use kufe_sled::{
    Axle, Error, FitResult, Group, Model, PrepareOptions, Prepared, RunEvaluation, Vehicle,
    by_track, evaluate, fit, groups, prepare_all, slip_offsets, validate,
};

struct Sample {
    model: Model,
    vehicle: Vehicle,
    prepared: Vec<Prepared>,
    fit: FitResult,
}

static SAMPLE: LazyLock<Sample> = LazyLock::new(|| {
    let model = Model::published();
    let vehicle = Vehicle::new(&model).unwrap();
    let runs = drive_sample(&sample_plan(1), &model).unwrap();
    let prepared = prepare_all(
        &runs,
        &vehicle,
        model.noise.as_ref(),
        &PrepareOptions::default(),
    )
    .unwrap();
    let days = ["d1", "d2", "d3"];
    let fitted: Vec<Prepared> = prepared
        .iter()
        .filter(|run| days.contains(&run.entry.session.as_str()))
        .cloned()
        .collect();
    let fit = fit(&fitted, &vehicle, true).unwrap();
    Sample {
        model,
        vehicle,
        prepared,
        fit,
    }
});

fn held_out_runs() -> Vec<Prepared> {
    let seen = |run: &&Prepared| !SAMPLE.fit.runs.contains(&run.entry.run);
    SAMPLE.prepared.iter().filter(seen).cloned().collect()
}

fn fitted_vehicle() -> Vehicle {
    SAMPLE
        .vehicle
        .with_lateral(SAMPLE.fit.front.law(), SAMPLE.fit.rear.law())
}

#[test]
fn the_sample_has_44_runs_of_five_drivers_on_two_tracks() {
    assert_eq!(SAMPLE.prepared.len(), 44);
    for (driver, count) in [("A1", 9), ("A2", 12), ("A3", 7), ("B1", 12), ("C1", 4)] {
        let runs = SAMPLE
            .prepared
            .iter()
            .filter(|run| run.entry.driver == driver);
        assert_eq!(runs.count(), count, "{driver}");
    }
    assert!(SAMPLE.prepared.iter().any(|run| run.entry.track == "west"));
}

#[test]
fn fit_of_the_sample_data_recovers_the_truth_within_five_percent() {
    let truth = &SAMPLE.model.friction;
    for (fit, truth) in [
        (&SAMPLE.fit.front, truth.front),
        (&SAMPLE.fit.rear, truth.rear),
    ] {
        assert!((fit.k_n_per_rad.value / truth.k_n_per_rad - 1.0).abs() < 0.05);
        assert!((fit.mu_zeta_c.value / truth.mu_zeta_c() - 1.0).abs() < 0.05);
    }
}

/// Offsets as after a new installation of the slip sensor and the steering sensor for each session.
#[test]
fn zero_offsets_of_sessions_are_estimated_and_do_not_change_the_fit() {
    let offsets = [
        ("d1", 1.2e-3, 0.0),
        ("d2", -0.8e-3, 1.0e-3),
        ("d3", 0.5e-3, -1.5e-3),
    ];
    let fitted = |run: &&Prepared| SAMPLE.fit.runs.contains(&run.entry.run);
    let mut runs: Vec<Prepared> = SAMPLE.prepared.iter().filter(fitted).cloned().collect();
    for run in &mut runs {
        let own = offsets
            .iter()
            .find(|(session, ..)| *session == run.entry.session);
        let (_, slip, steering) = own.unwrap();
        for state in &mut run.states {
            state.alpha_cog_rad += slip;
            state.alpha_r_rad += slip;
            state.alpha_f_rad += slip + steering;
            state.delta_rad += steering;
        }
    }
    let fit = fit(&runs, &SAMPLE.vehicle, true).unwrap();
    let truth = &SAMPLE.model.friction;
    for (fit, truth) in [(&fit.front, truth.front), (&fit.rear, truth.rear)] {
        let k = fit.k_n_per_rad.value;
        assert!((k / truth.k_n_per_rad - 1.0).abs() < 0.05, "{k}");
    }
    // Wall contacts are detected in the runs after the offsets are subtracted.
    let [found, expected] = [&fit, &SAMPLE.fit].map(|fit| fit.excluded_contacts as f64);
    assert!((found / expected - 1.0).abs() < 0.05, "{found} {expected}");
    let [found, expected] = [&fit, &SAMPLE.fit].map(|fit| fit.balances_left_rms.side_n);
    assert!(found < 1.05 * expected, "{found} {expected}");
    for (session, slip, steering) in offsets {
        for (runner, offset) in [(Axle::Rear, slip), (Axle::Front, slip + steering)] {
            let mut found = fit.slip_offsets.iter();
            let found = found.find(|one| one.session == session && one.runner == runner);
            let found = found.map_or(0.0, |one| one.offset_rad);
            assert!(
                (found - offset).abs() < 0.1e-3,
                "{session} {runner:?}: {found}, {offset}"
            );
        }
    }
}

#[test]
fn a_fit_that_fails_with_the_offsets_subtracted_is_an_error() {
    let mut runs = SAMPLE.prepared.clone();
    for run in &mut runs {
        // The standard deviation is larger than the slips and smaller than the offset.
        run.slip_sd_rad = [0.01; 2];
        for state in &mut run.states {
            state.alpha_r_rad += 0.02;
            state.alpha_f_rad += 0.02;
        }
    }
    let error = fit(&runs, &SAMPLE.vehicle, false).unwrap_err();
    println!("{error}");
    assert!(matches!(error, Error::SlipOffsets { .. }), "{error}");
}

#[test]
fn offsets_are_estimated_with_given_laws() {
    assert!(slip_offsets(&SAMPLE.prepared, &fitted_vehicle()).is_empty());
    let mut runs = SAMPLE.prepared.clone();
    for state in runs.iter_mut().flat_map(|run| &mut run.states) {
        state.alpha_r_rad += 0.002;
    }
    let offsets = slip_offsets(&runs, &fitted_vehicle());
    assert!(!offsets.is_empty());
    for one in offsets {
        assert_eq!(one.runner, Axle::Rear);
        assert!((one.offset_rad - 0.002).abs() < 1e-4, "{one:?}");
    }
}

#[test]
fn fitted_model_has_a_lower_error_than_braghin_on_held_out_runs() {
    let runs = validate(&held_out_runs(), &fitted_vehicle());
    for run in &runs {
        assert!(run.rmse_n < run.rmse_braghin_n, "{}", run.run);
    }
    let tracks = by_track(&runs);
    assert_eq!(tracks.len(), 2);
    for track in &tracks {
        println!(
            "{}: {:.0} N, Braghin {:.0} N",
            track.track, track.rmse_n, track.rmse_braghin_n
        );
        assert!(track.rmse_n < 0.5 * track.rmse_braghin_n);
    }
}

#[test]
fn wall_contact_raises_the_error_at_its_position() {
    let runs = validate(&held_out_runs(), &fitted_vehicle());
    let rmse = |track: &str| {
        by_track(&runs)
            .iter()
            .find(|t| t.track == track)
            .unwrap()
            .rmse_n
    };
    assert!(
        rmse("east") > 2.0 * rmse("west"),
        "{} against {}",
        rmse("east"),
        rmse("west")
    );
    let plan = sample_plan(1);
    for run in runs
        .iter()
        .filter(|run| run.track == "east" && run.driver != "C1")
    {
        let contacts = &plan
            .iter()
            .find(|p| p.run == run.run)
            .unwrap()
            .options
            .contacts;
        // The two largest differences are within 15 m of a simulated wall contact.
        for disagreement in run.largest.iter().take(2) {
            let near = contacts
                .iter()
                .any(|c| (disagreement.s_m - c.s_m - 0.5 * c.length_m).abs() < 15.0);
            assert!(
                near,
                "{}: {disagreement:?} is near none of {contacts:?}",
                run.run
            );
        }
        assert!(!run.largest.is_empty(), "{}", run.run);
    }
}

fn group<'a>(groups: &'a [Group], by: &str, name: &str) -> &'a Group {
    let found = groups
        .iter()
        .find(|g| g.by == by && g.name == name && g.track.as_deref() == Some("east"));
    found.unwrap()
}

#[test]
fn losses_increase_from_class_a_to_class_c() {
    let runs: Vec<RunEvaluation> = evaluate(&SAMPLE.prepared, &SAMPLE.vehicle);
    let groups = groups(&runs, 1);
    let class = |name| group(&groups, "class", name).increase_total;
    assert!(class("A").high.unwrap() < class("B").low.unwrap());
    assert!(class("B").mean < class("C").low.unwrap());
    // Two styles: A2 steers more than A1 and loses more at the front.
    let driver = |name| group(&groups, "driver", name);
    assert!(driver("A2").steering_above_2deg.mean > driver("A1").steering_above_2deg.mean);
    assert!(driver("A2").increase_front.mean > driver("A1").increase_front.mean);
    // Driver C1 steers least above 2 degrees, never above 4 degrees, and slips most at the rear.
    for other in ["A1", "A2", "A3", "B1"] {
        assert!(driver("C1").steering_above_2deg.mean < driver(other).steering_above_2deg.mean);
        assert!(driver("C1").slip_rear_above_2deg.mean > driver(other).slip_rear_above_2deg.mean);
        assert!(driver("C1").increase_total.mean > driver(other).increase_total.mean);
    }
    assert_eq!(driver("C1").steering_above_4deg.mean, 0.0);
}

#[test]
fn loss_increases_equal_an_independent_integration() {
    // Reference: Simpson's rule over the powers of the forces of one run.
    let run = &SAMPLE.prepared[0];
    let vehicle = &SAMPLE.vehicle;
    let evaluated = &evaluate(std::slice::from_ref(run), vehicle)[0];
    let power = |i: usize| {
        let s = &run.states[i];
        let f = kufe_sled::one_track::forward(vehicle, s);
        let rho = 0.5 * s.air_density_kgpm3 * vehicle.sled.cda_m2 * s.v_mps * s.v_mps;
        let beta = -s.alpha_cog_rad;
        let ideal = f.front[0] + f.rear[0] - rho;
        let driven = (f.front_body[0] + f.rear[0]) * beta.cos()
            + (f.front_body[1] + f.rear[1]) * beta.sin()
            - rho * (1.0 + 0.0694 * beta.abs().to_degrees());
        [ideal * s.v_mps, driven * s.v_mps]
    };
    let n = (run.states.len() - 1) / 2 * 2;
    let mut energy = [0.0; 2];
    for i in (0..n).step_by(2) {
        let (a, b, c) = (power(i), power(i + 1), power(i + 2));
        for k in 0..2 {
            energy[k] += run.dt_s / 3.0 * (a[k] + 4.0 * b[k] + c[k]);
        }
    }
    assert!((evaluated.e_tot_loss_j / energy[0] - 1.0).abs() < 1e-3);
    let increase = energy[1] / energy[0] - 1.0;
    assert!((evaluated.increase_total - increase).abs() < 1e-3 * increase.abs() + 1e-6);
}
