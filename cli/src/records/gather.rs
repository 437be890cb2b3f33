//! `kufe runs gather`: the runs of several folders in one index.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_sled::{Entry, file_stem, track_file, write_index};
use serde_json::json;

use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::paths::{leads_out, resolved, same_file};
use crate::output::say::{say, warn};
use crate::records::gathered::{Gathered, UNNAMED, gathered, is_run};

const EXAMPLES: &str = "\
Examples:
  kufe runs gather monday/ tuesday/ wednesday/ -o runs.csv               three days' indices in one
  kufe runs gather raw/ -o runs.csv --track igls --session-from-folder   files without an index
  kufe runs gather monday/runs.csv extra/late.csv -o all/runs.csv --copy into a folder of their own

Of a folder its runs.csv is taken, or, without one, its files that are runs. The index names them by relative paths; runs whose
names stand in several folders get the folder's before them. Tables of tracks (track_NAME.csv) are written beside the index,
where commands look for them. Options fill in what is not stated and change nothing that is.";

/// Arguments of `kufe runs gather`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Folders, indices and files of runs
    #[arg(required = true, value_name = "FOLDER")]
    pub from: Vec<PathBuf>,
    /// The index of them all, a file that is not there yet
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

/// Reads the indices, settles names and places, and writes one.
///
/// # Errors
/// [`Failure::BadInput`] with file and place; for runs of one name in folders of one name, and tables of one track that differ.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if args.out.file_name().is_none() {
        let text = format!("-o {}: expected a file", args.out.display());
        return Err(Failure::Usage(text));
    }
    let folder = args
        .out
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    let Gathered {
        mut entries,
        passed_over,
    } = gathered(&args.from)?;
    let renamed = with_own_names(&mut entries)?;
    fill_in(args, &mut entries);
    let tracks = track_tables(&entries, folder)?;
    let inputs: Vec<PathBuf> = entries.iter().map(|entry| entry.file.clone()).collect();
    let copies: Vec<String> = entries.iter().map(copied_as).collect();
    let mut paths: Vec<PathBuf> = tracks.keys().map(|name| folder.join(name)).collect();
    if args.copy {
        entries.iter().try_for_each(may_be_copied)?;
        paths.extend(copies.iter().map(|name| folder.join(name)));
    }
    paths.push(args.out.clone());
    let output = OutputFiles::begin("runs gather", &inputs, &paths, global.force)?;
    for (name, bytes) in &tracks {
        output.write(&folder.join(name), |to| to.write_all(bytes))?;
    }
    let base = resolved(folder);
    for (entry, copy) in entries.iter_mut().zip(&copies) {
        if args.copy {
            output.write(&folder.join(copy), |mut to| {
                let mut from = kufe_files::open_regular(&entry.file)?;
                std::io::copy(&mut from, &mut to).map(|_| ())
            })?;
            entry.file = PathBuf::from(copy);
        } else {
            entry.file = relative(&resolved(&entry.file), &base);
        }
    }
    output.write(&args.out, |file| write_index(file, &entries))?;
    output.commit()?;
    tell(args, global, &entries, &renamed, &passed_over);
    Ok(())
}

/// Refuses to copy what a foreign index or folder names and is no run of its own.
fn may_be_copied(entry: &Entry) -> Result<(), Failure> {
    let refuse = |reason: &str| {
        let file = entry.file.display();
        Err(Failure::BadInput(format!(
            "{file}: not copied: {reason}; expected a file of a run"
        )))
    };
    if leads_out(&entry.file) {
        return refuse("a link that leads out of its folder");
    }
    match is_run(&entry.file)? {
        true => Ok(()),
        false => refuse("it has no columns t_s and v_mps"),
    }
}

/// Puts the folder's name before every run's whose name another folder's run has; the new names.
fn with_own_names(entries: &mut [Entry]) -> Result<Vec<String>, Failure> {
    let mut count: BTreeMap<String, usize> = BTreeMap::new();
    for entry in entries.iter() {
        *count.entry(entry.run.clone()).or_default() += 1;
    }
    let mut renamed = Vec::new();
    for entry in entries.iter_mut().filter(|entry| count[&entry.run] > 1) {
        entry.run = format!("{}_{}", folder_of(&entry.file), entry.run);
        renamed.push(entry.run.clone());
    }
    let mut seen: BTreeMap<&str, &Entry> = BTreeMap::new();
    for entry in entries.iter() {
        if let Some(first) = seen.insert(&entry.run, entry) {
            return Err(Failure::BadInput(format!(
                "{}: run {:?} is {} too: expected names that differ, or folders whose names do",
                entry.file.display(),
                entry.run,
                first.file.display()
            )));
        }
    }
    Ok(renamed)
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

/// The name of the folder that a file is in.
fn folder_of(file: &Path) -> String {
    let whole = std::path::absolute(file).unwrap_or_else(|_| file.into());
    let folder = whole.parent().and_then(Path::file_name);
    folder.map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}

/// The tables of the tracks that stand beside the runs, by the name that they get beside the index; not those that are there already.
fn track_tables(entries: &[Entry], folder: &Path) -> Result<BTreeMap<String, Vec<u8>>, Failure> {
    /// A track has some thousand rows [bytes].
    const LONGEST: u64 = 1 << 26;
    let mut tables: BTreeMap<String, (PathBuf, Vec<u8>)> = BTreeMap::new();
    for entry in entries {
        let name = track_file(&entry.track);
        let beside = entry.file.parent().unwrap_or(Path::new("")).join(&name);
        for path in [beside, folder.join(&name)] {
            if !path.is_file() {
                continue;
            }
            let bytes = kufe_files::read_regular(&path, LONGEST).map_err(|error| {
                Failure::BadInput(format!("{}: cannot be read: {error}", path.display()))
            })?;
            match tables.get(&name) {
                Some((first, known)) if *known != bytes => {
                    return Err(Failure::BadInput(format!(
                        "{}: another table of track {} than {}: expected one of each track",
                        path.display(),
                        entry.track,
                        first.display()
                    )));
                }
                Some(_) => {}
                None => {
                    tables.insert(name.clone(), (path, bytes));
                }
            }
        }
    }
    let missing = |(name, (path, bytes)): (String, (PathBuf, Vec<u8>))| {
        (!same_file(&path, &folder.join(&name)) && !folder.join(&name).exists())
            .then_some((name, bytes))
    };
    Ok(tables.into_iter().filter_map(missing).collect())
}

/// The name of a run's copy.
fn copied_as(entry: &Entry) -> String {
    let name = file_stem(&entry.run);
    match entry.file.extension() {
        Some(ending) => format!("{name}.{}", ending.to_string_lossy()),
        None => name,
    }
}

/// The way from a folder to a file, both whole.
fn relative(file: &Path, folder: &Path) -> PathBuf {
    let (file, folder): (Vec<_>, Vec<_>) =
        (file.components().collect(), folder.components().collect());
    let shared = file.iter().zip(&folder).take_while(|(a, b)| a == b).count();
    let up = folder[shared..]
        .iter()
        .map(|_| std::path::Component::ParentDir);
    up.chain(file[shared..].iter().copied()).collect()
}

/// A name that an index states of a run.
type Name = fn(&Entry) -> &str;

fn tell(
    args: &Args,
    global: &Global,
    entries: &[Entry],
    renamed: &[String],
    passed_over: &[String],
) {
    let stated = |of: Name| -> BTreeSet<&str> {
        entries
            .iter()
            .map(of)
            .filter(|name| *name != UNNAMED)
            .collect()
    };
    let fields: [(&str, Name); 3] = [
        ("session", |entry| &entry.session),
        ("driver", |entry| &entry.driver),
        ("track", |entry| &entry.track),
    ];
    if !global.quiet {
        for (name, of) in fields {
            let without = entries.iter().filter(|entry| of(entry) == UNNAMED).count();
            if without > 0 {
                warn(&format!(
                    "{without} of {} runs state no {name}: --{name} NAME does for them",
                    entries.len()
                ));
            }
        }
    }
    if global.json {
        let document = json!({
            "written": args.out,
            "runs": entries.len(),
            "renamed": renamed,
            "passed_over": passed_over,
            "sessions": stated(|entry| &entry.session),
            "drivers": stated(|entry| &entry.driver),
            "tracks": stated(|entry| &entry.track),
        });
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        let mut text = String::new();
        for passed in passed_over {
            text += &format!("passed over: {passed}\n");
        }
        if !renamed.is_empty() {
            text += &format!(
                "named by their folders, for others have their names: {}\n",
                renamed.join(", ")
            );
        }
        let counts = fields.map(|(name, of)| {
            let count = stated(of).len();
            format!("{count} {name}{}", if count == 1 { "" } else { "s" })
        });
        text += &format!(
            "{}: {} runs, {}\n",
            args.out.display(),
            entries.len(),
            counts.join(", ")
        );
        say(&text);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_way_from_an_index_to_a_run_goes_up_and_down() {
        let way = |file: &str, folder: &str| relative(Path::new(file), Path::new(folder));
        assert_eq!(way("/a/b/run.csv", "/a"), Path::new("b/run.csv"));
        assert_eq!(way("/a/b/run.csv", "/a/c/d"), Path::new("../../b/run.csv"));
        assert_eq!(way("/a/run.csv", "/a"), Path::new("run.csv"));
    }
}
