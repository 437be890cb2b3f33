//! Equations of elasticity of ice under a needle-shaped contact patch, that of a runner of 30 m
//! rocker and 5 mm section.

use kufe_fem::{End, Material, PlanewiseDiagonal, TensorOperator};
use kufe_mesh::TensorGrid;

/// Young's modulus [Pa] and Poisson's ratio of the ice in every benchmark.
pub const ICE: (f64, f64) = (9.0e9, 0.33);

/// A quarter of a block of ice, graded around a patch with aspect ratio 183.
#[derive(Clone, Debug)]
pub struct NeedleBlock {
    /// The grid.
    pub grid: TensorGrid,
    /// Half length and half width of the patch [m].
    pub patch: [f64; 2],
    /// The stiffness.
    pub operator: TensorOperator,
    /// Its preconditioner.
    pub preconditioner: PlanewiseDiagonal,
}

/// A block of `cells` cells along each axis: uniform over the patch, then in geometric progression
/// to 0.3 m.
pub fn needle_block(cells: usize) -> NeedleBlock {
    let patch = [0.0251, 0.000137];
    let axis = |half: f64| -> Vec<f64> {
        let even = cells / 3;
        let mut nodes: Vec<f64> = (0..=even).map(|i| half * i as f64 / even as f64).collect();
        let ratio = (0.3 / half).powf(1.0 / (cells - even) as f64);
        nodes.extend((1..=cells - even).map(|i| half * ratio.powi(i as i32)));
        nodes
    };
    let grid = TensorGrid {
        x: axis(patch[0]),
        y: axis(patch[1]),
        z: axis(patch[1]).iter().rev().map(|d| -d).collect(),
    };
    let ice = Material::new(ICE.0, ICE.1).unwrap_or_else(|error| panic!("{error}"));
    // Mirror planes at x = 0 and y = 0, the far faces fixed, the surface free.
    let fixed = std::array::from_fn(|c| [[c == 0, true], [c == 1, true], [true, false]]);
    let operator = TensorOperator::new(&grid, ice, fixed);
    let preconditioner = PlanewiseDiagonal::new(&operator, End::High);
    NeedleBlock {
        grid,
        patch,
        operator,
        preconditioner,
    }
}

impl NeedleBlock {
    /// Nodal forces of Hertz' pressure on the patch [N], by component.
    pub fn load(&self) -> Vec<f64> {
        let grid = &self.grid;
        let [nx, ny, nz] = grid.shape();
        let nodes = grid.node_count();
        let [along, across] = self.patch;
        let [x, y] = [0, 1].map(|axis| &self.operator.axes[axis].lumped_mass);
        let mut load = vec![0.0; 3 * nodes];
        for j in 0..ny {
            for i in 0..nx {
                let inside = 1.0 - (grid.x[i] / along).powi(2) - (grid.y[j] / across).powi(2);
                load[2 * nodes + grid.node(i, j, nz - 1)] =
                    -PEAK * inside.max(0.0).sqrt() * x[i] * y[j];
            }
        }
        self.operator.mask(&mut load);
        load
    }
}

/// Pressure at the middle of the patch [Pa].
const PEAK: f64 = 1e8;
