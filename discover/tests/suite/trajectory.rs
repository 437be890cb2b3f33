//! A search closes the misfit of the trajectory as it closes that of the forces: on held-out runs,
//! validated and replayed with both models.

use std::collections::BTreeMap;

use kufe_discover::{Found, Verdict};
use kufe_sled::sample_data::sample_track;
use kufe_sled::{
    Inputs, Model, PrepareOptions, Run, SimulateOptions, TrackShape, Vehicle, prepare, replay,
    validate,
};

use crate::campaign::{driven, plan, searched, truth};

/// Root mean squares over the held-out runs: of the force residuals, and of the differences of
/// replays.
fn gaps(found: &Found, recorded: &[Run], model: &Model) -> BTreeMap<String, f64> {
    let vehicle = Vehicle::with_effects(model).unwrap();
    let mut squares: BTreeMap<String, (f64, f64)> = BTreeMap::new();
    let mut add = |what: &str, x: f64| {
        let sum = squares.entry(what.to_owned()).or_default();
        *sum = (sum.0 + x * x, sum.1 + 1.0);
    };
    for name in &found.report.held_out.runs {
        let run = recorded.iter().find(|r| r.entry.run == *name).unwrap();
        let prepared = prepare(
            run,
            &vehicle,
            model.noise.as_ref(),
            &PrepareOptions::default(),
        )
        .unwrap();
        let residuals = validate(&[prepared], &vehicle)[0].left_rms;
        add("along [N]", residuals.along_n);
        add("side [N]", residuals.side_n);
        add("yaw [N m]", residuals.yaw_nm);
        let track = sample_track(&run.entry.track);
        let inputs = Inputs::of(run, &vehicle, track.s_m[0]).unwrap();
        let options = SimulateOptions {
            step_s: 2.5e-3,
            rate_hz: 100.0,
            conditions: run.entry.conditions,
            ..SimulateOptions::default()
        };
        let again = replay(&inputs, &vehicle, &TrackShape::new(&track), &options).unwrap();
        for difference in again.differences {
            add(&difference.column, difference.rms);
        }
    }
    squares
        .into_iter()
        .map(|(what, (sum, n))| (what, (sum / n).sqrt()))
        .collect()
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn misfits_of_forces_and_trajectory_decrease_alike_on_held_out_runs() {
    for (hidden, force, way) in [
        (
            "\n[effects.drag-area]\ncda_m2 = 0.08\n",
            "along [N]",
            ["t_s", "v_mps"],
        ),
        (
            "\n[effects.speed-grip]\nslope_s_per_m = 0.03\n",
            "side [N]",
            ["yaw_rate_radps", "alpha_rad"],
        ),
    ] {
        let mut plan = plan(3);
        plan.truncate(20);
        let recorded = driven(&plan, &truth(hidden));
        let found = searched(&recorded, 3);
        assert!(
            matches!(
                found.report.verdict,
                Verdict::Named | Verdict::OneOf | Verdict::DependsOn
            ),
            "{}",
            found.report.sentence
        );
        let next = Model::from_toml(found.next_model.as_deref().unwrap(), "next").unwrap();
        let [before, after, floor] = [&Model::published(), &next, &truth(hidden)]
            .map(|model| gaps(&found, &recorded, model));
        println!(
            "{}\nbefore {before:?}\nafter {after:?}\ntruth {floor:?}",
            found.report.sentence
        );
        // Residuals of the truth are sensor noise; four fifths of the excess over it are closed, of
        // forces and trajectory alike.
        for what in [force, way[0], way[1]] {
            let excess = |gaps: &BTreeMap<String, f64>| {
                (gaps[what].powi(2) - floor[what].powi(2)).max(0.0).sqrt()
            };
            let closed = 1.0 - excess(&after) / excess(&before);
            println!("{what}: {closed:.3} closed");
            assert!(closed > 0.8, "{what}: {closed}");
        }
        // The report's own figures of the same runs decrease with them.
        let channel = force.split(' ').next().unwrap();
        let mut own = found.report.held_out.channels.iter();
        assert!(own.any(|c| c.channel == channel && c.after < c.before));
    }
}
