//! Serialisation of solves: one at a time, and the newest request cancels the others.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Lock for requests: a new request stops the running one and overtakes waiting ones.
#[derive(Default)]
pub struct Turn {
    newest: Mutex<Arc<AtomicBool>>,
    hands: Mutex<()>,
}

impl Turn {
    /// Runs `work` when no other request is running; `None` if a newer request arrived.
    ///
    /// The argument of `work` is the flag that a newer request sets.
    pub fn take<T>(&self, work: impl FnOnce(&Arc<AtomicBool>) -> T) -> Option<T> {
        let mine = Arc::new(AtomicBool::new(false));
        let before = std::mem::replace(&mut *lock(&self.newest), mine.clone());
        before.store(true, Ordering::Relaxed);
        let _hands = lock(&self.hands);
        if mine.load(Ordering::Relaxed) {
            return None;
        }
        let done = work(&mine);
        (!mine.load(Ordering::Relaxed)).then_some(done)
    }
}

/// Locks a mutex. A panic of another holder does not leave the data inconsistent.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::AtomicUsize;
    use std::sync::mpsc::channel;

    #[test]
    fn a_newer_question_stops_the_one_in_work_and_overtakes_those_that_wait() {
        let turn = Turn::default();
        let (at_once, most) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let (begun, begins) = channel();
        let answers = std::thread::scope(|scope| {
            let first = scope.spawn(|| {
                turn.take(|stop| {
                    most.fetch_max(1 + at_once.fetch_add(1, Ordering::SeqCst), Ordering::SeqCst);
                    begun.send(()).expect("a listener");
                    while !stop.load(Ordering::Relaxed) {
                        std::thread::yield_now();
                    }
                    at_once.fetch_sub(1, Ordering::SeqCst);
                    1
                })
            });
            begins.recv().expect("the first works");
            let later: Vec<_> = (2..6)
                .map(|number| {
                    let (turn, at_once, most) = (&turn, &at_once, &most);
                    scope.spawn(move || {
                        turn.take(|_| {
                            most.fetch_max(
                                1 + at_once.fetch_add(1, Ordering::SeqCst),
                                Ordering::SeqCst,
                            );
                            at_once.fetch_sub(1, Ordering::SeqCst);
                            number
                        })
                    })
                })
                .collect();
            let first = first.join().expect("no panic");
            let later: Vec<_> = later
                .into_iter()
                .map(|one| one.join().expect("no panic"))
                .collect();
            (first, later)
        });
        assert_eq!(answers.0, None);
        assert!(answers.1.iter().any(Option::is_some), "{answers:?}");
        assert_eq!(most.into_inner(), 1);
    }
}
