//! Where the plane that elimination ends on lies in the vectors.

use crate::precondition::planewise_diagonal::PlanewiseDiagonal;

/// Where the vertical component on that plane begins among modal and among nodal values, and its numbers.
pub(super) struct Place {
    pub modal: [usize; 2],
    pub nodal: [usize; 2],
}

impl Place {
    pub fn of(planewise: &PlanewiseDiagonal) -> Self {
        let vertical = &planewise.components[2];
        let [nx, ny, nz] = planewise.shape;
        let pairs: usize = vertical.pairs().iter().product();
        let planes = &vertical.z.planes;
        Place {
            modal: [vertical.start + (planes.len() - 1) * pairs, pairs],
            nodal: [(2 * nz + planes[planes.len() - 1]) * nx * ny, nx * ny],
        }
    }
}
