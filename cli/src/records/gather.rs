//! `kufe runs gather`: the runs of several folders in one index.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::gather::{Gathered, UNNAMED, folder_of, gather, is_run, relative, track_tables};
use kufe::jobs::runs::run_inputs;
use kufe_files::leads_out;
use kufe_sled::{Entry, file_stem, write_index};
use serde::Serialize;

use crate::output::OutputFiles;
use crate::terminal::{Global, warn};
use crate::text::print_document;

/// Arguments of `kufe runs gather`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Folders, indices and files of runs
    #[arg(required = true, value_name = "FOLDER")]
    pub from: Vec<PathBuf>,
    /// The index to write, a new file
    #[arg(long, short, value_name = "CSV")]
    pub out: PathBuf,
    /// Copy the runs into the index's folder
    #[arg(long)]
    pub copy: bool,
    /// Track, where none is stated
    #[arg(long, value_name = "NAME")]
    pub track: Option<String>,
    /// Session, where none is stated
    #[arg(long, value_name = "NAME", conflicts_with = "session_from_folder")]
    pub session: Option<String>,
    /// The folder's name as session, where none is stated
    #[arg(long)]
    pub session_from_folder: bool,
    /// Driver, where none is stated
    #[arg(long, value_name = "NAME")]
    pub driver: Option<String>,
    /// Driver's class, where none is stated
    #[arg(long, value_name = "NAME")]
    pub driver_class: Option<String>,
}

/// An index that was written.
#[derive(Serialize)]
struct WrittenIndex<'a> {
    written: &'a Path,
    runs: usize,
    renamed: &'a [String],
    passed_over: &'a [String],
    sessions: BTreeSet<&'a str>,
    drivers: BTreeSet<&'a str>,
    tracks: BTreeSet<&'a str>,
}

/// Reads the indices and writes one, with the tables of the tracks, and copies of the runs where
/// requested.
///
/// # Errors
/// [`Failure::BadInput`] with file and place; for runs of equal names in folders of equal names,
/// and for differing tables of one track.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if args.out.file_name().is_none() {
        let text = format!("-o {}: expected a file", args.out.display());
        return Err(Failure::Usage(text));
    }
    let folder = args.out.parent().filter(|folder| *folder != Path::new(""));
    let folder = folder.unwrap_or(Path::new("."));
    let mut gathered = gather(&args.from)?;
    let entries = &mut gathered.entries;
    fill_in(args, entries);
    let tracks = track_tables(entries, folder)?;
    let mut inputs: Vec<PathBuf> = entries.iter().map(|entry| entry.file.clone()).collect();
    for path in &args.from {
        inputs.extend(run_inputs(path));
        inputs.extend(run_inputs(&path.join("runs.csv")));
    }
    let copies: Vec<String> = entries.iter().map(copied_as).collect();
    let mut paths: Vec<PathBuf> = tracks.keys().map(|name| folder.join(name)).collect();
    if args.copy {
        let check = |entry| check_copied(entry, &args.from);
        entries.iter().try_for_each(check)?;
        paths.extend(copies.iter().map(|name| folder.join(name)));
    }
    paths.push(args.out.clone());
    let output = OutputFiles::begin("runs gather", &inputs, &paths, global.force)?;
    for (name, bytes) in &tracks {
        output.bytes(&folder.join(name), bytes)?;
    }
    for (entry, copy) in entries.iter_mut().zip(&copies) {
        if args.copy {
            output.write(&folder.join(copy), |mut to| {
                let mut from = kufe_files::open_regular(&entry.file)?;
                std::io::copy(&mut from, &mut to).map(|_| ())
            })?;
            entry.file = PathBuf::from(copy);
        } else {
            entry.file = relative(&entry.file, folder);
        }
    }
    output.write(&args.out, |file| write_index(file, entries))?;
    output.commit()?;
    report(args, global, &gathered)
}

/// Refuses to copy files that are not runs, and links out of their folder of `from`.
fn check_copied<'a>(entry: &'a Entry, from: &'a [PathBuf]) -> Result<(), Failure> {
    let refuse = |reason: &str| {
        let reason = format!("not copied: {reason}; expected a file of a run");
        Err(Failure::in_file(&entry.file, reason))
    };
    let parent = |path: &'a Path| path.parent().unwrap_or(Path::new(""));
    let folder = |path: &'a PathBuf| if path.is_dir() { path } else { parent(path) };
    let folders = from.iter().map(folder);
    let own = folders.filter(|folder| entry.file.starts_with(folder));
    let own = own.max_by_key(|folder| folder.components().count());
    if leads_out(own.unwrap_or(parent(&entry.file)), &entry.file) {
        return refuse("a link leads to it, out of its folder");
    }
    if !is_run(&entry.file)? {
        return refuse("it has no columns t_s and v_mps");
    }
    Ok(())
}

fn fill_in(args: &Args, entries: &mut [Entry]) {
    for entry in entries {
        let from_folder = args.session_from_folder.then(|| folder_of(&entry.file));
        let fill = |field: &mut String, with: Option<&String>| {
            if let (true, Some(with)) = (field == UNNAMED, with) {
                field.clone_from(with);
            }
        };
        fill(&mut entry.track, args.track.as_ref());
        fill(
            &mut entry.session,
            args.session.as_ref().or(from_folder.as_ref()),
        );
        fill(&mut entry.driver, args.driver.as_ref());
        fill(&mut entry.driver_class, args.driver_class.as_ref());
    }
}

/// The name of a run's copy.
fn copied_as(entry: &Entry) -> String {
    let name = file_stem(&entry.run);
    match entry.file.extension() {
        Some(ending) => format!("{name}.{}", ending.to_string_lossy()),
        None => name,
    }
}

fn report(args: &Args, global: &Global, gathered: &Gathered) -> Result<(), Failure> {
    let entries = &gathered.entries;
    let count = entries.len();
    let stated = |name: &str, field: fn(&Entry) -> &str| -> BTreeSet<&str> {
        let without = entries.iter().filter(|entry| field(entry) == UNNAMED);
        let without = without.count();
        if without > 0 && !global.quiet {
            warn(&format!(
                "{without} of {count} runs state no {name}: --{name} NAME does for them"
            ));
        }
        let names = entries.iter().map(field);
        names.filter(|name| *name != UNNAMED).collect()
    };
    let written = WrittenIndex {
        written: &args.out,
        runs: count,
        renamed: &gathered.renamed,
        passed_over: &gathered.passed_over,
        sessions: stated("session", |entry| &entry.session),
        drivers: stated("driver", |entry| &entry.driver),
        tracks: stated("track", |entry| &entry.track),
    };
    print_document(&written, global)
}
