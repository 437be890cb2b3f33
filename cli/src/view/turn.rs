//! One solve at a time, the newest question first.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Whose turn it is.
///
/// A question that arrives stops the one in work and overtakes those that wait.
#[derive(Default)]
pub struct Turn {
    newest: Mutex<Arc<AtomicBool>>,
    hands: Mutex<()>,
}

impl Turn {
    /// Does `work` once nobody else works; `None` where a newer question came first.
    ///
    /// `work` is given the flag that a newer question raises.
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

/// A panic of someone before leaves nothing half done here.
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
