//! Steady sliding on one mesh: the plane with plastic memory, and the bodies that correct its
//! response.

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

/// Most corrections of the response.
const CORRECTIONS: usize = 60;
/// Change of the forces, over their sum, at which corrections end.
const SETTLED: f64 = 1e-6;
/// Corrections with which the nodes' shares of the plane are fitted to the area that yields; then
/// they stay, so that the forces do.
const FITTINGS: usize = 4;
/// Most iterations of one response.
const ITERATIONS: usize = 400;

impl MeshContact<'_> {
    /// Solves on the contact plane alone.
    pub fn on_plane(&self, start: &Start) -> Result<SlidingState, Error> {
        self.begin(&self.plane()?, start)
    }

    /// Solves with the bodies' own response, from the far field of `forces`.
    ///
    /// The plane's response G is corrected by what the bodies answer to the forces found last, S
    /// f - G f, until the forces stay. Then they are those of S: G determines the rate alone.
    /// Full nodes' parts of the plane add up to the area that yields below the cell,
    /// [`Rims::full_area`], so that the load does not depend on where nodes lie next to the rim.
    /// Returns the solution and the residual without that correction; `report` receives the states
    /// on the way.
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
        while slid.corrections < CORRECTIONS {
            report(&slid);
            if slid.corrections > 0 {
                outer.fix_outer_faces(&Forces::of(self.mesh, &slid.state), &mut slid.state);
            }
            let tolerance = (1e-2 * slid.residual).clamp(options.residual, 1e-3);
            slid.iterations += contact
                .solve_displacement(&mut slid.state, tolerance, ITERATIONS)
                .ok_or_else(|| not_converged(&slid))?;
            options.check_stop()?;
            if slid.residual <= SETTLED && slid.corrections >= FITTINGS {
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

    /// The contact plane on the preconditioner's response, whose matrix steady sliding needs
    /// stored.
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

    /// Steady sliding on the plane.
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

    /// Why no motion carries the load: more than the runner bears however deep it sinks, or the
    /// search failed.
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
                tolerance: SETTLED,
            },
        }
    }

    /// New forces under the response that the bodies have given to the last ones.
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

    /// Depth of the groove in which the ice of row `j` comes [m].
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

    /// The depth on the whole plane: each row keeps towards the back what it had.
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
        tolerance: SETTLED,
    }
}

// The motion under which a plane with plastic memory carries the load.

/// A plane with plastic memory and the balance that determines the runner's motion.
///
/// Force and moments rise with approach and turn, in steps: a node at the front goes from open to
/// full within the little that its own response gives. Newton's steps lead near the balance where
/// they can; from there each motion is bracketed (bisection with the secant of Illinois: M. Dowell,
/// P. Jarratt, BIT 11 (1971) 168-174), the approach within the pitch and the pitch within the roll.
pub(crate) struct LoadBalance<'a> {
    pub plane: &'a PlasticContact,
    /// The free motions and their balance.
    pub motion: &'a Motion,
    pub options: &'a Options,
}

/// What may be out of balance, over the load and the load's moment over the contact.
const SLACK: f64 = 1e-10;
/// Most motions tried for one balance.
const TRIALS: usize = 120;
/// First step of a motion over the depth of the contact.
const FIRST: f64 = 0.02;
/// Most steps of all motions at once, and the largest that is trusted, over the depth of the
/// contact.
const NEWTON_STEPS: usize = 12;
const LARGEST: f64 = 0.5;

impl LoadBalance<'_> {
    /// Solves from a motion and sets near the solution; `None` where none is found.
    pub fn from(&self, motion: [f64; 3], kinds: Vec<Kind>) -> Option<PlasticState> {
        let start = self.plane.at(motion, &kinds)?;
        let free: Vec<usize> = (0..3).filter(|&axis| self.motion.free[axis]).collect();
        let near = self.near(start, &free);
        self.balanced(near, &free)
    }

    /// Towards the balance of all motions at once, by Newton's method on the sets as they are, for
    /// as long as that leads there.
    fn near(&self, start: PlasticState, free: &[usize]) -> PlasticState {
        let mut at = start;
        for _ in 0..NEWTON_STEPS {
            let missing = self.missing(&at, free);
            if missing <= SLACK {
                break;
            }
            let slopes = self.plane.slopes(&at.kinds);
            let identity = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
            let is_free = |a: usize| free.contains(&a);
            let matrix = Matrix3::from_fn(|a, b| {
                if is_free(a) && is_free(b) {
                    slopes[a][b] / self.size(a) * self.unit(b, &at)
                } else {
                    identity(a, b)
                }
            });
            let out = Vector3::from_fn(|a, _| {
                if is_free(a) {
                    self.out(&at, a) / self.size(a)
                } else {
                    0.0
                }
            });
            let Some(inverse) = matrix.try_inverse() else {
                break;
            };
            let step = -(inverse * out);
            // A step that is no number is not trusted either.
            if step
                .iter()
                .any(|part| part.is_nan() || part.abs() > LARGEST)
            {
                break;
            }
            let motion = [0, 1, 2].map(|a| at.motion[a] + step[a] * self.unit(a, &at));
            match self.plane.at(motion, &at.kinds) {
                Some(next) if self.missing(&next, free) < 0.7 * missing => at = next,
                _ => break,
            }
        }
        at
    }

    /// Largest part that is out of balance.
    fn missing(&self, state: &PlasticState, free: &[usize]) -> f64 {
        let parts = free
            .iter()
            .map(|&axis| self.out(state, axis).abs() / self.size(axis));
        parts.fold(0.0, f64::max)
    }

    /// The motion that moves the farthest node by the contact's depth.
    fn unit(&self, axis: usize, state: &PlasticState) -> f64 {
        self.deep(state) / self.scale(axis)
    }

    /// Balances the last of the `free` motions with those before it.
    fn balanced(&self, start: PlasticState, free: &[usize]) -> Option<PlasticState> {
        let Some((&axis, inner)) = free.split_last() else {
            return Some(start);
        };
        let scale = self.scale(axis);
        let slack = SLACK * 10f64.powi(axis.min(1) as i32) * self.size(axis);
        let mut at = self.balanced(start, inner)?;
        let mut out = self.out(&at, axis);
        let mut step = FIRST * self.deep(&at) / scale * if out > 0.0 { -1.0 } else { 1.0 };
        // A state on the other side of the balance, once there is one, with the weight that the
        // secant gives it.
        let mut other: Option<(f64, f64)> = None;
        for _ in 0..TRIALS {
            if self.options.stopped() {
                return None;
            }
            if out.abs() <= slack {
                return Some(at);
            }
            let here = at.motion[axis];
            let next = match other {
                None => here + step,
                Some((there, there_out)) => {
                    let share = (out / (out - there_out)).clamp(0.05, 0.95);
                    here + share * (there - here)
                }
            };
            if next == here || other.is_some_and(|(there, _)| next == there) {
                return Some(at);
            }
            let mut motion = at.motion;
            motion[axis] = next;
            let moved = self.balanced(self.plane.at(motion, &at.kinds)?, inner)?;
            let now = self.out(&moved, axis);
            if now * out <= 0.0 {
                other = Some((here, out));
            } else {
                other = other.map(|(there, there_out)| (there, 0.5 * there_out));
                step *= 2.0;
            }
            (at, out) = (moved, now);
        }
        None
    }

    /// What a state carries too much along a motion.
    fn out(&self, state: &PlasticState, axis: usize) -> f64 {
        self.plane.resultant(&state.force)[axis] - self.motion.balance[axis]
    }

    /// The load, or its moment at the farthest node.
    fn size(&self, axis: usize) -> f64 {
        self.scale(axis) * self.motion.balance[0].abs()
    }

    /// What a unit of a motion moves the farthest node.
    fn scale(&self, axis: usize) -> f64 {
        let reach = self.plane.rows.iter().map(|row| row[axis].abs());
        reach.fold(f64::MIN_POSITIVE, f64::max)
    }

    /// Deepest place of the runner in the undeformed ice [m].
    fn deep(&self, state: &PlasticState) -> f64 {
        let below = |i: usize| dot(self.plane.rows[i], state.motion) - self.plane.gap[i];
        (0..state.force.len())
            .filter(|&i| state.force[i] > 0.0)
            .map(|i| below(i).abs())
            .fold(1e-9, f64::max)
    }
}

// A state with its groove, and where another mesh's solve begins.

/// The state on one mesh with its groove.
#[derive(Clone)]
pub(crate) struct SlidingState {
    pub state: State,
    /// On the candidates.
    pub grooved: PlasticState,
    /// Plastic depth on the whole plane, x fastest [m].
    pub depth: Vec<f64>,
    /// Conjugate-gradient iterations.
    pub iterations: usize,
    /// Corrections of the plane's response by the bodies.
    pub corrections: usize,
    /// What the last correction changed: the sum of the forces' changes over the load.
    pub residual: f64,
}

/// Where a mesh's solve begins.
pub(crate) enum Start {
    /// At the indentation at rest, searched near this motion [m].
    AtRest(f64),
    /// At what another mesh found.
    From(WarmStart),
}

/// What nodes do, and the motion, as another mesh found them.
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

    /// Those of the nearest nodes, for another mesh's candidates.
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
