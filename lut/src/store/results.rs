//! Results on disk, one file a point, whole or absent.
//!
//! A file is written beside its place, flushed to the disk and renamed, so a process that dies leaves every finished point
//! and no half ones. Each file carries what it belongs to and a checksum of itself.

use std::io::Read;
use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};
use sha2::{Digest, Sha256};

use crate::error::Error;
use crate::file::json::{get, number, object, point_json, read_method, text};
use crate::table::quantity::Quantity;
use crate::table::solved::{Point, Solved};

/// Most bytes of a point's file.
const MAX_POINT_BYTES: u64 = 1 << 16;

/// What results must have in common to make one table.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Origin {
    /// Version of the program that solves.
    pub version: String,
    /// SHA-256 of the case, of the content of the files it names and of the solver's tolerance, hexadecimal.
    pub case_sha256: String,
}

/// A folder of results.
#[derive(Clone, Debug)]
pub struct Store {
    folder: PathBuf,
    origin: Origin,
}

impl Store {
    /// The folder's results of this origin; makes the folder where it is missing.
    ///
    /// # Errors
    /// [`Error::Io`] where the folder cannot be made.
    pub fn open(folder: &Path, origin: Origin) -> Result<Self, Error> {
        std::fs::create_dir_all(folder).map_err(|source| Error::Io {
            path: folder.display().to_string(),
            action: "cannot be made",
            source,
        })?;
        kufe_files::clear_temporaries(folder);
        Ok(Store {
            folder: folder.to_path_buf(),
            origin,
        })
    }

    /// The folder.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// What the results belong to.
    pub fn origin(&self) -> &Origin {
        &self.origin
    }

    /// The file of a point.
    pub fn path(&self, point: &Point) -> PathBuf {
        let name = sha256(point_json(point).to_string().as_bytes());
        self.folder.join(format!("{}.json", &name[..32]))
    }

    /// The result of a point, `None` where it has none.
    ///
    /// # Errors
    /// [`Error::Corrupt`] where the file's checksum does not hold or it is another point's, [`Error::Mixture`] where it
    /// is of another version or case, [`Error::Io`] where it cannot be read.
    pub fn get(&self, point: &Point) -> Result<Option<Solved>, Error> {
        let path = self.path(point);
        let name = || path.display().to_string();
        let file = match kufe_files::open_regular(&path) {
            Ok(file) => file,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(source) => {
                return Err(Error::Io {
                    path: name(),
                    action: "cannot be opened",
                    source,
                });
            }
        };
        let mut bytes = Vec::new();
        file.take(MAX_POINT_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(|source| Error::Io {
                path: name(),
                action: "cannot be read",
                source,
            })?;
        let damaged = |reason: String| Error::Corrupt {
            path: name(),
            reason,
        };
        let record: Value = serde_json::from_slice(&bytes)
            .map_err(|error| damaged(format!("it is no JSON: {error}")))?;
        let (body, stated) = split_checksum(&record).map_err(|error| damaged(error.to_string()))?;
        let found = sha256(Value::Object(body.clone()).to_string().as_bytes());
        if found != stated {
            return Err(damaged(format!(
                "its checksum is {found}, it states {stated}"
            )));
        }
        for (what, expected) in [
            ("version", &self.origin.version),
            ("case_sha256", &self.origin.case_sha256),
        ] {
            let found = text(&body, what).map_err(|error| damaged(error.to_string()))?;
            if found != expected {
                return Err(Error::Mixture {
                    path: name(),
                    what,
                    found: found.into(),
                    expected: expected.clone(),
                });
            }
        }
        if body.get("point") != Some(&point_json(point)) {
            return Err(damaged(format!("it is not the result of {point}")));
        }
        read_figures(&body)
            .map(Some)
            .map_err(|error| damaged(error.to_string()))
    }

    /// Keeps the result of a point.
    ///
    /// # Errors
    /// [`Error::Io`] with the file where it cannot be written, a full disk for one.
    pub fn put(&self, point: &Point, solved: &Solved) -> Result<(), Error> {
        let mut body = Map::new();
        body.insert("version".into(), json!(self.origin.version));
        body.insert("case_sha256".into(), json!(self.origin.case_sha256));
        body.insert("point".into(), point_json(point));
        let figures: Map<String, Value> = solved
            .own_keys()
            .iter()
            .zip(solved.figures())
            .map(|(key, value)| (key.to_string(), json!(value)))
            .collect();
        body.insert("result".into(), Value::Object(figures));
        body.insert("method".into(), json!(solved.method.name()));
        let checksum = sha256(Value::Object(body.clone()).to_string().as_bytes());
        body.insert("sha256".into(), json!(checksum));
        write_file(
            &self.path(point),
            Value::Object(body).to_string().as_bytes(),
        )
    }

    /// Removes the files of these points and, where that leaves it empty, the folder.
    ///
    /// # Errors
    /// [`Error::Io`] where a file that is there cannot be removed.
    pub fn clear(&self, points: &[Point]) -> Result<(), Error> {
        for point in points {
            let path = self.path(point);
            match std::fs::remove_file(&path) {
                Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
                    return Err(Error::Io {
                        path: path.display().to_string(),
                        action: "cannot be removed",
                        source,
                    });
                }
                _ => {}
            }
        }
        // Fails where something else is in there: that stays.
        let _ = std::fs::remove_dir(&self.folder);
        Ok(())
    }
}

fn split_checksum(record: &Value) -> Result<(Map<String, Value>, String), Error> {
    let mut body = object(record, "the file")?.clone();
    let stated = text(&body, "sha256")?.to_string();
    body.remove("sha256");
    Ok((body, stated))
}

fn read_figures(body: &Map<String, Value>) -> Result<Solved, Error> {
    let result = object(get(body, "result", "the file")?, "result")?;
    let has = |key| result.contains_key(key);
    let keys = Solved::keys(has(Quantity::Mu.key()), has("area_error_m2"));
    let figures: Result<Vec<f64>, Error> = keys
        .iter()
        .map(|key| number(get(result, key, "result")?, key))
        .collect();
    let method = read_method(get(body, "method", "the file")?, "method")?;
    Ok(Solved {
        method,
        ..Solved::from_figures(&figures?)
    })
}

/// SHA-256 as lower-case hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}

/// Writes a file that is whole or absent.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), Error> {
    kufe_files::write_whole(path, |writer| writer.write_all(bytes)).map_err(|source| Error::Io {
        path: path.display().to_string(),
        action: "cannot be written",
        source,
    })
}
