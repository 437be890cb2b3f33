//! Solved points of a sweep on disk: a file to which one line of JSON per point is appended.
//!
//! Each line is written at once and flushed to the disk, so that no finished point is lost when the
//! process is killed. A line contains the origin and a checksum. A last line without line end was
//! interrupted and is ignored.

use std::collections::HashMap;
use std::fs::{File, OpenOptions};
use std::io::{BufRead, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use kufe_files::sha256;
use kufe_lut::{AxisKind, Figures, Origin, Point, Solve};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::jobs::failure::{Failure, Located};

/// Maximum length of a line [bytes].
const MAX_LINE_BYTES: u64 = 1 << 14;
/// The first bytes of every file of points.
const PREFIX: &[u8] = br#"{"origin":{"#;
/// Filename extension of the files of points in a folder.
const EXTENSION: &str = "jsonl";

/// A line of a file of points.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Line {
    origin: Origin,
    /// SHA-256 of `solve`.
    sha256: String,
    solve: Box<RawValue>,
}

/// The bits of the coordinates of a point, as a key of maps.
pub(super) type Key = [u64; AxisKind::ALL.len()];

/// The key of a point; -0 and 0 have the same key.
pub(super) fn key(point: &Point) -> Key {
    let bits = |value: f64| (value + 0.0).to_bits();
    AxisKind::ALL.map(|kind| point.get(kind).map_or(u64::MAX, bits))
}

/// The solved points of one sweep.
#[derive(Debug)]
pub struct PointStore {
    /// The file to which points are appended.
    path: PathBuf,
    origin: Origin,
    /// Messages about damaged lines.
    damaged: Vec<String>,
    state: Mutex<State>,
}

#[derive(Debug, Default)]
struct State {
    solved: HashMap<Key, Figures>,
    /// The file, opened when the first point is appended.
    file: Option<File>,
}

impl PointStore {
    /// Reads the points of one file, which need not exist.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the file cannot be read or contains points of another version or
    /// case.
    pub fn of_file(path: &Path, origin: Origin) -> Result<Self, Failure> {
        let mut store = PointStore {
            path: path.to_path_buf(),
            origin,
            damaged: Vec::new(),
            state: Mutex::default(),
        };
        if path.symlink_metadata().is_ok() {
            store.read(path)?;
        }
        Ok(store)
    }

    /// Reads the points of all files of a folder, which need not exist. New points are appended to
    /// the file `name` in it.
    ///
    /// # Errors
    /// As [`of_file`](Self::of_file).
    pub fn of_folder(folder: &Path, name: &str, origin: Origin) -> Result<Self, Failure> {
        if folder.is_symlink() {
            return Err(link(folder));
        }
        let appended = folder.join(name).with_extension(EXTENSION);
        let mut store = PointStore::of_file(&appended, origin)?;
        let mut files = Vec::new();
        if folder.exists() {
            for entry in folder.read_dir().readable(folder)? {
                files.push(entry.readable(folder)?.path());
            }
        }
        files.sort();
        for file in files {
            let is_points = file
                .extension()
                .is_some_and(|extension| extension == EXTENSION);
            if file != appended && is_points {
                store.read(&file)?;
            }
        }
        Ok(store)
    }

    fn read(&mut self, path: &Path) -> Result<(), Failure> {
        if path.is_symlink() {
            return Err(link(path));
        }
        let file = match kufe_files::open_regular(path) {
            // Another process with the same command has finished and removed the file.
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
            opened => opened.in_file(path)?,
        };
        let mut reader = BufReader::new(file);
        let start = reader.fill_buf().readable(path)?;
        let length = start.len().min(PREFIX.len());
        if start[..length] != PREFIX[..length] {
            let reason = "kufe did not write it; expected a file of solved points, or none";
            return Err(Failure::in_file(path, reason));
        }
        let mut line = Vec::new();
        for number in 1.. {
            if !next_line(&mut reader, &mut line).readable(path)? {
                break;
            }
            let place = format!("{}, line {number}", path.display());
            match read_line(&line) {
                Err(reason) => self.damaged.push(format!("{place}: damaged: {reason}")),
                Ok((origin, solve)) => {
                    same_origin(&place, &origin, &self.origin)?;
                    self.lock().solved.insert(key(&solve.point), solve.figures);
                }
            }
        }
        Ok(())
    }

    /// The file to which points are appended.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The origin of all points.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// A message for each damaged line, with the file, the line and the reason.
    pub fn damaged(&self) -> &[String] {
        &self.damaged
    }

    /// The results at a point, if it is solved.
    pub fn get(&self, point: &Point) -> Option<Figures> {
        self.lock().solved.get(&key(point)).copied()
    }

    /// Appends a solved point.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the file if it cannot be written, for example on a full disk.
    pub fn append(&self, solve: &Solve) -> Result<(), Failure> {
        let text = serde_json::to_string(solve)?;
        let line = Line {
            origin: self.origin.clone(),
            sha256: sha256(text.as_bytes()),
            solve: RawValue::from_string(text)?,
        };
        let mut line = serde_json::to_vec(&line)?;
        line.push(b'\n');
        let mut state = self.lock();
        let mut file = match state.file.take() {
            Some(file) => file,
            None => self.open_to_append()?,
        };
        let written = file.write_all(&line).and_then(|()| file.sync_data());
        written.writable(&self.path)?;
        state.file = Some(file);
        state.solved.insert(key(&solve.point), solve.figures);
        Ok(())
    }

    /// Opens the file for appending and removes an interrupted last line.
    fn open_to_append(&self) -> Result<File, Failure> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        std::fs::create_dir_all(folder).writable(folder)?;
        // A symbolic link may have been created since the file was read.
        if folder.is_symlink() || self.path.is_symlink() {
            return Err(link(&self.path));
        }
        let mut options = OpenOptions::new();
        let options = options.read(true).append(true).create(true);
        let whole = options.open(&self.path).and_then(|file| {
            let (mut reader, mut line, mut whole) = (BufReader::new(&file), Vec::new(), 0);
            while next_line(&mut reader, &mut line)? {
                whole += line.len() as u64;
            }
            if whole < file.metadata()?.len() {
                file.set_len(whole)?;
            }
            Ok(file)
        });
        whole.writable(&self.path)
    }

    /// Removes the file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the file exists and cannot be removed.
    pub fn remove(&self) -> Result<(), Failure> {
        self.lock().file = None;
        match std::fs::remove_file(&self.path) {
            // No point was appended, or another process with the same command has removed the file.
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
            removed => removed.writable(&self.path),
        }
    }

    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Reads a line, up to the maximum length. Returns false at the end of the file and for a last line
/// that was interrupted.
fn next_line(reader: &mut impl BufRead, line: &mut Vec<u8>) -> std::io::Result<bool> {
    line.clear();
    reader.take(MAX_LINE_BYTES).read_until(b'\n', line)?;
    Ok(line.ends_with(b"\n") || line.len() as u64 == MAX_LINE_BYTES)
}

fn read_line(line: &[u8]) -> Result<(Origin, Solve), String> {
    let line: Line = serde_json::from_slice(line).map_err(|error| error.to_string())?;
    let found = sha256(line.solve.get().as_bytes());
    if found != line.sha256 {
        let stated = line.sha256;
        return Err(format!("its checksum is {found}, it states {stated}"));
    }
    let solve = serde_json::from_str(line.solve.get()).map_err(|error| error.to_string())?;
    Ok((line.origin, solve))
}

/// Checks that stored results were made by this version for this case.
///
/// # Errors
/// [`Failure::BadInput`] with `place`, which states where the results are stored.
pub fn same_origin(place: &str, stored: &Origin, now: &Origin) -> Result<(), Failure> {
    for (what, stored, now) in [
        ("version", stored.version(), now.version()),
        ("case_sha256", stored.case_sha256(), now.case_sha256()),
    ] {
        if stored != now {
            return Err(Failure::BadInput(format!(
                "{place}: {what} is {stored}, that of this program and case is {now}: the case, a file that it reads \
                 or the program has changed since; delete these points to solve them again, or give another output"
            )));
        }
    }
    Ok(())
}

/// The failure for a symbolic link, which is not followed.
fn link(path: &Path) -> Failure {
    Failure::in_file(
        path,
        "a link is in the way; expected solved points, or none",
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe_lut::Quantity;

    fn origin(version: &str, digit: &str) -> Origin {
        Origin::new(version.into(), digit.repeat(64)).expect("an origin")
    }

    fn solve(n: u32) -> Solve {
        let fz = 100.0 * f64::from(n);
        let figures = Figures::at_rest([1e8 + fz / 3.0, 1e8, 1e-5, 0.05, 3e-4, 1e-5]);
        Solve {
            point: Point {
                fz,
                ..Point::default()
            },
            figures: figures.with_error(Quantity::PMax, 1e5),
        }
    }

    fn points(path: &Path) -> PointStore {
        PointStore::of_file(path, origin("1", "a")).expect("a store")
    }

    fn written(path: &Path) {
        let store = points(path);
        (1..=5).for_each(|n| store.append(&solve(n)).expect("a line"));
    }

    #[test]
    fn points_are_read_back_to_the_bit_and_appended_to() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("t.lut.points");
        written(&path);
        let before = std::fs::read(&path).expect("lines");
        let store = points(&path);
        for n in 1..=5 {
            assert_eq!(store.get(&solve(n).point), Some(solve(n).figures));
        }
        assert_eq!(store.get(&solve(6).point), None);
        store.append(&solve(6)).expect("a line");
        let after = std::fs::read(&path).expect("lines");
        assert!(after.starts_with(&before) && store.damaged().is_empty());
        store.remove().expect("removed");
        assert!(!path.exists());
    }

    #[test]
    fn an_interrupted_last_line_is_not_counted_and_is_replaced() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("points.jsonl");
        written(&path);
        let whole = std::fs::read(&path).expect("lines");
        std::fs::write(&path, &whole[..whole.len() - 9]).expect("cut");
        let store = points(&path);
        assert!(store.damaged().is_empty() && store.get(&solve(5).point).is_none());
        store.append(&solve(5)).expect("a line");
        assert_eq!(std::fs::read(&path).expect("lines"), whole);
    }

    #[test]
    fn damaged_lines_are_named_and_the_others_remain() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("points.jsonl");
        written(&path);
        let whole = std::fs::read_to_string(&path).expect("lines");
        let lines: Vec<&str> = whole.lines().collect();
        let flipped = lines[2].replace("\"p_mean_pa\":1", "\"p_mean_pa\":2");
        assert_ne!(flipped, lines[2]);
        let long = "x".repeat(40_000);
        for damage in ["", &lines[2][..90], "{\"sha256\": 4}", &flipped, &long] {
            std::fs::write(&path, whole.replace(lines[2], damage)).expect("lines");
            let store = points(&path);
            let text = store.damaged().join("\n");
            assert!(text.contains("points.jsonl, line 3: damaged"), "{text}");
            assert!(store.get(&solve(3).point).is_none());
            assert!(
                [1, 2, 4, 5]
                    .iter()
                    .all(|n| store.get(&solve(*n).point).is_some())
            );
        }
    }

    #[test]
    fn versions_and_cases_are_not_mixed() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("points.jsonl");
        written(&path);
        for (other, what) in [
            (origin("9", "a"), "version"),
            (origin("1", "b"), "case_sha256"),
        ] {
            let refused = PointStore::of_folder(folder.path(), "other", other);
            let text = refused.expect_err("another origin").to_string();
            assert!(
                text.contains(what) && text.contains("points.jsonl"),
                "{text}"
            );
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_not_followed_neither_before_nor_after_the_points_are_read() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().expect("a folder");
        let at = |name: &str| folder.path().join(name);
        std::fs::create_dir(at("mine")).expect("a folder");
        written(&at("mine/shard.jsonl"));
        let before = std::fs::read(at("mine/shard.jsonl")).expect("lines");
        symlink("mine", at("linked")).expect("a link");
        let whole = PointStore::of_folder(&at("linked"), "shard", origin("1", "a"));
        assert!(
            whole
                .expect_err("a linked folder")
                .to_string()
                .contains("a link")
        );
        std::fs::create_dir(at("points")).expect("a folder");
        let store = PointStore::of_folder(&at("points"), "shard", origin("1", "a"));
        let store = store.expect("a store");
        symlink("../mine/shard.jsonl", at("points/shard.jsonl")).expect("a link");
        let text = store.append(&solve(9)).expect_err("a link").to_string();
        assert!(text.contains("a link"), "{text}");
        let again = PointStore::of_folder(&at("points"), "shard", origin("1", "a"));
        assert!(again.expect_err("a link").to_string().contains("a link"));
        assert_eq!(
            std::fs::read(at("mine/shard.jsonl")).expect("lines"),
            before
        );
    }

    #[test]
    fn a_file_that_cannot_be_written_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("file"), "in the way").expect("a file");
        let store = points(&folder.path().join("file/points.jsonl"));
        let text = store.append(&solve(1)).expect_err("no folder").to_string();
        assert!(text.contains("cannot be written"), "{text}");
    }
}
