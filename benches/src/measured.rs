//! Measurement of a piece of work in a separate process, so that its peak memory is separate too.

use std::process::Command;
use std::time::Instant;

/// Time and memory of a piece of work.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Wall time [s].
    pub seconds: f64,
    /// Largest resident memory of the process [bytes].
    pub peak_bytes: u64,
}

/// Runs this program again with `arguments` and returns the words of its last line of output.
///
/// # Panics
/// Panics if the program cannot be run or fails.
pub fn run_again(arguments: &[&str]) -> Vec<String> {
    let program = std::env::current_exe().unwrap_or_else(|error| panic!("own path: {error}"));
    let output = Command::new(program)
        .args(arguments)
        .output()
        .unwrap_or_else(|error| panic!("{error}"));
    let text = String::from_utf8_lossy(&output.stdout);
    assert!(
        output.status.success(),
        "{arguments:?}: {}",
        String::from_utf8_lossy(&output.stderr)
    );
    text.lines()
        .last()
        .unwrap_or_default()
        .split_whitespace()
        .map(str::to_owned)
        .collect()
}

/// As [`run_again`], with the `N` words as numbers.
///
/// # Panics
/// Also panics if the words are not `N` numbers.
pub fn measure_again<const N: usize>(arguments: &[&str]) -> [f64; N] {
    let words = run_again(arguments);
    let numbers: Vec<f64> = words.iter().filter_map(|word| word.parse().ok()).collect();
    let expected = |_| panic!("{arguments:?}: {words:?}, expected {N} numbers");
    numbers.try_into().unwrap_or_else(expected)
}

/// Best wall time of `rounds` repetitions [s], and the last result.
pub fn best_of<T>(rounds: usize, mut work: impl FnMut() -> T) -> (f64, T) {
    let mut best = f64::INFINITY;
    let mut last = None;
    for _ in 0..rounds.max(1) {
        let begun = Instant::now();
        last = Some(work());
        best = best.min(begun.elapsed().as_secs_f64());
    }
    match last {
        Some(value) => (best, value),
        None => unreachable!("at least one round"),
    }
}

/// Processor time of this process so far, of all threads, to a hundredth of a second [s]; 0 if the
/// system does not state it.
pub fn cpu_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // Fields are counted after the name in brackets, which may contain spaces. User and system time
    // are fields 14 and 15.
    let fields = stat.rsplit(')').next().unwrap_or_default();
    let ticks = fields.split_whitespace().skip(11).take(2);
    ticks.filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Largest resident memory of this process so far [bytes]; 0 if the system does not state it.
pub fn peak_bytes() -> u64 {
    std::fs::read_to_string("/proc/self/status")
        .ok()
        .and_then(|status| {
            let line = status
                .lines()
                .find(|line| line.starts_with("VmHWM:"))?
                .to_owned();
            line.split_whitespace().nth(1)?.parse::<u64>().ok()
        })
        .map_or(0, |kib| kib * 1024)
}
