//! Places of a body's top that a mount holds, as a constraint of its preconditioner.

use faer::Mat;
use kufe_fem::FastDiagonal;

use crate::precondition::beam_space::BeamSpace;
use crate::precondition::dense_cholesky::DenseCholesky;
use crate::precondition::plane_modes::PlaneModes;

/// Held displacements of one horizontal plane.
///
/// With D picking them, the preconditioner in the subspace D z = 0 is
/// M^-1 r = Q^-1 (r - D^T m), G m = D Q^-1 r, G = D Q^-1 D^T, where Q^-1 = P^-1 + Z C^-1 Z^T knows no clamps.
/// Restricting stiffness and preconditioner to one subspace keeps their spectral bounds.
pub(crate) struct Clamps {
    /// The plane's modes by component.
    modes: [PlaneModes; 3],
    /// Held nodes (i, j) by component.
    held: [Vec<[usize; 2]>; 3],
    /// Z's rows of the held displacements, in their order; none without a beam.
    rows: Vec<Vec<(usize, f64)>>,
    /// G as it is, and with P's part scaled to elasticity's response.
    factors: [DenseCholesky; 2],
    /// Nodes along x and y.
    shape: [usize; 2],
}

impl Clamps {
    /// Holds `held`, nodes (i, j) of plane `plane` by component, with P's part of G scaled by each of `scales`.
    ///
    /// None where G is not definite.
    pub fn new(
        fast: &FastDiagonal,
        plane: usize,
        held: [Vec<[usize; 2]>; 3],
        beam: Option<&BeamSpace>,
        scales: [f64; 2],
    ) -> Option<Self> {
        let modes = [0, 1, 2].map(|c| PlaneModes::new(fast, c, plane));
        let shape = [0, 1].map(|axis| fast.axis_modes(0, axis).vectors.nrows());
        let count: usize = held.iter().map(Vec::len).sum();
        let rows: Vec<Vec<(usize, f64)>> = beam.map_or(Vec::new(), |beam| {
            (0..3)
                .flat_map(|c| held[c].iter().map(move |&node| beam.row(node, plane, c)))
                .collect()
        });
        let mut blocks = Mat::<f64>::zeros(count, count);
        let mut start = 0;
        for (modes, nodes) in modes.iter().zip(&held) {
            let green = modes.green(nodes);
            for j in 0..nodes.len() {
                for i in 0..nodes.len() {
                    blocks[(start + i, start + j)] = green[(i, j)];
                }
            }
            start += nodes.len();
        }
        let of_beam = beam.map(|beam| {
            let rows: Vec<_> = rows.iter().collect();
            beam.green(&rows, &rows)
        });
        let factor = |scale: f64| {
            let mut green = faer::Scale(scale) * &blocks;
            if let Some(beam) = &of_beam {
                green += beam;
            }
            DenseCholesky::new(&green)
        };
        Some(Clamps {
            factors: [factor(scales[0])?, factor(scales[1])?],
            modes,
            held,
            rows,
            shape,
        })
    }

    /// Takes from Q^-1 r, given by its modal values and by Z^T r, what moves the held displacements.
    pub fn hold(
        &self,
        fast: &FastDiagonal,
        beam: Option<&BeamSpace>,
        modal: &mut [f64],
        motion: &mut [f64],
    ) {
        let mut moved = Vec::new();
        for (modes, nodes) in self.modes.iter().zip(&self.held) {
            if nodes.is_empty() {
                continue;
            }
            let trace = modes.trace(fast, modal);
            moved.extend(nodes.iter().map(|&[i, j]| trace[(i, j)]));
        }
        if let Some(beam) = beam {
            let c = beam.answer(motion);
            for (m, row) in moved.iter_mut().zip(&self.rows) {
                *m += row.iter().map(|&(k, v)| v * c[k]).sum::<f64>();
            }
        }
        let side = Mat::from_fn(moved.len(), 1, |i, _| moved[i]);
        let reaction = self.factors[0].solve(&side);
        let mut start = 0;
        for (modes, nodes) in self.modes.iter().zip(&self.held) {
            if nodes.is_empty() {
                continue;
            }
            let mut plane = Mat::<f64>::zeros(self.shape[0], self.shape[1]);
            for (k, &[i, j]) in nodes.iter().enumerate() {
                plane[(i, j)] = reaction[(start + k, 0)];
            }
            modes.subtract_load(fast, plane.as_ref(), modal);
            start += nodes.len();
        }
        for (k, row) in self.rows.iter().enumerate() {
            for &(m, value) in row {
                motion[m] -= value * reaction[(k, 0)];
            }
        }
    }

    /// What the clamps take from the Green's matrix of contact nodes: X G^-1 X^T, X between those and the held ones.
    ///
    /// `kind` says which of the scales, `scale` its value.
    pub fn share(
        &self,
        kind: usize,
        fast: &FastDiagonal,
        contact: &PlaneModes,
        beam: Option<&BeamSpace>,
        scale: f64,
        nodes: &[[usize; 2]],
    ) -> Mat<f64> {
        let count: usize = self.held.iter().map(Vec::len).sum();
        let vertical = count - self.held[2].len();
        let table = contact.table_with(&self.modes[2], fast);
        let basis = &contact.basis;
        let direct = basis.green_between(table.as_ref(), nodes, &self.held[2]);
        let mut cross = match beam {
            Some(beam) => {
                let rows: Vec<_> = self.rows.iter().collect();
                beam.green(&rows, &beam.contact_rows(nodes))
            }
            None => Mat::zeros(count, nodes.len()),
        };
        for j in 0..nodes.len() {
            for i in 0..self.held[2].len() {
                cross[(vertical + i, j)] += scale * direct[(j, i)];
            }
        }
        // Half of the factor on either side, so that the share is symmetric: Y = L^-1 X^T, share = Y^T Y.
        let mut half = cross;
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(
            self.factors[kind].lower(),
            half.as_mut(),
            faer::Par::Seq,
        );
        half.transpose() * &half
    }
}
