//! `kufe report`: one page to look at.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::field::pretty;
use serde::Serialize;

use crate::output::file::OutputFiles;
use crate::output::folder::FolderRecord;
use crate::output::global::Global;
use crate::output::paths::{leads_out, same_file};
use crate::output::say::say;
use crate::report::{contact, evaluation, gathered, results, series, table};

const EXAMPLES: &str = "\
Examples:
  kufe report out/                             a solved contact, to out/report.html
  kufe report series/                          a series of contacts, over what was varied
  kufe report front.lut -o front.html          a lookup table
  kufe report evaluation/ -o drivers.html      what drivers lose
  kufe report finding/ -o finding.html         what kufe discover found
  kufe report check/                           what kufe runs check found
  kufe report gathered/                        the runs that kufe runs gather has brought together

The page is one file that needs no network: open it in a browser, or send it to someone.";

/// The page of a folder, by default.
const PAGE: &str = "report.html";

/// Arguments of `kufe report`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// A folder that a command has written, or a lookup table (.lut)
    pub result: PathBuf,
    /// Where the page goes [default: report.html in the folder, or the table's name with .html]
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
/// [`Failure::BadInput`] where there is nothing to report on, a file of it is broken, or the page cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let (kind, default, html) = html(&args.result)?;
    let out = args.out.clone().unwrap_or(default);
    // kufe discover writes its page itself.
    if kind != "discovery" || !same_file(&out, &args.result.join(PAGE)) {
        let outputs = std::slice::from_ref(&out);
        let files = OutputFiles::begin("report", &read(&args.result), outputs, global.force)?;
        files.write(&out, |writer| writer.write_all(html.as_bytes()))?;
        files.commit()?;
    }
    if global.json {
        let bytes = html.len();
        say(&pretty(&Written {
            kind,
            written: [out],
            bytes,
        })?);
    } else if !global.quiet {
        say(&format!(
            "{}: {kind}, {:.2} MB\n",
            out.display(),
            html.len() as f64 / 1e6
        ));
    }
    Ok(())
}

/// The inputs: a table, or the files of a folder, without pages that this command made of it.
fn read(result: &Path) -> Vec<PathBuf> {
    if !result.is_dir() {
        return vec![result.to_path_buf()];
    }
    let record = FolderRecord::read(result);
    let is_page = |path: &Path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let writer = record
            .as_ref()
            .and_then(|record| record.writer_of(result, &name));
        writer == Some("report") || (writer.is_none() && name == PAGE)
    };
    let entries = std::fs::read_dir(result).into_iter().flatten().flatten();
    let files = entries.map(|entry| entry.path());
    files.filter(|path| !is_page(path)).collect()
}

/// What it is, where its page goes by default, and the page.
fn html(result: &Path) -> Result<(&'static str, PathBuf, String), Failure> {
    let told = |reason: &str| Failure::BadInput(format!("{}: {reason}", result.display()));
    if !result.exists() {
        return Err(told("cannot be read: there is no such file or folder"));
    }
    if !result.is_dir() {
        if result.extension().is_some_and(|ending| ending == "lut") {
            let html = table::page(result)?;
            return Ok(("table", result.with_extension("html"), html));
        }
        return Err(told(
            "expected a folder that a command of kufe has written, or a .lut file",
        ));
    }
    let entries = std::fs::read_dir(result).into_iter().flatten().flatten();
    let mut files = entries.map(|entry| entry.path());
    if let Some(link) = files.find(|path| path.is_file() && leads_out(path)) {
        return Err(Failure::BadInput(format!(
            "{}: a link that leads out of the folder; expected a file in it",
            link.display()
        )));
    }
    let default = result.join(PAGE);
    if result.join("result.json").is_file() {
        Ok(("press", default, contact::page(result)?))
    } else if result.join("table.json").is_file() {
        Ok(("series", default, series::page(result)?))
    } else if result.join("evaluation.json").is_file() {
        Ok(("evaluation", default, evaluation::page(result)?))
    } else if result.join("report.json").is_file() {
        Ok(("discovery", default, written(&result.join(PAGE))?))
    } else if result.join("check.json").is_file() {
        Ok(("check", default, written(&result.join("check.html"))?))
    } else if results::DOCUMENTS
        .iter()
        .any(|name| result.join(name).is_file())
    {
        Ok(("results", default, results::page(result)?))
    } else if result.join(gathered::INDEX).is_file() {
        Ok(("runs", default, gathered::page(result)?))
    } else {
        Err(told(&without_page(result).unwrap_or_else(|| {
            "nothing to report on: expected what a command of kufe has written, as result.json or table.json (kufe press), \
             evaluation.json (kufe evaluate) or report.json (kufe discover)"
                .into()
        })))
    }
}

/// What a folder without figures holds, and the command that shows it.
fn without_page(folder: &Path) -> Option<String> {
    let shown = |name: &str| folder.join(name).display().to_string();
    if folder.join("plan.json").is_file() {
        return Some(format!(
            "the plan of a table: solve its shards, then kufe lut merge {} -o table.lut makes the table, which kufe report shows",
            folder.display()
        ));
    }
    if folder.join("glides.csv").is_file() {
        return Some(format!(
            "glides without figures: kufe icehouse {} makes them",
            shown("glides.csv")
        ));
    }
    let entries = std::fs::read_dir(folder).ok()?;
    let mut tables: Vec<PathBuf> = entries
        .filter_map(|entry| Some(entry.ok()?.path()))
        .filter(|path| path.extension().is_some_and(|ending| ending == "lut"))
        .collect();
    tables.sort();
    let first = tables.first()?;
    Some(format!(
        "lookup tables, which have a page each: kufe report {}",
        first.display()
    ))
}

/// The page that a command has written itself.
fn written(path: &Path) -> Result<String, Failure> {
    kufe_files::text_of_regular(path, 1 << 30)
        .map_err(|error| Failure::BadInput(format!("{}: cannot be read: {error}", path.display())))
}
