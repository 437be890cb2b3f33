//! Filling a table: given points, or points placed until the interpolation is as good as asked.

use crate::error::Error;
use crate::sweep::each::each;
use crate::sweep::grid::{Grid, spread};
use crate::sweep::plan::{Plan, SolveBatch};
use crate::sweep::refine::{Refinement, refine};
use crate::table::nodes::{Check, Table, finite};
use crate::table::solved::{Point, Solved};

/// A failed sweep: the table's part or the solver's.
#[derive(Debug, thiserror::Error)]
pub enum SweepError<E: std::error::Error + 'static> {
    /// The plan or the table is at fault.
    #[error(transparent)]
    Table(#[from] Error),
    /// A solve failed.
    #[error("{point}: {source}")]
    Solve {
        /// Where.
        point: Point,
        /// Why.
        source: E,
    },
}

/// A table and whether refinement reached what was asked.
#[derive(Debug)]
pub struct Swept {
    /// The table; complete and usable in any case.
    pub table: Table,
    /// [`Error::ToleranceNotReached`] where refinement ran into a limit.
    pub shortfall: Option<Error>,
}

/// Solves the contacts of a plan, points in parallel, and makes the table.
///
/// Every point is solved by itself, from nothing but its coordinates, so the table is the same to the last bit for any number of
/// threads, after an interruption, and when the points were solved on several machines.
/// `solve` is called once a point; several calls run at once.
///
/// # Errors
/// [`SweepError::Solve`] with the first failed point in sweep order; [`SweepError::Table`] where the plan's axes
/// are not usable or a figure is not finite.
///
/// ```
/// use kufe_lut::{Plan, Solved, Spacing, sweep};
/// let plan = Plan::new(Spacing::Range { from: 200.0, to: 8000.0 }, Spacing::Values(vec![0.0, 0.01, 0.02]));
/// let swept = sweep(&plan, |point| {
///     let p_max = 1e8 * (point.fz / 1000.0).cbrt() * (1.0 - 10.0 * point.curvature);
///     Ok::<_, std::convert::Infallible>(Solved { p_max, p_max_error: 0.0, p_mean: p_max / 1.5, area: 1e-5, length: 0.05, width: 3e-4, approach: 1e-5, errors: None, sliding: None, method: Default::default() })
/// })?;
/// assert!(swept.shortfall.is_none());
/// # Ok::<(), kufe_lut::SweepError<std::convert::Infallible>>(())
/// ```
pub fn sweep<E>(
    plan: &Plan,
    solve: impl Fn(&Point) -> Result<Solved, E> + Sync,
) -> Result<Swept, SweepError<E>>
where
    E: std::error::Error + Send + 'static,
{
    sweep_batches(plan, |points| {
        let solved: Vec<Result<Solved, E>> = each(points, &solve);
        points
            .iter()
            .zip(solved)
            .map(|(&point, solved)| solved.map_err(|source| SweepError::Solve { point, source }))
            .collect()
    })
}

/// As [`sweep`], with the points handed out in batches that may be solved anywhere in any order.
///
/// The batches follow from the plan and the results so far alone, so a sweep can be replayed from stored results. A
/// batch never repeats a point.
///
/// # Errors
/// Those of `solve`, and an [`Error`] of the plan or its results.
pub fn sweep_batches<E: From<Error>>(
    plan: &Plan,
    mut solve: impl FnMut(&[Point]) -> Result<Vec<Solved>, E>,
) -> Result<Swept, E> {
    if !(1e-6..=0.5).contains(&plan.interpolation) {
        return Err(Error::Tolerance {
            value: plan.interpolation,
        }
        .into());
    }
    let mut checked = |points: &[Point]| {
        let solved = solve(points)?;
        if solved.len() != points.len() {
            return Err(E::from(Error::NodeCount {
                found: solved.len(),
                expected: points.len(),
            }));
        }
        for (point, solved) in points.iter().zip(&solved) {
            finite(point, solved)?;
        }
        Ok(solved)
    };
    if plan.is_fixed() && plan.flush.is_none() {
        let grid = Grid::start(plan)?;
        let (nodes, checks) = fixed(&grid, plan.checks, &mut checked)?;
        let axes = grid.axes()?;
        return Ok(Swept {
            table: Table::new(axes, nodes, checks)?,
            shortfall: None,
        });
    }
    let Refinement {
        axes,
        nodes,
        checks,
        shortfall,
    } = refine(plan, &mut checked)?;
    let mut table = Table::new(axes, nodes, checks)?;
    table.interpolation_asked = Some(plan.interpolation);
    Ok(Swept { table, shortfall })
}

/// Nodes of given axes and checks between them, in one batch.
fn fixed<E>(
    grid: &Grid,
    checks: usize,
    solve: &mut SolveBatch<E>,
) -> Result<(Vec<Solved>, Vec<Check>), E> {
    let mut places = grid.nodes();
    let nodes = places.len();
    if nodes > 1 {
        places.extend(spread(&grid.values, checks));
    }
    let points: Vec<Point> = places.into_iter().map(|place| grid.point(place)).collect();
    let mut solved = solve(&points)?;
    let measured = solved.split_off(nodes);
    let checks = points[nodes..]
        .iter()
        .zip(measured)
        .map(|(&point, solved)| Check { point, solved })
        .collect();
    Ok((solved, checks))
}
