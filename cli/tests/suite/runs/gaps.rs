//! Runs with gaps in every command that takes runs: used without them and counted, or refused.

use std::path::Path;

use crate::kufe::{json, refused, succeeds};

/// Eight of the sample runs, the second of which loses rows and values, moves no more at its end and has a clock with jitter.
fn eight(folder: &Path) {
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "1"],
    );
    let read =
        |name: &str| std::fs::read_to_string(folder.join("sample").join(name)).expect("a file");
    let index: Vec<String> = read("runs.csv")
        .lines()
        .take(9)
        .map(str::to_owned)
        .collect();
    std::fs::write(folder.join("sample/runs.csv"), index.join("\n")).expect("an index");
    let name = index[2].split(',').nth(1).expect("a file").to_owned();
    let text = read(&name);
    let mut lines = text.lines();
    let header = lines.next().expect("a header");
    let place = |column: &str| {
        header
            .split(',')
            .position(|name| name == column)
            .expect("a column")
    };
    let (yaw, speed) = (place("yaw_rate_radps"), place("v_mps"));
    let mut rows = vec![header.to_owned()];
    for (i, line) in lines.enumerate().filter(|(i, _)| !(3000..3200).contains(i)) {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if (8000..8100).contains(&i) {
            cells[yaw] = "NaN".to_owned();
        }
        if i >= 20_000 {
            cells[speed] = "0.01".to_owned();
        }
        // A fifth of a step to and fro.
        let t: f64 = cells[0].parse().expect("a time");
        cells[0] = format!("{:.6}", t + if i % 3 == 1 { 4e-4 } else { 0.0 });
        rows.push(cells.join(","));
    }
    std::fs::write(folder.join("sample").join(name), rows.join("\n")).expect("a run");
}

#[test]
fn commands_use_and_count_samples_without_gaps_and_refuse_gaps_with_strict() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    eight(folder);
    let (runs, model) = ("sample/runs.csv", "sample/model.toml");
    for (words, result) in [
        (vec!["fit", "lateral"], "fit.json"),
        (vec!["validate"], "validation.json"),
        (vec!["evaluate"], "evaluation.json"),
        (vec!["discover"], "report.json"),
    ] {
        let mut call = words.clone();
        call.extend([runs, "--model", model, "-o", "out", "--force"]);
        if words[0] == "discover" {
            call.extend(["--twins", "10"]);
        }
        succeeds(folder, &call);
        let result = json(&folder.join("out").join(result));
        let gaps = result["gaps"].as_array().expect("gaps");
        assert_eq!(gaps.len(), 1, "{words:?}");
        let gap = &gaps[0];
        assert_eq!(gap["rows_missing"], 200);
        assert_eq!(gap["missing"]["yaw_rate_radps"], 100);
        let number = |key: &str| gap[key].as_f64().expect("a number");
        assert!((0.15..0.25).contains(&number("jitter")), "{gap}");
        assert!(
            gap["cut_s"][1].as_f64().is_some_and(|cut| cut > 1.0),
            "{gap}"
        );
        let (used, of) = (number("used_s"), number("of_s"));
        // 0.6 s are missing, and around each gap no more than half a second on either side.
        assert!(used < of - 0.6 && used > of - 2.6, "{used} of {of}");
        call.push("--strict");
        refused(folder, &call, 3, &["row"]);
    }
}
