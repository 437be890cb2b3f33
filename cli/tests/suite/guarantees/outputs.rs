//! What commands replace: nothing that they read, nothing that kufe did not write, no links.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::kufe::{Bench, CASE, errors, names, refused, succeeds};

const TABLE: &str = "case = \"case.toml\"\n[axes]\nfz_n = { values = [500.0, 1000.0] }\n\
                     curvature_1pm = { values = [0.0, 0.01] }\n";

/// A folder with a case, a table of it, its file and a rocker's points.
fn bench() -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write("t.toml", TABLE);
    bench.write("r.obj", "x_m,z_m\n-0.6,0.006\n0,0\n0.6,0.006\n");
    bench
}

/// All files of a folder and of the folders in it, with their content.
fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut found = Vec::new();
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            found.extend(content(&path));
        } else {
            found.push((
                path.display().to_string(),
                std::fs::read(&path).unwrap_or_default(),
            ));
        }
    }
    found
}

/// Runs a command that must exit with 3, name `parts`, and change no file.
fn is_refused(bench: &Bench, words: &[&str], parts: &[&str]) {
    let before = content(bench.folder.path());
    refused(bench.folder.path(), words, 3, parts);
    assert!(content(bench.folder.path()) == before, "{words:?}");
}

#[test]
fn no_command_writes_over_what_it_reads_also_with_force() {
    let bench = bench();
    bench.succeeds(&["lut", "t.toml", "-o", "t.lut", "-q"]);
    bench.succeeds(&["init", "model.toml", "--kind", "model", "-q"]);
    bench.write(
        "track_a.csv",
        "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n200,0.1,0,0\n400,0.1,0,0\n600,0.1,0,0\n",
    );
    let rows: [(&str, &str); 12] = [
        ("lut t.toml -o t.toml", "t.toml"),
        ("lut t.toml -o ./case.toml", "case.toml"),
        ("lut t.toml -o new/../case.toml", "case.toml"),
        ("lut t.toml -o u.lut --csv=case.toml", "case.toml"),
        ("lut t.toml -o u.lut --csv=u.csv --mat=u.csv", "u.csv"),
        ("lut export t.lut --csv=t.lut", "t.lut"),
        ("lut show t.lut -o t.lut", "t.lut"),
        ("report t.lut -o t.lut", "t.lut"),
        ("hull bob --rocker-points r.obj -o r.obj", "r.obj"),
        ("export case.toml --stiffness case.toml", "case.toml"),
        ("simulate model.toml track_a.csv -o .", "track_a.csv"),
        ("simulate model.toml --sample-data .", "model.toml"),
    ];
    for (words, output) in rows {
        let words: Vec<&str> = words.split(' ').collect();
        let words = [&words[..], &["--force"]].concat();
        is_refused(&bench, &words, &[output, "cannot be written"]);
    }
    // An earlier output as input, in a folder of the command's own.
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    let surface = CASE.replace("[track]", "surface = \"out/pressure.exr\"\n[track]");
    bench.write("surface.toml", surface);
    is_refused(
        &bench,
        &["press", "surface.toml", "-o", "out", "--force"],
        &["out/pressure.exr", "this command reads it"],
    );
    // A picture that a report reads.
    is_refused(
        &bench,
        &["report", "out", "-o", "out/pressure.png", "--force"],
        &["out/pressure.png", "this command reads it"],
    );
}

/// Folders, records and points that others made lead no command to another file.
#[cfg(unix)]
#[test]
fn foreign_records_links_and_points_lead_to_no_other_file() {
    use std::os::unix::fs::symlink;
    let bench = bench();
    bench.write("precious", "mine, all\n");
    for hash in ["", "0"] {
        std::fs::create_dir_all(bench.path("out")).expect("a folder");
        let record = format!(
            r#"{{"version":"0.1.0","command":"press","files":{{"../precious":{{"command":"press","sha256":["{hash}"]}}}}}}"#
        );
        bench.write("out/.kufe.json", record);
        bench.succeeds(&["press", "case.toml", "-o", "out", "-q", "--force"]);
        assert!(bench.path("precious").exists());
    }
    bench.succeeds(&["press", "case.toml", "-o", "archive", "-q"]);
    let archived = content(&bench.path("archive"));
    for (step, name) in [("step-001", "step-001"), ("step-002", "step-002")] {
        let series = bench.path(&format!("series-{name}"));
        std::fs::create_dir(&series).expect("a folder");
        bench.write(
            &format!("series-{name}/.kufe.json"),
            r#"{"version":"0.1.0","command":"press (series)","files":{}}"#,
        );
        symlink("../archive", series.join(step)).expect("a link");
        let out = format!("series-{name}");
        // A step of the series is refused where it is a link; one that the series does not have stays.
        let words = ["press", "case.toml", "--fz-n", "500", "-o", &out, "-q"];
        bench.kufe(&words);
        assert!(content(&bench.path("archive")) == archived, "{step}");
    }
    for (output, points) in [("t.lut", "t.lut.points"), ("u.lut", "u.lut.points")] {
        if output == "u.lut" {
            symlink("precious", bench.path(points)).expect("a link");
        } else {
            bench.write(points, "mine\n");
        }
        is_refused(&bench, &["lut", "t.toml", "-o", output], &[points]);
    }
    bench.succeeds(&["lut", "plan", "t.toml", "-o", "plan", "-q"]);
    bench.succeeds(&["lut", "plan", "t.toml", "-o", "plan", "-q"]);
    let script = std::fs::read_to_string(bench.path("plan/slurm.sh")).expect("a script");
    bench.write("plan/slurm.sh", script + "# mine\n");
    is_refused(
        &bench,
        &["lut", "plan", "t.toml", "-o", "plan"],
        &["slurm.sh", "--force"],
    );
}

#[test]
fn runs_and_tracks_that_an_index_names_are_inputs() {
    let bench = bench();
    bench.succeeds(&["lut", "t.toml", "-o", "t.lut", "-q"]);
    bench.succeeds(&["init", "model.toml", "--kind", "model", "-q"]);
    std::fs::create_dir(bench.path("runs")).expect("a folder");
    bench.write("runs/runs.csv", "run,file,track\na,a.csv,t\n");
    bench.write("runs/a.csv", "t_s,v_mps\n0,10\n0.01,10\n0.02,10\n");
    bench.write(
        "runs/track_t.csv",
        "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n200,0.1,0,0\n400,0.1,0,0\n600,0.1,0,0\n",
    );
    for output in ["runs.csv", "a.csv", "track_t.csv"] {
        let output = format!("runs/{output}");
        for words in [
            vec!["runs", "gather", "runs", "-o", &output],
            vec![
                "lut",
                "show",
                "t.lut",
                "--runs",
                "runs/runs.csv",
                "--model",
                "model.toml",
                "-o",
                &output,
            ],
        ] {
            let words = [&words[..], &["--force"]].concat();
            is_refused(&bench, &words, &[&output, "reads it"]);
        }
    }
}

#[test]
fn files_that_commands_name_by_themselves_replace_nothing() {
    let bench = bench();
    bench.succeeds(&["lut", "t.toml", "-o", "t.lut", "-q"]);
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    bench.write("log.csv", "Time [s],Speed [km/h]\n0,50\n0.1,50\n0.2,51\n");
    let rows = [
        ("lut export t.lut --fmu", "t.fmu"),
        ("lut export t.lut --mat", "t.mat"),
        ("lut export t.lut --csv", "t.csv"),
        ("lut export t.lut --header", "t.h"),
        ("lut export t.lut --simulink", "t_sfun.c"),
        ("lut export t.lut --simulink", "build_t.m"),
        ("lut show t.lut", "t.png"),
        ("report t.lut", "t.html"),
        ("report out", "out/report.html"),
        ("runs init log.csv", "mapping.schema.json"),
        ("runs init log.csv", "mapping.toml"),
        ("init fresh.toml", "case.schema.json"),
        ("init other.toml", "other.toml"),
        ("init new/../other.toml", "other.toml"),
        ("schema case -o other.json", "other.json"),
        ("hull bob -o other.stl", "other.stl"),
        ("hull check hull.stl -o other.toml", "other.toml"),
        ("lut plan t.toml -o plan", "plan/slurm.sh"),
        ("lut t.toml -o other.lut", "other.lut"),
        ("man --markdown other.md", "other.md"),
        (
            "export case.toml --stiffness other.mtx --cells 2",
            "other.mtx",
        ),
    ];
    std::fs::create_dir(bench.path("plan")).expect("a folder");
    bench.succeeds(&["hull", "bob", "-o", "hull.stl", "-q"]);
    for (words, output) in rows {
        bench.write(output, "mine");
        let words: Vec<&str> = words.split(' ').collect();
        is_refused(&bench, &words, &[output, "--force"]);
        bench.succeeds(&[&words[..], &["--force", "-q"]].concat());
        assert_ne!(std::fs::read(bench.path(output)).expect("there"), b"mine");
        bench.succeeds(&[&words[..], &["-q"]].concat());
        // Its own file, which the user changed: by one bit, and by a line.
        let own = std::fs::read(bench.path(output)).expect("there");
        let mut changed = own.clone();
        changed[own.len() / 2] ^= 1;
        for changed in [changed, [&own[..], b"\n% mine\n"].concat()] {
            bench.write(output, &changed);
            is_refused(&bench, &words, &[output, "--force"]);
        }
        std::fs::remove_file(bench.path(output)).expect("there");
        assert!(!bench.path("new").exists());
    }
}

#[test]
fn a_file_of_kufe_is_replaced_by_its_own_kind_alone() {
    let bench = bench();
    bench.succeeds(&["lut", "t.toml", "-o", "t.lut", "-q"]);
    bench.succeeds(&["lut", "t.toml", "-o", "other.lut", "-q"]);
    is_refused(
        &bench,
        &["lut", "export", "t.lut", "--header=other.lut"],
        &["other.lut", "--force"],
    );
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    is_refused(
        &bench,
        &["lut", "show", "t.lut", "-o", "out/pressure.png"],
        &["out/pressure.png", "kufe press wrote it"],
    );
}

#[test]
fn an_output_folder_is_new_empty_or_of_the_same_command() {
    let bench = bench();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    std::fs::create_dir(bench.path("mine")).expect("a folder");
    bench.write("mine/notes.txt", "mine");
    let runs = "sample/runs.csv --model sample/model.toml";
    let commands = [
        "press case.toml".to_owned(),
        "press case.toml --fz-n 800,1000".to_owned(),
        "mesh case.toml".to_owned(),
        format!("evaluate {runs}"),
        format!("validate {runs}"),
        format!("fit lateral {runs}"),
        format!("discover {runs}"),
        format!("runs align {runs}"),
        "runs check sample/runs.csv".to_owned(),
        "simulate sample/model.toml sample/track_west.csv".to_owned(),
        "man".to_owned(),
    ];
    for words in &commands {
        let words: Vec<&str> = words.split(' ').chain(["-o", "mine"]).collect();
        is_refused(
            &bench,
            &words,
            &["mine", "not empty", "notes.txt", "--force"],
        );
        let words = [&words[..words.len() - 1], &["sample"]].concat();
        refused(bench.folder.path(), &words, 3, &["sample"]);
    }
    is_refused(
        &bench,
        &["simulate", "--sample-data", "mine"],
        &["not empty"],
    );
    // With --force the rest of the folder stays.
    bench.succeeds(&["press", "case.toml", "-o", "mine", "--force", "-q"]);
    bench.succeeds(&["press", "case.toml", "-o", "mine", "-q"]);
    assert!(bench.path("mine/notes.txt").exists() && bench.path("mine/result.json").exists());
}

#[test]
fn a_run_removes_the_files_of_the_one_before_and_no_others() {
    let bench = bench();
    let elastic = CASE.replace("[ice]", "elastic = true\n[ice]");
    bench.write("elastic.toml", elastic);
    let rigid = ["press", "case.toml", "-o", "out", "-q"];
    bench.succeeds(&["press", "elastic.toml", "-o", "out", "--subsurface", "-q"]);
    bench.succeeds(&["report", "out", "-q"]);
    for name in ["runner.vtu", "subsurface.csv", "report.html"] {
        assert!(bench.path("out").join(name).exists(), "{name}");
    }
    bench.write("out/notes.txt", "mine");
    bench.succeeds(&rigid);
    let expected = [
        "contact.vtp",
        "field.vtu",
        "hull.glb",
        "notes.txt",
        "pressure.exr",
        "pressure.png",
        "result.json",
    ];
    assert_eq!(names(&bench.path("out")), expected);
    bench.write("out/hull.glb", "changed by hand");
    is_refused(
        &bench,
        &rigid,
        &["out/hull.glb", "changed since kufe wrote it"],
    );
    bench.succeeds(&[&rigid[..], &["--force"]].concat());
    // A series is no single contact, and one of fewer steps removes the others.
    let series = |case: &str, out: &str, loads: &str| {
        let words = ["press", case, "-o", out, "--fz-n", loads, "-q"];
        bench.kufe(&words)
    };
    let output = series("case.toml", "out", "800,1000");
    assert_eq!(output.status.code(), Some(3));
    assert!(errors(&output).contains("results of kufe press"));
    assert!(
        series("elastic.toml", "series", "800,900,1000")
            .status
            .success()
    );
    assert!(bench.path("series/runner.pvd").exists());
    bench.write("series/step-003/notes.txt", "mine");
    assert!(series("case.toml", "series", "800,1000").status.success());
    let expected = [
        "series.pvd",
        "step-001",
        "step-002",
        "step-003",
        "table.csv",
        "table.json",
    ];
    assert_eq!(names(&bench.path("series")), expected);
    assert_eq!(names(&bench.path("series/step-003")), ["notes.txt"]);
    assert!(!bench.path("series/step-001/runner.vtu").exists());
    let single = ["press", "case.toml", "-o", "series"];
    is_refused(&bench, &single, &["results of kufe press (series)"]);
}

#[test]
fn equal_commands_at_once_all_end_well() {
    let bench = bench();
    let press = ["press", "case.toml", "-o", "out", "-q"];
    let lut = ["lut", "t.toml", "-o", "t.lut", "-q"];
    for (round, words) in [press, lut, press, lut].iter().enumerate() {
        let start = |_| {
            Command::new(env!("CARGO_BIN_EXE_kufe"))
                .current_dir(bench.folder.path())
                .args(words)
                .stderr(Stdio::piped())
                .spawn()
                .expect("the command runs")
        };
        let children: Vec<_> = (0..4).map(start).collect();
        for child in children {
            let output = child.wait_with_output().expect("it ends");
            assert!(
                output.status.success(),
                "round {round}: {}",
                errors(&output)
            );
        }
        assert_eq!(names(&bench.path("out")).len(), 6);
        assert!(!bench.path("t.lut.points").exists());
    }
    assert!(bench.path("t.lut").exists());
}

#[test]
fn names_of_runs_and_tracks_do_not_lead_out_of_the_output() {
    let bench = Bench::new();
    bench.succeeds(&["simulate", "--sample-data", "sample", "-q"]);
    bench.write("precious.csv", "mine");
    let whole = bench.path("precious").display().to_string();
    let index = std::fs::read_to_string(bench.path("sample/runs.csv")).expect("an index");
    let mut lines = index.lines();
    let header = lines.next().expect("a header");
    let rows: Vec<&str> = lines.filter(|row| row.contains("east")).take(4).collect();
    let names = ["../precious", &whole, "a/b", "a_b"];
    let mut text = format!("{header}\n");
    for (row, name) in rows.iter().zip(names) {
        let (_, rest) = row.split_once(',').expect("cells");
        text += &format!("{name},{rest}\n");
    }
    bench.write("sample/hostile.csv", text);
    let folder = bench.folder.path();
    let align = "runs align sample/hostile.csv --model sample/model.toml -o out -q";
    succeeds(folder, &align.split(' ').collect::<Vec<_>>());
    for (k, name) in names.iter().enumerate() {
        let out = format!("again{k}");
        let replay = "simulate sample/model.toml sample/track_east.csv --replay sample/hostile.csv";
        let words: Vec<&str> = replay
            .split(' ')
            .chain(["-q", "-o", &out, "--run", name])
            .collect();
        succeeds(folder, &words);
    }
    assert_eq!(
        std::fs::read(bench.path("precious.csv")).expect("there"),
        b"mine"
    );
    let files = crate::kufe::names(&bench.path("out"));
    let runs = files.iter().filter(|name| name.ends_with(".csv")).count();
    // Four runs, their track and their index.
    assert_eq!(runs, 6, "{files:?}");
}

#[cfg(unix)]
#[test]
fn what_is_no_file_stays_and_links_are_followed_to_their_file() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let bench = bench();
    std::fs::create_dir(bench.path("folder.obj")).expect("a folder");
    let _socket = std::os::unix::net::UnixListener::bind(bench.path("socket.obj")).expect("one");
    symlink("nowhere/at/all.obj", bench.path("lost.obj")).expect("a link");
    for name in ["folder.obj", "socket.obj", "lost.obj"] {
        let words = ["hull", "bob", "-o", name, "--force"];
        is_refused(&bench, &words, &[name, "in the way"]);
    }
    let null = ["schema", "case", "-o", "/dev/null", "--force"];
    refused(bench.folder.path(), &null, 3, &["/dev/null", "a device"]);
    let found = std::fs::metadata("/dev/null").expect("there");
    assert!(found.file_type().is_char_device());
    bench.write("real.json", "mine");
    symlink("real.json", bench.path("link.json")).expect("a link");
    is_refused(
        &bench,
        &["schema", "case", "-o", "link.json"],
        &["link.json"],
    );
    bench.succeeds(&["schema", "case", "-o", "link.json", "-q", "--force"]);
    let link = bench.path("link.json").symlink_metadata().expect("there");
    assert!(link.file_type().is_symlink());
    let text = std::fs::read_to_string(bench.path("real.json")).expect("text");
    assert!(text.contains("case.toml"));
    // In an output folder a link is not followed.
    bench.write("elsewhere.json", "mine");
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    std::fs::remove_file(bench.path("out/result.json")).expect("there");
    symlink("../elsewhere.json", bench.path("out/result.json")).expect("a link");
    let words = ["press", "case.toml", "-o", "out", "--force"];
    is_refused(&bench, &words, &["out/result.json", "a link is in the way"]);
}

#[cfg(unix)]
#[test]
fn every_file_may_be_read_by_whom_any_other_new_file_may() {
    use std::os::unix::fs::PermissionsExt;
    let bench = bench();
    bench.write("other", "");
    bench.succeeds(&["press", "case.toml", "-o", "out", "--subsurface", "-q"]);
    let words = "lut t.toml -o out/t.lut -q --csv --header";
    bench.succeeds(&words.split(' ').collect::<Vec<_>>());
    bench.succeeds(&["lut", "show", "out/t.lut", "-q"]);
    let mode = |name: &str| {
        let found = std::fs::metadata(bench.path(name)).expect("there");
        found.permissions().mode()
    };
    for name in crate::kufe::names(&bench.path("out")) {
        assert_eq!(mode(&format!("out/{name}")), mode("other"), "{name}");
    }
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
            ["t.toml: axes.rocker_radius_m", "0.05 to 1e6, or inf"],
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

#[test]
fn hulls_state_that_kufe_wrote_them() {
    let bench = bench();
    for ending in ["obj", "stl", "glb"] {
        let name = format!("bob.{ending}");
        let hull = ["hull", "bob", "-q", "-o", &name];
        bench.succeeds(&hull);
        bench.succeeds(&[&hull[..], &["--edge-length-m", "0.01"]].concat());
        bench.succeeds(&["hull", "check", &name]);
        let bytes = std::fs::read(bench.path(&name)).expect("a hull");
        let mark = concat!("kufe ", env!("CARGO_PKG_VERSION")).as_bytes();
        let at = bytes.windows(mark.len()).position(|part| part == mark);
        let at = at.unwrap_or_else(|| panic!("no mark in {name}"));
        // The same file of another program.
        let mut foreign = bytes;
        foreign[at..at + 4].copy_from_slice(b"scan");
        bench.write(&name, &foreign);
        is_refused(&bench, &hull, &[&name, "--force"]);
    }
}
