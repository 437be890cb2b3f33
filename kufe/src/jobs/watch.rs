//! Callbacks of a job: progress, warnings and a stop flag.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::jobs::failure::Failure;

/// Callbacks for progress and warnings, and a flag that stops the job.
///
/// The default ignores all messages and never stops.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    /// Receives the progress of the job.
    pub progress: Option<&'a (dyn Fn(&str) + Sync)>,
    /// Receives warnings; the job continues.
    pub warn: Option<&'a (dyn Fn(&str) + Sync)>,
    /// If true, the job finishes the current step and begins no other.
    pub stop: Option<&'a AtomicBool>,
}

impl Watch<'_> {
    /// Reports the progress of the job.
    pub fn progress(&self, text: &str) {
        if let Some(progress) = self.progress {
            progress(text);
        }
    }

    /// Reports a warning.
    pub fn warn(&self, text: &str) {
        if let Some(warn) = self.warn {
            warn(text);
        }
    }

    /// Whether the job shall stop.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Returns an error if the job shall stop.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if self.stopped() {
            return Err(Failure::Partial("stopped before the end".into()));
        }
        Ok(())
    }
}
