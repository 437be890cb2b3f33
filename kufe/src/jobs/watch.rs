//! Who watches a job.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::jobs::failure::Failure;

/// Someone who receives progress and warnings, and may stop the job.
///
/// The default hears nothing and never stops.
#[derive(Clone, Copy, Default)]
pub struct Watch<'a> {
    /// Receives how far the job is.
    pub progress: Option<&'a (dyn Fn(&str) + Sync)>,
    /// Receives what the user should know; the job goes on.
    pub warn: Option<&'a (dyn Fn(&str) + Sync)>,
    /// Once true, the job finishes what it has in hand and begins nothing else.
    pub stop: Option<&'a AtomicBool>,
}

impl Watch<'_> {
    /// Reports how far the job is.
    pub fn progress(&self, text: &str) {
        if let Some(progress) = self.progress {
            progress(text);
        }
    }

    /// Reports what the user should know.
    pub fn warn(&self, text: &str) {
        if let Some(warn) = self.warn {
            warn(text);
        }
    }

    /// Whether the job is to stop.
    pub fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Ends a job that is to stop.
    pub(crate) fn check(&self) -> Result<(), Failure> {
        if self.stopped() {
            return Err(Failure::Partial("stopped before the end".into()));
        }
        Ok(())
    }
}
