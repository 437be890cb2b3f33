//! Sixty damaged or foreign records made of clean ones, each with the expected finding of the check; and the clean ones, of which it
//! must report nothing.

use std::path::Path;

use kufe_blind::catalogue::chosen;
use serde_json::Value;

use crate::kufe::{json, kufe, succeeds};
use crate::runs::corpus::{Damage, Expected, Table, corpus};

/// Whether the check reports this of a run.
fn reports(run: &Value, (column, kind, part): &Expected) -> bool {
    let list = |key: &str| run[key].as_array().cloned().unwrap_or_default();
    if *kind == "note" {
        return list("notes")
            .iter()
            .any(|note| note["column"] == *column && note["what"].to_string().contains(part));
    }
    list("faults").iter().any(|fault| {
        let named = fault["columns"]
            .as_array()
            .is_some_and(|all| all.iter().any(|one| one == column));
        let mend = fault["mend"]
            .as_str()
            .is_some_and(|mend| mend.contains(part));
        named && mend && fault["kind"] == *kind
    })
}

/// Four runs without findings, and their damaged copies.
struct Bench {
    folder: tempfile::TempDir,
    runs: Vec<(String, Table)>,
}

impl Bench {
    /// Of an index and its runs, name by name.
    fn new(index: &str, runs: Vec<(String, Table)>) -> Bench {
        let folder = tempfile::tempdir().expect("a folder");
        let chosen = |line: &&str| {
            let of = |run: &(String, Table)| line.starts_with(&format!("{},", run.0));
            line.starts_with("run,") || runs.iter().any(of)
        };
        let index: Vec<&str> = index.lines().filter(chosen).collect();
        std::fs::create_dir(folder.path().join("records")).expect("a folder");
        std::fs::write(folder.path().join("records/runs.csv"), index.join("\n")).expect("an index");
        Bench { folder, runs }
    }

    /// The exit code and the findings of each run.
    fn check(&self, damage: &dyn Fn(&mut Table)) -> (Option<i32>, Vec<Value>) {
        let folder = self.folder.path();
        for (run, clean) in &self.runs {
            let mut table = clean.clone();
            damage(&mut table);
            let file = folder.join("records").join(format!("{run}.csv"));
            std::fs::write(file, table.text()).expect("a run");
        }
        let arguments = ["runs", "check", "records/runs.csv", "-o", "check"];
        let code = kufe(folder, &arguments).status.code();
        let result = json(&folder.join("check/check.json"));
        (code, result["runs"].as_array().expect("runs").clone())
    }

    /// How many damaged runs are named with the line that mends them, of how many.
    fn named(&self, corpus: &[(Damage, Vec<Expected>)]) -> (usize, usize) {
        let (mut named, mut of, mut missed) = (0, 0, Vec::new());
        for (damage, expected) in corpus {
            let (code, runs) = self.check(damage);
            let mut wrong = false;
            for run in runs {
                of += 1;
                let faults = run["faults"].as_array().expect("faults");
                wrong |= faults.iter().any(|fault| fault["proven"] == true);
                if expected.iter().all(|one| reports(&run, one)) {
                    named += 1;
                } else {
                    let [run, faults, notes] = ["run", "faults", "notes"].map(|key| &run[key]);
                    missed.push(format!("{run}: {expected:?} {faults} {notes}"));
                }
            }
            assert_eq!(code, Some(if wrong { 3 } else { 0 }), "{expected:?}");
        }
        eprintln!("{named} of {of} damaged runs named:\n{}", missed.join("\n"));
        (named, of)
    }
}

#[test]
fn nineteen_of_twenty_damaged_records_are_named_and_no_clean_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let sample = ["simulate", "--sample-data", "sample", "--seed", "1"];
    succeeds(folder.path(), &sample);
    let read = |name: String| {
        std::fs::read_to_string(folder.path().join("sample").join(name)).expect("a file")
    };
    // A fifth of the rows: 100 Hz are enough to be judged.
    let runs = ["A1-01", "A3-02", "B1-04", "C1-03"]
        .map(|run| (run.to_owned(), Table::read(&read(format!("{run}.csv")), 5)));
    let bench = Bench::new(&read("runs.csv".to_owned()), runs.into());
    let (code, runs) = bench.check(&|_| {});
    assert_eq!(code, Some(0), "{runs:?}");
    for run in runs {
        assert_eq!(run["faults"], serde_json::json!([]), "{run}");
        assert_eq!(run["notes"], serde_json::json!([]), "{run}");
    }
    let corpus = corpus();
    assert_eq!(corpus.len(), 60);
    let (named, of) = bench.named(&corpus);
    assert!(20 * named >= 19 * of, "{named} of {of}");
    assert!(bench.folder.path().join("check/check.html").is_file());
}

/// The second generator's sled, recorder and worlds share nothing with the sample runs; their gyros are off by 1 %, their filters and
/// noise are those of its world, and they last 20 s.
#[test]
#[ignore = "slow study: .ci/slow"]
fn damage_to_runs_of_another_generator_is_named() {
    let (mut named, mut of) = (0, 0);
    for world in ["clean-null/none", "gyros-null/none", "filters-null/none"] {
        let case = chosen(world).expect("a case")[0]
            .build(52_017)
            .expect("runs");
        let text = |name: &str| {
            let (_, bytes) = case
                .files
                .iter()
                .find(|(file, _)| file == name)
                .expect("a file");
            String::from_utf8(bytes.clone()).expect("text")
        };
        let run = |run: &str| {
            let mut table = Table::read(&text(&format!("{run}.csv")), 1);
            table.integrated();
            (run.to_owned(), table)
        };
        let bench = Bench::new(
            &text("runs.csv"),
            ["r01", "r05", "r09", "r14"].map(run).into(),
        );
        let (code, runs) = bench.check(&|_| {});
        assert_eq!(code, Some(0), "{runs:?}");
        let score = bench.named(&corpus());
        println!("{world}: {score:?}");
        named += score.0;
        of += score.1;
    }
    assert!(20 * named >= 19 * of, "{named} of {of}");
}

#[test]
fn the_check_finds_nothing_in_the_real_car_and_the_sample_runs() {
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "2"],
    );
    succeeds(folder, &["runs", "check", "sample/runs.csv", "-o", "check"]);
    let result = json(&folder.join("check/check.json"));
    assert_eq!(result["runs"].as_array().map(Vec::len), Some(44));
    assert_eq!(result["wrong"], 0);
    let Some(data) = std::env::var_os("KUFE_DATA") else {
        kufe_outside::not_here("KUFE_DATA is not set");
        return;
    };
    let car = Path::new(&data).join("revs/run.csv");
    let row = format!("car,{},targa,a,a,1,5,25,101000", car.display());
    let header = "run,file,track,driver,driver_class,session,ice_c,air_c,air_pa";
    std::fs::write(folder.join("car.csv"), format!("{header}\n{row}\n")).expect("an index");
    succeeds(folder, &["runs", "check", "car.csv", "-o", "car"]);
    assert_eq!(json(&folder.join("car/check.json"))["wrong"], 0);
}
