//! `kufe runs align`.

use crate::kufe::{json, refused, succeeds};

#[test]
fn runs_are_aligned_along_a_survey_or_one_another_and_recorded_ones_are_not_replaced() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "1"],
    );
    let common = ["--model", "sample/model.toml", "-q"];
    let align = |runs: &str, more: &[&str]| {
        let words: Vec<&str> = ["runs", "align", runs]
            .into_iter()
            .chain(common)
            .chain(more.iter().copied())
            .collect();
        succeeds(folder, &words);
    };
    // What is already at its place stays there.
    align("sample/runs.csv", &["-o", "placed"]);
    let document = json(&folder.join("placed/align.json"));
    let tracks = document["tracks"].as_array().expect("tracks");
    assert_eq!(tracks.len(), 2);
    for run in tracks
        .iter()
        .flat_map(|track| track["runs"].as_array().expect("runs"))
    {
        let [start, sd] = ["start_m", "sd_m"].map(|key| run[key].as_f64().unwrap_or(f64::NAN));
        assert!(start.abs() < 6.0 && start.abs() < 5.0 * sd, "{run}");
    }
    let estimated = ["--estimate", "-o", "felt", "--parquet"];
    align("sample/runs.csv", &estimated);
    let track = std::fs::read_to_string(folder.join("felt/track_west.csv")).expect("a track");
    assert!(
        track.starts_with("s_m,slope_rad,curvature_1pm,bank_rad,slope_sd_rad"),
        "{track}"
    );
    // The estimated track is one to drive on, and its runs are ones to evaluate.
    succeeds(
        folder,
        &[
            "simulate",
            "sample/model.toml",
            "felt/track_west.csv",
            "-o",
            "driven",
        ],
    );
    let model = ["--model", "sample/model.toml", "-o", "evaluation"];
    succeeds(
        folder,
        &[&["evaluate", "felt/runs.csv"], &model[..]].concat(),
    );
    // Again into the same folder, but not over what was recorded.
    align("sample/runs.csv", &estimated);
    refused(
        folder,
        &[
            "runs",
            "align",
            "placed/runs.csv",
            "--model",
            "sample/model.toml",
            "-o",
            "sample",
        ],
        3,
        &["sample", "expected another folder"],
    );
}
