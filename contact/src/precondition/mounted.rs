//! The preconditioner of a body on a tensor grid, ready for a constraint on its contact plane.

use faer::{Mat, MatRef};
use kufe_fem::{Axis, BeamModes, FastDiagonal, Material, TensorOperator, to_components, to_nodes};
use rayon::prelude::*;

use crate::precondition::dense::DenseCholesky;
use crate::precondition::planewise::{Columns, InverseWork, PlaneBasis, surface_response};

/// M^-1 = P^-1 + Z C^-1 Z^T, in the subspace where the clamps hold.
///
/// P is fast diagonalisation, Z the motions of a beam where the body is slender ([`BeamSpace`]),
/// and the clamps ([`Clamps`]) are places on the body's top that no face of P holds.
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
    /// Without beam and clamps; `first` is the x axis of component x where it is not the operator's
    /// own.
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

    /// Fixes entries (component, node (i, j)) of plane `plane`; fails where they are no independent
    /// constraint.
    pub fn clamp(&mut self, plane: usize, fixed: [Vec<[usize; 2]>; 3]) -> Option<()> {
        let factors = [1.0, self.response];
        self.clamps = Some(Clamps::new(
            &self.fast,
            plane,
            fixed,
            self.beam.as_ref(),
            factors,
        )?);
        Some(())
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        InverseWork {
            intermediate: vec![0.0; self.fast.mode_count()],
            motion: vec![0.0; self.beam.as_ref().map_or(0, BeamSpace::len)],
            scratch: vec![0.0; self.fast.scratch_len()],
            by_node: vec![0.0; self.beam.as_ref().map_or(0, BeamSpace::vector_len)],
            sums: Vec::new(),
        }
    }

    /// See [`crate::precondition::inverse::Inverse::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        let InverseWork {
            intermediate: modal,
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
            intermediate: modal,
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
            intermediate: modal,
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

    /// See [`crate::precondition::inverse::Inverse::green`]; the second one scales P's part to
    /// elasticity's response.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let local = self.columns.all_local(nodes);
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

// Places of a body's top that a mount holds, as a constraint of its preconditioner.

/// Fixed displacements of one horizontal plane.
///
/// With D picking them, the preconditioner in the subspace D z = 0 is M^-1 r = Q^-1 (r - D^T m), G
/// m = D Q^-1 r, G = D Q^-1 D^T, where Q^-1 = P^-1 + Z C^-1 Z^T knows no clamps. Restricting
/// stiffness and preconditioner to one subspace keeps their spectral bounds.
pub(crate) struct Clamps {
    /// The plane's modes by component.
    modes: [PlaneModes; 3],
    /// Fixed nodes (i, j) by component.
    fixed: [Vec<[usize; 2]>; 3],
    /// Z's rows of the fixed displacements, in their order; none without a beam.
    rows: Vec<Vec<(usize, f64)>>,
    /// G as it is, and with P's part scaled to elasticity's response.
    factors: [DenseCholesky; 2],
    /// Nodes along x and y.
    shape: [usize; 2],
}

impl Clamps {
    /// Clamps `fixed`, nodes (i, j) of plane `plane` by component, with P's part of G scaled by
    /// each of `scales`.
    ///
    /// None where G is not definite.
    pub fn new(
        fast: &FastDiagonal,
        plane: usize,
        fixed: [Vec<[usize; 2]>; 3],
        beam: Option<&BeamSpace>,
        scales: [f64; 2],
    ) -> Option<Self> {
        let modes = [0, 1, 2].map(|c| PlaneModes::new(fast, c, plane));
        let shape = [0, 1].map(|axis| fast.axis_modes(0, axis).vectors.nrows());
        let count: usize = fixed.iter().map(Vec::len).sum();
        let rows: Vec<Vec<(usize, f64)>> = beam.map_or(Vec::new(), |beam| {
            (0..3)
                .flat_map(|c| fixed[c].iter().map(move |&node| beam.row(node, plane, c)))
                .collect()
        });
        let mut blocks = Mat::<f64>::zeros(count, count);
        let mut start = 0;
        for (modes, nodes) in modes.iter().zip(&fixed) {
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
            fixed,
            rows,
            shape,
        })
    }

    /// Takes from Q^-1 r, given by its modal values and by Z^T r, the part that moves the fixed
    /// displacements.
    pub fn hold(
        &self,
        fast: &FastDiagonal,
        beam: Option<&BeamSpace>,
        modal: &mut [f64],
        motion: &mut [f64],
    ) {
        let mut moved = Vec::new();
        for (modes, nodes) in self.modes.iter().zip(&self.fixed) {
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
        for (modes, nodes) in self.modes.iter().zip(&self.fixed) {
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

    /// The clamps' reduction of the Green's matrix of contact nodes: X G^-1 X^T, X between those
    /// and the fixed ones.
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
        let count: usize = self.fixed.iter().map(Vec::len).sum();
        let vertical = count - self.fixed[2].len();
        let table = contact.table_with(&self.modes[2], fast);
        let basis = &contact.basis;
        let direct = basis.green_between(table.as_ref(), nodes, &self.fixed[2]);
        let mut cross = match beam {
            Some(beam) => {
                let rows: Vec<_> = self.rows.iter().collect();
                beam.green(&rows, &beam.contact_rows(nodes))
            }
            None => Mat::zeros(count, nodes.len()),
        };
        for j in 0..nodes.len() {
            for i in 0..self.fixed[2].len() {
                cross[(vertical + i, j)] += scale * direct[(j, i)];
            }
        }
        // Half of the factor on either side, so that the share is symmetric: Y = L^-1 X^T, share =
        // Y^T Y.
        let mut half = cross;
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(
            self.factors[kind].lower(),
            half.as_mut(),
            faer::Par::Seq,
        );
        half.transpose() * &half
    }
}

// The modes of one displacement component on one horizontal plane of a body.

/// The modes of one displacement component on one horizontal plane of a body, under the
/// fast-diagonalisation operator P.
pub(crate) struct PlaneModes {
    /// The displacement component.
    component: usize,
    pub basis: PlaneBasis,
    /// Values of the z modes on the plane.
    z: Vec<f64>,
    /// T, modes of x by modes of y [m/N]: the sum over c of Qz[plane,c]^2 / Lambda_abc.
    table: Mat<f64>,
}

impl PlaneModes {
    /// The modes of displacement component `component` on plane `plane` of the z axis.
    pub fn new(preconditioner: &FastDiagonal, component: usize, plane: usize) -> Self {
        let [x, y, z] = [0, 1, 2].map(|axis| preconditioner.axis_modes(component, axis));
        let values: Vec<f64> = (0..z.values.len()).map(|m| z.vectors[(plane, m)]).collect();
        let mut modes = PlaneModes {
            component,
            basis: PlaneBasis::new(x, y),
            z: values,
            table: Mat::new(),
        };
        modes.table = modes.table_with(&modes, preconditioner);
        modes
    }

    /// sum over c of Qz[plane,c] Qz[other plane,c] / Lambda_abc, for two planes of one component.
    pub fn table_with(&self, other: &PlaneModes, preconditioner: &FastDiagonal) -> Mat<f64> {
        assert_eq!(self.component, other.component);
        let [mx, my] = self.basis.mode_shape();
        let inverse = preconditioner.inverse(self.component);
        let mut table = Mat::<f64>::zeros(mx, my);
        for (c, (p, q)) in self.z.iter().zip(&other.z).enumerate() {
            for b in 0..my {
                for a in 0..mx {
                    table[(a, b)] += p * q * inverse[(c * my + b) * mx + a];
                }
            }
        }
        table
    }

    /// Displacement on the plane's nodes from a modal vector of the body.
    pub fn trace(&self, preconditioner: &FastDiagonal, modal: &[f64]) -> Mat<f64> {
        let own = &modal[preconditioner.component_range(self.component)];
        let [mx, my] = self.basis.mode_shape();
        let mut trace = vec![0.0; mx * my];
        for (layer, value) in own.chunks_exact(mx * my).zip(&self.z) {
            for (t, m) in trace.iter_mut().zip(layer) {
                *t += value * m;
            }
        }
        let trace = MatRef::from_column_major_slice(&trace, mx, my);
        self.basis.to_nodes(trace)
    }

    /// Subtracts what P^-1 answers to nodal forces on the plane from a modal vector of the body.
    pub fn subtract_load(
        &self,
        preconditioner: &FastDiagonal,
        nodal: MatRef<'_, f64>,
        modal: &mut [f64],
    ) {
        let load = self.basis.to_modes(nodal);
        let (mx, my) = (load.nrows(), load.ncols());
        let flat: Vec<f64> = (0..mx * my).map(|i| load[(i % mx, i / mx)]).collect();
        modal[preconditioner.component_range(self.component)]
            .par_chunks_mut(mx * my)
            .zip(preconditioner.inverse(self.component).par_chunks(mx * my))
            .zip(&self.z)
            .for_each(|((layer, inverse), value)| {
                for ((m, i), l) in layer.iter_mut().zip(inverse).zip(&flat) {
                    *m -= value * i * l;
                }
            });
    }

    /// G between nodes (i, j) of this plane.
    pub fn green(&self, nodes: &[[usize; 2]]) -> Mat<f64> {
        self.basis.green(self.table.as_ref(), nodes)
    }
}

// The motions of a beam in a body's preconditioner, where they meet the contact plane and the
// mount.

/// Entries (motion, value) of a row of Z.
type Row = Vec<(usize, f64)>;

/// Z and C = Z^T K Z of a slender body on a tensor grid.
pub(crate) struct BeamSpace {
    modes: BeamModes,
    /// C^-1, dense.
    inverse: Mat<f64>,
    /// Nodes along x and y.
    shape: [usize; 2],
    /// Rows of the vertical displacements of the contact plane.
    contact: Vec<Row>,
    /// Length of a displacement vector.
    vector_len: usize,
}

impl BeamSpace {
    /// For a body of `shape` whose contact plane is the lowest.
    pub fn new(modes: BeamModes, shape: [usize; 3]) -> Self {
        let n = modes.len();
        let [nx, ny, nz] = shape;
        let columns: Vec<Vec<f64>> = (0..n)
            .into_par_iter()
            .map(|j| {
                let mut c = vec![0.0; n];
                c[j] = 1.0;
                modes.solve(&mut c);
                c
            })
            .collect();
        let contact = (0..nx * ny).map(|node| modes.row(node, 2)).collect();
        BeamSpace {
            inverse: Mat::from_fn(n, n, |i, j| 0.5 * (columns[j][i] + columns[i][j])),
            modes,
            shape: [nx, ny],
            contact,
            vector_len: 3 * nx * ny * nz,
        }
    }

    /// Number of motions.
    pub fn len(&self) -> usize {
        self.modes.len()
    }

    /// Length of a displacement vector.
    pub fn vector_len(&self) -> usize {
        self.vector_len
    }

    /// c = Z^T r for r by components, through a vector node by node and the sums of tasks.
    pub fn project(&self, r: &[f64], c: &mut [f64], by_node: &mut [f64], sums: &mut Vec<f64>) {
        to_nodes(r, by_node);
        self.modes.project(by_node, c, sums);
    }

    /// C^-1 c.
    pub fn answer(&self, c: &[f64]) -> Vec<f64> {
        let mut out = c.to_vec();
        self.modes.solve(&mut out);
        out
    }

    /// `u` += Z c for u by components, through a vector node by node.
    pub fn add_motion(&self, c: &[f64], u: &mut [f64], by_node: &mut [f64]) {
        to_nodes(u, by_node);
        self.modes.add_motion(c, by_node);
        to_components(by_node, u);
    }

    /// Z's row of a component of the node in column (i, j) on plane `plane`.
    pub fn row(&self, [i, j]: [usize; 2], plane: usize, component: usize) -> Row {
        let [nx, ny] = self.shape;
        self.modes.row((plane * ny + j) * nx + i, component)
    }

    /// Vertical displacement of a node of the contact plane.
    pub fn on_contact(&self, [i, j]: [usize; 2], c: &[f64]) -> f64 {
        self.contact[j * self.shape[0] + i]
            .iter()
            .map(|&(k, v)| v * c[k])
            .sum()
    }

    /// `c` -= Z^T of a vertical force on the contact plane.
    pub fn subtract_contact(&self, [i, j]: [usize; 2], force: f64, c: &mut [f64]) {
        for &(k, v) in &self.contact[j * self.shape[0] + i] {
            c[k] -= force * v;
        }
    }

    /// Z C^-1 Z^T between vertical displacements of the contact plane.
    pub fn contact_green(&self, nodes: &[[usize; 2]]) -> Mat<f64> {
        let rows = self.contact_rows(nodes);
        self.green(&rows, &rows)
    }

    /// Z's rows of nodes of the contact plane.
    pub fn contact_rows(&self, nodes: &[[usize; 2]]) -> Vec<&Row> {
        nodes
            .iter()
            .map(|[i, j]| &self.contact[j * self.shape[0] + i])
            .collect()
    }

    /// R C^-1 S^T for rows R and S of Z.
    pub fn green(&self, left: &[&Row], right: &[&Row]) -> Mat<f64> {
        let columns: Vec<Vec<f64>> = right
            .par_iter()
            .map(|row| {
                let mut answer = vec![0.0; self.len()];
                for &(k, value) in *row {
                    for (a, c) in answer.iter_mut().zip(self.inverse.col(k).iter()) {
                        *a += value * c;
                    }
                }
                left.iter()
                    .map(|row| row.iter().map(|&(k, v)| v * answer[k]).sum())
                    .collect()
            })
            .collect();
        Mat::from_fn(left.len(), right.len(), |i, j| columns[j][i])
    }
}
