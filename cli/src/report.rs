//! `kufe report`: one page of the results of another command.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::report::{PAGE, ResultPage, result_page};
use kufe_files::same_file;
use serde::Serialize;

use crate::output::{FolderRecord, write_file};
use crate::terminal::Global;
use crate::text::print_document;

/// Arguments of `kufe report`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// A folder that a command has written, or a lookup table (.lut)
    pub result: PathBuf,
    /// The page to write [default: report.html in the folder, or the table's name with .html]
    #[arg(long, short, value_name = "HTML")]
    pub out: Option<PathBuf>,
}

/// A page that was written.
#[derive(Serialize)]
struct Written {
    kind: &'static str,
    written: [PathBuf; 1],
    bytes: usize,
}

/// Writes the page.
///
/// # Errors
/// [`Failure::BadInput`] if there is nothing to report on, a file of it is broken, or the page
/// cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let ResultPage {
        kind,
        file: out,
        html,
    } = result_page(&args.result, args.out.as_deref())?;
    // kufe discover writes its page itself.
    if kind != "discovery" || !same_file(&out, &args.result.join(PAGE)) {
        let inputs = read(&args.result, &out);
        write_file("report", &inputs, &out, html.as_bytes(), global)?;
    }
    let written = Written {
        kind,
        written: [out],
        bytes: html.len(),
    };
    print_document(&written, global)
}

/// The inputs: a table, or the files of a folder, without `out` if this command wrote it.
fn read(result: &Path, out: &Path) -> Vec<PathBuf> {
    if !result.is_dir() {
        return vec![result.to_path_buf()];
    }
    let name = out.file_name().unwrap_or_default();
    let writer = FolderRecord::writer_of(result, &name.to_string_lossy());
    let is_page = writer.map_or(name == PAGE, |writer| writer == "report");
    let entries = std::fs::read_dir(result).into_iter().flatten().flatten();
    let files = entries.filter(|entry| !(is_page && entry.file_name() == name));
    files.map(|entry| entry.path()).collect()
}
