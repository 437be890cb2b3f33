//! A share of a plan's points, solved where they have no result.

use std::collections::HashMap;
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
/// `solve` is given points that differ in speed alone, for what they have in common is solved once; it answers them in order and
/// may leave out what comes after a failure. One group's failure does not keep the others from being solved and kept. A
/// damaged result is solved again and told.
///
/// # Errors
/// [`SweepError::Solve`] with the first failed point; [`Error::Mixture`] before anything is solved; [`Error::Io`]
/// where a result cannot be kept, after which no further group is begun.
pub fn solve_missing<E>(
    store: &Store,
    points: &[Point],
    solve: impl Fn(&[Point]) -> Vec<Result<Solved, E>> + Sync,
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
    let outcomes: Vec<Vec<Result<(), SweepError<E>>>> = each(&groups(&missing), |group| {
        if broken.load(Ordering::Relaxed) {
            return Vec::new();
        }
        let keep = |(point, solved): (&Point, Result<Solved, E>)| {
            let solved = solved.map_err(|source| SweepError::Solve {
                point: *point,
                source,
            })?;
            let kept = finite(point, &solved).and_then(|()| store.put(point, &solved));
            broken.fetch_or(kept.is_err(), Ordering::Relaxed);
            kept.map_err(SweepError::Table)
        };
        group.iter().zip(solve(group)).map(keep).collect()
    });
    for outcome in outcomes.into_iter().flatten() {
        outcome?;
        done.solved += 1;
    }
    Ok(done)
}

/// Points that differ in speed alone, together, in the order of their first ones.
fn groups(points: &[Point]) -> Vec<Vec<Point>> {
    let mut groups: Vec<Vec<Point>> = Vec::new();
    let mut places: HashMap<String, usize> = HashMap::new();
    for &point in points {
        let alike = Point {
            speed: None,
            ..point
        };
        let place = *places.entry(alike.to_string()).or_insert_with(|| {
            groups.push(Vec::new());
            groups.len() - 1
        });
        groups[place].push(point);
    }
    groups
}
