//! An import that is killed, or fills the disk, writes everything or nothing.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use kufe_sled::read_index;

use crate::kufe::{Bench, names};

/// Runs and rows of the recordings: some ten files of a quarter of a megabyte are written.
const RUNS: usize = 6;
const ROWS: usize = 6000;

fn bench() -> Bench {
    let bench = Bench::new();
    for run in 0..RUNS {
        let mut text = String::from("Time [s],Speed [km/h],ay [g]\n");
        for row in 0..ROWS {
            let t = row as f64 * 0.01;
            let v = 90.0 + 3.0 * (0.7 * t + run as f64).sin();
            text += &format!("{t:.2},{v:.4},{:.5}\n", 0.4 * (2.0 * t).sin());
        }
        bench.write(&format!("r{run}.csv"), text);
    }
    for (name, rate) in [("mapping.toml", 100), ("other.toml", 50)] {
        let text = format!(
            "rate_hz = {rate}\n[logger.box]\nfiles = \"r*.csv\"\ntime = \"Time\"\n[channels]\n\
             v_mps = {{ from = \"Speed\", unit = \"km/h\" }}\nay_mps2 = {{ from = \"ay\", unit = \"g\" }}\n\
             [index]\ntrack = \"t\"\ndriver = \"d\"\ndriver_class = \"c\"\nsession = \"1\"\nair_c = 0\nair_pa = 95000\n"
        );
        bench.write(name, text);
    }
    bench
}

/// Every visible file of a folder.
fn files(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let visible = names(folder)
        .into_iter()
        .filter(|name| !name.starts_with('.'));
    let read = |name: String| {
        let bytes = std::fs::read(folder.join(&name)).expect("a file");
        (name, bytes)
    };
    visible.map(read).collect()
}

/// Where there is an index, all that it names is as one whole import wrote it.
fn is_whole_or_absent(folder: &Path, whole: &[&BTreeMap<String, Vec<u8>>]) -> bool {
    if !folder.join("runs.csv").exists() {
        return false;
    }
    let found = files(folder);
    assert!(whole.contains(&&found), "{:?}", found.keys());
    assert_eq!(
        read_index(&folder.join("runs.csv"))
            .expect("an index")
            .len(),
        RUNS
    );
    true
}

fn import<'a>(bench: &Bench, mapping: &'a str, out: &'a str) -> Vec<&'a str> {
    let words = vec!["runs", "import", mapping, "-o", out, "-q"];
    bench.succeeds(&words);
    words
}

#[test]
fn twenty_kills_over_an_import_leave_the_old_the_new_or_no_index() {
    let bench = bench();
    let start = Instant::now();
    let words = import(&bench, "mapping.toml", "runs");
    let whole = start.elapsed();
    let new = files(&bench.path("runs"));
    import(&bench, "other.toml", "other");
    let old = files(&bench.path("other"));
    assert_ne!(new, old);
    let mut counts = [0; 3];
    for kill in 0..20 {
        // Every other kill is over runs of another mapping.
        let _ = std::fs::remove_dir_all(bench.path("runs"));
        if kill % 2 == 1 {
            import(&bench, "other.toml", "runs");
        }
        let mut child = Command::new(env!("CARGO_BIN_EXE_kufe"))
            .current_dir(bench.folder.path())
            .args(&words)
            .stderr(Stdio::null())
            .spawn()
            .expect("the command runs");
        // Spread over the import and a little beyond, more densely towards its end, where files are moved.
        let share = 1.1 * (1.0 - (1.0 - f64::from(kill + 1) / 20.0).powi(2));
        std::thread::sleep(Duration::from_secs_f64(share * whole.as_secs_f64()));
        let _ = child.kill();
        let _ = child.wait();
        let folder = bench.path("runs");
        let there = folder.exists() && is_whole_or_absent(&folder, &[&new, &old]);
        counts[match there {
            false => 0,
            true if files(&folder) == old => 1,
            true => 2,
        }] += 1;
        // And the next one succeeds.
        if kill % 5 == 4 {
            import(&bench, "mapping.toml", "runs");
            assert!(files(&folder) == new, "after kill {kill}");
        }
    }
    println!(
        "no index {}, the old {}, the new {}",
        counts[0], counts[1], counts[2]
    );
    assert!(
        counts[0] > 0,
        "{counts:?}: no kill was early enough to say anything"
    );
}

#[cfg(unix)]
#[test]
fn twenty_full_disks_under_an_import_leave_nothing() {
    let bench = bench();
    let words = import(&bench, "mapping.toml", "whole");
    let whole = files(&bench.path("whole"));
    let largest = whole.values().map(Vec::len).max().unwrap_or(0);
    let words: Vec<&str> = words
        .iter()
        .map(|w| if *w == "whole" { "runs" } else { w })
        .collect();
    let mut refused = 0;
    for step in 0..20 {
        // The longest that a file may be, in blocks of 512 bytes; longer ones fail as on a full disk.
        let blocks = largest * (step + 1) / 18 / 512;
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; exec \"$0\" \"$@\"");
        let output = Command::new("sh")
            .current_dir(bench.folder.path())
            .args(["-c", &script, env!("CARGO_BIN_EXE_kufe")])
            .args(&words)
            .output()
            .expect("a shell");
        let folder = bench.path("runs");
        if output.status.success() {
            assert!(
                files(&folder) == whole,
                "{blocks} blocks: done, and not whole"
            );
            std::fs::remove_dir_all(&folder).expect("gone");
            continue;
        }
        refused += 1;
        let reported = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(3), "{reported}");
        assert!(
            reported.contains("runs/") && reported.contains("cannot be written"),
            "{reported}"
        );
        assert!(!folder.exists(), "{:?}", names(&folder));
    }
    assert!((12..20).contains(&refused), "{refused} of 20");
}
