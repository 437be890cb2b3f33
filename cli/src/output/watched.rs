//! A sweep at a terminal: progress, warnings, and Ctrl-C that keeps what is done.

use std::sync::atomic::{AtomicBool, Ordering};

use kufe::jobs::Watch;

use crate::output::global::Global;
use crate::output::say::warn;

static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Does `work` with a progress line, which goes when it ends.
pub fn watched<T>(global: &Global, work: impl FnOnce(&Watch) -> T) -> T {
    stop_on_interrupt();
    let bar = global.progress();
    let done = work(&Watch {
        progress: Some(&|text| bar.set_message(text.to_owned())),
        warn: Some(&warn),
        stop: Some(&INTERRUPTED),
    });
    bar.finish_and_clear();
    done
}

/// From now on Ctrl-C lets the points in hand finish and begins no others; a second one leaves at once.
fn stop_on_interrupt() {
    // A handler is set once a process: that one is there already is no error.
    let _ = ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::Relaxed) {
            std::process::exit(5);
        }
    });
}
