//! Options that every command takes.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use kufe::jobs::Failure;

use crate::output::progress::Progress;

/// Most threads on a core: more only take memory.
const THREADS_A_CORE: usize = 4;

/// Options that every command takes.
#[derive(clap::Args, Clone, Debug)]
pub struct Global {
    /// Print the result as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Number of threads (default: one a core)
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<usize>,
    /// Print nothing but the result, warnings and errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Replace files that kufe did not write, or that another of its commands wrote
    #[arg(long, global = true)]
    pub force: bool,
    /// Say on standard error what is being done, a line a step
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl Global {
    /// Starts the threads: as many as `--threads` or `RAYON_NUM_THREADS` states, else one a core.
    ///
    /// # Errors
    /// [`Failure::Usage`] where `--threads` is out of range, [`Failure::BadInput`] where the system
    /// does not permit that many.
    pub fn apply(&self) -> Result<(), Failure> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let most = (THREADS_A_CORE * cores).max(16);
        if let Some(threads) = self.threads.filter(|threads| !(1..=most).contains(threads)) {
            return Err(Failure::Usage(format!(
                "--threads {threads}: expected 1 to {most} on this machine"
            )));
        }
        let stated = std::env::var("RAYON_NUM_THREADS").ok();
        let stated = stated.and_then(|text| text.parse().ok());
        let threads = self.threads.or(stated.filter(|threads| *threads > 0));
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(cores).min(most))
            .build_global()
            .map_err(|error| Failure::BadInput(format!("threads cannot be started: {error}")))
    }

    /// A progress line on the terminal, invisible with `--quiet` or where standard error is no terminal; with
    /// `--verbose` a line for each step instead, terminal or not.
    pub fn progress(&self) -> Progress {
        let shown = !self.quiet && !self.verbose && std::io::stderr().is_terminal();
        let bar = if shown {
            ProgressBar::new_spinner()
        } else {
            ProgressBar::hidden()
        };
        if shown {
            if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed_precise} {msg}") {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Progress::new(bar, self.verbose)
    }
}
