//! `kufe report`: one page of the results of another command.

mod pages;

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_files::{leads_out, same_file};
use serde::Serialize;

use crate::output::{FolderRecord, OutputFiles};
use crate::terminal::Global;

pub use pages::{LONGEST_TREE, read_json};

/// The page of a folder, by default.
const PAGE: &str = "report.html";

/// Arguments of `kufe report`.
#[derive(clap::Args, Debug)]
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
/// [`Failure::BadInput`] where there is nothing to report on, a file of it is broken, or the page
/// cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let (kind, default, html) = html(&args.result)?;
    let out = args.out.clone().unwrap_or(default);
    // kufe discover writes its page itself.
    if kind != "discovery" || !same_file(&out, &args.result.join(PAGE)) {
        let outputs = std::slice::from_ref(&out);
        let files = OutputFiles::begin("report", &read(&args.result, &out), outputs, global.force)?;
        files.write(&out, |writer| writer.write_all(html.as_bytes()))?;
        files.commit()?;
    }
    let bytes = html.len();
    let written = Written {
        kind,
        written: [out],
        bytes,
    };
    global.print(&written, || {
        let [out] = &written.written;
        format!("{}: {kind}, {:.2} MB\n", out.display(), bytes as f64 / 1e6)
    })
}

/// The inputs: a table, or the files of a folder, without `out` where it is this command's page.
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

/// The kind of the result, where its page goes by default, and the page.
fn html(result: &Path) -> Result<(&'static str, PathBuf, String), Failure> {
    let wrong = |reason: &str| Failure::BadInput(format!("{}: {reason}", result.display()));
    if !result.exists() {
        return Err(wrong("cannot be read: there is no such file or folder"));
    }
    if !result.is_dir() {
        if result.extension().is_some_and(|ending| ending == "lut") {
            let html = pages::table(result)?;
            return Ok(("table", result.with_extension("html"), html));
        }
        return Err(wrong(
            "expected a folder that a command of kufe has written, or a .lut file",
        ));
    }
    let entries = std::fs::read_dir(result).into_iter().flatten().flatten();
    let mut files = entries.map(|entry| entry.path());
    if let Some(link) = files.find(|path| path.is_file() && leads_out(result, path)) {
        return Err(Failure::BadInput(format!(
            "{}: a link that leads out of the folder; expected a file in it",
            link.display()
        )));
    }
    let has = |name: &str| result.join(name).is_file();
    let (kind, html) = if has("result.json") {
        ("press", pages::contact(result)?)
    } else if has("comparison.json") {
        (
            "comparison",
            pages::written(&result.join("comparison.html"))?,
        )
    } else if has("table.json") {
        ("series", pages::series(result)?)
    } else if has("evaluation.json") {
        ("evaluation", pages::evaluation(result)?)
    } else if has("report.json") {
        ("discovery", pages::written(&result.join(PAGE))?)
    } else if has("check.json") {
        ("check", pages::written(&result.join("check.html"))?)
    } else if pages::DOCUMENTS.into_iter().any(has) {
        ("results", pages::documents(result)?)
    } else if has(pages::INDEX) {
        ("runs", pages::index(result)?)
    } else {
        return Err(wrong(&without_page(result).unwrap_or_else(|| {
            "no results: expected what a command of kufe has written, as result.json or table.json (kufe press), \
             evaluation.json (kufe evaluate) or report.json (kufe discover)"
                .into()
        })));
    };
    Ok((kind, result.join(PAGE), html))
}

/// The contents of a folder without figures, and the command that shows them.
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
