//! A whole table in one process.

use std::path::Path;

use kufe_lut::{Next, Point, Store, Swept, Table, next_batch};

use crate::jobs::failure::Failure;
use crate::jobs::table::solver::Solver;
use crate::jobs::table::wanted::Wanted;
use crate::jobs::watch::Watch;

/// A filled table, and the results in hand that it makes needless.
pub struct Filled {
    /// The table and whether its interpolation is as good as asked.
    pub swept: Swept,
    /// Contacts solved now; the others were on disk.
    pub solves: usize,
    store: Store,
}

/// Solves every point that is not on disk yet. Points are kept beside `out` until [`Filled::clear`], so that the same
/// call resumes after an interrupt.
///
/// # Errors
/// [`Failure::BadInput`] for files and cases, [`Failure::NotConverged`] where a contact stays far from its accuracy,
/// [`Failure::Partial`] where the watch stops it.
pub fn fill(
    wanted: &Wanted,
    solver: &Solver,
    out: &Path,
    watch: &Watch,
) -> Result<Filled, Failure> {
    let store = open_store(out, solver)?;
    let mut solves = 0;
    let mut swept = loop {
        match next_batch(&wanted.plan, &store) {
            Ok(Next::Finished(swept)) => break *swept,
            Ok(Next::Points { points, round, .. }) => {
                let label = format!("round {round}");
                solves += solver.solve_missing(&store, &points, &label, watch)?;
            }
            // A damaged point among finished ones: solved again with the others of its batch.
            Err(kufe_lut::Error::Corrupt { path, reason }) => {
                watch.warn(&format!(
                    "{path}: damaged: {reason}; it will be solved again"
                ));
                std::fs::remove_file(&path).map_err(|error| {
                    Failure::BadInput(format!("{path}: cannot be removed: {error}"))
                })?;
            }
            Err(error) => return Err(Failure::bad_input(error)),
        }
    };
    swept.table.case = solver.case();
    Ok(Filled {
        swept,
        solves,
        store,
    })
}

impl Filled {
    /// Removes the points kept on disk: the table is written.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where a file cannot be removed.
    pub fn clear(&self) -> Result<(), Failure> {
        self.store
            .clear(&all_points(&self.swept.table))
            .map_err(Failure::bad_input)
    }
}

/// Results in hand stand beside the table to be until it is there.
fn open_store(out: &Path, solver: &Solver) -> Result<Store, Failure> {
    let mut folder = out.as_os_str().to_owned();
    folder.push(".points");
    Store::open(Path::new(&folder), solver.origin()).map_err(Failure::bad_input)
}

fn all_points(table: &Table) -> Vec<Point> {
    let mut points = table.axes().points();
    points.extend(table.checks().iter().map(|check| check.point));
    points
}
