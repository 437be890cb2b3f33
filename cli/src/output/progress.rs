//! How far a command is, on standard error.

use std::borrow::Cow;
use std::time::Instant;

use indicatif::ProgressBar;

use crate::output::say::note;

/// How far a command is.
#[derive(Clone)]
pub struct Progress {
    bar: ProgressBar,
    lines: bool,
    begun: Instant,
}

impl Progress {
    /// Counts from now; with `lines` each step is a line on standard error too.
    pub fn new(bar: ProgressBar, lines: bool) -> Progress {
        Progress {
            bar,
            lines,
            begun: Instant::now(),
        }
    }

    /// Says what is being done.
    pub fn set_message(&self, text: impl Into<Cow<'static, str>>) {
        let text = text.into();
        if self.lines {
            note(&format!(
                "{:.2} s: {text}",
                self.begun.elapsed().as_secs_f64()
            ));
        }
        self.bar.set_message(text);
    }

    /// Does something while the line is out of the way.
    pub fn suspend<T>(&self, work: impl FnOnce() -> T) -> T {
        self.bar.suspend(work)
    }

    /// Takes the line away.
    pub fn finish_and_clear(&self) {
        self.bar.finish_and_clear();
    }
}
