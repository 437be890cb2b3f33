//! What every command shares: global options, progress, and files that are whole or absent.

use std::io::{BufWriter, IsTerminal, Write};
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

use crate::failure::Failure;

/// Options that every command takes.
#[derive(clap::Args, Clone, Debug)]
pub struct Global {
    /// Print the result as JSON on standard output
    #[arg(long, global = true)]
    pub json: bool,
    /// Number of threads (default: one a core)
    #[arg(long, global = true, value_name = "N")]
    pub threads: Option<usize>,
    /// Print nothing but the result and errors
    #[arg(long, short, global = true)]
    pub quiet: bool,
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

    /// A progress line on the terminal, invisible with `--quiet` or where standard error is no terminal.
    pub fn progress(&self) -> ProgressBar {
        if self.quiet || !std::io::stderr().is_terminal() {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::new_spinner();
        if let Ok(style) = ProgressStyle::with_template("{spinner} {elapsed_precise} {msg}") {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(100));
        bar
    }
}

/// Prints on standard output; a reader that has gone away (`| head`) is no failure.
pub fn say(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}

/// Writes `path` through a temporary file in its folder that is renamed once it is whole.
///
/// # Errors
/// [`Failure::BadInput`] with the path where the folder or the file cannot be written.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let told = |error: std::io::Error| {
        Failure::BadInput(format!("{}: cannot be written: {error}", path.display()))
    };
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    std::fs::create_dir_all(folder).map_err(told)?;
    let mut temporary = tempfile::Builder::new()
        .prefix(".kufe-")
        .tempfile_in(folder)
        .map_err(told)?;
    {
        let mut writer = BufWriter::new(temporary.as_file_mut());
        write(&mut writer)
            .and_then(|()| writer.flush())
            .map_err(told)?;
    }
    set_ordinary_permissions(temporary.as_file()).map_err(told)?;
    temporary.persist(path).map_err(|error| told(error.error))?;
    Ok(())
}

/// Temporary files are private; a result is readable like any other new file.
#[cfg(unix)]
fn set_ordinary_permissions(file: &std::fs::File) -> std::io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    file.set_permissions(std::fs::Permissions::from_mode(0o644))
}

#[cfg(not(unix))]
fn set_ordinary_permissions(_file: &std::fs::File) -> std::io::Result<()> {
    Ok(())
}
