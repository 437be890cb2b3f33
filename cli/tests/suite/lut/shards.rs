//! Tables in pieces: killed, interrupted, short of disk, damaged, mixed.

use kufe_outside::not_here;
use std::collections::HashSet;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use crate::kufe::Bench;

const CASE: &str = r#"[runner]
shape = { kind = "paraboloid", rocker_radius_m = 30.0, section_radius_m = 0.005 }
[ice]
youngs_modulus_pa = 9.0e9
poissons_ratio = 0.33
thickness_m = "half-space"
[load]
fz_n = 1000.0
"#;

/// Points enough for a few seconds of work on one thread.
fn bench(points: usize) -> Bench {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    let forces: Vec<String> = (0..points)
        .map(|n| format!("{:.1}", 250.0 + 40.0 * n as f64))
        .collect();
    let table = format!(
        "case = \"case.toml\"\n[axes]\nfz_n = {{ values = [{}] }}\ncurvature_1pm = {{ values = [-0.01, 0.0, 0.01, 0.02] }}\n[accuracy]\nchecks = 4\n",
        forces.join(", ")
    );
    bench.write("table.toml", table);
    bench
}

fn start(bench: &Bench, words: &[&str]) -> Child {
    Command::new(env!("CARGO_BIN_EXE_kufe"))
        .args(words)
        .current_dir(bench.folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the command runs")
}

/// The whole lines of a file of points, or of those of a folder.
fn finished(path: &Path) -> Vec<String> {
    let files = match std::fs::read_dir(path) {
        Ok(entries) => entries
            .map(|entry| entry.expect("an entry").path())
            .collect(),
        Err(_) => vec![path.to_path_buf()],
    };
    let mut lines = Vec::new();
    for file in files {
        let text = std::fs::read_to_string(file).unwrap_or_default();
        let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
        lines.extend(whole.lines().map(str::to_owned));
    }
    lines
}

fn same_bytes(bench: &Bench, a: &str, b: &str) {
    assert!(std::fs::read(bench.path(a)).unwrap() == std::fs::read(bench.path(b)).unwrap());
}

#[test]
fn killed_twenty_times_nothing_is_lost_and_nothing_solved_twice() {
    let bench = bench(40);
    bench.succeeds(&["lut", "table.toml", "-o", "whole.lut"]);
    bench.succeeds(&["lut", "plan", "table.toml", "-o", "plan", "--shards", "1"]);
    let points = bench.path("plan/points");
    let mut state = 12345u64;
    let mut before = finished(&points);
    let (mut killed, mut progressed) = (0, 0);
    while killed < 20 {
        let mut child = start(
            &bench,
            &["lut", "run", "plan", "--shard", "1/1", "--threads", "1"],
        );
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1);
        // A random moment by progress, not by the clock alone: a busy machine must not make every kill too early.
        let wanted = before.len() + (state >> 33) as usize % 7;
        for _ in 0..3000 {
            if finished(&points).len() >= wanted || child.try_wait().unwrap().is_some() {
                break;
            }
            std::thread::sleep(Duration::from_millis(10));
        }
        std::thread::sleep(Duration::from_millis((state >> 45) % 40));
        child.kill().unwrap();
        let status = child.wait().unwrap();
        let after = finished(&points);
        assert!(after.starts_with(&before), "a point was lost");
        progressed += usize::from(after.len() > before.len());
        before = after;
        killed += 1;
        if status.success() {
            break;
        }
    }
    assert!(
        killed == 20 || before.len() == 164,
        "{killed} kills, {} points",
        before.len()
    );
    assert!(progressed > 3, "the kills came too early to tell anything");
    bench.succeeds(&["lut", "run", "plan", "--shard", "1/1"]);
    let all = finished(&points);
    assert!(all.starts_with(&before), "a point was lost");
    let distinct: HashSet<&String> = all.iter().collect();
    assert_eq!((all.len(), distinct.len()), (164, 164), "solved again");
    bench.succeeds(&["lut", "merge", "plan", "-o", "merged.lut"]);
    same_bytes(&bench, "whole.lut", "merged.lut");
}

#[test]
fn interrupted_it_leaves_with_5_and_resumes() {
    let bench = bench(40);
    let words = ["lut", "table.toml", "-o", "t.lut", "--threads", "1"];
    let mut child = start(&bench, &words);
    let points = bench.path("t.lut.points");
    for _ in 0..600 {
        if finished(&points).len() >= 3 {
            break;
        }
        std::thread::sleep(Duration::from_millis(10));
    }
    // The shell's own: a bare machine has no program of that name.
    let reported = Command::new("sh")
        .args(["-c", &format!("kill -INT {}", child.id())])
        .status()
        .unwrap();
    assert!(reported.success());
    let status = child.wait().unwrap();
    let mut printed = String::new();
    std::io::Read::read_to_string(child.stderr.as_mut().unwrap(), &mut printed).unwrap();
    assert_eq!(status.code(), Some(5), "{printed}");
    assert!(printed.contains("resumes"), "{printed}");
    assert!(!bench.path("t.lut").exists());
    let stored = finished(&points).len();
    assert!(stored >= 3);
    let summary = bench.succeeds(&["lut", "table.toml", "-o", "t.lut", "--json"]);
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["solves"], 164 - stored);
    assert!(
        !points.exists(),
        "results in hand are gone once the table is there"
    );
    bench.succeeds(&["lut", "table.toml", "-o", "whole.lut"]);
    same_bytes(&bench, "whole.lut", "t.lut");
}

#[test]
fn shards_of_a_tolerance_go_in_rounds_and_give_the_same_table() {
    let bench = Bench::new();
    bench.write("case.toml", CASE);
    bench.write(
        "table.toml",
        "case = \"case.toml\"\n[axes]\nfz_n = { from = 250.0, to = 4000.0 }\ncurvature_1pm = { from = 0.0, to = 0.015 }\n\
         [accuracy]\ninterpolation = 0.02\nchecks = 6\n",
    );
    bench.succeeds(&["lut", "plan", "table.toml", "-o", "plan", "--shards", "3"]);
    let mut rounds = 0;
    loop {
        let early = bench.kufe(&["lut", "merge", "plan", "-o", "merged.lut"]);
        let printed = String::from_utf8_lossy(&early.stderr).into_owned();
        assert!(
            early.status.code() == Some(5) && printed.contains("have no result yet"),
            "{printed}"
        );
        for shard in ["2/3", "1/3", "3/3"] {
            bench.succeeds(&["lut", "run", "plan", "--shard", shard]);
        }
        rounds += 1;
        let merged = bench.kufe(&["lut", "merge", "plan", "-o", "merged.lut"]);
        if merged.status.success() {
            break;
        }
        let printed = String::from_utf8_lossy(&merged.stderr).into_owned();
        assert!(
            merged.status.code() == Some(5) && printed.contains("is planned"),
            "{printed}"
        );
    }
    assert!(rounds > 1);
    bench.succeeds(&["lut", "table.toml", "-o", "whole.lut"]);
    same_bytes(&bench, "whole.lut", "merged.lut");
}

#[test]
fn damaged_and_foreign_results_are_named() {
    let bench = bench(2);
    bench.succeeds(&["lut", "plan", "table.toml", "-o", "plan", "--shards", "2"]);
    for shard in ["1/2", "2/2"] {
        bench.succeeds(&["lut", "run", "plan", "--shard", shard]);
    }
    let name = "shard-1-of-2.jsonl";
    let path = bench.path("plan/points").join(name);
    let content = std::fs::read_to_string(&path).unwrap();
    std::fs::write(
        &path,
        content.replacen("\"p_mean_pa\":", "\"p_mean_pa\":1", 1),
    )
    .unwrap();
    let output = bench.kufe(&["lut", "merge", "plan", "-o", "t.lut"]);
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(
        output.status.code() == Some(3) && printed.contains(name) && printed.contains("damaged"),
        "{printed}"
    );
    for shard in ["1/2", "2/2"] {
        bench.succeeds(&["lut", "run", "plan", "--shard", shard]);
    }
    bench.succeeds(&["lut", "merge", "plan", "-o", "t.lut"]);
    // Another ice in the same folder.
    bench.write("case.toml", CASE.replace("0.33", "0.31"));
    for words in [
        ["lut", "merge", "plan", "-o", "u.lut"],
        ["lut", "run", "plan", "--shard", "1/1"],
        ["lut", "plan", "table.toml", "-o", "plan"],
    ] {
        let output = bench.kufe(&words);
        let printed = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            output.status.code() == Some(3) && printed.contains("case_sha256"),
            "{words:?} {printed}"
        );
    }
}

#[test]
fn a_full_disk_is_named_and_what_was_finished_stays() {
    let bench = bench(40);
    let small = bench.path("plan");
    std::fs::create_dir(&small).unwrap();
    let mounted = Command::new("mount")
        .args(["-t", "tmpfs", "-o", "size=96k", "tmpfs"])
        .arg(&small)
        .output();
    if !mounted.is_ok_and(|output| output.status.success()) {
        not_here("a small file system cannot be mounted");
        return;
    }
    let output = bench.kufe(&["lut", "plan", "table.toml", "-o", "plan"]);
    let planned = output.status.success();
    let output = bench.kufe(&["lut", "run", "plan", "--shard", "1/1"]);
    let stored = finished(&bench.path("plan/points")).len();
    let printed = String::from_utf8_lossy(&output.stderr).into_owned();
    let unmounted = Command::new("umount").arg(&small).status().unwrap();
    assert!(unmounted.success() && planned);
    assert_eq!(output.status.code(), Some(3), "{printed}");
    assert!(
        printed.contains("plan/points/") && printed.contains("No space left"),
        "{printed}"
    );
    assert!(stored > 0 && stored < 164, "{stored}");
}
