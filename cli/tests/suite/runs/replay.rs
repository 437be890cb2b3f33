//! `kufe simulate --replay`.

use crate::kufe::{json, refused, succeeds};

#[test]
fn a_replay_writes_run_figures_picture_and_page_and_refuses_by_name() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "1"],
    );
    let (model, track) = ("sample/model.toml", "sample/track_east.csv");
    let with = |more: &[&str]| -> Vec<String> {
        let words = ["simulate", model, track, "--replay"];
        words.iter().chain(more).map(ToString::to_string).collect()
    };
    let call = |more: &[&str]| {
        let words = with(more);
        succeeds(
            folder,
            &words.iter().map(String::as_str).collect::<Vec<_>>(),
        )
    };
    let fails = |more: &[&str], parts: &[&str]| {
        let words = with(more);
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        refused(folder, &words, 3, parts);
    };
    let run = ["sample/runs.csv", "--run", "A2-03"];
    call(&[&run[..], &["--view", "-o", "again"]].concat());
    let document = json(&folder.join("again/simulation.json"));
    let replay = &document["replay"];
    let difference = |column: &str| {
        let all = replay["differences"].as_array().expect("differences");
        let found = all
            .iter()
            .find(|d| d["column"] == column)
            .expect("a column");
        found["rms"].as_f64().expect("a number")
    };
    // The model is the one that it was driven with: noise of the start, and pushes that the model does not get.
    assert!(
        difference("t_s") < 0.05 && difference("v_mps") < 0.05,
        "{replay}"
    );
    let sections = replay["sections"].as_array().expect("sections");
    let at = |s: f64| {
        sections.iter().any(|section| {
            let [from, to] = ["from_m", "to_m"].map(|key| section[key].as_f64().unwrap_or(0.0));
            (from - 10.0..to + 10.0).contains(&s)
        })
    };
    // Every sample run touches the wall of this track near 490 m and 790 m.
    assert!(at(495.0) && at(800.0), "{sections:?}");
    assert!(folder.join("again/replay.png").is_file());
    succeeds(folder, &["report", "again/"]);
    succeeds(folder, &["report", "again/", "-o", "pages/again.html"]);
    // The pages link to the run, and to where it differs, in the page of the run.
    for (page, viewer) in [
        ("again/report.html", "view.html"),
        ("pages/again.html", "../again/view.html"),
    ] {
        let page = std::fs::read_to_string(folder.join(page)).expect("a page");
        for part in ["\">the whole run", "&amp;channel="] {
            let link = format!("<a href=\"{viewer}#run=A2-03{part}");
            assert!(page.contains(&link), "{link} in {page}");
        }
    }
    assert!(folder.join("again/view.html").is_file());
    let words = with(&["sample/A2-03.csv", "--view", "-o", "none"]);
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    refused(folder, &words, 2, &["--run"]);
    succeeds(
        folder,
        &["evaluate", "again/runs.csv", "--model", model, "-o", "e"],
    );

    // A file alone, with a hole in the steering and nothing that a replay does not use.
    let text = std::fs::read_to_string(folder.join("sample/A2-03.csv")).expect("a run");
    let mut lines = text.lines();
    let header: Vec<&str> = lines.next().expect("a header").split(',').collect();
    let place = |name| {
        header
            .iter()
            .position(|column| *column == name)
            .expect("a column")
    };
    let keep = ["t_s", "v_mps", "delta_rad", "s_m"].map(place);
    let mut short = String::from("t_s,v_mps,delta_rad,s_m\n");
    for (row, line) in lines.enumerate() {
        let cells: Vec<&str> = line.split(',').collect();
        let mut written = keep.map(|at| cells[at]);
        if (9000..9050).contains(&row) {
            written[2] = "";
        }
        short += &(written.join(",") + "\n");
    }
    std::fs::write(folder.join("short.csv"), short).expect("a file");
    call(&["short.csv", "-o", "short"]);
    let document = json(&folder.join("short/simulation.json"));
    assert_eq!(
        document["replay"]["taking_part"]["missing"]["delta_rad"],
        50
    );
    assert!(
        document["replay"]["bridged_m"]
            .as_f64()
            .is_some_and(|way| way > 3.0)
    );

    fails(
        &["short.csv", "--strict", "-o", "strict"],
        &["short.csv", "delta_rad"],
    );
    assert!(!folder.join("strict").exists());
    fails(
        &["sample/runs.csv", "--run", "Z9", "-o", "none"],
        &["Z9", "A1-01"],
    );
    fails(
        &["sample/runs.csv", "--run", "A1-09", "-o", "none"],
        &["west", "east"],
    );
}

/// The sled of the third generator: two tracks of runners on a frame with roll and torsion, on a
/// track with headings, lines and heights of its own. It shares no code with the simulator.
#[test]
fn a_sled_of_another_simulator_is_driven_again_at_its_speed() {
    let case = kufe_blind::catalogue::chosen("open-quiet/none").expect("a case")[0]
        .build(991)
        .expect("a campaign");
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    for (name, bytes) in &case.fresh {
        std::fs::write(folder.join(name), bytes).expect("a file");
    }
    let index = std::fs::read_to_string(folder.join("runs.csv")).expect("an index");
    for row in index.lines().skip(1) {
        let cells: Vec<&str> = row.split(',').collect();
        let (run, track) = (cells[0], format!("track_{}.csv", cells[2]));
        let words = ["simulate", "refitted.toml", &track, "--replay", "runs.csv"];
        succeeds(folder, &[&words[..], &["--run", run, "-o", run]].concat());
        let document = json(&folder.join(run).join("simulation.json"));
        let all = document["replay"]["differences"].as_array().expect("all");
        let of = |column: &str| {
            all.iter()
                .find(|d| d["column"] == column)
                .expect("a column")
        };
        let speed = of("v_mps")["rms"].as_f64().expect("a number");
        let time = of("t_s")["end"].as_f64().expect("a number");
        // Of some 25 m/s and 30 s: with the faults of a quiet campaign.
        assert!(
            speed < 0.2 && time.abs() < 0.2,
            "{run}: {speed} m/s, {time} s"
        );
    }
}
