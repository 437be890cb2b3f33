//! Computation of a table: at given points, or at points placed until the interpolation has the
//! requested accuracy.

mod grid;
mod parallel;
mod plan;
mod refine;

pub use parallel::each;
pub use plan::{Plan, Spacing};

use crate::axes::Point;
use crate::error::Error;
use crate::quantity::Figures;
use crate::solve::Solve;
use crate::sweep::grid::{Grid, spread};
use crate::sweep::refine::refine;
use crate::table::{Table, check_finite};

/// A failed sweep.
#[derive(Debug, thiserror::Error)]
pub enum SweepError<E: std::error::Error + 'static> {
    /// An invalid plan or table.
    #[error(transparent)]
    Table(#[from] Error),
    /// A solve failed.
    #[error("{point}: {source}")]
    Solve {
        /// The point.
        point: Point,
        /// The solver's error.
        source: E,
    },
}

/// A table, and whether its refinement reached the tolerance.
#[derive(Debug)]
pub struct SweepResult {
    /// The table; complete and usable in any case.
    pub table: Table,
    /// [`Error::ToleranceNotReached`] if the refinement reached a limit; else `None`.
    pub shortfall: Option<Error>,
}

/// Solves a batch of points, results in their order.
type SolveBatch<'a, E> = dyn FnMut(&[Point]) -> Result<Vec<Figures>, E> + 'a;

/// Solves the contacts of a plan, points in parallel, and makes the table.
///
/// The solution at a point depends only on its coordinates. The table is therefore equal to the
/// last bit for any number of threads, after an interruption, and if points are solved on several
/// machines. `solve` is called once per point, from several threads.
///
/// # Errors
/// [`SweepError::Solve`] with the first failed point in sweep order; [`SweepError::Table`] if the
/// axes of the plan are invalid or a figure is not finite.
///
/// ```
/// use kufe_lut::{Figures, Plan, Quantity, Spacing, sweep};
/// let plan = Plan::new(Spacing::Range { from: 200.0, to: 8000.0 }, Spacing::Values(vec![0.0, 0.01, 0.02]));
/// let swept = sweep(&plan, |point| {
///     let p_max = 1e8 * (point.fz / 1000.0).cbrt() * (1.0 - 10.0 * point.curvature);
///     let figures = Figures::at_rest([p_max, p_max / 1.5, 1e-5, 0.05, 3e-4, 1e-5]);
///     Ok::<_, std::convert::Infallible>(figures.with_error(Quantity::PMax, 0.0))
/// })?;
/// assert!(swept.shortfall.is_none());
/// # Ok::<(), kufe_lut::SweepError<std::convert::Infallible>>(())
/// ```
pub fn sweep<E>(
    plan: &Plan,
    solve: impl Fn(&Point) -> Result<Figures, E> + Sync,
) -> Result<SweepResult, SweepError<E>>
where
    E: std::error::Error + Send + 'static,
{
    sweep_batches(plan, |points| {
        let solved = each(points, |&point| {
            solve(&point).map_err(|source| SweepError::Solve { point, source })
        });
        solved.into_iter().collect()
    })
}

/// The state of a sweep whose results are stored.
#[derive(Debug)]
pub enum Progress {
    /// An incomplete batch; `missing` of its points have no result yet.
    Batch {
        /// The whole batch.
        points: Vec<Point>,
        /// Number of the batch, from 1.
        round: usize,
        /// Number of points without a result.
        missing: usize,
        /// The first point without a result.
        first: Point,
    },
    /// Every point has its result.
    Finished(Box<SweepResult>),
}

/// Repeats a sweep from stored results: returns its table, or the first incomplete batch.
///
/// # Errors
/// Errors of the plan.
pub fn replay(plan: &Plan, stored: impl Fn(&Point) -> Option<Figures>) -> Result<Progress, Error> {
    /// An incomplete batch, or the plan's error.
    struct Stop(Result<Progress, Error>);
    impl From<Error> for Stop {
        fn from(error: Error) -> Self {
            Stop(Err(error))
        }
    }
    let mut round = 0;
    let swept = sweep_batches(plan, |points| {
        round += 1;
        let (mut solved, mut missing) = (Vec::with_capacity(points.len()), Vec::new());
        for point in points {
            match stored(point) {
                Some(figures) => solved.push(figures),
                None => missing.push(*point),
            }
        }
        match missing.first() {
            None => Ok(solved),
            Some(&first) => Err(Stop(Ok(Progress::Batch {
                points: points.to_vec(),
                round,
                missing: missing.len(),
                first,
            }))),
        }
    });
    match swept {
        Ok(swept) => Ok(Progress::Finished(Box::new(swept))),
        Err(Stop(stopped)) => stopped,
    }
}

/// As [`sweep`], with a solver of batches of points.
///
/// The batches depend only on the plan and the previous results, so that a sweep can be repeated
/// from stored results. No point occurs twice.
///
/// # Errors
/// Those of `solve`, and an [`Error`] of the plan or its results.
fn sweep_batches<E: From<Error>>(
    plan: &Plan,
    mut solve: impl FnMut(&[Point]) -> Result<Vec<Figures>, E>,
) -> Result<SweepResult, E> {
    if !(1e-6..=0.5).contains(&plan.interpolation) {
        let found = plan.interpolation;
        let expected = "expected a relative error between 1e-6 and 0.5";
        return Err(Error::Invalid(format!("interpolation = {found}: {expected}")).into());
    }
    let mut checked = |points: &[Point]| {
        let solved = solve(points)?;
        if solved.len() != points.len() {
            return Err(E::from(Error::node_count(solved.len(), points.len())));
        }
        for (point, figures) in points.iter().zip(&solved) {
            check_finite(point, figures)?;
        }
        Ok(solved)
    };
    if plan.is_fixed() && plan.flush.is_none() {
        let grid = Grid::start(plan)?;
        let (nodes, checks) = fixed(&grid, plan.checks, &mut checked)?;
        return Ok(SweepResult {
            table: Table::new(grid.axes()?, &nodes, checks)?,
            shortfall: None,
        });
    }
    refine(plan, &mut checked)
}

/// Nodes of given axes and checks between them, in one batch.
fn fixed<E>(
    grid: &Grid,
    checks: usize,
    solve: &mut SolveBatch<E>,
) -> Result<(Vec<Figures>, Vec<Solve>), E> {
    let mut places = grid.nodes();
    let nodes = places.len();
    if nodes > 1 {
        places.extend(spread(&grid.values, checks));
    }
    let points: Vec<Point> = places.into_iter().map(|place| grid.point(place)).collect();
    let mut solved = solve(&points)?;
    let measured = points[nodes..].iter().zip(solved.split_off(nodes));
    let checks = measured.map(|(&point, figures)| Solve { point, figures });
    Ok((solved, checks.collect()))
}
