//! The preconditioner of a body on a tensor grid, ready for a constraint on its contact plane.

use faer::Mat;
use kufe_fem::{Axis, FastDiagonal, Material, TensorOperator};

use crate::bodies::columns::Columns;
use crate::precondition::beam_space::BeamSpace;
use crate::precondition::clamps::Clamps;
use crate::precondition::plane_modes::PlaneModes;
use crate::precondition::response::surface_response;
use crate::precondition::work::InverseWork;

/// M^-1 = P^-1 + Z C^-1 Z^T, in the subspace where the clamps hold.
///
/// P is fast diagonalisation, Z the motions of a beam where the body is slender ([`BeamSpace`]), and the clamps
/// ([`Clamps`]) are places on the body's top that no face of P holds.
pub(crate) struct MountedInverse {
    fast: FastDiagonal,
    contact: PlaneModes,
    columns: Columns,
    sign: f64,
    /// Factor by which the true surface response exceeds that of P on a half-space.
    response: f64,
    beam: Option<BeamSpace>,
    clamps: Option<Clamps>,
}

impl MountedInverse {
    /// Without beam and clamps; `first` is the x axis of component x where it is not the operator's own.
    pub fn new(
        operator: &TensorOperator,
        first: Option<&Axis>,
        plane: usize,
        columns: Columns,
        sign: f64,
        material: Material,
    ) -> Self {
        let fast = FastDiagonal::with_first_axis(operator, first);
        let contact = PlaneModes::new(&fast, 2, plane);
        let response = surface_response(operator, material);
        MountedInverse {
            fast,
            contact,
            columns,
            sign,
            response,
            beam: None,
            clamps: None,
        }
    }

    /// Adds the motions of a beam.
    pub fn add_beam(&mut self, beam: BeamSpace) {
        self.beam = Some(beam);
    }

    /// Holds entries (component, node (i, j)) of plane `plane`; fails where they are no constraint that can be told apart.
    pub fn clamp(&mut self, plane: usize, held: [Vec<[usize; 2]>; 3]) -> Option<()> {
        let factors = [1.0, self.response];
        self.clamps = Some(Clamps::new(
            &self.fast,
            plane,
            held,
            self.beam.as_ref(),
            factors,
        )?);
        Some(())
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        InverseWork {
            kept: vec![0.0; self.fast.mode_count()],
            motion: vec![0.0; self.beam.as_ref().map_or(0, BeamSpace::len)],
            scratch: vec![0.0; self.fast.scratch_len()],
            by_node: vec![0.0; self.beam.as_ref().map_or(0, BeamSpace::vector_len)],
            sums: Vec::new(),
        }
    }

    /// See [`crate::precondition::inverse::Inverse::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        let InverseWork {
            kept: modal,
            motion,
            scratch,
            by_node,
            sums,
        } = work;
        self.fast.to_modes(residual, modal, scratch);
        self.fast.divide(modal);
        if let Some(beam) = &self.beam {
            beam.project(residual, motion, by_node, sums);
        }
        self.hold(modal, motion);
        self.add_closing(1.0, modal, motion, closing);
    }

    /// See [`crate::precondition::inverse::Inverse::finish`].
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        let InverseWork {
            kept: modal,
            motion,
            scratch,
            by_node,
            ..
        } = work;
        self.take_forces(multipliers, modal, motion);
        self.hold(modal, motion);
        self.fast.from_modes(modal, step, scratch);
        if let Some(beam) = &self.beam {
            beam.add_motion(&beam.answer(motion), step, by_node);
        }
    }

    /// See [`crate::precondition::inverse::Inverse::respond`].
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut InverseWork) {
        let InverseWork {
            kept: modal,
            motion,
            ..
        } = work;
        modal.fill(0.0);
        motion.fill(0.0);
        self.take_forces(forces, modal, motion);
        self.hold(modal, motion);
        self.add_closing(-1.0, modal, motion, closing);
    }

    /// `closing` += `factor` B u of what modal values and motions of a beam say.
    fn add_closing(&self, factor: f64, modal: &[f64], motion: &[f64], closing: &mut [f64]) {
        let trace = self.contact.trace(&self.fast, modal);
        let amplitudes = self.beam.as_ref().map(|beam| beam.answer(motion));
        let [nx, ny] = self.columns.count;
        for j in 0..ny {
            for i in 0..nx {
                let mut value = trace[(i, j)];
                if let (Some(beam), Some(c)) = (&self.beam, &amplitudes) {
                    value += beam.on_contact([i, j], c);
                }
                closing[self.columns.node([i, j])] += factor * self.sign * value;
            }
        }
    }

    /// Takes the forces m on nodes from what an application has gathered: r - B^T m.
    fn take_forces(&self, multipliers: &[(usize, f64)], modal: &mut [f64], motion: &mut [f64]) {
        let [nx, ny] = self.columns.count;
        let mut plane = Mat::<f64>::zeros(nx, ny);
        for &(node, m) in multipliers {
            if let Some([i, j]) = self.columns.local(node) {
                plane[(i, j)] = self.sign * m;
                if let Some(beam) = &self.beam {
                    beam.subtract_contact([i, j], self.sign * m, motion);
                }
            }
        }
        self.contact
            .subtract_load(&self.fast, plane.as_ref(), modal);
    }

    /// Subtracts the clamps' reactions that keep them still.
    fn hold(&self, modal: &mut [f64], motion: &mut [f64]) {
        if let Some(clamps) = &self.clamps {
            clamps.hold(&self.fast, self.beam.as_ref(), modal, motion);
        }
    }

    /// See [`crate::precondition::inverse::Inverse::green`]; the second one scales P's part to elasticity's response.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let n = nodes.len();
        let local: Vec<[usize; 2]> = nodes
            .iter()
            .filter_map(|&node| self.columns.local(node))
            .collect();
        assert_eq!(local.len(), n, "contact candidates over the body");
        let fast = self.contact.green(&local);
        let beam = self.beam.as_ref().map(|beam| beam.contact_green(&local));
        [0, 1].map(|kind| {
            let factor = [1.0, self.response][kind];
            let mut green = faer::Scale(factor) * &fast;
            if let Some(beam) = &beam {
                green += beam;
            }
            if let Some(clamps) = &self.clamps {
                let beam = self.beam.as_ref();
                green -= clamps.share(kind, &self.fast, &self.contact, beam, factor, &local);
            }
            green
        })
    }
}
