//! The solution of a contact problem.

use kufe_fem::ElementKind;
use kufe_mesh::{HexMesh, TensorGrid};

use crate::result::measure::ROUNDED;
use crate::{AssembledBody, Bed, UnderPeak};

/// A figure with its estimated discretisation error, in the same unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measure {
    /// The figure, extrapolated to the limit of finer meshes where possible.
    pub value: f64,
    /// Its error.
    pub error: f64,
}

/// The solved contact.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Peak pressure in the limit of finer and finer meshes, at most the ice's hardness [Pa].
    pub p_max: f64,
    /// Estimated discretisation error of the peak pressure [Pa].
    pub p_max_error: f64,
    /// Peak pressure on the last mesh, as in maps and fields [Pa].
    pub p_max_mesh: f64,
    /// Hardness of the ice [Pa]; `None` for elastic ice.
    pub hardness: Option<f64>,
    /// Mean pressure: ratio of force to contact area [Pa].
    pub p_mean: f64,
    /// Estimated error of the mean pressure, from that of the area [Pa].
    pub p_mean_error: f64,
    /// Contact area, with sub-cell resolution [m2].
    pub area: f64,
    /// Estimated error of the area on the last mesh, with the order observed on the last three;
    /// infinite after one mesh [m2].
    pub area_error: f64,
    /// Extent of the contact along x, from its first to its last point [m].
    pub length: f64,
    /// Estimated error of the length, likewise [m].
    pub length_error: f64,
    /// Extent of the contact along y [m].
    pub width: f64,
    /// Estimated error of the width, likewise [m].
    pub width_error: f64,
    /// Rigid approach at the origin, from first touch [m].
    pub approach: f64,
    /// Estimated error of the approach [m].
    pub approach_error: f64,
    /// Pitch about y, positive lowers the nose [rad].
    pub pitch: f64,
    /// Estimated error of the pitch; 0 where it is fixed [rad].
    pub pitch_error: f64,
    /// Roll about x [rad].
    pub roll: f64,
    /// Estimated error of the roll; 0 where it is fixed [rad].
    pub roll_error: f64,
    /// The largest shear in the ice under the peak pressure; `None` if it was not requested or lies
    /// at the surface.
    pub under_peak: Option<UnderPeak>,
    /// Integrated normal force [N].
    pub fz: f64,
    /// Point of action of the pressure's resultant, x and y [m].
    pub centre_of_pressure: [f64; 2],
    /// Largest violation of the contact conditions and of equilibrium, relative.
    pub kkt_residual: f64,
    /// Unknowns of the finest solve.
    pub dofs: usize,
    /// Conjugate-gradient iterations of the finest solve.
    pub iterations: usize,
    /// Updates of the contact set on all meshes, in order.
    pub history: Vec<Iterate>,
    /// Pressure, gap and displacement on the contact plane, over the whole patch (symmetry
    /// unfolded).
    pub surface: SurfaceField,
    /// Displacements in the ice on the solved grid (one part of it where symmetry was used); `None`
    /// if only the contact plane was solved.
    pub volume: Option<VolumeField>,
    /// Displacements in an elastic runner.
    pub runner_volume: Option<RunnerField>,
    /// The mirror planes that were used, x = 0 and y = 0.
    pub symmetry: [bool; 2],
    /// Assembled stiffness of the finest mesh, first of the ice, then of an elastic runner; empty
    /// if the stiffness was not assembled.
    pub assembled: Vec<AssembledBody>,
}

impl Solution {
    /// Largest possible pressure: the ice's hardness, infinite for elastic ice [Pa].
    pub fn bound(&self) -> f64 {
        self.hardness.unwrap_or(f64::INFINITY)
    }
}

/// One update of the contact set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iterate {
    /// Number of the mesh, counted from the coarsest.
    pub level: usize,
    /// Unknowns of that mesh.
    pub dofs: usize,
    /// Relative error of the peak on the previous meshes, or of the area where the ice's hardness
    /// fixes the peak; `None` while there are too few meshes for an estimate.
    pub error_before: Option<f64>,
    /// Nodes in the contact set.
    pub contact_nodes: usize,
    /// Conjugate-gradient iterations since the last update.
    pub iterations: usize,
    /// Relative residual reached.
    pub residual: f64,
    /// Present peak pressure [Pa].
    pub p_max: f64,
    /// Projected SOR sweeps since the last update.
    pub sweeps: usize,
    /// Accelerations since the last update: those on the contact plane plus the iteration on this
    /// set. With boundary elements, the number of contact sets whose equations were solved.
    pub accelerations: usize,
    /// Complementary energy of the last accepted contact forces [J], which falls from update to
    /// update of a mesh. At the solution it is minus the total potential energy, which includes the
    /// load's work from first touch.
    pub energy: f64,
}

/// Fields on the contact plane over a rectilinear grid; arrays are `y.len()` rows of `x.len()`.
#[derive(Clone, Debug, PartialEq)]
pub struct SurfaceField {
    /// Node coordinates along the runner, increasing [m].
    pub x: Vec<f64>,
    /// Node coordinates across the runner, increasing [m].
    pub y: Vec<f64>,
    /// Contact pressure at the nodes, 0 outside the contact [Pa].
    pub pressure: Vec<f64>,
    /// Gap at the nodes, 0 in contact; infinite where there is no hull [m].
    pub gap: Vec<f64>,
    /// Depth to which the ice has yielded under the runner at the nodes, below the groove of
    /// previous runners; 0 where it has not yielded [m].
    pub yielded: Vec<f64>,
    /// Vertical displacement of the ice surface, upwards positive [m].
    pub uz: Vec<f64>,
}

impl SurfaceField {
    /// Integral of the nodal pressures, bilinear between nodes [N].
    pub fn force(&self) -> f64 {
        let pressures = self.pressure.iter().zip(self.node_areas());
        pressures.map(|(p, area)| p * area).sum()
    }

    /// Nodal pressures that integrate to `fz` [N], bilinear between nodes [Pa].
    ///
    /// The pressure of a node inside the contact is the one at its place; that of a node at the rim
    /// is a mean over its hat function, which reaches out of the contact. Together they integrate
    /// to about 1 % more than the load. The difference is subtracted at the nodes with an open
    /// neighbour; the others, the peak and nodes at the ice's hardness are unchanged.
    pub fn balanced_pressure(&self, fz: f64) -> Vec<f64> {
        let nx = self.x.len();
        let top = self.pressure.iter().copied().fold(0.0, f64::max);
        let open = |n: usize| self.pressure[n] <= 0.0;
        let at_rim = |n: usize| {
            let (i, j) = (n % nx, n / nx);
            let columns = i.saturating_sub(1)..=(i + 1).min(nx - 1);
            let rows = j.saturating_sub(1)..=(j + 1).min(self.y.len() - 1);
            let neighbours = rows.flat_map(|j| columns.clone().map(move |i| j * nx + i));
            neighbours.into_iter().any(open)
        };
        let lower = |n: &usize| self.pressure[*n] < top * ROUNDED && at_rim(*n);
        let rim: Vec<usize> = (0..self.pressure.len())
            .filter(|n| !open(*n))
            .filter(lower)
            .collect();
        let areas = self.node_areas();
        let at_rims: f64 = rim.iter().map(|&n| self.pressure[n] * areas[n]).sum();
        let mut pressure = self.pressure.clone();
        if at_rims > 0.0 {
            let factor = (1.0 + (fz - self.force()) / at_rims).max(0.0);
            for n in rim {
                pressure[n] = (factor * pressure[n]).min(top);
            }
        }
        pressure
    }

    /// Integrals of the nodes' hat functions [m2].
    pub(super) fn node_areas(&self) -> Vec<f64> {
        let widths = |nodes: &[f64]| -> Vec<f64> {
            let last = nodes.len() - 1;
            let width = |k: usize| 0.5 * (nodes[(k + 1).min(last)] - nodes[k.saturating_sub(1)]);
            (0..=last).map(width).collect()
        };
        let (along, across) = (widths(&self.x), widths(&self.y));
        let row = |width: &f64| along.iter().map(|w| w * width).collect::<Vec<f64>>();
        across.iter().flat_map(row).collect()
    }
}

/// Displacements of one body on its tensor grid.
#[derive(Clone, Debug, PartialEq)]
pub struct VolumeField {
    /// The grid, z = 0 being the surface of the ice.
    pub grid: TensorGrid,
    /// Displacement at the nodes, in [`TensorGrid::node`] order [m].
    pub displacement: Vec<[f64; 3]>,
    /// Young's modulus of the ice [Pa].
    pub youngs_modulus: f64,
    /// Poisson's ratio of the ice.
    pub poissons_ratio: f64,
    /// The element of its cells.
    pub element: ElementKind,
    /// The elastic bed under the ice, and its number of cells along z, which are the lowest.
    pub bed: Option<(Bed, usize)>,
}

/// Displacements of an elastic runner on its hexahedra, relative to the rigid motion of its mount.
#[derive(Clone, Debug, PartialEq)]
pub struct RunnerField {
    /// The mesh, undeformed and before the approach.
    pub mesh: HexMesh,
    /// Displacement at the nodes [m].
    pub displacement: Vec<[f64; 3]>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::pressure_map::tests::ellipse;

    #[test]
    fn balanced_pressures_integrate_to_the_load_and_differ_at_the_rim_only() {
        let field = ellipse(0.025, 0.14e-3, 138.5e6);
        for part in [0.99, 1.0, 1.01] {
            let fz = part * field.force();
            let pressure = field.balanced_pressure(fz);
            let changed = pressure
                .iter()
                .zip(&field.pressure)
                .filter(|(a, b)| a != b)
                .count();
            let touching = pressure.iter().filter(|p| **p > 0.0).count();
            let balanced = SurfaceField {
                pressure,
                ..field.clone()
            };
            assert!((balanced.force() / fz - 1.0).abs() < 1e-12);
            assert!(changed < touching / 10, "{changed} of {touching}");
        }
    }
}
