//! Preconditioner of a body on a tensor grid with a mount: fast diagonalisation, beam motions and
//! clamps.

use faer::{Mat, MatRef};
use kufe_fem::{Axis, BeamModes, FastDiagonal, TensorOperator, to_components, to_nodes};
use rayon::prelude::*;

use crate::precondition::dense::DenseCholesky;
use crate::precondition::planewise::{Columns, InverseWork, PlaneBasis, Side, surface_response};

/// M^-1 = P^-1 + Z C^-1 Z^T, restricted to the subspace in which the clamped displacements are 0.
///
/// P is fast diagonalisation, Z the motions of a beam ([`BeamSpace`]), and the clamps ([`Clamps`])
/// are nodes of the body's top that are not fixed in P. The contact plane is the lowest one.
pub(crate) struct MountedInverse {
    fast: FastDiagonal,
    contact: PlaneModes,
    columns: Columns,
    /// Factor by which the true surface response exceeds that of P on a half-space.
    response: f64,
    beam: BeamSpace,
    clamps: Clamps,
}

/// Ratio of the closing of the gap to a vertical displacement of the contact plane.
const SIGN: f64 = Side::Above.sign();

impl MountedInverse {
    /// The inverse with the nodes (i, j) of the highest plane that the mount fixes, by component;
    /// `first` is the x axis of component x if it differs from the operator's.
    ///
    /// `None` if the clamps are not linearly independent.
    pub fn new(
        operator: &TensorOperator,
        first: Option<&Axis>,
        columns: Columns,
        beam: BeamSpace,
        fixed: [Vec<[usize; 2]>; 3],
    ) -> Option<Self> {
        let fast = FastDiagonal::new(operator, first);
        let response = surface_response(operator);
        let top = operator.shape()[2] - 1;
        Some(MountedInverse {
            contact: PlaneModes::new(&fast, 2, 0),
            clamps: Clamps::new(&fast, top, fixed, &beam, [1.0, response])?,
            fast,
            columns,
            response,
            beam,
        })
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        InverseWork {
            intermediate: vec![0.0; self.fast.mode_count()],
            motion: vec![0.0; self.beam.len()],
            scratch: vec![0.0; self.fast.scratch_len()],
            by_node: vec![0.0; self.beam.vector_len],
            sums: Vec::new(),
        }
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        let modal = &mut work.intermediate;
        self.fast.to_modes(residual, modal, &mut work.scratch);
        self.fast.divide(modal);
        self.beam.project(residual, work);
        self.apply_clamps(work);
        self.add_closing(1.0, work, closing);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::finish`].
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        self.subtract_forces(multipliers, work);
        self.apply_clamps(work);
        self.fast
            .from_modes(&work.intermediate, step, &mut work.scratch);
        let amplitudes = self.beam.answer(&work.motion);
        self.beam.add_motion(&amplitudes, step, &mut work.by_node);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::respond`].
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64], work: &mut InverseWork) {
        work.intermediate.fill(0.0);
        work.motion.fill(0.0);
        self.subtract_forces(forces, work);
        self.apply_clamps(work);
        self.add_closing(-1.0, work, closing);
    }

    /// `closing` += `factor` B u for the modal values and the motions of the beam in `work`.
    fn add_closing(&self, factor: f64, work: &InverseWork, closing: &mut [f64]) {
        let trace = self.contact.trace(&self.fast, &work.intermediate);
        let amplitudes = self.beam.answer(&work.motion);
        self.columns.add_to_plane(closing, |[i, j]| {
            let value = trace[(i, j)] + self.beam.on_contact([i, j], &amplitudes);
            factor * SIGN * value
        });
    }

    /// Subtracts the forces m on nodes from the residual of the first pass: r - B^T m.
    fn subtract_forces(&self, multipliers: &[(usize, f64)], work: &mut InverseWork) {
        let forces = multipliers.iter().map(|&(node, m)| (node, SIGN * m));
        let forces: Vec<(usize, f64)> = forces.collect();
        let plane = self.columns.field(&forces);
        for (node, force) in forces {
            if let Some(column) = self.columns.local(node) {
                self.beam.subtract_contact(column, force, &mut work.motion);
            }
        }
        self.contact
            .subtract_load(&self.fast, plane.as_ref(), &mut work.intermediate);
    }

    /// Subtracts the clamps' reactions, so that the clamped displacements are 0.
    fn apply_clamps(&self, work: &mut InverseWork) {
        let (modal, motion) = (&mut work.intermediate, &mut work.motion);
        self.clamps.hold(&self.fast, &self.beam, modal, motion);
    }

    /// See [`crate::bodies::elastic_body::ElasticBody::green`]; the second one scales P's part to
    /// elasticity's response.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let local = self.columns.all_local(nodes);
        let fast = self.contact.green(&local);
        let rows = self.beam.contact_rows(&local);
        let beam = self.beam.green(&rows, &rows);
        [0, 1].map(|kind| {
            let factor = [1.0, self.response][kind];
            let mut green = faer::Scale(factor) * &fast;
            green += &beam;
            green -= self.clamped_share(kind, factor, &local);
            green
        })
    }

    /// Reduction of the Green's matrix of contact nodes by the clamps: X G^-1 X^T, with X the
    /// Green's matrix between contact nodes and clamps.
    ///
    /// `kind` is the index of the scale of P's part, `scale` its value.
    fn clamped_share(&self, kind: usize, scale: f64, nodes: &[[usize; 2]]) -> Mat<f64> {
        let clamps = &self.clamps;
        let vertical = clamps.rows.len() - clamps.fixed[2].len();
        let table = self.contact.table_with(&clamps.modes[2], &self.fast);
        let basis = &self.contact.basis;
        let direct = basis.green_between(table.as_ref(), nodes, &clamps.fixed[2]);
        let rows: Vec<_> = clamps.rows.iter().collect();
        let mut cross = self.beam.green(&rows, &self.beam.contact_rows(nodes));
        for j in 0..nodes.len() {
            for i in 0..clamps.fixed[2].len() {
                cross[(vertical + i, j)] += scale * direct[(j, i)];
            }
        }
        // With the Cholesky factor the result is symmetric: Y = L^-1 X^T, result = Y^T Y.
        let mut half = cross;
        faer::linalg::triangular_solve::solve_lower_triangular_in_place(
            clamps.factors[kind].lower(),
            half.as_mut(),
            faer::Par::Seq,
        );
        half.transpose() * &half
    }
}

// Fixed displacements of a body's top as a constraint in its preconditioner.

/// Fixed displacements of one horizontal plane.
///
/// With D selecting them, the preconditioner in the subspace D z = 0 is M^-1 r = Q^-1 (r - D^T m),
/// G m = D Q^-1 r, G = D Q^-1 D^T, where Q^-1 = P^-1 + Z C^-1 Z^T is that without clamps. The
/// restriction of stiffness and preconditioner to one subspace preserves their spectral bounds.
struct Clamps {
    /// The plane's modes by component.
    modes: [PlaneModes; 3],
    /// Fixed nodes (i, j) by component.
    fixed: [Vec<[usize; 2]>; 3],
    /// Z's rows of the fixed displacements, in their order.
    rows: Vec<Row>,
    /// G as it is, and with P's part scaled to elasticity's response.
    factors: [DenseCholesky; 2],
    /// Nodes along x and y.
    shape: [usize; 2],
}

impl Clamps {
    /// Clamps `fixed`, nodes (i, j) of plane `plane` by component, with P's part of G scaled by
    /// each of `scales`.
    ///
    /// `None` if G is not positive definite.
    fn new(
        fast: &FastDiagonal,
        plane: usize,
        fixed: [Vec<[usize; 2]>; 3],
        beam: &BeamSpace,
        scales: [f64; 2],
    ) -> Option<Self> {
        let modes = [0, 1, 2].map(|c| PlaneModes::new(fast, c, plane));
        let rows: Vec<Row> = (0..3)
            .flat_map(|c| fixed[c].iter().map(move |&node| beam.row(node, plane, c)))
            .collect();
        let mut blocks = Mat::<f64>::zeros(rows.len(), rows.len());
        let mut start = 0;
        for (modes, nodes) in modes.iter().zip(&fixed) {
            let (green, n) = (modes.green(nodes), nodes.len());
            let mut block = blocks.as_mut().submatrix_mut(start, start, n, n);
            block.copy_from(&green);
            start += n;
        }
        let references: Vec<_> = rows.iter().collect();
        let of_beam = beam.green(&references, &references);
        let factor = |scale: f64| {
            let mut green = faer::Scale(scale) * &blocks;
            green += &of_beam;
            DenseCholesky::new(&green)
        };
        Some(Clamps {
            factors: [factor(scales[0])?, factor(scales[1])?],
            shape: [beam.shape[0], beam.shape[1]],
            modes,
            fixed,
            rows,
        })
    }

    /// Subtracts from Q^-1 r, given by its modal values and by Z^T r, the part due to the clamps'
    /// reactions.
    fn hold(&self, fast: &FastDiagonal, beam: &BeamSpace, modal: &mut [f64], motion: &mut [f64]) {
        let clamped = || {
            let components = self.modes.iter().zip(&self.fixed);
            components.filter(|(_, nodes)| !nodes.is_empty())
        };
        let mut moved = Vec::new();
        for (modes, nodes) in clamped() {
            let trace = modes.trace(fast, modal);
            moved.extend(nodes.iter().map(|&[i, j]| trace[(i, j)]));
        }
        let c = beam.answer(motion);
        for (m, row) in moved.iter_mut().zip(&self.rows) {
            *m += row.iter().map(|&(k, v)| v * c[k]).sum::<f64>();
        }
        let side = Mat::from_fn(moved.len(), 1, |i, _| moved[i]);
        let reaction = self.factors[0].solve(&side);
        let mut start = 0;
        for (modes, nodes) in clamped() {
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
}

// The modes of one displacement component on one horizontal plane of a body.

/// The modes of one displacement component on one horizontal plane of a body, under the
/// fast-diagonalisation operator P.
struct PlaneModes {
    /// The displacement component.
    component: usize,
    basis: PlaneBasis,
    /// Values of the z modes on the plane.
    z: Vec<f64>,
    /// T, modes of x by modes of y [m/N]: the sum over c of Qz[plane,c]^2 / Lambda_abc.
    table: Mat<f64>,
}

impl PlaneModes {
    /// The modes of displacement component `component` on plane `plane` of the z axis.
    fn new(preconditioner: &FastDiagonal, component: usize, plane: usize) -> Self {
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
    fn table_with(&self, other: &PlaneModes, preconditioner: &FastDiagonal) -> Mat<f64> {
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
    fn trace(&self, preconditioner: &FastDiagonal, modal: &[f64]) -> Mat<f64> {
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

    /// Subtracts P^-1 times nodal forces on the plane from a modal vector of the body.
    fn subtract_load(
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
    fn green(&self, nodes: &[[usize; 2]]) -> Mat<f64> {
        self.basis.green(self.table.as_ref(), nodes)
    }
}

// The motions of a beam in a body's preconditioner, with their values on the contact plane and the
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
    /// The motions of a body of `shape` whose contact plane is the lowest plane.
    pub fn new(modes: BeamModes, shape: [usize; 3]) -> Self {
        let n = modes.count();
        let [nx, ny, nz] = shape;
        let inverse = modes.inverse();
        let inverse = Mat::from_fn(n, n, |i, j| 0.5 * (inverse[(i, j)] + inverse[(j, i)]));
        let contact = (0..nx * ny).map(|node| modes.row(node, 2)).collect();
        BeamSpace {
            inverse,
            modes,
            shape: [nx, ny],
            contact,
            vector_len: 3 * nx * ny * nz,
        }
    }

    /// Number of motions.
    fn len(&self) -> usize {
        self.modes.count()
    }

    /// The motions Z^T r of `work`, for r by components.
    fn project(&self, r: &[f64], work: &mut InverseWork) {
        to_nodes(r, &mut work.by_node);
        let motion = &mut work.motion;
        self.modes.project(&work.by_node, motion, &mut work.sums);
    }

    /// C^-1 c.
    fn answer(&self, c: &[f64]) -> Vec<f64> {
        let mut out = c.to_vec();
        self.modes.solve(&mut out);
        out
    }

    /// `u` += Z c for u by components, through a vector node by node.
    fn add_motion(&self, c: &[f64], u: &mut [f64], by_node: &mut [f64]) {
        to_nodes(u, by_node);
        self.modes.add_motion(c, by_node);
        to_components(by_node, u);
    }

    /// Z's row of a component of the node in column (i, j) on plane `plane`.
    fn row(&self, [i, j]: [usize; 2], plane: usize, component: usize) -> Row {
        let [nx, ny] = self.shape;
        self.modes.row((plane * ny + j) * nx + i, component)
    }

    /// Vertical displacement of a node of the contact plane.
    fn on_contact(&self, [i, j]: [usize; 2], c: &[f64]) -> f64 {
        self.contact[j * self.shape[0] + i]
            .iter()
            .map(|&(k, v)| v * c[k])
            .sum()
    }

    /// `c` -= Z^T of a vertical force on the contact plane.
    fn subtract_contact(&self, [i, j]: [usize; 2], force: f64, c: &mut [f64]) {
        for &(k, v) in &self.contact[j * self.shape[0] + i] {
            c[k] -= force * v;
        }
    }

    /// Z's rows of nodes of the contact plane.
    fn contact_rows(&self, nodes: &[[usize; 2]]) -> Vec<&Row> {
        nodes
            .iter()
            .map(|[i, j]| &self.contact[j * self.shape[0] + i])
            .collect()
    }

    /// R C^-1 S^T for rows R and S of Z.
    fn green(&self, left: &[&Row], right: &[&Row]) -> Mat<f64> {
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
