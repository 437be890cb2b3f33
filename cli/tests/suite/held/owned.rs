//! A command replaces what kufe wrote and nothing else, and takes no file of another command's result.

use crate::kufe::{Bench, CASE, json, names, refused, succeeds};

/// Runs `words` in a folder whose `out` holds one foreign file, which stays alone there.
fn stays(bench: &Bench, name: &str, words: &[&str]) {
    let out = bench.path("out");
    let _ = std::fs::remove_dir_all(&out);
    std::fs::create_dir(&out).expect("a folder");
    let mine = "{\"a\": 1, \"mine\": \"no version of anything\"}";
    std::fs::write(out.join(name), mine).expect("a file");
    let told = ["kufe did not write it", name];
    refused(bench.folder.path(), words, 3, &told);
    assert_eq!(names(&out), [name], "{words:?}");
    let kept = std::fs::read_to_string(out.join(name)).expect("still there");
    assert_eq!(kept, mine, "{words:?}");
}

#[test]
fn a_file_that_kufe_did_not_write_is_not_replaced() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    let press = ["press", "case.toml", "-o", "out"];
    for name in ["field.vtu", "result.json", "pressure.png"] {
        stays(&bench, name, &press);
    }
    stays(&bench, "result.mat", &[&press[..], &["--mat"]].concat());
    for name in ["table.csv", "series.pvd"] {
        stays(
            &bench,
            name,
            &[&press[..], &["--fz-n", "800,1000"]].concat(),
        );
    }
    stays(&bench, "ice.vtu", &["mesh", "case.toml", "-o", "out"]);
    let runs = ["sample/runs.csv", "--model", "sample/model.toml"];
    for (command, name) in [
        (&["evaluate"][..], "evaluation.csv"),
        (&["evaluate"], "angles.png"),
        (&["validate"], "rmse.png"),
        (&["fit", "lateral"], "model.fit.toml"),
        (&["discover"], "model.next.toml"),
    ] {
        let words = [command, &runs, &["-o", "out"]].concat();
        stays(&bench, name, &words);
    }
    stays(
        &bench,
        "check.html",
        &["runs", "check", "sample/runs.csv", "-o", "out"],
    );
}

#[test]
fn what_someone_changed_is_not_replaced_and_earlier_versions_results_are() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let press = ["press", "case.toml", "-o", "out", "-q"];
    bench.succeeds(&press);
    // Before documents listed their files.
    let mut result = json(&bench.path("out/result.json"));
    result.as_object_mut().expect("keys").shift_remove("files");
    bench.write("out/result.json", result.to_string());
    bench.write("out/field.vtu", "of an earlier version");
    bench.succeeds(&press);
    bench.write("out/hull.glb", "changed by hand");
    refused(
        bench.folder.path(),
        &press,
        3,
        &["out/hull.glb", "changed since kufe wrote it"],
    );
    bench.write("out/hull.glb", "");
    bench.succeeds(&press);
}

#[test]
fn no_command_replaces_a_file_of_another_ones_result() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write(
        "elastic.toml",
        CASE.replace("[ice]", "elastic = true\n[ice]"),
    );
    bench.succeeds(&["mesh", "elastic.toml", "-o", "out", "-q"]);
    let before = names(&bench.path("out"));
    assert!(before.contains(&"runner.vtu".to_owned()), "{before:?}");
    let told = ["out: ", "by kufe mesh"];
    refused(bench.folder.path(), &["press", "elastic.toml"], 3, &told);
    assert_eq!(names(&bench.path("out")), before);
    // What writes other files may stand beside it.
    bench.succeeds(&["press", "case.toml", "-q"]);
}

#[test]
fn commands_may_write_beside_what_they_read_and_beside_files_of_other_names() {
    let bench = Bench::new();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    let runs = ["sample/runs.csv", "--model", "sample/model.toml"];
    for command in [&["fit", "lateral"][..], &["validate"], &["evaluate"]].repeat(2) {
        bench.succeeds(&[command, &runs, &["-o", "out", "-q"]].concat());
    }
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    succeeds(
        bench.folder.path(),
        &["runs", "check", "sample/runs.csv", "-o", "sample", "-q"],
    );
}

#[test]
fn runs_of_an_earlier_simulation_go() {
    let bench = Bench::new();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    let drive = |runs: &str| {
        let words = ["simulate", "sample/model.toml", "sample/track_west.csv"];
        bench.succeeds(&[&words[..], &["-o", "out", "-q", "--runs", runs]].concat());
        names(&bench.path("out"))
    };
    assert!(drive("3").contains(&"run_003.csv".to_owned()));
    bench.write("out/notes.txt", "mine");
    let left = drive("1");
    assert!(!left.contains(&"run_003.csv".to_owned()), "{left:?}");
    assert!(left.contains(&"notes.txt".to_owned()));
}
