//! Models on fresh runs, by the finder's own commands: `kufe validate` and `kufe simulate
//! --replay`.

use std::path::Path;
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::score::outcome::{Fresh, OnRun};

/// Compares the given, the refitted and the written model on the fresh runs of a folder.
///
/// # Errors
/// What went wrong with the first two.
pub fn compared(kufe: &Path, fresh: &Path, given: &Path, written: &Path) -> Result<Fresh, String> {
    let given = on_runs(kufe, fresh, given)?;
    let refitted = on_runs(kufe, fresh, &fresh.join("refitted.toml"))?;
    // A model that cannot be used is the finder's fault, not the benchmark's.
    let written = on_runs(kufe, fresh, written).unwrap_or_default();
    Ok(Fresh {
        given,
        refitted,
        written,
    })
}

fn on_runs(kufe: &Path, fresh: &Path, model: &Path) -> Result<Vec<OnRun>, String> {
    let model = model.to_str().ok_or("the model's path is no text")?;
    let validated = json_of(kufe, fresh, &["validate", "runs.csv", "--model", model])?;
    let runs = validated["runs"]
        .as_array()
        .ok_or("validation without runs")?;
    let on_run = |run: &Value| -> Option<(String, String, [f64; 3])> {
        let misfits = &run["left_rms"];
        let force = ["along_n", "side_n", "yaw_nm"].map(|key| misfits[key].as_f64());
        let [Some(along), Some(side), Some(yaw)] = force else {
            return None;
        };
        let text = |key: &str| run[key].as_str().map(str::to_owned);
        Some((text("run")?, text("track")?, [along, side, yaw]))
    };
    let mut all = Vec::new();
    for run in runs {
        let (name, track, force) = on_run(run).ok_or("validation without residuals")?;
        let track = format!("track_{track}.csv");
        let of = [
            "simulate", model, &track, "--replay", "runs.csv", "--run", &name,
        ];
        let replayed = json_of(kufe, fresh, &of)?;
        let differences = replayed["replay"]["differences"].as_array();
        let rms = |column: &str| -> Option<f64> {
            let of = differences?.iter().find(|d| d["column"] == column)?;
            of["rms"].as_f64()
        };
        let replay = [rms("t_s"), rms("v_mps")];
        let [Some(time), Some(speed)] = replay else {
            return Err(format!("replay of {name} without time or speed"));
        };
        all.push(OnRun {
            force,
            replay: [time, speed],
        });
    }
    Ok(all)
}

/// What a command prints with `--json`, run in a folder.
fn json_of(kufe: &Path, folder: &Path, arguments: &[&str]) -> Result<Value, String> {
    let out = tempfile::tempdir().map_err(|error| error.to_string())?;
    let done = Command::new(kufe)
        .args(arguments)
        .args(["--json", "--quiet", "--threads", "1", "--force", "-o"])
        .arg(out.path())
        .current_dir(folder)
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("{}: {error}", kufe.display()))?;
    serde_json::from_slice(&done.stdout).map_err(|error| {
        let why = String::from_utf8_lossy(&done.stderr);
        let why = why.lines().last().unwrap_or("").to_owned();
        format!("kufe {}: {error}: {why}", arguments[0])
    })
}
