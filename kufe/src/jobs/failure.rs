//! Failures of jobs, with exit codes, and atomic writing of files.

use std::fmt::Display;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// A failed job: its kind, and the message for the user.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Failure {
    /// A combination of arguments is wrong (exit code 2).
    #[error("{0}")]
    Usage(String),
    /// A file or a value in it is not what it must be, or a file cannot be written (exit code 3).
    #[error("{0}")]
    BadInput(String),
    /// An iteration stopped short of its tolerance (exit code 4).
    #[error("{0}")]
    NotConverged(String),
    /// Part of the work is done and stored; the rest can be resumed (exit code 5).
    #[error("{0}")]
    Partial(String),
}

impl Failure {
    /// A wrong value of an option: `--option value: expected ...`.
    pub fn option(option: &str, value: impl Display, expected: impl Display) -> Self {
        Failure::Usage(format!("--{option} {value}: expected {expected}"))
    }

    /// Bad input with the message of a library's error.
    pub fn bad_input(error: impl Display) -> Self {
        Failure::BadInput(error.to_string())
    }

    /// Bad input in a file or a folder.
    pub fn in_file(path: &Path, reason: impl Display) -> Self {
        Failure::BadInput(format!("{}: {reason}", path.display()))
    }

    /// A file or a folder that cannot be read.
    pub fn unreadable(path: &Path, error: impl Display) -> Self {
        Failure::in_file(path, format_args!("cannot be read: {error}"))
    }

    /// A file or a folder that cannot be written.
    pub fn unwritable(path: &Path, error: impl Display) -> Self {
        Failure::in_file(path, format_args!("cannot be written: {error}"))
    }

    /// The failure with a place before its message: `place: text`.
    #[must_use]
    pub fn within(mut self, place: impl Display) -> Self {
        let text = self.text();
        *text = format!("{place}: {text}");
        self
    }

    /// The message.
    pub(crate) fn text(&mut self) -> &mut String {
        let (Failure::Usage(text)
        | Failure::BadInput(text)
        | Failure::NotConverged(text)
        | Failure::Partial(text)) = self;
        text
    }

    /// The process's exit code.
    pub fn exit_code(&self) -> ExitCode {
        ExitCode::from(match self {
            Failure::Usage(_) => 2,
            Failure::BadInput(_) => 3,
            Failure::NotConverged(_) => 4,
            Failure::Partial(_) => 5,
        })
    }
}

impl From<kufe_sled::Error> for Failure {
    fn from(error: kufe_sled::Error) -> Self {
        match error {
            kufe_sled::Error::NotConverged { .. } | kufe_sled::Error::SlipOffsets { .. } => {
                Failure::NotConverged(error.to_string())
            }
            _ => Failure::bad_input(error),
        }
    }
}

/// Conversions of errors into bad input.
macro_rules! from_bad_input {
    ($($error:ty),+) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Failure::bad_input(error)
            }
        }
    )+};
}

from_bad_input!(kufe_lut::Error, kufe_mesh::MeshError, serde_json::Error);

/// Conversion of any error into a failure that names its place.
pub trait Located<T> {
    /// Bad input with the message of a library's error.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the message.
    fn bad_input(self) -> Result<T, Failure>;
    /// Bad input in a file or a folder.
    ///
    /// # Errors
    /// As [`Failure::in_file`].
    fn in_file(self, path: &Path) -> Result<T, Failure>;
    /// A file or a folder that cannot be read.
    ///
    /// # Errors
    /// As [`Failure::unreadable`].
    fn readable(self, path: &Path) -> Result<T, Failure>;
    /// A file or a folder that cannot be written.
    ///
    /// # Errors
    /// As [`Failure::unwritable`].
    fn writable(self, path: &Path) -> Result<T, Failure>;
}

impl<T, E: Display> Located<T> for Result<T, E> {
    fn bad_input(self) -> Result<T, Failure> {
        self.map_err(Failure::bad_input)
    }

    fn in_file(self, path: &Path) -> Result<T, Failure> {
        self.map_err(|error| Failure::in_file(path, error))
    }

    fn readable(self, path: &Path) -> Result<T, Failure> {
        self.map_err(|error| Failure::unreadable(path, error))
    }

    fn writable(self, path: &Path) -> Result<T, Failure> {
        self.map_err(|error| Failure::unwritable(path, error))
    }
}

/// Writes `path` completely or not at all; creates its folder where it is missing.
///
/// # Errors
/// [`Failure::BadInput`] with the path if the folder or the file cannot be written.
pub fn write_whole(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> std::io::Result<()>,
) -> Result<(), Failure> {
    let folder = path.parent().unwrap_or(Path::new(""));
    std::fs::create_dir_all(folder)
        .and_then(|()| kufe_files::write_whole(path, write))
        .writable(path)
}
