//! `kufe info` of every file that commands write, and `kufe report` of every folder.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::kufe::{Bench, CASE, errors, refused};

/// All files below a folder; what is hidden is between runs of a command.
fn files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let hidden = path
            .file_name()
            .is_some_and(|name| name.to_string_lossy().starts_with('.'));
        if path.is_dir() && !hidden {
            found.extend(files(&path));
        } else if !hidden {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// What commands leave of a contact, a table, and runs.
fn written() -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write(
        "front.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\ncurvature_1pm = { values = [0.0, 0.01] }\n",
    );
    let sliding =
        CASE.replace("p_max = 0.02", "p_max = 0.1") + "[sliding]\nv_mps = 20.0\nice_c = -5.0\n";
    bench.write(
        "sliding.toml",
        sliding.replace("[load]\n", "[load]\ntilt = \"fixed\"\n"),
    );
    let runs = ["sample/runs.csv", "--model", "sample/model.toml", "-o"];
    let on_runs = |command: &[&str], out: &str| {
        let words = [command, &runs, &[out]].concat();
        bench.succeeds(&words);
    };
    for words in [
        "press case.toml -o out --subsurface --mat",
        "press sliding.toml -o slid",
        "press case.toml -o series --fz-n 500,1000",
        "lut front.toml --csv --mat --header --fmu --simulink -o tables/front.lut",
        "lut plan front.toml -o plan --shards 2",
        "lut run plan --shard 1/2",
        "mesh case.toml -o mesh",
        "export case.toml --stiffness K.mtx --cells 2",
        "hull bob -o bob.glb",
        "init model.toml --kind model",
        "friction sliding.toml --groove --v-mps 20 --ice-c -5 -o friction",
        "simulate --sample-data sample --seed 1",
        "simulate sample/model.toml sample/track_west.csv -o simulated --runs 1 --seed 3 --mat",
        "runs check sample/runs.csv -o check",
        "runs gather sample -o all.csv",
        "report out",
    ] {
        bench.succeeds(&words.split(' ').collect::<Vec<_>>());
    }
    on_runs(&["fit", "lateral"], "fit");
    on_runs(&["validate", "--mat"], "validation");
    on_runs(&["evaluate"], "evaluation");
    on_runs(&["runs", "align"], "aligned");
    bench
}

#[test]
#[ignore = "slow study: .ci/slow"]
fn info_tells_every_file_that_a_command_has_written_and_report_shows_every_folder() {
    let bench = written();
    let files = files(bench.folder.path());
    let mut endings: Vec<String> = Vec::new();
    for file in &files {
        let name = file
            .strip_prefix(bench.folder.path())
            .expect("below")
            .display()
            .to_string();
        let facts: Value =
            serde_json::from_str(&bench.succeeds(&["info", &name, "--json"])).expect("JSON");
        assert!(
            facts["kind"].as_str().is_some_and(|kind| !kind.is_empty()),
            "{name}: {facts}"
        );
        assert_eq!(
            facts["size_bytes"],
            file.metadata().expect("a file").len(),
            "{name}"
        );
        let said = bench.succeeds(&["info", &name]);
        assert!(
            !said.contains("null") && said.lines().count() >= 3,
            "{name}: {said}"
        );
        endings.extend(
            file.extension()
                .map(|ending| ending.to_string_lossy().into_owned()),
        );
    }
    endings.sort();
    endings.dedup();
    let expected = "c csv exr fmu glb h html json lut m mat mtx png sh toml vtp vtu";
    for ending in expected.split(' ') {
        assert!(
            endings.iter().any(|found| found == ending),
            "no .{ending} in {endings:?}"
        );
    }

    let facts = |name: &str| -> Value {
        serde_json::from_str(&bench.succeeds(&["info", name, "--json"])).expect("JSON")
    };
    let version = env!("CARGO_PKG_VERSION");
    // A document names its command, its version and its case.
    let result = facts("out/result.json");
    assert_eq!(
        (&result["kind"], &result["written_by"]),
        (&"a solved contact".into(), &"kufe press".into())
    );
    assert_eq!(
        (&result["version"], &result["case"]["load"]["fz_n"]),
        (&version.into(), &1000.0.into())
    );
    // A file without words of its own says what it was written with.
    for name in [
        "field.vtu",
        "pressure.exr",
        "contact.vtp",
        "hull.glb",
        "subsurface.csv",
    ] {
        let facts = facts(&format!("out/{name}"));
        assert_eq!(facts["written_with"]["version"], version, "{name}: {facts}");
        assert_eq!(
            facts["written_with"]["case"]["load"]["fz_n"], 1000.0,
            "{name}"
        );
    }
    let vtu = facts("out/field.vtu");
    assert!(
        vtu["points"].as_u64() > Some(1000)
            && vtu["fields"]
                .as_str()
                .is_some_and(|f| f.contains("von_mises_pa")),
        "{vtu}"
    );
    assert_eq!(
        facts("out/pressure.png")["drawn_by"],
        format!("kufe {version}")
    );
    let mat = facts("out/result.mat");
    assert_eq!(mat["variables"]["p_max_pa"], "1 x 1");
    assert!(
        mat["origin"]
            .as_str()
            .is_some_and(|origin| origin.contains(version)),
        "{mat}"
    );
    let fmu = facts("tables/front.fmu");
    assert_eq!(
        (&fmu["nodes"], &fmu["version"]),
        (&4.into(), &version.into())
    );
    assert_eq!(facts("tables/front.h")["version"], version);
    let index = facts("sample/runs.csv");
    assert_eq!(
        (&index["runs"], &index["tracks"]),
        (&44.into(), &"east, west".into())
    );
    let run = facts("sample/A1-01.csv");
    assert!(
        (run["rate_hz"].as_f64().unwrap_or(0.0) - 500.0).abs() < 1.0,
        "{run}"
    );
    assert!(run["columns"]["v_mps"]["to"].as_f64() > Some(20.0), "{run}");
    assert!(
        bench
            .succeeds(&["info", "sample/A1-01.csv"])
            .contains(" m/s\n")
    );

    // A page of each folder, or the command that shows it.
    for folder in [
        "out",
        "slid",
        "series",
        "friction",
        "fit",
        "validation",
        "evaluation",
        "simulated",
        "aligned",
        "check",
        "mesh",
        "sample",
    ] {
        bench.succeeds(&["report", folder, "-o", "page.html"]);
        let page = std::fs::read_to_string(bench.path("page.html")).expect("a page");
        assert!(
            page.contains("<h1") || page.contains("id=\"data\""),
            "{folder}"
        );
    }
    let said = errors(&bench.kufe(&["report", "tables"]));
    assert!(said.contains("kufe report tables/front.lut"), "{said}");
    let said = errors(&bench.kufe(&["report", "plan"]));
    assert!(said.contains("kufe lut merge plan"), "{said}");
}

#[test]
fn files_that_are_not_known_end_with_one_error_that_says_what_was_expected() {
    let bench = Bench::new();
    for (name, content, expected) in [
        ("notes.txt", "hello", "kind \".txt\" is not known"),
        ("a.json", "{\"a\": 1}", "a JSON document that is not known"),
        ("b.json", "{", "b.json: EOF"),
        ("a.csv", "one,two\n1,2\n", "its columns one, two"),
        ("a.toml", "answer = 42\n", "keys that are not known"),
        ("a.vtu", "<html></html>", "no VTK file"),
        ("a.png", "GIF89a", "no PNG"),
        ("short.png", "\u{89}PNG", "no PNG"),
        ("a.mat", "MATLAB", "cannot be read"),
        ("a.fmu", "PK", "a.fmu: "),
        ("a.h", "#define KUFE 1\n", "not of kufe"),
        ("a.html", "<p>kufe </p>", "not of kufe"),
    ] {
        bench.write(name, content);
        refused(bench.folder.path(), &["info", name], 3, &[expected]);
    }
    refused(bench.folder.path(), &["info", "."], 3, &["is a folder"]);
    refused(
        bench.folder.path(),
        &["info", "nothing.json"],
        3,
        &["cannot be read"],
    );
}
