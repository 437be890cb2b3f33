//! Options that every command takes.

use std::io::IsTerminal;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use kufe::jobs::Failure;

use crate::output::progress::Progress;

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
    /// Say on standard error what is being done, a line a step
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl Global {
    /// Sets the size of the thread pool.
    ///
    /// # Errors
    /// [`Failure::Usage`] where `--threads` is 0 or beyond 1024.
    pub fn apply(&self) -> Result<(), Failure> {
        if let Some(threads) = self.threads {
            if !(1..=1024).contains(&threads) {
                return Err(Failure::Usage(format!(
                    "--threads {threads}: expected 1 to 1024"
                )));
            }
            rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build_global()
                .map_err(|error| Failure::Usage(format!("--threads {threads}: {error}")))?;
        }
        Ok(())
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
