//! Sixty damaged or foreign records made of clean ones, each with what the check must say of it; and the clean ones, of which it
//! must say nothing.

use std::path::Path;

use serde_json::Value;

use crate::kufe::{json, kufe, succeeds};
use crate::runs::corpus::{Said, Table, corpus};

/// Whether the check says this of a run.
fn says(run: &Value, (column, kind, part): &Said) -> bool {
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

#[test]
fn nineteen_of_twenty_damaged_records_are_named_and_nothing_is_said_of_clean_ones() {
    const RUNS: [&str; 4] = ["A1-01", "A3-02", "B1-04", "C1-03"];
    let bench = tempfile::tempdir().expect("a folder");
    let folder = bench.path();
    succeeds(
        folder,
        &["simulate", "--sample-data", "sample", "--seed", "1"],
    );
    let read =
        |name: &str| std::fs::read_to_string(folder.join("sample").join(name)).expect("a file");
    let index = read("runs.csv");
    let chosen = |line: &&str| {
        line.starts_with("run,") || RUNS.iter().any(|run| line.starts_with(&format!("{run},")))
    };
    let index: Vec<&str> = index.lines().filter(chosen).collect();
    let clean = RUNS.map(|run| read(&format!("{run}.csv")));
    let records = folder.join("records");
    std::fs::create_dir(&records).expect("a folder");
    std::fs::write(records.join("runs.csv"), index.join("\n")).expect("an index");
    let check = |damage: &dyn Fn(&mut Table)| -> (Option<i32>, Value) {
        for (run, text) in RUNS.iter().zip(&clean) {
            let mut table = Table::read(text);
            damage(&mut table);
            std::fs::write(records.join(format!("{run}.csv")), table.text()).expect("a run");
        }
        let output = kufe(
            folder,
            &["runs", "check", "records/runs.csv", "-o", "check"],
        );
        (output.status.code(), json(&folder.join("check/check.json")))
    };
    let runs = |result: &Value| result["runs"].as_array().expect("runs").clone();

    let (code, result) = check(&|_| {});
    assert_eq!(code, Some(0), "{result}");
    for run in runs(&result) {
        assert_eq!(run["faults"], serde_json::json!([]), "{run}");
        assert_eq!(run["notes"], serde_json::json!([]), "{run}");
    }
    let corpus = corpus();
    assert_eq!(corpus.len(), 60);
    let (mut named, mut of, mut missed) = (0, 0, Vec::new());
    for (damage, said) in &corpus {
        let (code, result) = check(damage);
        let provable = said.iter().any(|(_, kind, _)| *kind != "note");
        assert_eq!(
            code,
            Some(if provable { 3 } else { 0 }),
            "{said:?}: {result}"
        );
        for run in runs(&result) {
            of += 1;
            if said.iter().all(|one| says(&run, one)) {
                named += 1;
            } else {
                missed.push(format!(
                    "{}: {said:?} {} {}",
                    run["run"], run["faults"], run["notes"]
                ));
            }
        }
    }
    eprintln!("{named} of {of} damaged runs named:\n{}", missed.join("\n"));
    assert!(20 * named >= 19 * of, "{named} of {of}");
    assert!(folder.join("check/check.html").is_file());
}

#[test]
fn the_check_says_nothing_of_the_real_car_and_of_the_sample_runs() {
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
