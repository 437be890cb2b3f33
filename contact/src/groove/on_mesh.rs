//! Steady sliding on one mesh: the contact plane with plastic memory, corrected by the bodies.

use std::borrow::Cow;

use nalgebra::{Matrix3, Vector3};

use crate::accuracy::mesh_solve::{Forces, MeshSolve};
use crate::green::matrix::{Green, StorageLimit};
use crate::groove::measures::Rims;
use crate::groove::plastic_contact::{Kind, PlasticContact, PlasticState};
use crate::groove::solution::GrooveProfile;
use crate::mesh::contact_mesh::State;
use crate::mesh::discretise::Discretisation;
use crate::motion::{Motion, dot};
use crate::problem::check::CheckedProblem;
use crate::{Error, Load, Options};

/// One mesh of a sliding contact.
pub(crate) struct MeshContact<'a> {
    pub checked: &'a CheckedProblem<'a>,
    pub mesh: &'a Discretisation,
    pub before: Option<&'a GrooveProfile>,
}

/// Largest number of corrections of the response.
const MAX_CORRECTIONS: usize = 60;
/// Tolerance of the change of the forces in a correction, relative to their sum.
const FORCE_RTOL: f64 = 1e-6;
/// Number of first corrections in which the nodes' parts of the plane are fitted to the yielding
/// area; they are fixed afterwards, so that the forces converge.
const FITTINGS: usize = 4;
/// Largest number of iterations of one response.
const MAX_ITERATIONS: usize = 400;

impl MeshContact<'_> {
    /// Solves on the contact plane alone.
    pub fn on_plane(&self, start: &Start) -> Result<SlidingState, Error> {
        self.begin(&self.plane()?, start)
    }

    /// Solves with the response S of the bodies, from the far field of `forces`.
    ///
    /// The plane's response G f is corrected by S f - G f for the last forces, until the forces
    /// converge. They are then those of S: G only determines the rate of convergence. The full
    /// nodes' parts of the plane are scaled to the yielding area with sub-cell resolution,
    /// [`Rims::full_area`], so that the load does not depend on the position of nodes next to the
    /// rim. Returns the solution and the measures without this scaling; `report` receives the
    /// intermediate states.
    pub fn solve(
        &self,
        start: &Start,
        forces: &Forces,
        report: impl Fn(&SlidingState),
    ) -> Result<[SlidingState; 2], Error> {
        let contact = &self.mesh.contact;
        let options = self.checked.options;
        let mut plane = self.plane()?;
        let mut slid = self.begin(&plane, start)?;
        slid.state.displacement = vec![0.0; contact.len()];
        let outer = MeshSolve {
            checked: self.checked,
            mesh: self.mesh,
            stored: StorageLimit::USUAL,
            report: &|_, _| {},
        };
        outer.fix_outer_faces(forces, &mut slid.state);
        slid.residual = 1.0;
        while slid.corrections < MAX_CORRECTIONS {
            report(&slid);
            if slid.corrections > 0 {
                outer.fix_outer_faces(&Forces::of(self.mesh, &slid.state), &mut slid.state);
            }
            let tolerance = (1e-2 * slid.residual).clamp(options.residual, 1e-3);
            slid.iterations += contact
                .solve_displacement(&mut slid.state, tolerance, MAX_ITERATIONS)
                .ok_or_else(|| not_converged(&slid))?;
            options.check_stop()?;
            if slid.residual <= FORCE_RTOL && slid.corrections >= FITTINGS {
                let mut plain = slid.clone();
                plane.bound = contact.on_candidates(&contact.bound);
                self.correct(&mut plane, &mut plain)?;
                return Ok([slid, plain]);
            }
            if slid.corrections < FITTINGS {
                let full = Rims::new(self.mesh, &slid).full_area();
                plane.bound = contact.on_candidates(&contact.bound);
                plane.bound.iter_mut().for_each(|bound| *bound *= full);
            }
            self.correct(&mut plane, &mut slid)?;
        }
        Err(not_converged(&slid))
    }

    /// The contact plane with the stored matrix of the preconditioner's response.
    fn plane(&self) -> Result<PlasticContact, Error> {
        let contact = &self.mesh.contact;
        let nodes = &contact.candidates;
        let (count, limit) = (nodes.len(), StorageLimit::USUAL.mounted);
        if count > limit {
            return Err(Error::Unsolved(format!(
                "{count} nodes of the contact plane may touch while the runner slides, {limit} are \
                 the most: expected a shorter contact, longer waves, or less accuracy"
            )));
        }
        let [_, green] = contact.dense_greens();
        let row = |node: &usize| node / self.mesh.grid.x.len();
        let same_row = |k: usize| nodes.get(k + 1).map(row) == Some(row(&nodes[k]));
        Ok(PlasticContact {
            green,
            gap: contact.unpressed_gap(),
            rows: contact.on_candidates(&contact.rows),
            bound: contact.on_candidates(&contact.bound),
            has_ahead: (0..count).map(same_row).collect(),
            before: nodes.iter().map(|n| self.depth_before(row(n))).collect(),
        })
    }

    /// Solves steady sliding on the plane.
    fn begin(&self, plane: &PlasticContact, start: &Start) -> Result<SlidingState, Error> {
        let contact = &self.mesh.contact;
        let (kinds, motion) = match start {
            Start::AtRest(motion) => {
                let stored = Green::Dense(Cow::Borrowed(&plane.green));
                let rest = contact.plane_contact_from_rest(&stored, *motion);
                (plane.kinds(&rest.force), rest.motion)
            }
            Start::From(known) => (known.on(self.mesh), known.motion),
        };
        let grooved = self
            .load_balance(plane)
            .from(motion, kinds)
            .ok_or_else(|| self.no_balance(plane))?;
        Ok(SlidingState {
            state: contact.state_of(&grooved.force, grooved.motion),
            depth: self.whole(&grooved),
            grooved,
            iterations: 0,
            corrections: 0,
            residual: 1.0,
        })
    }

    /// The error if no motion balances the load: the load exceeds the runner's capacity at any
    /// depth, or the search failed.
    fn no_balance(&self, plane: &PlasticContact) -> Error {
        let highest = plane.gap.iter().filter(|gap| gap.is_finite());
        let sunk = 2.0 * highest.fold(0.0, |most: f64, gap| most.max(*gap));
        let bears = plane
            .at([sunk, 0.0, 0.0], &vec![Kind::Full; plane.gap.len()])
            .map(|state| plane.resultant(&state.force)[0]);
        let required = self.mesh.contact.motion.balance[0];
        match (self.checked.problem.load, bears) {
            (Load::Force { fz, .. }, Some(bears)) if bears < required => {
                Error::LoadExceedsHardness {
                    fz,
                    capacity: bears / required * fz,
                }
            }
            _ => Error::NotConverged {
                iterations: 0,
                residual: 1.0,
                tolerance: FORCE_RTOL,
            },
        }
    }

    /// New forces with the bodies' response to the last ones.
    fn correct(&self, plane: &mut PlasticContact, slid: &mut SlidingState) -> Result<(), Error> {
        let contact = &self.mesh.contact;
        let closing = contact.closing(&slid.state.displacement);
        let known = plane.deflection(&slid.grooved.force);
        let nodes = contact.candidates.iter().zip(known);
        plane.gap = nodes
            .map(|(&node, known)| contact.gap[node] - closing[node] - known)
            .collect();
        let kinds = slid.grooved.kinds.clone();
        let next = self.load_balance(plane).from(slid.grooved.motion, kinds);
        let next = next.ok_or_else(|| not_converged(slid))?;
        let pairs = next.force.iter().zip(&slid.grooved.force);
        let change: f64 = pairs.map(|(a, b)| (a - b).abs()).sum();
        slid.residual = change / next.force.iter().sum::<f64>();
        let displacement = std::mem::take(&mut slid.state.displacement);
        slid.state = State {
            displacement,
            ..contact.state_of(&next.force, next.motion)
        };
        slid.depth = self.whole(&next);
        slid.grooved = next;
        slid.corrections += 1;
        Ok(())
    }

    /// Depth of the groove of earlier runners in row `j` [m].
    fn depth_before(&self, j: usize) -> f64 {
        let y = self.mesh.grid.y[j];
        self.before.map_or(0.0, |groove| groove.at(y))
    }

    fn load_balance<'b>(&'b self, plane: &'b PlasticContact) -> LoadBalance<'b> {
        LoadBalance {
            plane,
            motion: &self.mesh.contact.motion,
            options: self.checked.options,
        }
    }

    /// The depth on the whole plane: behind the candidates, each row keeps its last depth.
    fn whole(&self, grooved: &PlasticState) -> Vec<f64> {
        let [nx, ny] = [self.mesh.grid.x.len(), self.mesh.grid.y.len()];
        let mut known = vec![f64::NAN; nx * ny];
        for (&node, &depth) in self.mesh.contact.candidates.iter().zip(&grooved.depth) {
            known[node] = depth;
        }
        for (j, row) in known.chunks_exact_mut(nx).enumerate() {
            let mut ahead = self.depth_before(j);
            for depth in row.iter_mut().rev() {
                if depth.is_nan() {
                    *depth = ahead;
                }
                ahead = *depth;
            }
        }
        known
    }
}

fn not_converged(slid: &SlidingState) -> Error {
    Error::NotConverged {
        iterations: slid.iterations,
        residual: slid.residual,
        tolerance: FORCE_RTOL,
    }
}

// The rigid motion that balances the load on a plane with plastic memory.

/// A plane with plastic memory and the balance that determines the runner's motion.
///
/// Force and moments increase with approach and tilt almost in steps: a node at the front changes
/// from open to full within a small motion. Newton's method leads near the balance. Then each
/// motion is bracketed (Illinois variant of regula falsi: M. Dowell, P. Jarratt, BIT 11 (1971)
/// 168-174), with the approach nested within the pitch and the pitch within the roll.
pub(crate) struct LoadBalance<'a> {
    pub plane: &'a PlasticContact,
    /// The free motions and their balance.
    pub motion: &'a Motion,
    pub options: &'a Options,
}

/// Largest imbalance relative to the load, and to the load's moment over the contact.
const BALANCE_RTOL: f64 = 1e-10;
/// Largest number of motions tried for one balance.
const MAX_TRIALS: usize = 120;
/// First step of a motion relative to the depth of the contact.
const FIRST: f64 = 0.02;
/// Largest number of Newton steps, and largest accepted step relative to the depth of the contact.
const NEWTON_STEPS: usize = 12;
const MAX_STEP: f64 = 0.5;

impl LoadBalance<'_> {
    /// Solves from a motion and sets near the solution; `None` if the search fails.
    pub fn from(&self, motion: [f64; 3], kinds: Vec<Kind>) -> Option<PlasticState> {
        let start = self.plane.at(motion, &kinds)?;
        let free: Vec<usize> = (0..3).filter(|&axis| self.motion.free[axis]).collect();
        let start = self.newton(start, &free);
        self.balanced(start, &free)
    }

    /// Newton's method for the balance of all motions at once on the present sets, while the
    /// imbalance decreases.
    fn newton(&self, start: PlasticState, free: &[usize]) -> PlasticState {
        let mut state = start;
        for _ in 0..NEWTON_STEPS {
            let imbalance = self.imbalance(&state, free);
            if imbalance <= BALANCE_RTOL {
                break;
            }
            let slopes = self.plane.slopes(&state.kinds);
            let identity = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
            let is_free = |a: usize| free.contains(&a);
            let matrix = Matrix3::from_fn(|a, b| {
                if is_free(a) && is_free(b) {
                    slopes[a][b] / self.size(a) * self.unit_motion(b, &state)
                } else {
                    identity(a, b)
                }
            });
            let excess = Vector3::from_fn(|a, _| {
                if is_free(a) {
                    self.excess(&state, a) / self.size(a)
                } else {
                    0.0
                }
            });
            let Some(inverse) = matrix.try_inverse() else {
                break;
            };
            let step = -(inverse * excess);
            // NaN steps are not accepted either.
            if step
                .iter()
                .any(|part| part.is_nan() || part.abs() > MAX_STEP)
            {
                break;
            }
            let motion = [0, 1, 2].map(|a| state.motion[a] + step[a] * self.unit_motion(a, &state));
            match self.plane.at(motion, &state.kinds) {
                Some(next) if self.imbalance(&next, free) < 0.7 * imbalance => state = next,
                _ => break,
            }
        }
        state
    }

    /// Largest relative imbalance.
    fn imbalance(&self, state: &PlasticState, free: &[usize]) -> f64 {
        let parts = free
            .iter()
            .map(|&axis| self.excess(state, axis).abs() / self.size(axis));
        parts.fold(0.0, f64::max)
    }

    /// The motion that moves the farthest node by the contact's depth.
    fn unit_motion(&self, axis: usize, state: &PlasticState) -> f64 {
        self.depth(state) / self.scale(axis)
    }

    /// Balances the last of the `free` motions with those before it.
    fn balanced(&self, start: PlasticState, free: &[usize]) -> Option<PlasticState> {
        let Some((&axis, inner)) = free.split_last() else {
            return Some(start);
        };
        let scale = self.scale(axis);
        let slack = BALANCE_RTOL * 10f64.powi(axis.min(1) as i32) * self.size(axis);
        let mut state = self.balanced(start, inner)?;
        let mut excess = self.excess(&state, axis);
        let mut step = FIRST * self.depth(&state) / scale * if excess > 0.0 { -1.0 } else { 1.0 };
        // The motion and the weighted imbalance of a state on the other side of the balance.
        let mut other: Option<(f64, f64)> = None;
        for _ in 0..MAX_TRIALS {
            if self.options.stopped() {
                return None;
            }
            if excess.abs() <= slack {
                return Some(state);
            }
            let current = state.motion[axis];
            let next = match other {
                None => current + step,
                Some((opposite, opposite_excess)) => {
                    let weight = (excess / (excess - opposite_excess)).clamp(0.05, 0.95);
                    current + weight * (opposite - current)
                }
            };
            if next == current || other.is_some_and(|(opposite, _)| next == opposite) {
                return Some(state);
            }
            let mut motion = state.motion;
            motion[axis] = next;
            let trial = self.balanced(self.plane.at(motion, &state.kinds)?, inner)?;
            let trial_excess = self.excess(&trial, axis);
            if trial_excess * excess <= 0.0 {
                other = Some((current, excess));
            } else {
                other = other.map(|(opposite, opposite_excess)| (opposite, 0.5 * opposite_excess));
                step *= 2.0;
            }
            (state, excess) = (trial, trial_excess);
        }
        None
    }

    /// Excess of a state's resultant along a motion.
    fn excess(&self, state: &PlasticState, axis: usize) -> f64 {
        self.plane.resultant(&state.force)[axis] - self.motion.balance[axis]
    }

    /// The load, or its moment at the farthest node.
    fn size(&self, axis: usize) -> f64 {
        self.scale(axis) * self.motion.balance[0].abs()
    }

    /// Displacement of the farthest node by a unit of a motion.
    fn scale(&self, axis: usize) -> f64 {
        let reach = self.plane.rows.iter().map(|row| row[axis].abs());
        reach.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Deepest place of the runner in the undeformed ice [m].
    fn depth(&self, state: &PlasticState) -> f64 {
        let below = |i: usize| dot(self.plane.rows[i], state.motion) - self.plane.gap[i];
        (0..state.force.len())
            .filter(|&i| state.force[i] > 0.0)
            .map(|i| below(i).abs())
            .fold(1e-9, f64::max)
    }
}

// A state with its groove, and the initial state of a mesh's solve.

/// The state on one mesh with its groove.
#[derive(Clone)]
pub(crate) struct SlidingState {
    pub state: State,
    /// State of the candidates.
    pub grooved: PlasticState,
    /// Plastic depth on the whole plane, x fastest [m].
    pub depth: Vec<f64>,
    /// Conjugate-gradient iterations.
    pub iterations: usize,
    /// Corrections of the plane's response by the bodies.
    pub corrections: usize,
    /// Ratio of the sum of the forces' changes in the last correction to the load.
    pub residual: f64,
}

/// Initial state of a mesh's solve.
pub(crate) enum Start {
    /// The indentation at rest, searched near this motion [m].
    AtRest(f64),
    /// The solution of another mesh.
    From(WarmStart),
}

/// States of the nodes and motion from the solution of another mesh.
pub(crate) struct WarmStart {
    x: Vec<f64>,
    y: Vec<f64>,
    kinds: Vec<Kind>,
    pub motion: [f64; 3],
}

impl WarmStart {
    /// The states of a mesh.
    pub fn of(mesh: &Discretisation, slid: &SlidingState) -> Self {
        let (x, y) = (mesh.grid.x.clone(), mesh.grid.y.clone());
        let mut kinds = vec![Kind::Open; x.len() * y.len()];
        for (&node, &kind) in mesh.contact.candidates.iter().zip(&slid.grooved.kinds) {
            kinds[node] = kind;
        }
        let motion = slid.grooved.motion;
        WarmStart {
            x,
            y,
            kinds,
            motion,
        }
    }

    /// States of another mesh's candidates, from the nearest nodes.
    pub fn on(&self, mesh: &Discretisation) -> Vec<Kind> {
        let nearest = |places: &[f64], at: f64| {
            let next = places
                .partition_point(|&p| p < at)
                .clamp(1, places.len() - 1);
            if at - places[next - 1] < places[next] - at {
                next - 1
            } else {
                next
            }
        };
        let columns: Vec<usize> = mesh.grid.x.iter().map(|&x| nearest(&self.x, x)).collect();
        let rows: Vec<usize> = mesh.grid.y.iter().map(|&y| nearest(&self.y, y)).collect();
        let nodes = mesh.contact.candidates.iter();
        let nx = mesh.grid.x.len();
        nodes
            .map(|n| self.kinds[rows[n / nx] * self.x.len() + columns[n % nx]])
            .collect()
    }
}
