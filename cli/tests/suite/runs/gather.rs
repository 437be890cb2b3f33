//! `kufe runs gather`: three days of runs in one index, from folders with and without indices.

use std::path::Path;

use crate::kufe::{Bench, errors, json, refused};

/// A few samples at a speed.
fn run(v: f64) -> String {
    let rows = (0..50).map(|k| format!("{:.2},{v},0.0\n", 0.01 * f64::from(k)));
    format!("t_s,v_mps,yaw_rate_radps\n{}", rows.collect::<String>())
}

fn days() -> Bench {
    let bench = Bench::new();
    for day in ["monday", "tuesday", "raw/wednesday"] {
        std::fs::create_dir_all(bench.path(day)).expect("a folder");
    }
    bench.write("monday/runs.csv", "run,file,track,driver,session,ice_c\nA1,a1.csv,igls,anna,d1,-5\nA2,a2.csv,igls,bert,d1,-6\n");
    bench.write(
        "monday/track_igls.csv",
        "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.1,0,0\n10,0.1,0,0\n20,0.1,0,0\n30,0.1,0,0\n",
    );
    bench.write(
        "tuesday/runs.csv",
        "run,file,track,ice_c@350\nA1,first.csv,igls,-7.5\nB1,second.csv,igls,\n",
    );
    for (k, file) in [
        "monday/a1",
        "monday/a2",
        "tuesday/first",
        "tuesday/second",
        "raw/wednesday/C1",
        "raw/wednesday/C2",
    ]
    .iter()
    .enumerate()
    {
        bench.write(&format!("{file}.csv"), run(20.0 + k as f64));
    }
    bench.write("raw/wednesday/notes.csv", "what,when\nrain,noon\n");
    bench
}

fn rows(path: &Path) -> Vec<Vec<String>> {
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .from_path(path)
        .expect("an index");
    reader
        .records()
        .map(|row| row.expect("a row").iter().map(str::to_owned).collect())
        .collect()
}

#[test]
fn three_days_become_one_index_whose_runs_are_found_and_whose_columns_are_united() {
    let bench = days();
    let printed = bench.succeeds(&[
        "runs",
        "gather",
        "monday",
        "tuesday/runs.csv",
        "raw/wednesday",
        "monday/a2.csv",
        "-o",
        "all/runs.csv",
        "--session-from-folder",
        "--track",
        "igls",
        "--driver",
        "carl",
    ]);
    for line in [
        "runs: 6",
        "sessions: d1, tuesday, wednesday",
        "drivers: anna, bert, carl",
        "tracks: igls",
    ] {
        assert!(printed.contains(&format!("{line}\n")), "{printed}");
    }
    assert!(printed.contains("monday_A1, tuesday_A1"), "{printed}");
    assert!(
        printed.contains("notes.csv: no run") && printed.contains("it is run A2 already"),
        "{printed}"
    );
    let rows = rows(&bench.path("all/runs.csv"));
    assert_eq!(
        rows[0].join(","),
        "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa,ice_c@350"
    );
    let reported: Vec<String> = rows[1..].iter().map(|row| row.join(",")).collect();
    assert_eq!(
        reported,
        [
            "monday_A1,../monday/a1.csv,igls,anna,unnamed,d1,-5,,,",
            "A2,../monday/a2.csv,igls,bert,unnamed,d1,-6,,,",
            "tuesday_A1,../tuesday/first.csv,igls,carl,unnamed,tuesday,,,,-7.5",
            "B1,../tuesday/second.csv,igls,carl,unnamed,tuesday,,,,",
            "C1,../raw/wednesday/C1.csv,igls,carl,unnamed,wednesday,,,,",
            "C2,../raw/wednesday/C2.csv,igls,carl,unnamed,wednesday,,,,",
        ]
    );
    // The track's table is where commands look for it, and nothing else was copied.
    assert_eq!(
        crate::kufe::names(&bench.path("all")),
        ["runs.csv", "track_igls.csv"]
    );
    // Another command reads what the index names.
    bench.kufe(&["runs", "check", "all/runs.csv", "-o", "check"]);
    assert_eq!(
        json(&bench.path("check/check.json"))["runs"]
            .as_array()
            .map(Vec::len),
        Some(6)
    );
}

#[test]
fn copies_lie_next_to_their_index_and_bring_the_same_numbers() {
    let bench = days();
    bench.succeeds(&[
        "runs",
        "gather",
        "monday",
        "tuesday",
        "-o",
        "kept/runs.csv",
        "--copy",
        "-q",
    ]);
    assert_eq!(
        crate::kufe::names(&bench.path("kept")),
        [
            "A2.csv",
            "B1.csv",
            "monday_A1.csv",
            "runs.csv",
            "track_igls.csv",
            "tuesday_A1.csv"
        ]
    );
    let read = |name: &str| std::fs::read(bench.path(name)).expect("a file");
    assert_eq!(read("kept/tuesday_A1.csv"), read("tuesday/first.csv"));
    assert_eq!(rows(&bench.path("kept/runs.csv"))[3][1], "tuesday_A1.csv");
}

#[test]
fn what_cannot_be_gathered_is_refused_and_nothing_is_written() {
    let bench = days();
    let folder = bench.folder.path();
    let gather = |words: &[&str], parts: &[&str]| {
        let words = [&["runs", "gather"], words].concat();
        refused(folder, &words, 3, parts);
    };
    bench.write("there.csv", "mine");
    gather(
        &["monday", "-o", "there.csv"],
        &["there.csv", "exists already"],
    );
    gather(&["raw", "-o", "new.csv"], &["raw: no runs"]);
    gather(&["absent", "-o", "new.csv"], &["absent: "]);
    std::fs::remove_file(bench.path("tuesday/second.csv")).expect("a file");
    gather(
        &["tuesday", "-o", "new.csv"],
        &["tuesday/runs.csv: run B1", "no such file"],
    );
    bench.write("tuesday/second.csv", run(30.0));
    bench.write(
        "tuesday/track_igls.csv",
        "s_m,slope_rad,curvature_1pm,bank_rad\n0,0.2,0,0\n10,0.1,0,0\n20,0.1,0,0\n30,0.1,0,0\n",
    );
    gather(
        &["monday", "tuesday", "-o", "new.csv"],
        &["expected one table of track igls"],
    );
    for day in ["x/day", "y/day"] {
        std::fs::create_dir_all(bench.path(day)).expect("a folder");
        bench.write(&format!("{day}/A.csv"), run(10.0));
    }
    gather(
        &["x/day", "y/day", "-o", "new.csv"],
        &["run \"day_A\"", "x/day/A.csv"],
    );
    assert!(!bench.path("new.csv").exists());
    // Runs that state no session are reported of.
    let printed = errors(&bench.kufe(&["runs", "gather", "raw/wednesday", "-o", "new.csv"]));
    assert!(
        printed.contains("2 of 2 runs state no session"),
        "{printed}"
    );
}

#[cfg(unix)]
#[test]
fn only_runs_are_copied_and_no_links_out_of_their_folder() {
    let bench = days();
    bench.write("secret.csv", "user,password\nanna,1234\n");
    bench.write("other.csv", run(30.0));
    std::fs::create_dir(bench.path("elsewhere")).expect("a folder");
    bench.write("elsewhere/run.csv", run(30.0));
    let link = |to: &str, name: &str| {
        std::os::unix::fs::symlink(to, bench.path(name)).expect("a link");
    };
    link("../other.csv", "tuesday/link.csv");
    link("link.csv", "tuesday/twice.csv");
    link("../elsewhere", "tuesday/folder");
    for (file, part) in [
        ("../secret.csv", "no columns t_s and v_mps"),
        ("link.csv", "a link leads to it, out of its folder"),
        ("twice.csv", "a link leads to it, out of its folder"),
        ("folder/run.csv", "a link leads to it, out of its folder"),
    ] {
        bench.write("tuesday/runs.csv", format!("run,file\nA1,{file}\n"));
        let words = ["runs", "gather", "tuesday", "-o", "all/runs.csv", "--copy"];
        refused(bench.folder.path(), &words, 3, &[part]);
        assert!(!bench.path("all").exists());
    }
    // Neither by a table of a track, which is copied with or without --copy.
    bench.write("tuesday/runs.csv", "run,file,track\nA1,first.csv,lost\n");
    link("../secret.csv", "tuesday/track_lost.csv");
    let words = ["runs", "gather", "tuesday", "-o", "all/runs.csv"];
    refused(
        bench.folder.path(),
        &words,
        3,
        &["track_lost.csv", "a link that leads out"],
    );
    // A link within the folder, and a folder that is a link itself, are what the user named.
    std::fs::remove_file(bench.path("tuesday/track_lost.csv")).expect("there");
    link("second.csv", "tuesday/inner.csv");
    link("tuesday", "linked");
    bench.write("tuesday/runs.csv", "run,file\nA1,inner.csv\n");
    bench.succeeds(&["runs", "gather", "linked", "-o", "all/runs.csv", "--copy"]);
    assert!(bench.path("all/A1.csv").is_file());
}
