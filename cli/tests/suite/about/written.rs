//! `kufe report` of every folder that a command writes, and `kufe info` of results.

use std::path::{Path, PathBuf};

use crate::kufe::{Bench, CASE, errors};

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

/// The outputs of commands for a contact, a table, and runs.
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
fn report_shows_every_folder_and_info_every_result() {
    let bench = written();
    for file in files(bench.folder.path()) {
        let name = file.display().to_string();
        let ending = file.extension().unwrap_or_default().to_string_lossy();
        let is_note = name.ends_with(".import.json") || name.contains("schema");
        if ["glb", "lut", "fmu", "exr", "json"].contains(&&*ending) && !is_note {
            let printed = bench.succeeds(&["info", &name]);
            assert!(
                !printed.contains("null") && printed.lines().count() >= 3,
                "{name}: {printed}"
            );
        }
    }
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
    let printed = errors(&bench.kufe(&["report", "tables"]));
    assert!(
        printed.contains("kufe report tables/front.lut"),
        "{printed}"
    );
    let printed = errors(&bench.kufe(&["report", "plan"]));
    assert!(printed.contains("kufe lut merge plan"), "{printed}");
}
