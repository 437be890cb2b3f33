//! Running of jobs without the interpreter's lock (GIL).

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, mpsc};
use std::time::{Duration, Instant};

use kufe::jobs::{Failure, Watch};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;

use crate::error::raised;

/// Largest time that an interrupted job is waited for.
const MAX_WAIT: Duration = Duration::from_secs(1);

/// Runs `job` on threads of its own, without the interpreter's lock.
///
/// A pool that all jobs share would not outlive a fork: only the thread that forks runs in the
/// child.
///
/// The calling thread passes messages to `progress` and checks for Ctrl-C ten times a second. After
/// Ctrl-C it stops the job, waits a second for its end, and raises the interrupt. A job that does
/// not end by then ends in the background, and its result is dropped. An exception of `progress`
/// stops the job likewise.
pub fn work<T: Send + 'static, E: Into<Failure> + Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    job: impl FnOnce(&Watch, Reporter) -> Result<T, E> + Send + 'static,
) -> PyResult<T> {
    work_with_warnings(py, progress, job).map(|(value, _)| value)
}

/// As [`work`], with the warnings of the job.
pub fn work_with_warnings<T: Send + 'static, E: Into<Failure> + Send + 'static>(
    py: Python<'_>,
    progress: Option<&Bound<'_, PyAny>>,
    job: impl FnOnce(&Watch, Reporter) -> Result<T, E> + Send + 'static,
) -> PyResult<(T, Vec<String>)> {
    let stop = Arc::new(AtomicBool::new(false));
    let (sender, mut messages) = mpsc::channel::<Message>();
    let stopping = stop.clone();
    let pool = rayon::ThreadPoolBuilder::new().build();
    let pool = pool.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
    let run = move || {
        let watch = Watch {
            progress: Some(&|text| send(&sender, Message::Progress(text.to_owned()))),
            warn: Some(&|text| send(&sender, Message::Warning(text.to_owned()))),
            stop: Some(&stopping),
        };
        let sender = sender.clone();
        let stop = stopping.clone();
        job(&watch, Reporter { sender, stop })
    };
    let worker = std::thread::spawn(move || pool.install(run));
    let mut warnings = Vec::new();
    let mut ended: Option<(PyErr, Instant)> = None;
    let mut checked = Instant::now();
    // The channel is closed when the job has ended and dropped its sender.
    loop {
        let messages = &mut messages;
        let message = py.detach(move || messages.recv_timeout(Duration::from_millis(100)));
        let error = match message {
            Err(mpsc::RecvTimeoutError::Disconnected) => break,
            Ok(Message::Progress(text)) if ended.is_none() => {
                progress.and_then(|call| call.call1((text,)).err())
            }
            Ok(Message::Warning(text)) => {
                warnings.push(text);
                None
            }
            Ok(Message::Progress(_)) | Err(mpsc::RecvTimeoutError::Timeout) => None,
        };
        // Messages may come faster than the time-out.
        let due = checked.elapsed() > Duration::from_millis(100);
        let error = error.or_else(|| due.then(|| py.check_signals().err()).flatten());
        if due {
            checked = Instant::now();
        }
        if let (Some(error), None) = (error, &ended) {
            stop.store(true, Ordering::Relaxed);
            ended = Some((error, Instant::now()));
        }
        let late = |(_, at): &(PyErr, Instant)| at.elapsed() > MAX_WAIT;
        if ended.as_ref().is_some_and(late) {
            break;
        }
    }
    if let Some((error, _)) = ended {
        return Err(error);
    }
    match py.detach(|| worker.join()) {
        Ok(Ok(value)) => Ok((value, warnings)),
        Ok(Err(error)) => Err(raised(error.into())),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}

enum Message {
    Progress(String),
    Warning(String),
}

/// Progress and stop flag of a [`Watch`] for closures that outlive it.
pub struct Reporter {
    sender: mpsc::Sender<Message>,
    /// If true, the job shall stop.
    pub stop: Arc<AtomicBool>,
}

impl Reporter {
    /// Reports the progress of the job.
    pub fn progress(&self, text: String) {
        send(&self.sender, Message::Progress(text));
    }
}

/// The receiver lives until every sender is gone, so sending cannot fail.
fn send(sender: &mpsc::Sender<Message>, message: Message) {
    let _ = sender.send(message);
}
