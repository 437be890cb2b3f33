//! `kufe doctor`: threads, memory and optional programs of this machine.

use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;

use kufe::jobs::Failure;
use serde::Serialize;

use crate::terminal::Global;

/// Programs that kufe works without, and their purpose.
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

/// Versions, threads, memory and optional programs.
#[derive(Serialize)]
struct Machine {
    version: &'static str,
    system: &'static str,
    architecture: &'static str,
    threads: usize,
    processors: usize,
    cores: usize,
    memory_bytes: Option<u64>,
    memory_available_bytes: Option<u64>,
    programs: BTreeMap<&'static str, Option<PathBuf>>,
}

/// Prints versions, threads, memory and which optional programs there are.
///
/// # Errors
/// None; the answer is the output.
pub fn run(_args: &Args, global: &Global) -> Result<(), Failure> {
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let machine = Machine {
        version: env!("CARGO_PKG_VERSION"),
        system: std::env::consts::OS,
        architecture: std::env::consts::ARCH,
        threads: rayon::current_num_threads(),
        processors,
        cores: cores().unwrap_or(processors).min(processors),
        memory_bytes: memory("MemTotal:"),
        memory_available_bytes: memory("MemAvailable:"),
        programs: OPTIONAL
            .iter()
            .map(|(name, _)| (*name, find(name)))
            .collect(),
    };
    global.answer(&machine, || text(&machine))
}

fn text(machine: &Machine) -> String {
    let Machine {
        processors,
        cores,
        threads,
        ..
    } = machine;
    let on = if cores < processors {
        format!(
            "{processors} processors (cores: {cores}; threads of one core share its arithmetic)"
        )
    } else {
        format!("{processors} cores")
    };
    let mut text = format!(
        "kufe {} on {} {}\nthreads   {threads} of {on}\n",
        machine.version, machine.system, machine.architecture
    );
    let memory = (machine.memory_bytes, machine.memory_available_bytes);
    if let (Some(total), Some(available)) = memory {
        let [total, available] = [total, available].map(|bytes| bytes as f64 / 1e9);
        text += &format!("memory    {total:.1} GB, {available:.1} GB available\n");
    }
    text += "optional programs:\n";
    for (name, purpose) in OPTIONAL {
        let place = machine.programs[name].as_ref();
        let place = place.map_or("not found".into(), |path| path.display().to_string());
        text += &format!("  {name:<10} {place} ({purpose})\n");
    }
    text
}

/// Cores of this machine, of which one may be several processors, where Linux states them.
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
