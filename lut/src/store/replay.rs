//! A sweep replayed from stored results.

use crate::error::Error;
use crate::store::results::Store;
use crate::sweep::batches::{Swept, sweep_batches};
use crate::sweep::plan::Plan;
use crate::table::solved::Point;

/// Where a sweep stands.
#[derive(Debug)]
pub enum Next {
    /// These points are to be solved; `missing` of them have no result yet.
    Points {
        /// The whole batch.
        points: Vec<Point>,
        /// Number of the batch, from 1.
        round: usize,
        /// How many have no result.
        missing: usize,
        /// The first of those.
        first: Point,
    },
    /// Nothing is missing.
    Finished(Box<Swept>),
}

/// Replays a sweep from stored results: its table, or the first batch that is not complete.
///
/// # Errors
/// [`Error::Corrupt`] and [`Error::Mixture`] naming the file, and the plan's own errors.
pub fn next_batch(plan: &Plan, store: &Store) -> Result<Next, Error> {
    enum Stop {
        Missing(Vec<Point>, usize, Point),
        Failed(Error),
    }
    impl From<Error> for Stop {
        fn from(error: Error) -> Self {
            Stop::Failed(error)
        }
    }
    let mut round = 0;
    let swept = sweep_batches(plan, |points| {
        round += 1;
        let mut solved = Vec::with_capacity(points.len());
        let mut missing = Vec::new();
        for point in points {
            match store.get(point)? {
                Some(result) => solved.push(result),
                None => missing.push(*point),
            }
        }
        match missing.first() {
            None => Ok(solved),
            Some(&first) => Err(Stop::Missing(points.to_vec(), missing.len(), first)),
        }
    });
    match swept {
        Ok(mut swept) => {
            swept.table.version = store.origin().version.clone();
            swept.table.case_sha256 = store.origin().case_sha256.clone();
            Ok(Next::Finished(Box::new(swept)))
        }
        Err(Stop::Missing(points, missing, first)) => Ok(Next::Points {
            points,
            round,
            missing,
            first,
        }),
        Err(Stop::Failed(error)) => Err(error),
    }
}
