//! An output takes the place of no input, of no other output, and of nothing that is no file.

use crate::kufe::{Bench, CASE, errors, refused};

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

/// Runs a command that must leave with 3, name the output, and leave the folder as it is, byte by byte.
fn kept(bench: &Bench, words: &[&str], output: &str) {
    let content = |bench: &Bench| -> Vec<(String, Option<Vec<u8>>)> {
        let names = bench.names().into_iter();
        names
            .map(|name| (name.clone(), std::fs::read(bench.path(&name)).ok()))
            .collect()
    };
    let before = content(bench);
    refused(
        bench.folder.path(),
        words,
        3,
        &[output, "cannot be written"],
    );
    assert_eq!(content(bench), before, "{words:?}");
}

#[test]
fn no_command_writes_over_what_it_reads() {
    let bench = bench();
    bench.succeeds(&["lut", "t.toml", "-o", "t.lut", "-q"]);
    bench.succeeds(&["init", "model.toml", "--kind", "model", "-q"]);
    bench.write(
        "track_a.csv",
        "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n200,0.1,0,0\n400,0.1,0,0\n600,0.1,0,0\n",
    );
    let rows: [(&[&str], &str); 12] = [
        (&["lut", "t.toml", "-o", "t.toml"], "t.toml"),
        (&["lut", "t.toml", "-o", "./case.toml"], "case.toml"),
        (
            &["lut", "t.toml", "-o", "u.lut", "--csv=case.toml"],
            "case.toml",
        ),
        (
            &["lut", "t.toml", "-o", "u.lut", "--csv=u.csv", "--mat=u.csv"],
            "u.csv",
        ),
        (&["lut", "export", "t.lut", "--csv=t.lut"], "t.lut"),
        (&["lut", "show", "t.lut", "-o", "t.lut"], "t.lut"),
        (&["report", "t.lut", "-o", "t.lut"], "t.lut"),
        (
            &["hull", "bob", "--rocker-points", "r.obj", "-o", "r.obj"],
            "r.obj",
        ),
        (
            &["export", "case.toml", "--stiffness", "case.toml"],
            "case.toml",
        ),
        (&["init", "case.schema.json"], "case.schema.json"),
        (
            &["simulate", "model.toml", "track_a.csv", "-o", "."],
            "track_a.csv",
        ),
        (
            &["simulate", "model.toml", "--sample-data", "."],
            "model.toml",
        ),
    ];
    for (words, output) in rows {
        if words[0] == "init" {
            std::fs::remove_file(bench.path("case.schema.json")).unwrap_or_default();
        }
        kept(&bench, words, output);
    }
}

#[test]
fn an_output_folder_keeps_the_inputs_in_it() {
    let bench = bench();
    std::fs::create_dir(bench.path("out")).expect("a folder");
    bench.write("out/pressure.exr", "a measured surface");
    let surface = CASE.replace("[track]", "surface = \"out/pressure.exr\"\n[track]");
    bench.write("case.toml", &surface);
    refused(
        bench.folder.path(),
        &["press", "case.toml", "-o", "out"],
        3,
        &["out/pressure.exr", "this command reads it"],
    );
    let kept = std::fs::read_to_string(bench.path("out/pressure.exr")).expect("still there");
    assert_eq!(kept, "a measured surface");
}

#[test]
fn recorded_runs_are_not_replaced_by_simulated_ones() {
    let bench = Bench::new();
    bench.write("runs.csv", "run,file\nmine,mine.csv\n");
    kept(&bench, &["simulate", "--sample-data", "."], "runs.csv");
}

#[test]
fn a_schema_that_is_not_kufes_stays_and_one_that_is_comes_anew() {
    let bench = Bench::new();
    bench.write("case.schema.json", "{\"title\": \"mine\"}");
    let output = bench.kufe(&["init"]);
    assert_eq!(output.status.code(), Some(3));
    assert!(errors(&output).contains("case.schema.json: exists already"));
    assert_eq!(bench.names(), ["case.schema.json"]);
    bench.succeeds(&["init", "--force", "-q"]);
    std::fs::remove_file(bench.path("case.toml")).expect("written");
    bench.succeeds(&["init", "-q"]);
}

#[cfg(unix)]
#[test]
fn links_are_written_through_and_what_is_no_file_stays() {
    use std::os::unix::fs::{FileTypeExt, symlink};
    let bench = bench();
    std::fs::create_dir(bench.path("folder.obj")).expect("a folder");
    let _socket = std::os::unix::net::UnixListener::bind(bench.path("socket.obj")).expect("one");
    symlink("nowhere/at/all.obj", bench.path("lost.obj")).expect("a link");
    for name in ["folder.obj", "socket.obj", "lost.obj"] {
        let found = || {
            bench
                .path(name)
                .symlink_metadata()
                .expect("there")
                .file_type()
        };
        let before = found();
        refused(
            bench.folder.path(),
            &["hull", "bob", "-o", name],
            3,
            &[name, "in the way"],
        );
        assert_eq!(found(), before);
    }
    refused(
        bench.folder.path(),
        &["schema", "case", "-o", "/dev/null"],
        3,
        &["/dev/null", "a device"],
    );
    let null = std::fs::metadata("/dev/null").expect("there");
    assert!(null.file_type().is_char_device());
    bench.write("real.json", "");
    symlink("real.json", bench.path("link.json")).expect("a link");
    bench.succeeds(&["schema", "case", "-o", "link.json", "-q"]);
    let link = bench.path("link.json").symlink_metadata().expect("there");
    assert!(link.file_type().is_symlink());
    let text = std::fs::read_to_string(bench.path("real.json")).expect("text");
    assert!(text.contains("case.toml"));
    // In an output folder too.
    std::fs::create_dir(bench.path("out")).expect("a folder");
    bench.write("elsewhere.json", "");
    symlink("../elsewhere.json", bench.path("out/result.json")).expect("a link");
    bench.succeeds(&["press", "case.toml", "-o", "out", "-q"]);
    let link = bench
        .path("out/result.json")
        .symlink_metadata()
        .expect("there");
    assert!(link.file_type().is_symlink());
    assert!(
        bench
            .path("elsewhere.json")
            .metadata()
            .expect("there")
            .len()
            > 100
    );
}

#[cfg(unix)]
#[test]
fn every_file_may_be_read_by_whom_any_other_new_file_may() {
    use std::os::unix::fs::PermissionsExt;
    let bench = bench();
    bench.write("other", "");
    bench.succeeds(&["press", "case.toml", "-o", "out", "--subsurface", "-q"]);
    bench.succeeds(&[
        "lut",
        "t.toml",
        "-o",
        "out/t.lut",
        "-q",
        "--csv",
        "--header",
    ]);
    bench.succeeds(&["lut", "show", "out/t.lut", "-q"]);
    let mode = |name: &str| {
        let found = std::fs::metadata(bench.path(name)).expect("there");
        found.permissions().mode()
    };
    for name in crate::kufe::names(&bench.path("out")) {
        assert_eq!(mode(&format!("out/{name}")), mode("other"), "{name}");
    }
}
