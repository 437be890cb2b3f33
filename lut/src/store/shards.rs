//! A share of a plan's points, solved where they have no result.

use std::sync::atomic::{AtomicBool, Ordering};

use crate::error::Error;
use crate::store::results::Store;
use crate::sweep::batches::SweepError;
use crate::sweep::each::each;
use crate::table::nodes::finite;
use crate::table::solved::{Point, Solved};

/// What a batch of points took.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Points that were solved now.
    pub solved: usize,
    /// Points that had their result already.
    pub kept: usize,
    /// Damaged results that were solved again: what was wrong with them.
    pub repaired: Vec<String>,
}

/// Solves the points that have no result in the store, in parallel, keeping each as soon as it is there.
///
/// A point's failure does not keep the others from being solved and kept. A damaged result is solved again and told.
///
/// # Errors
/// [`SweepError::Solve`] with the first failed point; [`Error::Mixture`] before anything is solved; [`Error::Io`]
/// where a result cannot be kept, after which no further point is begun.
pub fn solve_missing<E>(
    store: &Store,
    points: &[Point],
    solve: impl Fn(&Point) -> Result<Solved, E> + Sync,
) -> Result<Done, SweepError<E>>
where
    E: std::error::Error + Send + 'static,
{
    let mut done = Done::default();
    let mut missing = Vec::new();
    for point in points {
        match store.get(point) {
            Ok(Some(_)) => done.kept += 1,
            Ok(None) => missing.push(*point),
            Err(error @ Error::Corrupt { .. }) => {
                done.repaired.push(error.to_string());
                missing.push(*point);
            }
            Err(error) => return Err(error.into()),
        }
    }
    let broken = AtomicBool::new(false);
    let outcomes: Vec<Option<Result<(), SweepError<E>>>> = each(&missing, |point| {
        if broken.load(Ordering::Relaxed) {
            return None;
        }
        let solved = match solve(point) {
            Ok(solved) => solved,
            Err(source) => {
                let point = *point;
                return Some(Err(SweepError::Solve { point, source }));
            }
        };
        let kept = finite(point, &solved).and_then(|()| store.put(point, &solved));
        broken.fetch_or(kept.is_err(), Ordering::Relaxed);
        Some(kept.map_err(SweepError::Table))
    });
    for outcome in outcomes.into_iter().flatten() {
        outcome?;
        done.solved += 1;
    }
    Ok(done)
}
