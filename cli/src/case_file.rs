//! A case and the file that it came from.

use std::path::{Path, PathBuf};

use kufe_contact::case::{Case, CaseError};
use kufe_contact::{Error, Problem};

use crate::failure::Failure;

/// The case that is solved where none is given.
pub const EXAMPLE: &str = include_str!("../assets/example.toml");

/// A case file is a page of text; what is longer than this is something else [bytes].
const LONGEST: u64 = 1 << 20;

/// A case and where it stands.
#[derive(Clone, Debug)]
pub struct LoadedCase {
    /// What to call it in messages.
    pub name: String,
    /// The folder that a hull's path starts from.
    pub base: PathBuf,
    /// The case.
    pub case: Case,
}

impl LoadedCase {
    /// The built-in example.
    ///
    /// # Errors
    /// None in a released program; the example is part of it.
    pub fn example() -> Result<LoadedCase, Failure> {
        LoadedCase::parse("the built-in example", Path::new(""), EXAMPLE)
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] naming the file, the line, the key, the value and what was expected.
    pub fn read(path: &Path) -> Result<LoadedCase, Failure> {
        let name = path.display().to_string();
        let told = |reason: String| Failure::BadInput(format!("{name}: {reason}"));
        let meta =
            std::fs::metadata(path).map_err(|error| told(format!("cannot be read: {error}")))?;
        if meta.len() > LONGEST {
            return Err(told(format!(
                "{} bytes: expected a case file of at most {LONGEST} bytes",
                meta.len()
            )));
        }
        let text = std::fs::read_to_string(path)
            .map_err(|error| told(format!("cannot be read: {error}")))?;
        let base = path.parent().unwrap_or(Path::new(""));
        LoadedCase::parse(&name, base, &text)
    }

    fn parse(name: &str, base: &Path, text: &str) -> Result<LoadedCase, Failure> {
        let case =
            Case::parse(text).map_err(|error| Failure::BadInput(format!("{name}: {error}")))?;
        Ok(LoadedCase {
            name: name.to_string(),
            base: base.to_path_buf(),
            case,
        })
    }

    /// The problem that the case states, with what its reader should be warned of.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the hull cannot be had.
    pub fn problem(&self) -> Result<(Problem, Vec<String>), Failure> {
        let told = |error: CaseError| Failure::BadInput(format!("{}: {error}", self.name));
        let problem = self.case.problem(&self.base).map_err(told)?;
        Ok((problem, Vec::new()))
    }

    /// A solver's error as the command's.
    pub fn failure(&self, error: &Error) -> Failure {
        let text = format!("{}: {error}", self.name);
        match error {
            Error::NotConverged { .. } | Error::AccuracyNotReached { .. } => {
                Failure::NotConverged(text)
            }
            _ => Failure::BadInput(text),
        }
    }
}
