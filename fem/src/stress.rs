//! Strains and stresses of a displaced body, and their invariants.

use kufe_mesh::TensorGrid;
use nalgebra::Matrix3;
use rayon::prelude::*;

use crate::body::{Body, ElementKind, Material};
use crate::element::hex8::{self, GAUSS, Jacobian};
use crate::element::hex8_incompatible::{Uncondensed, mode_gradients};
use crate::element::{hex8_axial, hex8_dilatation};
use crate::sparse::graph::NodeCells;

/// Displacements of one cell, ready to be differentiated.
struct CellField {
    corners: hex8::Corners,
    displacement: [f64; 24],
    /// Amplitudes of the incompatible modes and the centre's Jacobian, where the cell has them.
    inner: Option<([f64; 9], Jacobian)>,
    kind: ElementKind,
}

impl CellField {
    fn new(body: &Body, cell: usize, u: &[f64]) -> Self {
        let corners = body.corners(cell);
        let displacement = body.gather(cell, u);
        let section = body.sections()[cell];
        let inner = (section.kind == ElementKind::Hex8Incompatible).then(|| {
            let element = Uncondensed::new(&corners, section.material);
            let centre = Jacobian::at(&corners, [0.0; 3]);
            (element.amplitudes(&displacement), centre)
        });
        Self {
            corners,
            displacement,
            inner,
            kind: section.kind,
        }
    }

    fn strain(&self, xi: [f64; 3]) -> [f64; 6] {
        match self.kind {
            ElementKind::Hex8Axial => {
                return hex8_axial::strain(&self.corners, &self.displacement, xi);
            }
            ElementKind::Hex8Dilatation => {
                return hex8_dilatation::strain(&self.corners, &self.displacement, xi);
            }
            ElementKind::Hex8 | ElementKind::Hex8Incompatible => {}
        }
        let (gradients, determinant) = hex8::gradients(&self.corners, xi);
        let mut h = [[0.0; 3]; 3];
        let mut add = |value: &[f64], gradient: [f64; 3]| {
            for i in 0..3 {
                for j in 0..3 {
                    h[i][j] += value[i] * gradient[j];
                }
            }
        };
        for (value, gradient) in self.displacement.chunks_exact(3).zip(gradients) {
            add(value, gradient);
        }
        if let Some((amplitudes, centre)) = &self.inner {
            let modes = mode_gradients(centre, xi, determinant);
            for (value, gradient) in amplitudes.chunks_exact(3).zip(modes) {
                add(value, gradient);
            }
        }
        strain_of(&h)
    }
}

/// The strain of a displacement's gradient, engineering shears last.
fn strain_of(h: &[[f64; 3]; 3]) -> [f64; 6] {
    let shear = |i: usize, j: usize| h[i][j] + h[j][i];
    [
        h[0][0],
        h[1][1],
        h[2][2],
        shear(1, 2),
        shear(0, 2),
        shear(0, 1),
    ]
}

/// Strain in `cell` at natural coordinates `xi` for the displacements `u` (three per node [m]).
///
/// In cells with incompatible modes it includes the modes' strain.
///
/// # Panics
/// If the cell does not exist or `u` is too short.
pub fn strain_at(body: &Body, cell: usize, u: &[f64], xi: [f64; 3]) -> [f64; 6] {
    CellField::new(body, cell, u).strain(xi)
}

/// Stress [Pa] in `cell` at natural coordinates `xi` for the displacements `u` (three per node
/// [m]).
///
/// # Panics
/// As [`strain_at`].
pub fn stress_at(body: &Body, cell: usize, u: &[f64], xi: [f64; 3]) -> [f64; 6] {
    body.sections()[cell]
        .material
        .stress(strain_at(body, cell, u, xi))
}

fn cell_stresses(body: &Body, cell: usize, u: &[f64]) -> [[f64; 6]; 8] {
    let field = CellField::new(body, cell, u);
    let material = body.sections()[cell].material;
    hex8::gauss_points().map(|xi| material.stress(field.strain(xi)))
}

/// Stresses at a cell's corners, extrapolated from its Gauss points.
enum CornerStresses {
    /// Lengths of a box with the plain element [m]. The derivative of u along an axis is bilinear
    /// in the other two, so its extrapolation to a corner is exact: the difference between the two
    /// ends of the edge divided by its length.
    Edges([f64; 3]),
    /// Stresses at the corners of any other cell [Pa].
    Continued(Box<[[f64; 6]; 8]>),
}

impl CornerStresses {
    fn new(body: &Body, cell: usize, u: &[f64]) -> Self {
        let plain = body.sections()[cell].kind == ElementKind::Hex8;
        match hex8::box_lengths(&body.corners(cell)) {
            Some(lengths) if plain => CornerStresses::Edges(lengths),
            _ => {
                let stresses = extrapolate_to_corners(&cell_stresses(body, cell, u));
                CornerStresses::Continued(Box::new(stresses))
            }
        }
    }

    fn at(&self, body: &Body, cell: usize, corner: usize, u: &[f64]) -> [f64; 6] {
        let lengths = match self {
            CornerStresses::Edges(lengths) => lengths,
            CornerStresses::Continued(stresses) => return stresses[corner],
        };
        let nodes = &body.mesh().cells[cell];
        // h[j][i] = d u_i / d x_j
        let h: [[f64; 3]; 3] = std::array::from_fn(|j| {
            let [low, high] = hex8::EDGES[corner][j].map(|end| 3 * nodes[end]);
            std::array::from_fn(|i| (u[high + i] - u[low + i]) / lengths[j])
        });
        body.sections()[cell].material.stress(strain_of(&h))
    }
}

/// Trilinear extrapolation of Gauss-point values to the eight corners of their cell.
pub fn extrapolate_to_corners(values: &[[f64; 6]; 8]) -> [[f64; 6]; 8] {
    // The Gauss points are the corners of a cell that is 1/sqrt(3) as large.
    hex8::CORNERS.map(|corner| {
        let weights = hex8::shape_functions(corner.map(|c| c / GAUSS));
        std::array::from_fn(|i| (0..8).map(|g| weights[g] * values[g][i]).sum())
    })
}

/// Stresses [Pa] at the nodes: Gauss-point stresses extrapolated to the corners, averaged over the
/// cells of a node.
///
/// Where materials meet, stresses jump and the average lies between the sides; use [`stress_at`]
/// there. Nodes without cells get zero.
///
/// # Panics
/// If `u` does not have three numbers per node.
pub fn nodal_stresses(body: &Body, u: &[f64]) -> Vec<[f64; 6]> {
    assert_eq!(u.len(), body.dofs());
    let corners: Vec<CornerStresses> = (0..body.mesh().cells.len())
        .into_par_iter()
        .map(|cell| CornerStresses::new(body, cell, u))
        .collect();
    let cells = NodeCells::new(body.mesh());
    (0..body.node_count())
        .into_par_iter()
        .map(|node| {
            let (mut sum, mut count) = ([0.0; 6], 0);
            for (cell, corner) in cells.of(node) {
                let stress = corners[cell].at(body, cell, corner, u);
                for i in 0..6 {
                    sum[i] += stress[i];
                }
                count += 1;
            }
            sum.map(|s| s / f64::from(count.max(1)))
        })
        .collect()
}

/// Von Mises stress: sqrt(3/2 s : s) with the deviator s, in the unit of the stress.
///
/// ```
/// assert_eq!(kufe_fem::von_mises([7.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 7.0);
/// ```
pub fn von_mises(stress: [f64; 6]) -> f64 {
    let [xx, yy, zz, yz, zx, xy] = stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (yz * yz + zx * zx + xy * xy)).sqrt()
}

/// Principal stresses, largest (most tensile) first, in the unit of the stress.
///
/// All NaN if a component is not finite.
pub fn principal_stresses(stress: [f64; 6]) -> [f64; 3] {
    let [xx, yy, zz, yz, zx, xy] = stress;
    if stress.iter().any(|s| !s.is_finite()) {
        return [f64::NAN; 3];
    }
    let values = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz).symmetric_eigenvalues();
    let mut values = [values[0], values[1], values[2]];
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Largest shear stress on any plane: half the difference of the largest and smallest principal
/// stress.
pub fn maximum_shear(stress: [f64; 6]) -> f64 {
    let [first, _, third] = principal_stresses(stress);
    (first - third) / 2.0
}

/// Stresses [Pa] at the nodes of a tensor grid of plain trilinear hexahedra, for displacements [m]
/// in [`TensorGrid::node`] order.
///
/// Equal to [`nodal_stresses`](crate::nodal_stresses) for
/// [`ElementKind::Hex8`](crate::ElementKind::Hex8) on the grid's mesh. In a corner of such a cell
/// the derivative along an axis is the difference between the two ends of the edge divided by its
/// length, so that the mean over a node's cells is the mean of the edges on its two sides. `below`
/// is another material, with the number of layers of cells that it fills from below; where the two
/// meet, the stress is the mean of both sides.
///
/// # Panics
/// If there is not one displacement per node.
pub fn grid_stresses(
    grid: &TensorGrid,
    material: Material,
    below: Option<(usize, Material)>,
    displacement: &[[f64; 3]],
) -> Vec<[f64; 6]> {
    assert_eq!(displacement.len(), grid.node_count());
    let [nx, ny, _] = grid.shape();
    let (x, y, z) = (slopes(&grid.x), slopes(&grid.y), slopes(&grid.z));
    let between = below.map_or(0, |(layers, _)| layers);
    let lower = below.map_or(material, |(_, lower)| lower);
    let along = |node: usize, stride: usize, [low, high]: [f64; 2]| -> [f64; 3] {
        let at = &displacement[node];
        let before = &displacement[node.saturating_sub(stride)];
        let after = displacement.get(node + stride).unwrap_or(at);
        std::array::from_fn(|c| low * (at[c] - before[c]) + high * (after[c] - at[c]))
    };
    let mut stresses = vec![[0.0; 6]; grid.node_count()];
    stresses
        .par_chunks_mut(nx)
        .enumerate()
        .for_each(|(row, stresses)| {
            let (j, k) = (row % ny, row / ny);
            let meet = below.is_some() && k == between;
            for (i, stress) in stresses.iter_mut().enumerate() {
                let node = row * nx + i;
                let (dx, dy) = (along(node, 1, x[i]), along(node, nx, y[j]));
                let of = |material: Material, sides: [f64; 2]| {
                    let dz = along(node, nx * ny, sides);
                    let [yz, zx, xy] = [dz[1] + dy[2], dz[0] + dx[2], dy[0] + dx[1]];
                    material.stress([dx[0], dy[1], dz[2], yz, zx, xy])
                };
                *stress = if meet {
                    let [under, over] = z[k];
                    let under = of(lower, [2.0 * under, 0.0]);
                    let over = of(material, [0.0, 2.0 * over]);
                    std::array::from_fn(|c| 0.5 * (under[c] + over[c]))
                } else if k < between {
                    of(lower, z[k])
                } else {
                    of(material, z[k])
                };
            }
        });
    stresses
}

/// Weights, at each node, of the differences to the previous and to the next node [1/m]: the mean
/// of both slopes, one slope at the ends.
fn slopes(nodes: &[f64]) -> Vec<[f64; 2]> {
    let last = nodes.len() - 1;
    (0..nodes.len())
        .map(|k| {
            let share = if k == 0 || k == last { 1.0 } else { 0.5 };
            let before = (k > 0).then(|| share / (nodes[k] - nodes[k - 1]));
            let after = (k < last).then(|| share / (nodes[k + 1] - nodes[k]));
            [before, after].map(|weight| weight.unwrap_or(0.0))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Section;
    use crate::body::tests::block;

    #[test]
    fn a_box_has_at_its_corners_what_its_gauss_points_continue_to() {
        let mesh = block([2, 3, 2], [0.3, 2e-4, 7e-4], 0.0);
        let material = Material::new(9.0e9, 0.33).unwrap();
        let body = Body::uniform(mesh, material, ElementKind::Hex8).unwrap();
        let u: Vec<f64> = (0..body.dofs())
            .map(|k| 1e-6 * (1.7 * k as f64 + (k * k) as f64).sin())
            .collect();
        for cell in 0..body.mesh().cells.len() {
            let expected = extrapolate_to_corners(&cell_stresses(&body, cell, &u));
            let stresses = CornerStresses::new(&body, cell, &u);
            assert!(matches!(stresses, CornerStresses::Edges(_)));
            let found: [[f64; 6]; 8] =
                std::array::from_fn(|corner| stresses.at(&body, cell, corner, &u));
            let largest = expected
                .as_flattened()
                .iter()
                .fold(0.0_f64, |m, s| m.max(s.abs()));
            for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() < 1e-12 * largest, "{a} {b}");
            }
        }
    }

    #[test]
    fn a_linear_displacement_has_its_stress_at_every_gauss_point_and_node() {
        for kind in [
            ElementKind::Hex8,
            ElementKind::Hex8Incompatible,
            ElementKind::Hex8Axial,
            ElementKind::Hex8Dilatation,
        ] {
            let mut mesh = block([3, 2, 4], [1.0, 2.0, 0.5], 0.25);
            // In planes across x, as the axial element requires.
            for (node, p) in mesh.points.iter_mut().enumerate() {
                p[0] = (node % 4) as f64 / 3.0;
            }
            let material = Material::new(9.0e9, 0.33).unwrap();
            let body = Body::uniform(mesh, material, kind).unwrap();
            let h = [[1e-3, 2e-4, 0.0], [-3e-4, 5e-4, 1e-4], [2e-4, 0.0, -7e-4]];
            let u: Vec<f64> = body
                .mesh()
                .points
                .iter()
                .flat_map(|p| h.map(|row| row[0] * p[0] + row[1] * p[1] + row[2] * p[2]))
                .collect();
            let expected = material.stress([
                h[0][0],
                h[1][1],
                h[2][2],
                h[1][2] + h[2][1],
                h[0][2] + h[2][0],
                h[0][1] + h[1][0],
            ]);
            let cells = 0..body.mesh().cells.len();
            let all: Vec<_> = cells
                .flat_map(|cell| cell_stresses(&body, cell, &u))
                .collect();
            for stress in all.into_iter().chain(nodal_stresses(&body, &u)) {
                for i in 0..6 {
                    assert!((stress[i] - expected[i]).abs() < 1e-12 * expected[0].abs());
                }
            }
        }
    }

    #[test]
    fn trilinear_fields_are_continued_exactly() {
        let field = |x: [f64; 3]| {
            std::array::from_fn(|i| 1.0 + x[0] - 2.0 * x[1] * x[2] + i as f64 * x[0] * x[1] * x[2])
        };
        let corners = extrapolate_to_corners(&hex8::gauss_points().map(field));
        for (found, expected) in corners.iter().zip(hex8::CORNERS.map(field)) {
            for i in 0..6 {
                assert!((found[i] - expected[i]).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn pure_shear_has_its_textbook_measures() {
        let tau = 3.0;
        for component in 3..6 {
            let mut stress = [0.0; 6];
            stress[component] = tau;
            assert!((von_mises(stress) - 3.0f64.sqrt() * tau).abs() < 1e-14);
            assert!((maximum_shear(stress) - tau).abs() < 1e-14);
        }
        assert!(principal_stresses([f64::NAN; 6])[0].is_nan());
    }

    #[test]
    fn principal_stresses_keep_the_invariants_and_order() {
        let stress = [3.0, -1.0, 2.0, 0.7, -0.4, 1.5];
        let [xx, yy, zz, yz, zx, xy] = stress;
        let [a, b, c] = principal_stresses(stress);
        assert!(a >= b && b >= c);
        let second = xx * yy + yy * zz + zz * xx - yz * yz - zx * zx - xy * xy;
        let third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
        assert!((a + b + c - (xx + yy + zz)).abs() < 1e-13);
        assert!((a * b + b * c + c * a - second).abs() < 1e-13);
        assert!((a * b * c - third).abs() < 1e-12);
        let by_principal = 0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2));
        assert!((von_mises(stress).powi(2) - by_principal).abs() < 1e-12);
    }

    #[test]
    fn a_grid_has_the_stresses_of_its_mesh_in_one_material_and_in_two() {
        let grid = TensorGrid {
            x: vec![-0.3, -0.1, 0.0, 0.25],
            y: vec![0.0, 1e-3, 3e-3],
            z: vec![-0.05, -0.02, -0.01, -0.004, 0.0],
        };
        let [ice, bed] = [[9.0e9, 0.33], [3.0e10, 0.2]]
            .map(|[modulus, poisson]| Material::new(modulus, poisson).unwrap());
        let u: Vec<[f64; 3]> = (0..grid.node_count())
            .map(|k| [1.7, 2.3, 0.9].map(|w| 1e-6 * (w * k as f64 + (k * k) as f64).sin()))
            .collect();
        let flat: Vec<f64> = u.iter().flatten().copied().collect();
        for layers in [0, 1, 2] {
            let mesh = grid.hex_mesh();
            let sections = (0..mesh.cells.len())
                .map(|cell| Section {
                    material: if cell < layers * 6 { bed } else { ice },
                    kind: ElementKind::Hex8,
                })
                .collect();
            let expected = nodal_stresses(&Body::new(mesh, sections).unwrap(), &flat);
            let below = (layers > 0).then_some((layers, bed));
            let found = grid_stresses(&grid, ice, below, &u);
            let largest = expected
                .as_flattened()
                .iter()
                .fold(0.0f64, |m, s| m.max(s.abs()));
            for (a, b) in found.as_flattened().iter().zip(expected.as_flattened()) {
                assert!((a - b).abs() < 1e-12 * largest, "{a} {b}");
            }
        }
    }
}
