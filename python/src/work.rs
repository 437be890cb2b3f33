//! Jobs without the interpreter's lock.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc;
use std::time::Duration;

use kufe::jobs::Watch;
use pyo3::prelude::*;

/// Messages and result of a job.
pub struct Worked<T> {
    /// What the job returned.
    pub value: T,
    /// Its warnings.
    pub warnings: Vec<String>,
}

/// Runs `job` on a thread of its own, without the interpreter's lock.
///
/// The calling thread hands `progress` its messages and looks for Ctrl-C ten times a second: then
/// the job is requested to stop, finishes what it has in hand, and the interrupt is raised. An
/// exception of `progress` stops it likewise.
pub fn work<T: Send>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    job: impl FnOnce(&Watch, Teller) -> T + Send,
) -> PyResult<Worked<T>> {
    let stop = AtomicBool::new(false);
    let (sender, mut messages) = mpsc::channel::<Message>();
    let (value, warnings, raised) = std::thread::scope(|scope| {
        let stop = &stop;
        let worker = scope.spawn(move || {
            let watch = Watch {
                progress: Some(&|text| tell(&sender, Message::Progress(text.to_owned()))),
                warn: Some(&|text| tell(&sender, Message::Warning(text.to_owned()))),
                stop: Some(stop),
            };
            job(&watch, Teller(sender.clone()))
        });
        let mut warnings = Vec::new();
        let mut raised = None;
        // The channel closes when the job has ended and dropped its end.
        loop {
            let messages = &mut messages;
            match py.detach(move || messages.recv_timeout(Duration::from_millis(100))) {
                Ok(Message::Warning(text)) => warnings.push(text),
                Ok(Message::Progress(text)) => {
                    let call = || progress.map(|call| call.call1((text,))).transpose();
                    if raised.is_none() {
                        raised = call().err();
                    }
                }
                Err(mpsc::RecvTimeoutError::Timeout) => {
                    if raised.is_none() {
                        raised = py.check_signals().err();
                    }
                }
                Err(mpsc::RecvTimeoutError::Disconnected) => break,
            }
            if raised.is_some() {
                stop.store(true, Ordering::Relaxed);
            }
        }
        let value = py.detach(|| worker.join());
        (value, warnings, raised)
    });
    if let Some(error) = raised {
        return Err(error);
    }
    match value {
        Ok(value) => Ok(Worked { value, warnings }),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

enum Message {
    Progress(String),
    Warning(String),
}

/// Tells progress from where a borrowed [`Watch`] cannot go.
pub struct Teller(mpsc::Sender<Message>);

impl Teller {
    /// Tells how far the job is.
    pub fn progress(&self, text: String) {
        tell(&self.0, Message::Progress(text));
    }
}

/// The receiver lives until every sender is gone, so sending cannot fail.
fn tell(sender: &mpsc::Sender<Message>, message: Message) {
    let _ = sender.send(message);
}
