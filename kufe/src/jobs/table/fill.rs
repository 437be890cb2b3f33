//! A whole table in one process.

use std::path::Path;

use kufe_lut::{Progress, SweepResult, replay};

use crate::jobs::failure::Failure;
use crate::jobs::table::points::PointStore;
use crate::jobs::table::solver::Solver;
use crate::jobs::table::spec::TableSpec;
use crate::jobs::watch::Watch;

/// A filled table, and the points on disk that it makes needless.
pub struct Filled {
    /// The table and whether its interpolation is as accurate as requested.
    pub swept: SweepResult,
    /// Contacts solved now; the others were on disk.
    pub solves: usize,
    store: PointStore,
}

/// Solves every point that is not on disk yet. Points are stored in `OUT.points` until
/// [`Filled::clear`], so that the same call resumes after an interrupt.
///
/// # Errors
/// [`Failure::BadInput`] for files and cases, [`Failure::NotConverged`] where a contact stays far
/// from its accuracy, [`Failure::Partial`] where the watch stops it.
pub fn fill(
    spec: &TableSpec,
    solver: &Solver,
    out: &Path,
    watch: &Watch,
) -> Result<Filled, Failure> {
    let mut path = out.as_os_str().to_owned();
    path.push(".points");
    let store = PointStore::of_file(Path::new(&path), solver.origin()?)?;
    for damage in store.damaged() {
        watch.warn(&format!("{damage}; its point is solved again"));
    }
    let mut solves = 0;
    let swept = loop {
        match replay(&spec.plan, |point| store.get(point)).map_err(Failure::bad_input)? {
            Progress::Finished(swept) => break solver.finished(*swept)?,
            Progress::Batch { points, round, .. } => {
                let label = format!("round {round}");
                solves += solver.solve_missing(&store, &points, &label, watch)?;
            }
        }
    };
    Ok(Filled {
        swept,
        solves,
        store,
    })
}

impl Filled {
    /// Removes the points on disk: the table is written.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where the file cannot be removed.
    pub fn clear(&self) -> Result<(), Failure> {
        self.store.remove()
    }
}
