//! `kufe doctor`: what this machine offers.

use std::collections::BTreeSet;
use std::path::PathBuf;

use kufe::jobs::Failure;
use serde_json::{Map, Value, json};

use crate::output::global::Global;
use crate::output::say::say;

/// Programs that kufe works without, and what they would add.
const OPTIONAL: [(&str, &str); 5] = [
    ("exrheader", "shows a pressure map's attributes"),
    ("paraview", "shows field.vtu"),
    ("python3", "reads every output with its usual packages"),
    ("ccx", "CalculiX, for comparisons"),
    ("sbatch", "Slurm, for tables on many machines"),
];

/// Arguments of `kufe doctor`.
#[derive(clap::Args, Debug)]
pub struct Args {}

/// Prints versions, threads, memory and which optional programs are there.
///
/// # Errors
/// None; the answer is the output.
pub fn run(_args: &Args, global: &Global) -> Result<(), Failure> {
    let threads = rayon::current_num_threads();
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let cores = cores().unwrap_or(processors).min(processors);
    let [total, available] = ["MemTotal:", "MemAvailable:"].map(memory);
    let programs: Map<String, Value> = OPTIONAL
        .iter()
        .map(|(name, _)| (name.to_string(), json!(find(name))))
        .collect();
    if global.json {
        let document = json!({
            "version": env!("CARGO_PKG_VERSION"),
            "system": std::env::consts::OS,
            "architecture": std::env::consts::ARCH,
            "threads": threads,
            "processors": processors,
            "cores": cores,
            "memory_bytes": total,
            "memory_available_bytes": available,
            "programs": programs,
        });
        say(&format!("{document:#}\n"));
        return Ok(());
    }
    let on = match cores < processors {
        true => format!(
            "{processors} processors (cores: {cores}; threads of one core share its arithmetic)"
        ),
        false => format!("{processors} cores"),
    };
    let mut text = format!(
        "kufe {} on {} {}\nthreads   {threads} of {on}\n",
        env!("CARGO_PKG_VERSION"),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    if let (Some(total), Some(available)) = (total, available) {
        let [total, available] = [total, available].map(|bytes| bytes as f64 / 1e9);
        text += &format!("memory    {total:.1} GB, {available:.1} GB available\n");
    }
    text += "optional programs:\n";
    for (name, purpose) in OPTIONAL {
        let place = find(name).map_or("not found".to_string(), |path| path.display().to_string());
        text += &format!("  {name:<10} {place} ({purpose})\n");
    }
    say(&text);
    Ok(())
}

/// Cores of this machine, of which one may be several processors, where Linux tells.
fn cores() -> Option<usize> {
    let mut of_one_core = BTreeSet::new();
    for processor in std::fs::read_dir("/sys/devices/system/cpu").ok()? {
        let siblings = processor.ok()?.path().join("topology/thread_siblings_list");
        of_one_core.extend(std::fs::read_to_string(siblings).ok());
    }
    (!of_one_core.is_empty()).then_some(of_one_core.len())
}

/// A line of /proc/meminfo, where there is one [bytes].
fn memory(key: &str) -> Option<u64> {
    let text = std::fs::read_to_string("/proc/meminfo").ok()?;
    let line = text.lines().find(|line| line.starts_with(key))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}

/// The first file of that name on the search path.
fn find(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH")?;
    std::env::split_paths(&path)
        .map(|folder| folder.join(name))
        .find(|candidate| candidate.is_file())
}
