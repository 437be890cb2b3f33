//! Steady sliding on one mesh: the plane with memory, and the bodies that correct its response.

use std::borrow::Cow;

use faer::Mat;
use kufe_fem::Material;

use crate::accuracy::mesh_solve::{Forces, MeshSolve};
use crate::active_set::plane_problem::PlaneState;
use crate::green::matrix::{Green, Stored};
use crate::grid::contact_mesh::State;
use crate::grid::discretise::Discretisation;
use crate::groove::elastic_response::respond;
use crate::groove::load_balance::LoadBalance;
use crate::groove::memory::{Kind, Memory, MemoryState};
use crate::groove::profile::GrooveProfile;
use crate::groove::rims::Rims;
use crate::groove::slid::{Slid, Start};
use crate::{Error, Load, Options, Problem};

/// One mesh of a sliding contact.
pub(crate) struct OnMesh<'a> {
    pub problem: &'a Problem,
    pub material: Material,
    pub mesh: &'a Discretisation,
    pub before: Option<&'a GrooveProfile>,
    pub options: &'a Options,
}

/// Most corrections of the response.
const CORRECTIONS: usize = 60;
/// Change of the forces, over their sum, at which corrections end.
const SETTLED: f64 = 1e-6;
/// Corrections with which the nodes' shares of the plane are fitted to the area that yields; then they stay, so that the forces do.
const FITTINGS: usize = 4;
/// Most iterations of one response.
const ITERATIONS: usize = 400;

/// What the plane with memory knows of a mesh.
struct Lines {
    rows: Vec<[f64; 3]>,
    bound: Vec<f64>,
    has_ahead: Vec<bool>,
    before: Vec<f64>,
}

impl OnMesh<'_> {
    /// Solves on the contact plane alone.
    pub fn on_plane(&self, start: &Start) -> Result<Slid, Error> {
        let contact = &self.mesh.contact;
        let green = self.green()?;
        self.begin(&green, &contact.unpressed_gap(), start)
    }

    /// Solves with the bodies' own response, from the far field of `forces`.
    ///
    /// The plane's response G is corrected by what the bodies answer to the forces found last, S f - G f, until the forces
    /// stay. Then they are those of S, whatever G: it only says how fast. Full nodes' parts of the plane add up to the area that
    /// yields below the cell, [`Rims::full_area`], so that the load does not depend on where nodes lie beside the rim. Beside the solution
    /// stands what it would be without that.
    pub fn solve(&self, start: &Start, forces: &Forces) -> Result<[Slid; 2], Error> {
        let contact = &self.mesh.contact;
        let green = self.green()?;
        let mut slid = self.begin(&green, &contact.unpressed_gap(), start)?;
        slid.state.displacement = vec![0.0; contact.len()];
        let outer = MeshSolve {
            problem: self.problem,
            material: self.material,
            mesh: self.mesh,
            options: self.options,
            stored: Stored::USUAL,
            tell: &|_, _| {},
        };
        outer.hold_outer_faces(forces, &mut slid.state);
        let mut lines = self.lines();
        slid.residual = 1.0;
        while slid.corrections < CORRECTIONS {
            if slid.corrections > 0 {
                outer.hold_outer_faces(&Forces::of(self.mesh, &slid.state), &mut slid.state);
            }
            let asked = (1e-2 * slid.residual).clamp(self.options.residual, 1e-3);
            slid.iterations += respond(contact, &mut slid.state, asked, ITERATIONS)
                .ok_or_else(|| not_converged(&slid))?;
            if self.options.stopped() {
                return Err(Error::Stopped);
            }
            if slid.residual <= SETTLED && slid.corrections >= FITTINGS {
                let mut plain = slid.clone();
                self.correct(&green, &self.lines(), &mut plain)?;
                return Ok([slid, plain]);
            }
            if slid.corrections < FITTINGS {
                let full = Rims::new(self.mesh, &slid).full_area();
                let bounds = self.mesh.contact.candidates.iter().zip(&mut lines.bound);
                bounds.for_each(|(&node, b)| *b = full * self.mesh.contact.bound[node]);
            }
            self.correct(&green, &lines, &mut slid)?;
        }
        Err(not_converged(&slid))
    }

    /// The Green's matrix of the candidates, which steady sliding needs stored.
    fn green(&self) -> Result<Mat<f64>, Error> {
        let contact = &self.mesh.contact;
        let nodes = contact.candidates.len();
        let limit = Stored::USUAL.mounted;
        if nodes > limit {
            return Err(Error::TooManyTouch { nodes, limit });
        }
        let [_, green] = contact.dense_greens();
        Ok(green)
    }

    /// Steady sliding on the plane.
    fn begin(&self, green: &Mat<f64>, gap: &[f64], start: &Start) -> Result<Slid, Error> {
        let contact = &self.mesh.contact;
        let lines = self.lines();
        let memory = self.memory(green, gap, &lines);
        let (kinds, motion) = match start {
            Start::AtRest(motion) => {
                let none = vec![0.0; contact.candidates.len()];
                let rest = PlaneState::new(none, [*motion, 0.0, 0.0]);
                let stored = Green::Dense(Cow::Borrowed(green));
                let rest = contact.plane_contact(&stored, gap, rest);
                (memory.kinds(&rest.force), rest.motion)
            }
            Start::From(known) => (known.on(self.mesh), known.motion),
        };
        let grooved = self
            .load_balance(&memory)
            .from(motion, kinds)
            .ok_or_else(|| self.no_balance(&memory, gap))?;
        Ok(Slid {
            state: contact.state_of(&grooved.force, grooved.motion),
            depth: self.whole(&grooved),
            grooved,
            iterations: 0,
            corrections: 0,
            residual: 1.0,
        })
    }

    /// Why no motion carries the load: more than the runner bears however deep it sinks, or the search failed.
    fn no_balance(&self, memory: &Memory<'_>, gap: &[f64]) -> Error {
        let highest = gap.iter().filter(|gap| gap.is_finite());
        let sunk = 2.0 * highest.fold(0.0, |most: f64, gap| most.max(*gap));
        let bears = memory
            .at([sunk, 0.0, 0.0], &vec![Kind::Full; gap.len()])
            .map(|state| memory.resultant(&state.force)[0]);
        let asked = self.mesh.contact.motion.balance[0];
        match (self.problem.load, bears) {
            (Load::Force { fz, .. }, Some(bears)) if bears < asked => Error::BeyondHardness {
                fz,
                capacity: bears / asked * fz,
            },
            _ => Error::NotConverged {
                iterations: 0,
                residual: 1.0,
                tolerance: SETTLED,
            },
        }
    }

    /// New forces under the response that the bodies have given to the last ones.
    fn correct(&self, green: &Mat<f64>, lines: &Lines, slid: &mut Slid) -> Result<(), Error> {
        let contact = &self.mesh.contact;
        let closing = contact.closing(&slid.state.displacement);
        let mut gap: Vec<f64> = contact
            .candidates
            .iter()
            .map(|&node| contact.gap[node] - closing[node])
            .collect();
        let known = self
            .memory(green, &gap, lines)
            .deflection(&slid.grooved.force);
        gap.iter_mut()
            .zip(&known)
            .for_each(|(gap, known)| *gap -= known);
        let memory = self.memory(green, &gap, lines);
        let kinds = slid.grooved.kinds.clone();
        let next = self.load_balance(&memory).from(slid.grooved.motion, kinds);
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

    fn lines(&self) -> Lines {
        let contact = &self.mesh.contact;
        let nx = self.mesh.grid.x.len();
        let nodes = &contact.candidates;
        let same_row = |k: usize| {
            nodes
                .get(k + 1)
                .is_some_and(|next| next / nx == nodes[k] / nx)
        };
        Lines {
            rows: nodes.iter().map(|&n| contact.rows[n]).collect(),
            bound: nodes.iter().map(|&n| contact.bound[n]).collect(),
            has_ahead: (0..nodes.len()).map(same_row).collect(),
            before: nodes.iter().map(|&n| self.depth_before(n / nx)).collect(),
        }
    }

    /// Depth of the groove in which the ice of row `j` comes [m].
    fn depth_before(&self, j: usize) -> f64 {
        let y = self.mesh.grid.y[j];
        self.before.map_or(0.0, |groove| groove.at(y))
    }

    fn memory<'b>(&'b self, green: &'b Mat<f64>, gap: &'b [f64], lines: &'b Lines) -> Memory<'b> {
        Memory {
            green,
            gap,
            rows: &lines.rows,
            bound: &lines.bound,
            has_ahead: &lines.has_ahead,
            before: &lines.before,
        }
    }

    fn load_balance<'b>(&'b self, memory: &'b Memory<'b>) -> LoadBalance<'b> {
        LoadBalance {
            memory,
            motion: &self.mesh.contact.motion,
            options: self.options,
        }
    }

    /// The depth on the whole plane: each row keeps towards the back what it had.
    fn whole(&self, grooved: &MemoryState) -> Vec<f64> {
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

fn not_converged(slid: &Slid) -> Error {
    Error::NotConverged {
        iterations: slid.iterations,
        residual: slid.residual,
        tolerance: SETTLED,
    }
}
