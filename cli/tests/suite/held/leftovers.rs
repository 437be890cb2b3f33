//! What a run did not write does not stand beside what it wrote, and what is not kufe's stays.

use crate::kufe::{Bench, CASE, json, names, refused};

fn elastic() -> String {
    CASE.replace("[ice]", "elastic = true\n[ice]")
}

#[test]
fn a_run_takes_the_files_of_the_one_before_away_and_no_others() {
    let bench = Bench::new();
    bench.write("elastic.toml", elastic());
    bench.write("rigid.toml", CASE);
    bench.succeeds(&["press", "elastic.toml", "-o", "out", "--subsurface", "-q"]);
    bench.succeeds(&["report", "out", "-q"]);
    for name in [
        "runner.vtu",
        "subsurface.csv",
        "subsurface.png",
        "report.html",
    ] {
        assert!(bench.path("out").join(name).exists(), "{name}");
    }
    // The user's own, one of them under a name of kufe's and of another length than it wrote.
    bench.write("out/notes.txt", "mine");
    bench.write("out/subsurface.csv", "mine too");
    bench.succeeds(&["press", "rigid.toml", "-o", "out", "-q"]);
    assert_eq!(
        names(&bench.path("out")),
        [
            "contact.vtp",
            "field.vtu",
            "hull.glb",
            "notes.txt",
            "pressure.exr",
            "pressure.png",
            "result.json",
            "subsurface.csv"
        ]
    );
    let listed = json(&bench.path("out/result.json"));
    let length = listed["files"]["pressure.exr"].as_u64();
    let found = std::fs::metadata(bench.path("out/pressure.exr")).expect("there");
    assert_eq!(length, Some(found.len()));
}

#[test]
fn a_single_contact_is_not_put_among_the_steps_of_a_series() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.succeeds(&[
        "press",
        "case.toml",
        "-o",
        "out",
        "--fz-n",
        "800,1000",
        "-q",
    ]);
    refused(
        bench.folder.path(),
        &["press", "case.toml", "-o", "out"],
        3,
        &["out", "holds a series of 2 steps"],
    );
}

#[test]
fn a_series_takes_a_single_contact_and_the_steps_it_lacks_away() {
    let bench = Bench::new();
    bench.write("elastic.toml", elastic());
    bench.write("case.toml", CASE);
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    bench.succeeds(&[
        "press",
        "elastic.toml",
        "-o",
        "out",
        "--fz-n",
        "800,900,1000",
        "-q",
    ]);
    assert!(bench.path("out/runner.pvd").exists() && !bench.path("out/result.json").exists());
    bench.write("out/step-003/notes.txt", "mine");
    bench.succeeds(&[
        "press",
        "case.toml",
        "-o",
        "out",
        "--fz-n",
        "800,1000",
        "-q",
    ]);
    assert_eq!(
        names(&bench.path("out")),
        [
            "series.pvd",
            "step-001",
            "step-002",
            "step-003",
            "table.csv",
            "table.json"
        ]
    );
    assert_eq!(names(&bench.path("out/step-003")), ["notes.txt"]);
    assert!(!bench.path("out/step-001/runner.vtu").exists());
}

#[test]
fn bad_axes_leave_no_folder_of_points_and_are_named_with_their_line() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let before = ["case.toml", "t.toml"];
    let good = "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\ncurvature_1pm = { values = [0.0] }\n";
    for (from, to, parts) in [
        ("500.0, 1000.0", "1000.0, 500.0", ["t.toml: line 3", "fz_n"]),
        (
            "[0.0]",
            "[1e300]",
            ["t.toml: axes.curvature_1pm", "-1 to 1"],
        ),
        (
            "500.0, 1000.0",
            "1e-300, 1000.0",
            ["t.toml: axes.fz_n", "0.001 to 1e7"],
        ),
        (
            "[0.0] }",
            "[0.0] }\nrocker_radius_m = { values = [1e-300] }",
            ["t.toml: axes.rocker_radius_m", "0.05 to inf"],
        ),
        (
            "curvature_1pm = { values = [0.0] }",
            "curvature_1pm = { from = 0.0, to = 0.01 }\n[accuracy]\ninterpolation = 1e-4",
            ["accuracy.interpolation = 0.0001", "0.0005"],
        ),
    ] {
        bench.write("t.toml", good.replace(from, to));
        refused(bench.folder.path(), &["lut", "t.toml"], 3, &parts);
        assert_eq!(bench.names(), before, "{to}");
    }
}
