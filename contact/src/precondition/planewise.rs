//! The preconditioner of a body that nothing but faces holds.

use faer::{Mat, MatMut, MatRef};
use kufe_fem::{End, Material, PlanewiseDiagonal, TensorOperator};

use crate::bodies::columns::Columns;
use crate::precondition::plane_basis::PlaneBasis;
use crate::precondition::response::surface_response;
use crate::precondition::work::InverseWork;

/// P^-1 by layers, with the contact plane as the end of the elimination.
pub(crate) struct PlanewiseInverse {
    pub preconditioner: PlanewiseDiagonal,
    pub basis: PlaneBasis,
    pub columns: Columns,
    sign: f64,
    /// Factor by which the true surface response exceeds that of P on a half-space.
    pub response: f64,
}

impl PlanewiseInverse {
    /// With the contact plane at `end` of z.
    pub fn new(
        operator: &TensorOperator,
        end: End,
        columns: Columns,
        sign: f64,
        material: Material,
    ) -> Self {
        let preconditioner = PlanewiseDiagonal::new(operator, end);
        let [x, y] = preconditioner.plane_modes();
        PlanewiseInverse {
            basis: PlaneBasis::new(x, y),
            columns,
            sign,
            response: surface_response(operator, material),
            preconditioner,
        }
    }

    /// Vectors for the methods below.
    pub fn work(&self) -> InverseWork {
        InverseWork {
            kept: vec![0.0; self.preconditioner.mode_count()],
            ..InverseWork::default()
        }
    }

    /// See [`crate::precondition::inverse::Inverse::begin`].
    pub fn begin(&self, residual: &[f64], closing: &mut [f64], work: &mut InverseWork) {
        self.preconditioner.gather(residual, &mut work.kept);
        self.add_closing(self.preconditioner.gathered(&work.kept), closing);
    }

    /// `closing` += B P^-1 r from what the contact plane has gathered of r.
    pub fn add_closing(&self, gathered: MatRef<'_, f64>, closing: &mut [f64]) {
        let response = self.preconditioner.end_response();
        let answer = Mat::from_fn(gathered.nrows(), gathered.ncols(), |a, b| {
            gathered[(a, b)] * response[(a, b)]
        });
        let trace = self.basis.to_nodes(answer.as_ref());
        let [nx, ny] = self.columns.count;
        for j in 0..ny {
            for i in 0..nx {
                closing[self.columns.node([i, j])] += self.sign * trace[(i, j)];
            }
        }
    }

    /// See [`crate::precondition::inverse::Inverse::finish`].
    pub fn finish(&self, multipliers: &[(usize, f64)], step: &mut [f64], work: &mut InverseWork) {
        let kept = &mut work.kept;
        self.take_forces(multipliers, self.preconditioner.gathered_mut(kept));
        self.preconditioner.spread(kept, step);
    }

    /// See [`crate::precondition::inverse::Inverse::respond`].
    pub fn respond(&self, forces: &[(usize, f64)], closing: &mut [f64]) {
        let [mx, my] = self.basis.mode_shape();
        let mut gathered = Mat::<f64>::zeros(mx, my);
        self.take_forces(forces, gathered.as_mut());
        gathered *= faer::Scale(-1.0);
        self.add_closing(gathered.as_ref(), closing);
    }

    /// `gathered` -= B^T m for the forces m on nodes.
    pub fn take_forces(&self, multipliers: &[(usize, f64)], mut gathered: MatMut<'_, f64>) {
        let [nx, ny] = self.columns.count;
        let mut plane = Mat::<f64>::zeros(nx, ny);
        for &(node, m) in multipliers {
            if let Some([i, j]) = self.columns.local(node) {
                plane[(i, j)] = m;
            }
        }
        let load = self.basis.to_modes(plane.as_ref());
        gathered -= faer::Scale(self.sign) * load;
    }

    /// See [`crate::precondition::inverse::Inverse::green`]; the second one is scaled to elasticity's response.
    pub fn green(&self, nodes: &[usize]) -> [Mat<f64>; 2] {
        let n = nodes.len();
        let local: Vec<[usize; 2]> = nodes
            .iter()
            .filter_map(|&node| self.columns.local(node))
            .collect();
        assert_eq!(local.len(), n, "contact candidates over the body");
        let green = self.basis.green(self.preconditioner.end_response(), &local);
        let scaled = faer::Scale(self.response) * &green;
        [green, scaled]
    }
}
