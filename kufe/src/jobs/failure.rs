//! How a job ends when it does not end well.

use std::fmt;
use std::process::ExitCode;

/// A failed job: what to say, and of which kind it is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// A combination of arguments is wrong (exit code 2).
    Usage(String),
    /// A file or a value in it is not what it must be, or a file cannot be written (exit code 3).
    BadInput(String),
    /// An iteration stopped short of its tolerance (exit code 4).
    NotConverged(String),
    /// Part of the work is done and stored; the rest can be resumed (exit code 5).
    Partial(String),
}

impl Failure {
    /// Bad input by a library's error.
    pub fn bad_input(error: impl fmt::Display) -> Self {
        Failure::BadInput(error.to_string())
    }

    /// The same failure at a place: `place: text`.
    #[must_use]
    pub fn within(self, place: &str) -> Self {
        let at = |text: String| format!("{place}: {text}");
        match self {
            Failure::Usage(text) => Failure::Usage(at(text)),
            Failure::BadInput(text) => Failure::BadInput(at(text)),
            Failure::NotConverged(text) => Failure::NotConverged(at(text)),
            Failure::Partial(text) => Failure::Partial(at(text)),
        }
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

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Usage(text)
            | Failure::BadInput(text)
            | Failure::NotConverged(text)
            | Failure::Partial(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for Failure {}
