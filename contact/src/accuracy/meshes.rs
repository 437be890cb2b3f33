//! The sequence of meshes of one problem, and the estimates from all of them.

use std::cell::RefCell;

use crate::accuracy::answer::SolvedMesh;
use crate::accuracy::estimators::{MIN_REFINEMENT, REFINEMENT, first_resolution, next_refinement};
use crate::accuracy::find_patch::find_patch;
use crate::accuracy::mesh_solve::{Forces, MeshSolve};
use crate::accuracy::own_cells::OwnCells;
use crate::accuracy::penetration_check::{DeformedGap, Penetration};
use crate::accuracy::watched::{ErrorFloor, FigureHistory, Limits, Place};
use crate::active_set::contact_set::SetUpdate;
use crate::green::matrix::StorageLimit;
use crate::grid::grading::Resolution;
use crate::grid::patch::{COARSE, Patch};
use crate::mesh::assembled::assemble;
use crate::mesh::contact_mesh::State;
use crate::mesh::discretise::{Discretisation, Reach, expected};
use crate::problem::check::CheckedProblem;
use crate::result::pressure::Field;
use crate::{Error, Iterate, Solution, StiffnessForm};

/// Largest number of regradings of a mesh; each may make its cells three times smaller.
pub(crate) const REGRADINGS: usize = 6;

/// Largest number of times that the patch is widened; each time by all places found.
const WIDENINGS: usize = 4;

/// Smallest number of cells over half the patch, if the limit of unknowns does not allow more.
pub(crate) const MIN_CELLS: f64 = 2.0;

/// The solution of a problem on a sequence of meshes.
pub(crate) struct Meshes<'a> {
    checked: CheckedProblem<'a>,
    /// The expected contact, and the last forces.
    pub(crate) patch: Patch,
    forces: Forces,
    /// Cells over half the patch of the next mesh, and of the first one that it is similar to,
    /// before rounding.
    cells: f64,
    coarsest: f64,
    /// Cells over half the patch of the first mesh of a patch.
    first: f64,
    /// The runner's own hexahedra; `None` if it has none.
    own: Option<OwnCells>,
    pub(super) solved: FigureHistory,
    /// Whether the next mesh is the last one graded anew, and the number of regradings.
    graded_anew: bool,
    pub(crate) regraded: usize,
    /// The widened patches, each solved at least once.
    widened: Vec<Patch>,
    history: Vec<Iterate>,
}

/// The next mesh.
pub(crate) struct Plan {
    /// Whether it is graded anew, instead of having more cells in the same proportions.
    anew: bool,
    /// Cells over half the patch.
    cells: f64,
}

impl<'a> Meshes<'a> {
    /// Finds the patch of a problem on the contact plane alone; its meshes are added to `history`,
    /// that of a method that gave no solution.
    pub fn guess(checked: CheckedProblem<'a>, history: Vec<Iterate>) -> Result<Self, Error> {
        let (patch, forces) = find_patch(&checked)?;
        let options = checked.options;
        let own = OwnCells::new(checked.problem, &patch);
        let coarsest = options.cells.map_or_else(
            || {
                let first = first_resolution(options.p_max_tolerance, patch.is_even());
                // Three meshes, the last as fine as the runner's own hexahedra.
                let room = own.map_or(f64::INFINITY, |own| own.ice_cells() / REFINEMENT.powi(2));
                first.min(room.max(MIN_CELLS))
            },
            |c| c as f64,
        );
        Ok(Meshes {
            patch,
            forces,
            cells: coarsest.round(),
            first: coarsest.round(),
            coarsest,
            own,
            solved: FigureHistory::new(checked.problem.ice.hardness, error_floor(own)),
            graded_anew: false,
            regraded: 0,
            widened: Vec::new(),
            history,
            checked,
        })
    }

    /// Solves the next mesh.
    pub fn solve_next(&mut self) -> Result<SolvedMesh, Error> {
        let mut mesh = self.next_mesh()?;
        let (problem, options) = (self.checked.problem, self.checked.options);
        if options.stiffness == StiffnessForm::Assembled {
            let elastic = problem.runner.elastic.as_ref();
            let element = elastic.map(|e| e.element_kind());
            assemble(&mut mesh, element, options.max_stiffness_bytes)?;
        }
        let (dofs, images) = (mesh.free_dofs(), mesh.image_count());
        let level = self.history.last().map_or(0, |last| last.level + 1);
        let reported = RefCell::new(Vec::new());
        let field = Field::new(&mesh, problem, &self.patch);
        let error_before = self.solved.limits().map(|limits| limits.relative);
        options.announce(level, dofs, error_before);
        let report = |update: &SetUpdate, state: &State| {
            let iterate = Iterate {
                level,
                dofs,
                error_before,
                contact_nodes: update.contact_nodes,
                iterations: update.iterations,
                residual: update.residual,
                p_max: field.p_max(state),
                sweeps: update.counts.sweeps,
                accelerations: update.counts.accelerations,
                energy: images * update.energy,
            };
            if let Some(watcher) = &options.progress {
                watcher(&iterate);
            }
            reported.borrow_mut().push(iterate);
        };
        let (state, progress) = MeshSolve {
            checked: &self.checked,
            mesh: &mesh,
            stored: StorageLimit::USUAL,
            report: &report,
        }
        .solve(self.patch.motion, &self.forces)?;
        let pressure = field.of(&state);
        self.history.append(&mut reported.into_inner());
        self.forces = Forces::of(&mesh, &state);
        let cells = Resolution::of(self.cells).real_cells(&self.patch, mesh.symmetry);
        let place = Place {
            approach: mesh.contact.depth(&state),
            tilt: self.checked.gap.tilt(state.motion[1], state.motion[2]),
            missed: self.patch.missed(&pressure.patch, cells),
            at_ridge: !self.patch.is_even(),
        };
        self.solved
            .push(pressure.figures, place, [cells; 3], self.graded_anew);
        if options.subsurface {
            let largest = mesh.largest_shear(self.checked.material, &pressure.values, &state);
            self.solved.push_under(largest, cells, self.graded_anew);
        }
        Ok(SolvedMesh {
            mesh,
            state,
            iterations: progress.iterations,
            pressure,
        })
    }

    /// The next mesh. The first mesh of a patch is so coarse that the limit of unknowns allows two
    /// more for an error estimate.
    fn next_mesh(&mut self) -> Result<Discretisation, Error> {
        let options = self.checked.options;
        loop {
            let resolution = Resolution::of(self.cells);
            let mesh = self.checked.mesh(&self.patch, resolution, Reach::Patch)?;
            let room = options.max_dofs as f64 / (mesh.free_dofs() as f64 * REFINEMENT.powi(6));
            let first = self.solved.similar() == 0 && options.cells.is_none();
            if !first || room >= 1.0 || self.cells <= MIN_CELLS {
                return Ok(mesh);
            }
            let fewer = (self.cells * room.cbrt()).floor().min(self.cells - 1.0);
            self.cells = fewer.max(MIN_CELLS);
            self.coarsest = self.cells;
        }
    }

    fn gap_of<'b>(&'b self, contact: &'b SolvedMesh) -> DeformedGap<'b> {
        DeformedGap::new(&self.checked, &self.patch, contact)
    }

    /// Adds these places to the patch, and restarts with the first mesh's cells.
    ///
    /// # Errors
    /// [`Error::Unsolved`] if it was widened [`WIDENINGS`] times.
    pub fn widen(&mut self, contact: &SolvedMesh, found: &[Penetration]) -> Result<(), Error> {
        let deepest = found.iter().max_by(|a, b| a.depth.total_cmp(&b.depth));
        if let Some(deepest) = deepest.filter(|_| self.widened.len() == WIDENINGS) {
            let ([x, y], depth) = (deepest.at, deepest.depth);
            return Err(Error::Unsolved(format!(
                "the runner also touches the ice at x = {x:.4} m, y = {y:.4} m, by {depth:.2e} m, far from \
                 where contact was expected or between the nodes there: expected a hull that touches \
                 at fewer places, or is smoother"
            )));
        }
        // Meshes without these places belong to another contact.
        let hardness = self.checked.problem.ice.hardness;
        self.solved = FigureHistory::new(hardness, error_floor(self.own));
        self.patch = self.gap_of(contact).patch_with(found);
        self.widened.push(self.patch.clone());
        self.graded_anew = true;
        self.cells = self.first;
        self.coarsest = self.first;
        Ok(())
    }

    /// Prepares the mesh of a verdict.
    pub fn refine(&mut self, contact: SolvedMesh, plan: Plan) {
        let found = contact.pressure.patch;
        // Rims are known to one cell: meshes for the same rims are similar.
        let agrees = self.patch.agrees_with(&found, 1.0 / self.cells);
        self.graded_anew = plan.anew || !agrees;
        if plan.anew {
            self.regraded += 1;
            self.patch = found;
        } else if agrees {
            self.patch.motion = found.motion;
        } else {
            self.patch = found.with_sizes_of(&self.patch);
        }
        // Meshes for other rims give little information on these; restarting with a coarse mesh is
        // cheapest.
        let again = !plan.anew && !agrees && self.regraded < REGRADINGS;
        self.cells = if again {
            self.first.min(plan.cells)
        } else {
            plan.cells
        };
        self.regraded += usize::from(again);
        if self.graded_anew {
            self.coarsest = self.cells;
        }
    }

    /// The solution from the last mesh and the limits of all meshes.
    pub fn solution(self, contact: SolvedMesh, limits: Limits) -> Solution {
        Solution {
            under_peak: self.solved.under_peak(),
            ..contact.solution(&self.checked, limits, self.history)
        }
    }
}

fn error_floor(own: Option<OwnCells>) -> ErrorFloor {
    own.map_or_else(ErrorFloor::default, OwnCells::error_floor)
}

// Decision after each mesh: whether the accuracy is reached, otherwise the next mesh.

/// Fraction of the requested error that the rims of a first mesh may contribute; otherwise the
/// contact's own patch is meshed next. The remainder is for the cells.
const BY_RIMS: f64 = 0.5;

/// Decision after a mesh.
pub(crate) enum Verdict {
    /// The requested accuracy is reached, with this limit of fine meshes.
    Reached(Limits),
    /// Another mesh is needed.
    Refine(Plan),
    /// The runner touches where contact was not expected.
    Widen(Vec<Penetration>),
    /// Another mesh is needed and would have too many unknowns, or finer cells than the runner's
    /// own hexahedra; with the limits of the meshes, if known.
    OutOfReach(Option<Limits>),
}

impl Meshes<'_> {
    /// The decision after the last mesh, `contact`.
    pub fn judge(&self, contact: &SolvedMesh) -> Verdict {
        let verdict = self.judge_accuracy(contact);
        // Uneven ice is in contact at many places, which are added before the first ones are
        // refined.
        let early = self.solved.similar() <= 1 && self.checked.problem.ice_surface.is_some();
        if matches!(verdict, Verdict::Refine(_)) && !early {
            return verdict;
        }
        let mut found = self.gap_of(contact).penetrations();
        // A place that was added and stayed open is not in contact, though meshes that no longer
        // include it penetrate there.
        found.retain(|place| {
            let [x, y] = place.at;
            // Within the expected contact, a penetration lies between the nodes.
            expected(&self.patch, x, y) || !self.widened.iter().any(|patch| expected(patch, x, y))
        });
        if found.is_empty() {
            verdict
        } else {
            Verdict::Widen(found)
        }
    }

    fn judge_accuracy(&self, contact: &SolvedMesh) -> Verdict {
        let options = self.checked.options;
        if options.cells.is_some() {
            return Verdict::Reached(self.solved.unjudged());
        }
        let limits = self.solved.limits();
        let tolerance = options.p_max_tolerance;
        let room = options.max_dofs as f64 / contact.mesh.free_dofs() as f64;
        let penetrations = self.solved.similar() == 1 && self.solved.missed > BY_RIMS * tolerance;
        let coarse = contact.pressure.patch.finest_over(&self.patch) < COARSE;
        let anew = self.regraded < REGRADINGS && (coarse || penetrations);
        // The grading is fine enough if no finer one is needed, or if regrading changed nothing.
        let graded = !anew || self.graded_anew;
        if let Some(limits) = limits.filter(|l| graded && l.relative <= tolerance) {
            // All meshes may be too coarse for a peak although they agree.
            return if coarse && !self.graded_anew {
                Verdict::OutOfReach(Some(limits))
            } else {
                Verdict::Reached(limits)
            };
        }
        let cells = match limits {
            _ if anew => self.cells,
            Some(limits) if self.solved.similar() >= 3 => {
                let finer_room = room.cbrt();
                let wished = next_refinement(limits.relative / tolerance);
                // As many cells as the limit of unknowns allows.
                let finer = if wished <= finer_room {
                    (self.cells * wished).round()
                } else {
                    (self.cells * finer_room.max(MIN_REFINEMENT)).floor()
                };
                finer.max(self.cells + 1.0)
            }
            _ => {
                let planned = self.coarsest * REFINEMENT.powi(self.solved.similar() as i32);
                planned.round().max(self.cells + 1.0)
            }
        };
        let cells = match self.own.map(|own| own.ice_cells().floor()) {
            Some(own) if !anew && cells > own && own > self.cells => own,
            Some(own) if !anew && cells > own => return Verdict::OutOfReach(limits),
            _ => cells,
        };
        // A mesh that is graded anew may have more unknowns than in proportion to its cells.
        let more = (cells / self.cells).powi(3).max(REFINEMENT);
        if more <= room {
            return Verdict::Refine(Plan { anew, cells });
        }
        // If only the grading is in doubt, fewer cells with the finer grading are enough.
        let fewer = (self.cells * (room / REFINEMENT).cbrt()).floor();
        match limits.filter(|l| l.relative <= tolerance) {
            Some(_) if fewer >= MIN_CELLS => Verdict::Refine(Plan { anew, cells: fewer }),
            _ => Verdict::OutOfReach(limits),
        }
    }

    /// The error with the best solution and its estimated accuracy.
    pub fn out_of_reach(self, contact: SolvedMesh, limits: Option<Limits>) -> Error {
        let limits = limits.unwrap_or_else(|| self.solved.last());
        let tolerance = self.checked.options.p_max_tolerance;
        let finest = contact.pressure.patch.finest_over(&self.patch);
        let best = self.solution(contact, limits);
        Error::AccuracyNotReached {
            dofs: best.dofs,
            estimate: limits.relative,
            tolerance,
            finest,
            best: Box::new(best),
        }
    }
}

#[cfg(test)]
mod tests {
    //! The largest order of convergence that is believed of values that a rim moves.

    use std::sync::Arc;

    use kufe_mesh::Paraboloid;

    use crate::accuracy::estimators::{MAX_ORDER, MeshValue};
    use crate::accuracy::meshes::{Meshes, Verdict};
    use crate::problem::check::CheckedProblem;
    use crate::{Error, Ice, Load, Measure, Options, Problem, Runner, Tilt};

    /// The order as it is, at half and at twice.
    const ORDERS: [f64; 3] = [0.5 * MAX_ORDER, MAX_ORDER, 2.0 * MAX_ORDER];
    const TOLERANCES: [f64; 2] = [0.02, 0.005];

    /// A contact on ice that yields, with the approach that rectangles give it and what they know
    /// it to.
    struct Row {
        problem: Problem,
        approach: f64,
        known_to: f64,
    }

    /// Those of `tests/data/coverage.csv`, or of the table that `KUFE_ROWS` names.
    fn rows() -> Vec<Row> {
        let table = match std::env::var_os("KUFE_ROWS") {
            Some(path) => std::fs::read_to_string(path).expect("a table of rows"),
            None => include_str!("../../../tests/data/coverage.csv").into(),
        };
        let row = |line: &str| {
            let cells: Vec<f64> = line
                .split(',')
                .skip(1)
                .map(|n| n.parse().expect("a number"))
                .collect();
            let runner = Runner::rigid(Arc::new(
                Paraboloid::new(cells[0], cells[1]).expect("radii"),
            ));
            let ice = Ice {
                hardness: Some(cells[10]),
                ..Ice::half_space(9e9, 0.33)
            };
            Row {
                problem: Problem::new(runner, ice, Load::central(cells[3], Tilt::Free)),
                approach: cells[16],
                known_to: cells[17],
            }
        };
        let yields = table
            .lines()
            .filter(|line| line.starts_with("ice that yields,"));
        yields.map(row).collect()
    }

    /// The approach of a contact solved to an accuracy, by each of [`ORDERS`]: what decides when
    /// meshes do is the area, whatever these say.
    fn approaches(problem: &Problem, tolerance: f64) -> Result<[Measure; 3], Error> {
        let options = Options {
            p_max_tolerance: tolerance,
            ..Options::default()
        };
        let mut meshes = Meshes::guess(CheckedProblem::bearable(problem, &options)?, Vec::new())?;
        loop {
            let contact = meshes.solve_next()?;
            match meshes.judge(&contact) {
                Verdict::Reached(_) | Verdict::OutOfReach(_) => {
                    return Ok(ORDERS.map(|order| meshes.solved.approach_by_rim_up_to(order)));
                }
                Verdict::Refine(plan) => meshes.refine(contact, plan),
                Verdict::Widen(found) => meshes.widen(&contact, &found)?,
            }
        }
    }

    /// The share of limits that hold 1, known to so much, and the median of what they state over
    /// what they are off by.
    fn reported(limits: &mut [(Measure, f64)]) -> [f64; 2] {
        let off = |(limit, _): &(Measure, f64)| (limit.value - 1.0).abs();
        let covered = limits.iter().filter(|l| off(l) <= l.0.error + l.1).count();
        let mut ratios: Vec<f64> = limits
            .iter()
            .map(|l| l.0.error / off(l).max(1e-12))
            .collect();
        ratios.sort_by(f64::total_cmp);
        [
            covered as f64 / limits.len() as f64,
            ratios[ratios.len() / 2],
        ]
    }

    /// A generator of numbers in [-1, 1) (G. Marsaglia's xorshift, 2003).
    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }
    }

    /// Three meshes of 3 to 8 cells and twice as many, with limit 1: a smooth error of an order of
    /// 0.5 to 3 and of 0.1 to 10 % on the coarsest, and one of the rim between nodes of 0.1 to 1
    /// times that, which falls with the cells' size to the power 1.5.
    fn sequence(random: &mut Random) -> [MeshValue; 3] {
        let first = (5.5 + 2.5 * random.next()).floor();
        let (order, error) = (
            1.75 + 1.25 * random.next(),
            10f64.powf(-2.0 + random.next()),
        );
        let rim = error * 10f64.powf(0.5 * random.next() - 0.5);
        let second = (first * 2f64.sqrt()).round();
        [first, second, 2.0 * first].map(|cells| {
            let h = first / cells;
            MeshValue {
                cells,
                value: 1.0 - error * h.powf(order) + rim * h.powf(1.5) * random.next(),
            }
        })
    }

    /// `cargo test --release -p kufe-contact highest -- --ignored --nocapture`; with `KUFE_ROWS`
    /// another table's rows.
    #[test]
    #[ignore = "slow study: .ci/slow"]
    fn the_highest_order_holds_errors_at_half_and_twice_itself() {
        let mut random = Random(0x2545_f491_4f6c_dd1d);
        let sequences: Vec<[MeshValue; 3]> = (0..20_000).map(|_| sequence(&mut random)).collect();
        let rows = rows();
        let solved: Vec<Vec<([Measure; 3], f64)>> = TOLERANCES
            .iter()
            .map(|&tolerance| {
                let of = |row: &Row| {
                    let part = |l: Measure| Measure {
                        value: l.value / row.approach,
                        error: l.error / row.approach,
                    };
                    (
                        approaches(&row.problem, tolerance)
                            .expect("a contact")
                            .map(part),
                        row.known_to,
                    )
                };
                rows.iter().map(of).collect()
            })
            .collect();
        println!(
            "| order | sequences covered | stated over true | contacts at 2 % | | at 0.5 % | |"
        );
        println!("|---|---|---|---|---|---|---|");
        for (k, &order) in ORDERS.iter().enumerate() {
            let mut made: Vec<(Measure, f64)> = sequences
                .iter()
                .map(|&meshes| (Measure::richardson_at_rim(meshes, order), 0.0))
                .collect();
            let [covered, ratio] = reported(&mut made);
            print!("| {order} | {:.1} % | {ratio:.1} |", 100.0 * covered);
            for of in &solved {
                let mut limits: Vec<(Measure, f64)> =
                    of.iter().map(|(l, known)| (l[k], *known)).collect();
                let [covered, ratio] = reported(&mut limits);
                print!(
                    " {:.0} % of {} | {ratio:.1} |",
                    100.0 * covered,
                    limits.len()
                );
                // One in twenty may be off, and of few one.
                let least = 0.95f64.min(1.0 - 1.0 / limits.len() as f64);
                assert!(order != MAX_ORDER || covered >= least, "{covered}");
            }
            println!();
            // Rims of contacts move less: theirs are covered more often.
            assert!(order != MAX_ORDER || covered >= 0.9, "{covered}");
        }
    }
}
