//! Global options, progress, messages and Ctrl-C, as all commands handle them.

use std::io::{ErrorKind, IsTerminal, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use kufe::jobs::field::pretty;
use kufe::jobs::{Failure, Watch};
use serde::Serialize;

/// Largest number of threads per core: more only take memory.
const MAX_THREADS_PER_CORE: usize = 4;
/// The error after which nothing more is written to standard output.
static STDOUT_ERROR: OnceLock<std::io::Error> = OnceLock::new();
static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Options that every command takes.
#[derive(clap::Args, Clone, Debug)]
pub struct Global {
    /// Print the result as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Number of threads (default: one per core)
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<usize>,
    /// Print nothing but the result, warnings and errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
    /// Replace files that kufe did not write, that another of its commands wrote, or that were
    /// changed since
    #[arg(long, global = true)]
    pub force: bool,
    /// Print each step on standard error, one line per step
    #[arg(long, short, global = true, conflicts_with = "quiet")]
    pub verbose: bool,
}

impl Global {
    /// Starts the threads: as many as `--threads` or `RAYON_NUM_THREADS` states, else one per core.
    ///
    /// # Errors
    /// [`Failure::Usage`] if `--threads` is out of range, [`Failure::BadInput`] if the system
    /// does not permit that many.
    pub fn apply(&self) -> Result<(), Failure> {
        let cores = std::thread::available_parallelism().map_or(1, usize::from);
        let most = (MAX_THREADS_PER_CORE * cores).max(16);
        if let Some(threads) = self.threads.filter(|threads| !(1..=most).contains(threads)) {
            let expected = format_args!("1 to {most} on this machine");
            return Err(Failure::option("threads", threads, expected));
        }
        let stated = std::env::var("RAYON_NUM_THREADS").ok();
        let stated = stated.and_then(|text| text.parse().ok());
        let threads = self.threads.or(stated.filter(|threads| *threads > 0));
        rayon::ThreadPoolBuilder::new()
            .num_threads(threads.unwrap_or(cores).min(most))
            .build_global()
            .map_err(|error| Failure::BadInput(format!("threads cannot be started: {error}")))
    }

    /// A progress line on the terminal, invisible with `--quiet` or where standard error is no
    /// terminal; with `--verbose` a line for each step instead, terminal or not.
    pub fn progress(&self) -> Progress {
        let is_shown = !self.quiet && !self.verbose && std::io::stderr().is_terminal();
        let bar = if is_shown {
            ProgressBar::new_spinner()
        } else {
            ProgressBar::hidden()
        };
        let style = ProgressStyle::with_template("{spinner} {elapsed_precise} {msg}");
        bar.set_style(style.expect("valid template"));
        if is_shown {
            bar.enable_steady_tick(Duration::from_millis(100));
        }
        Progress {
            bar,
            lines: self.verbose,
            begun: Instant::now(),
        }
    }

    /// Does `work` while the progress line shows `text`.
    pub fn during<T>(&self, text: &str, work: impl FnOnce() -> T) -> T {
        let bar = self.progress();
        bar.set_message(text);
        let done = work();
        bar.finish_and_clear();
        done
    }

    /// Does `work` with a progress line that is removed at its end.
    ///
    /// After Ctrl-C the job finishes the points or steps in progress and begins no others; a second
    /// Ctrl-C exits at once.
    pub fn watched<T>(&self, work: impl FnOnce(&Watch) -> T) -> T {
        // A process has one handler; an error means that it is set already.
        let _ = ctrlc::set_handler(|| {
            if INTERRUPTED.swap(true, Ordering::Relaxed) {
                std::process::exit(5);
            }
        });
        let bar = self.progress();
        let done = work(&Watch {
            progress: Some(&|text| bar.set_message(text)),
            warn: Some(&|text| bar.warn(text)),
            stop: Some(&INTERRUPTED),
        });
        bar.finish_and_clear();
        done
    }

    /// Prints the result of an action: as JSON with `--json`, nothing with `--quiet`, else as text.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a result that cannot be written as JSON.
    pub fn print(
        &self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        if self.quiet && !self.json {
            Ok(())
        } else {
            self.answer(result, text)
        }
    }

    /// Prints the answer to a question: as JSON with `--json`, else as text.
    ///
    /// # Errors
    /// As [`print`](Self::print).
    pub fn answer(
        &self,
        result: &impl Serialize,
        text: impl FnOnce() -> String,
    ) -> Result<(), Failure> {
        say(&if self.json { pretty(result)? } else { text() });
        Ok(())
    }
}

/// Progress of a command on standard error.
#[derive(Clone)]
pub struct Progress {
    bar: ProgressBar,
    lines: bool,
    begun: Instant,
}

impl Progress {
    /// Shows the step in progress.
    pub fn set_message(&self, text: &str) {
        if self.lines {
            let seconds = self.begun.elapsed().as_secs_f64();
            note(&format!("{seconds:.2} s: {text}"));
        }
        self.bar.set_message(text.to_owned());
    }

    /// Prints a warning above the progress line.
    pub fn warn(&self, text: &str) {
        self.bar.suspend(|| warn(text));
    }

    /// Removes the progress line.
    pub fn finish_and_clear(&self) {
        self.bar.finish_and_clear();
    }
}

/// Prints on standard output.
///
/// After a write error the command continues its work and fails at its end, in [`check_stdout`].
pub fn say(text: &str) {
    if STDOUT_ERROR.get().is_some() {
        return;
    }
    let mut out = std::io::stdout().lock();
    let text = printable(text);
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        let _ = STDOUT_ERROR.set(error);
    }
}

/// Prints a line on standard error, after the command's name.
///
/// The further lines of a text are indented, so that each message begins with `kufe: `. Write
/// errors are ignored.
pub fn note(text: &str) {
    let text = printable(text).trim_end().replace('\n', "\n  ");
    let _ = writeln!(std::io::stderr().lock(), "kufe: {text}");
}

/// Prints text on standard error with control characters escaped.
pub fn error_text(text: &str) {
    let _ = write!(std::io::stderr().lock(), "{}", printable(text));
}

/// The error for a misspelt subcommand, with a suggestion; `None` if `word` may be a file or is not
/// similar to any of `subcommands`.
pub fn misspelt(word: &str, subcommands: &[&str]) -> Option<String> {
    let path = Path::new(word);
    if subcommands.contains(&word) || path.extension().is_some() || path.exists() {
        return None;
    }
    let scored = subcommands
        .iter()
        .map(|name| (strsim::jaro_winkler(word, name), name));
    let (_, name) = scored
        .filter(|(similarity, _)| *similarity > 0.7)
        .max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(format!(
        "unrecognized subcommand '{word}'\n\n  tip: a similar subcommand exists: '{name}'"
    ))
}

/// Warns of a table whose last line has no line end: the file may be cut within its last number.
pub fn warn_if_cut(path: &Path) {
    let last_byte = || -> std::io::Result<u8> {
        let mut file = kufe_files::open_regular(path)?;
        file.seek(SeekFrom::End(-1))?;
        let mut byte = [0];
        file.read_exact(&mut byte)?;
        Ok(byte[0])
    };
    let is_csv = path.extension().is_some_and(|ending| ending == "csv");
    if is_csv && last_byte().is_ok_and(|byte| !matches!(byte, b'\n' | b'\r')) {
        let path = path.display();
        warn(&format!(
            "{path}: the last line has no line end; if the file was cut, its last value is wrong"
        ));
    }
}

/// Prints a warning on standard error.
pub fn warn(text: &str) {
    note(&format!("warning: {text}"));
}

/// Checks that everything was written to standard output; a closed pipe is not an error.
///
/// # Errors
/// [`Failure::BadInput`] with the first write error.
pub fn check_stdout() -> Result<(), Failure> {
    match STDOUT_ERROR.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::BadInput(format!(
            "standard output: cannot be written: {error}"
        ))),
        _ => Ok(()),
    }
}

/// The text with control characters escaped: in names from foreign files they would change the
/// terminal or the direction of writing. Line breaks and tabs are unchanged.
fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        let harmless = matches!(c, '\n' | '\t') || !c.is_control();
        let reorders = matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if harmless && !reorders {
            shown.push(c);
        } else {
            shown.extend(c.escape_unicode());
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(printable("Königssee 5 µm\n\ta"), "Königssee 5 µm\n\ta");
        for c in [
            '\u{1b}', '\r', '\u{7f}', '\u{85}', '\u{9b}', '\u{202e}', '\0',
        ] {
            assert!(!printable(&format!("a{c}b")).contains(c), "{c:?}");
        }
    }
}
