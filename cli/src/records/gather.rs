//! `kufe runs gather`: the runs of several folders in one index.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_files::same_file;
use kufe_sled::{Entry, write_index};
use serde_json::json;

use crate::output::global::Global;
use crate::output::say::say;
use crate::output::staging::Staging;
use crate::output::watched::warn;
use crate::records::gathered::{Gathered, UNNAMED, gathered};

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
    if args.out.exists() {
        let text = format!(
            "{}: exists already: expected a name that is free",
            args.out.display()
        );
        return Err(Failure::BadInput(text));
    }
    let name = args.out.file_name().and_then(|name| name.to_str());
    let name =
        name.ok_or_else(|| Failure::Usage(format!("-o {}: expected a file", args.out.display())))?;
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
    let mut names: Vec<&str> = vec![name];
    names.extend(tracks.keys().map(String::as_str));
    if args.copy {
        names.extend(copies.iter().map(String::as_str));
    }
    let staging = Staging::beside(&inputs, folder, &names)?;
    staging.remove_on_interrupt();
    for (file, bytes) in &tracks {
        staging.write(file, |mut to| std::io::Write::write_all(&mut to, bytes))?;
    }
    let base = absolute(folder)?;
    for (entry, copy) in entries.iter_mut().zip(&copies) {
        if args.copy {
            std::fs::copy(&entry.file, staging.path(copy))
                .map_err(|error| staging.failure(copy, &error))?;
            entry.file = PathBuf::from(copy);
        } else {
            entry.file = relative(&absolute(&entry.file)?, &base);
        }
    }
    staging.write(name, |file| write_index(file, &entries))?;
    staging.commit()?;
    tell(args, global, &entries, &renamed, &passed_over);
    Ok(())
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
        let name = format!("track_{}.csv", entry.track);
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

/// What a run's copy is called: its name, with signs that files may have.
fn copied_as(entry: &Entry) -> String {
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '_'
        }
    };
    let name: String = entry.run.chars().map(plain).collect();
    match entry.file.extension() {
        Some(ending) => format!("{name}.{}", ending.to_string_lossy()),
        None => name,
    }
}

fn absolute(path: &Path) -> Result<PathBuf, Failure> {
    // Links within stay as they are named; `..` goes.
    let told = |error| Failure::BadInput(format!("{}: {error}", path.display()));
    match path.canonicalize() {
        Ok(whole) => Ok(whole),
        Err(_) => std::path::absolute(path).map_err(told),
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
