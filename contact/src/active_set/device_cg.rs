//! Conjugate gradients that keep the contact closed, on a graphics processor.
//!
//! As [`crate::active_set::constrained_cg`], in two loops. The outer one is the host's, in double precision: it holds state and contact
//! set, closes what is open, balances the load, and takes the true residual. The inner one is the device's, in single
//! precision: a correction d with a turn t and multipliers m,
//!
//! K d + B^T m = r, B d + N t = 0, N^T m = 0,
//!
//! by conjugate gradients with the same preconditioner. In each of its iterations only the vertical modes of the contact plane go
//! to the host and back, where the factorised constraint is. What rounding leaves open is closed by the next outer step.

use faer::{MatMut, MatRef};
use kufe_fem::gpu::{Device, DeviceCg, EndPlane};

use crate::Error;
use crate::active_set::constrained_cg::{Constraint, OneSet, Workspace, add_to, forces_on};
use crate::active_set::progress::{Control, Counts, Progress};
use crate::green::matrix::Green;
use crate::grid::contact_mesh::{ContactMesh, State};
use crate::precondition::planewise::PlanewiseInverse;

/// By how much one correction reduces the residual, where the tolerance does not ask for less.
const REDUCTION: f64 = 1e-4;

/// The residual that the first correction of a contact set aims at: enough to judge the set by its signs.
const FIRST_LOOK: f64 = 5e-3;

/// Corrections in a row that may fail to improve on the best residual.
const PATIENCE: usize = 3;

impl ContactMesh {
    /// As [`ContactMesh::solve`], with the iterations on `device`.
    ///
    /// # Errors
    /// [`Error::NotOnDevice`] where there is more than one elastic body, [`Error::Device`].
    pub fn solve_on_device(
        &self,
        device: &Device,
        state: &mut State,
        greens: &[Green; 2],
        begun: Counts,
        control: &Control,
    ) -> Result<Progress, Error> {
        let plain = match &self.bodies[..] {
            [ice] => ice.plain(),
            _ => None,
        };
        let (operator, inverse) = plain.ok_or(Error::NotOnDevice {
            found: "an elastic runner",
        })?;
        let mut on_device = OnDevice {
            contact: self,
            inverse,
            cg: DeviceCg::new(device, operator, &inverse.preconditioner)?,
            work: self.workspace(),
        };
        self.solve_by(state, greens, begun, control, |set, state, progress| {
            on_device.iterate(set, state, progress)
        })
    }
}

/// One mesh's kernels and vectors.
struct OnDevice<'a> {
    contact: &'a ContactMesh,
    inverse: &'a PlanewiseInverse,
    cg: DeviceCg<'a>,
    work: Workspace,
}

impl OnDevice<'_> {
    /// The outer loop; returns whether the tolerance was reached and the signs confirm the set.
    fn iterate(
        &mut self,
        set: &OneSet,
        state: &mut State,
        progress: &mut Progress,
    ) -> Result<bool, Error> {
        let OneSet {
            sets,
            constraint,
            control,
            ..
        } = *set;
        let contact = self.contact;
        contact.project_forces(sets, state);
        let mut next_check = set.first_check;
        let (mut best, mut failures) = (f64::INFINITY, 0);
        loop {
            contact.enter(constraint, state, &mut self.work);
            progress.iterations += 1;
            contact.equilibrate(constraint, state, &mut self.work, progress);
            let residual = progress.residual;
            if let Some(confirmed) = contact.settled(set, state, residual, &mut next_check) {
                return Ok(confirmed);
            }
            failures = if residual < best { 0 } else { failures + 1 };
            best = best.min(residual);
            if failures > PATIENCE || control.reached(progress.iterations) {
                return Ok(false);
            }
            let aim = if residual > 2.0 * FIRST_LOOK {
                FIRST_LOOK
            } else {
                0.5 * control.tolerance
            };
            let reduction = (aim / residual).max(REDUCTION);
            if !self.correct(set, state, reduction, progress)? {
                return Ok(false);
            }
        }
    }

    /// The inner loop: a correction that reduces r . P^-1 r by `reduction` squared. Returns whether there was one.
    fn correct(
        &mut self,
        set: &OneSet,
        state: &mut State,
        reduction: f64,
        progress: &mut Progress,
    ) -> Result<bool, Error> {
        let OneSet {
            constraint,
            control,
            ..
        } = *set;
        self.cg.gather_first(&self.work.residual);
        let mut plane = self.cg.end_plane()?;
        let mut turn = self.constrain(constraint, state, &mut plane);
        self.cg.spread(&plane, true);
        let mut turn_direction = [0.0; 3];
        let mut aim = None;
        let mut done = 0;
        loop {
            self.cg.gather();
            plane = self.cg.end_plane()?;
            let [rho, alpha, beta] = [
                plane.progress.rho,
                plane.progress.alpha,
                plane.progress.beta,
            ]
            .map(f64::from);
            if alpha == 0.0 || !(rho * alpha).is_finite() {
                break;
            }
            turn_direction = [0, 1, 2].map(|a| turn[a] + beta * turn_direction[a]);
            for (q, t) in state.motion.iter_mut().zip(turn_direction) {
                *q += alpha * t;
            }
            done += 1;
            progress.iterations += 1;
            let aim = *aim.get_or_insert(reduction.powi(2) * rho);
            if rho <= aim || control.reached(progress.iterations) {
                break;
            }
            turn = self.constrain(constraint, state, &mut plane);
            self.cg.spread(&plane, false);
        }
        self.cg.add_correction(&mut state.displacement)?;
        Ok(done > 0)
    }

    /// Forces on the contact plane that keep it closed: off what it has gathered, off the residual, and on to the state's.
    /// Returns the turn that goes with them.
    fn constrain(
        &self,
        constraint: &Constraint,
        state: &mut State,
        plane: &mut EndPlane,
    ) -> [f64; 3] {
        let contact = self.contact;
        let shape = self.inverse.mode_shape();
        let mut closing = vec![0.0; contact.gap.len()];
        let gathered = MatRef::from_column_major_slice(&plane.gathered, shape[0], shape[1]);
        self.inverse.add_closing(gathered, &mut closing);
        let none = vec![0.0; constraint.inside.len()];
        let (turn, force) = contact.multipliers(constraint, &closing, &none, [0.0; 3]);
        let forces = forces_on(constraint, &force, 1.0);
        let gathered = MatMut::from_column_major_slice_mut(&mut plane.gathered, shape[0], shape[1]);
        self.inverse.take_forces(&forces, gathered);
        self.inverse.take_nodal(&forces, &mut plane.residual);
        add_to(constraint, &force, state);
        turn
    }
}
