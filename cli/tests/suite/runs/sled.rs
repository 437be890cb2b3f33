//! `kufe simulate`, `fit lateral`, `validate` and `evaluate`.

use crate::kufe::{json, kufe, octave, refused, succeeds};

#[test]
fn sample_data_goes_through_fit_validation_and_evaluation() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "1"],
    );
    let runs = "sample/runs.csv";
    let model = ["--model", "sample/model.toml"];
    let with = |words: &[&str]| -> Vec<String> {
        words
            .iter()
            .chain(&model)
            .map(ToString::to_string)
            .collect()
    };
    let call = |words: &[&str]| {
        let words = with(words);
        succeeds(
            folder,
            &words.iter().map(String::as_str).collect::<Vec<_>>(),
        )
    };

    call(&["fit", "lateral", runs, "--session", "d1,d2,d3", "-o", "fit"]);
    let fit = json(&folder.join("fit/fit.json"));
    for (runner, stiffness, product) in [
        ("front", 10522.0, 2.577 * 0.024),
        ("rear", 49776.0, 3.288 * 0.076),
    ] {
        for key in ["mu_zeta", "c", "e", "k_n_per_rad"] {
            for end in ["value", "low", "high"] {
                assert!(fit[runner][key][end].is_number(), "{runner} {key} {end}");
            }
        }
        let near = |key: &str, truth: f64| {
            let value = fit[runner][key]["value"].as_f64().unwrap_or(f64::NAN);
            assert!(
                (value / truth - 1.0).abs() < 0.05,
                "{runner} {key}: {value}"
            );
        };
        near("k_n_per_rad", stiffness);
        near("mu_zeta_c", product);
    }

    call(&[
        "validate",
        runs,
        "--fit",
        "fit/fit.json",
        "-o",
        "validation",
    ]);
    let validation = json(&folder.join("validation/validation.json"));
    let fitted = fit["runs"].as_array().expect("runs").len();
    assert_eq!(
        validation["runs"].as_array().expect("runs").len(),
        44 - fitted
    );
    let seen = ["validate", runs, "--fit", "fit/fit.json", "--session", "d1"];
    let seen = with(&seen);
    let seen: Vec<&str> = seen.iter().map(String::as_str).collect();
    refused(folder, &seen, 3, &["no run remains", "fitted to all"]);
    for track in validation["tracks"].as_array().expect("tracks") {
        let (ours, braghin) = (track["rmse_n"].as_f64(), track["rmse_braghin_n"].as_f64());
        assert!(ours < braghin, "{track}");
    }

    call(&["evaluate", runs, "-o", "evaluation"]);
    let evaluation = json(&folder.join("evaluation/evaluation.json"));
    assert_eq!(evaluation["runs"].as_array().expect("runs").len(), 44);
    // The stretches of a run are all of its losses, and those of a driver the mean of the runs'.
    for run in evaluation["runs"].as_array().expect("runs") {
        let stretches = run["losses"].as_array().expect("losses");
        let sum: f64 = stretches
            .iter()
            .flat_map(|one| ["front_j", "rear_j", "aero_j"].map(|key| one[key].as_f64()))
            .sum::<Option<f64>>()
            .expect("numbers");
        let number = |key: &str| run[key].as_f64().expect("a number");
        let whole = -number("increase_total") * number("e_tot_loss_j");
        assert!((sum / whole - 1.0).abs() < 1e-6, "{sum} J of {whole} J");
    }
    let drivers = evaluation["drivers"].as_array().expect("drivers");
    let runs_of = |driver: &serde_json::Value| driver["runs"].as_u64().expect("a count");
    assert_eq!(drivers.iter().map(runs_of).sum::<u64>(), 44);
    for name in [
        "evaluation/losses_east.png",
        "fit/fit_front.png",
        "fit/fit_rear.png",
        "fit/model.fit.toml",
        "validation/rmse.png",
        "evaluation/energy_east.png",
        "evaluation/energy_tracks.png",
        "evaluation/angles.png",
        "evaluation/evaluation.csv",
    ] {
        assert!(
            folder
                .join(name)
                .metadata()
                .is_ok_and(|file| file.len() > 500),
            "{name}"
        );
    }
    // A result is the same however many threads work on it.
    let one = with(&["evaluate", runs, "-o", "one", "--threads", "1"]);
    succeeds(folder, &one.iter().map(String::as_str).collect::<Vec<_>>());
    let bytes = |path: &str| std::fs::read(folder.join(path)).expect("a result");
    assert_eq!(
        bytes("one/evaluation.json"),
        bytes("evaluation/evaluation.json")
    );
    refused(
        folder,
        &[
            "fit",
            "lateral",
            runs,
            "--model",
            "sample/model.toml",
            "--session",
            "d9",
        ],
        3,
        &["--session d9", "d1, d2"],
    );
}

#[test]
fn a_simulated_run_is_read_like_a_measured_one_and_repeats_bit_by_bit() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    let model = kufe_sled::Model::published().to_toml();
    std::fs::write(folder.join("model.toml"), &model).expect("writable");
    let track = kufe_sled::sample_data::sample_track("west");
    track
        .write_csv(std::fs::File::create(folder.join("track_w.csv")).expect("writable"))
        .expect("written");
    for out in ["a", "b"] {
        succeeds(
            folder,
            &[
                "simulate",
                "model.toml",
                "track_w.csv",
                "--runs",
                "2",
                "--seed",
                "5",
                "--rate-hz",
                "200",
                "-o",
                out,
            ],
        );
    }
    let bytes = |path: &str| std::fs::read(folder.join(path)).expect("a result");
    assert_eq!(bytes("a/run_002.csv"), bytes("b/run_002.csv"));
    assert_ne!(bytes("a/run_001.csv"), bytes("a/run_002.csv"));
    let reported = json(&folder.join("a/simulation.json"));
    assert!(reported["runs"][0]["energy_balance_relative_error"].as_f64() < Some(1e-6));
    succeeds(
        folder,
        &["evaluate", "a/runs.csv", "--model", "model.toml", "-o", "e"],
    );

    refused(folder, &["simulate", "model.toml"], 2, &["TRACK.csv"]);
    refused(
        folder,
        &["simulate", "model.toml", "track_w.csv", "--skill", "2"],
        2,
        &["--skill 2"],
    );
    for (option, value) in [
        ("--rate-hz", "0"),
        ("--step-s", "10"),
        ("--start-speed-mps", "0"),
    ] {
        let words = ["simulate", "model.toml", "track_w.csv", option, value];
        refused(folder, &words, 2, &[option, "expected"]);
    }
    let words = [
        "simulate",
        "model.toml",
        "track_w.csv",
        "--most-s",
        "1",
        "-o",
        "short",
    ];
    let short = kufe(folder, &words);
    let reported = String::from_utf8_lossy(&short.stderr);
    assert!(
        reported.contains("is not at the finish after 1 s"),
        "{reported}"
    );
    let onto = ["simulate", "model.toml", "track_w.csv", "-o", "model.toml"];
    refused(folder, &onto, 3, &["model.toml", "expected a folder"]);
    std::fs::write(folder.join("up.csv"), "s_m,slope_rad,curvature_1pm,bank_rad\n0,-0.2,0,0\n50,-0.2,0,0\n100,-0.2,0,0\n200,-0.2,0,0\n").expect("writable");
    refused(
        folder,
        &["simulate", "model.toml", "up.csv", "-o", "up"],
        3,
        &["stopped", "slope_rad is positive downhill"],
    );
    assert!(
        !folder.join("up").exists(),
        "a failed command leaves nothing behind"
    );
    std::fs::write(
        folder.join("wide.csv"),
        "s_m,slope_rad,curvature_1pm,bank_rad,width\n0,0,0,0,1\n",
    )
    .expect("writable");
    refused(
        folder,
        &["simulate", "model.toml", "wide.csv"],
        3,
        &["wide.csv", "width", "unknown"],
    );
    std::fs::write(folder.join("bad.toml"), model.replace("mass_kg", "mass_lb")).expect("writable");
    refused(
        folder,
        &["simulate", "bad.toml", "track_w.csv"],
        3,
        &["bad.toml", "mass_lb"],
    );
}

/// SciPy and Octave read runs and forces as the CSV files and validation.json have them.
#[test]
fn scipy_and_octave_read_simulated_runs_and_their_validation() {
    let Some(interpreter) = kufe_outside::python("scipy") else {
        return;
    };
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "1"],
    );
    let (model, track) = ("sample/model.toml", "sample/track_east.csv");
    let words = [
        "simulate", model, track, "--runs", "2", "--mat", "-o", "out",
    ];
    succeeds(folder, &words);
    let runs = "out/runs.csv";
    succeeds(
        folder,
        &[
            "validate", runs, "--model", model, "--mat", "-o", "out", "--force",
        ],
    );
    octave(
        folder,
        "m = load('out/simulation.mat'); v = load('out/validation.mat'); j = jsondecode(fileread('out/validation.json'));\
         assert({m.series.run}, {'run_001', 'run_002'}); assert(strcmp(m.units.ax_mps2, 'm/s^2'));\
         assert([v.runs.rmse_n], [j.runs.rmse_n], -1e-12);\
         for s = v.series, assert(numel(s.measured_n), numel(s.model_n)); end;\
         assert(abs(sqrt(mean((v.series(2).measured_n - v.series(2).model_n) .^ 2)) / v.runs(2).rmse_n - 1) < 1e-6);",
    );
    let script = "import csv, json\n\
        import numpy as np\n\
        from scipy.io import loadmat\n\
        m = loadmat('out/simulation.mat', simplify_cells=True)\n\
        assert [s['run'] for s in m['series']] == ['run_001', 'run_002'], m['series']\n\
        for s in m['series']:\n\
        \x20   rows = list(csv.DictReader(open(f\"out/{s['run']}.csv\")))\n\
        \x20   for name in rows[0]:\n\
        \x20       assert np.allclose(s[name], [float(r[name]) for r in rows], rtol=0, atol=1e-9), name\n\
        assert m['units']['ax_mps2'] == 'm/s^2' and m['units']['t_s'] == 's'\n\
        v = loadmat('out/validation.mat', simplify_cells=True)\n\
        j = json.load(open('out/validation.json'))\n\
        assert len(v['series']) == len(j['runs']) == 2\n\
        for s, found, reported in zip(v['series'], v['runs'], j['runs']):\n\
        \x20   assert s['run'] == found['run'] == reported['run'] and found['rmse_n'] == reported['rmse_n']\n\
        \x20   rms = np.sqrt(np.mean((s['measured_n'] - s['model_n']) ** 2))\n\
        \x20   assert abs(rms / reported['rmse_n'] - 1) < 1e-6, (rms, reported['rmse_n'])\n\
        assert v['units']['rmse_n'] == 'N'\n";
    let output = std::process::Command::new(interpreter)
        .args(["-c", script])
        .current_dir(folder)
        .output()
        .expect("the interpreter that KUFE_PYTHON names");
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}
