//! The modes of one displacement component on one horizontal plane of a body.

use faer::{Mat, MatRef};
use kufe_fem::FastDiagonal;
use rayon::prelude::*;

use crate::precondition::plane_basis::PlaneBasis;

/// The modes of one displacement component on one horizontal plane of a body, under the fast-diagonalisation operator P.
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
