//! Consistent nodal forces of loads on faces and in the volume of hexahedra.

use kufe_fem::Body;
use kufe_fem::hex8::{self, GAUSS, Jacobian};
use kufe_mesh::HexMesh;

/// One Gauss point of a face.
struct FacePoint {
    shape: [f64; 4],
    position: [f64; 3],
    /// Outward normal times area weight [m^2].
    area: [f64; 3],
}

fn face_points(corners: [[f64; 3]; 4]) -> [FacePoint; 4] {
    const NATURAL: [[f64; 2]; 4] = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
    NATURAL.map(|at| {
        let (s, t) = (at[0] * GAUSS, at[1] * GAUSS);
        let shape = NATURAL.map(|c| (1.0 + c[0] * s) * (1.0 + c[1] * t) / 4.0);
        let ds = NATURAL.map(|c| c[0] * (1.0 + c[1] * t) / 4.0);
        let dt = NATURAL.map(|c| (1.0 + c[0] * s) * c[1] / 4.0);
        let sum = |w: [f64; 4]| -> [f64; 3] {
            std::array::from_fn(|i| (0..4).map(|a| w[a] * corners[a][i]).sum())
        };
        let (a, b) = (sum(ds), sum(dt));
        FacePoint {
            shape,
            position: sum(shape),
            area: [
                a[1] * b[2] - a[2] * b[1],
                a[2] * b[0] - a[0] * b[2],
                a[0] * b[1] - a[1] * b[0],
            ],
        }
    })
}

fn add_force(
    mesh: &HexMesh,
    faces: &[[usize; 4]],
    loads: &mut [f64],
    force: impl Fn(&FacePoint) -> [f64; 3],
) {
    assert_eq!(loads.len(), 3 * mesh.points.len());
    for face in faces {
        for point in face_points(face.map(|node| mesh.points[node])) {
            let force = force(&point);
            for (&node, n) in face.iter().zip(point.shape) {
                for i in 0..3 {
                    loads[3 * node + i] += n * force[i];
                }
            }
        }
    }
}

/// Adds the consistent nodal forces [N] of a traction given by position [Pa] on faces, 2 x 2 Gauss
/// points each.
///
/// `loads` has three numbers a node.
pub fn add_traction(
    mesh: &HexMesh,
    faces: &[[usize; 4]],
    traction: impl Fn([f64; 3]) -> [f64; 3],
    loads: &mut [f64],
) {
    add_force(mesh, faces, loads, |point| {
        let [x, y, z] = point.area;
        let area = (x * x + y * y + z * z).sqrt();
        traction(point.position).map(|t| t * area)
    });
}

/// Adds the consistent nodal forces [N] of a pressure given by position [Pa] on faces, against
/// their outward normals.
///
/// Faces are counter-clockwise seen from outside, as from [`kufe_fem::boundary_faces`].
pub fn add_pressure(
    mesh: &HexMesh,
    faces: &[[usize; 4]],
    pressure: impl Fn([f64; 3]) -> f64,
    loads: &mut [f64],
) {
    add_force(mesh, faces, loads, |point| {
        let p = pressure(point.position);
        point.area.map(|a| -p * a)
    });
}

/// Adds the consistent nodal forces [N] of a body force given by position [N/m^3], 2 x 2 x 2 Gauss
/// points a cell.
pub fn add_body_force(body: &Body, force: impl Fn([f64; 3]) -> [f64; 3], loads: &mut [f64]) {
    assert_eq!(loads.len(), body.dofs());
    for (cell, nodes) in body.mesh().cells.iter().enumerate() {
        let corners = body.corners(cell);
        for xi in hex8::gauss_points() {
            let shape = hex8::shape_functions(xi);
            let determinant = Jacobian::at(&corners, xi).determinant;
            let density = force(std::array::from_fn(|i| {
                (0..8).map(|a| shape[a] * corners[a][i]).sum()
            }));
            for (&node, n) in nodes.iter().zip(shape) {
                for i in 0..3 {
                    loads[3 * node + i] += n * density[i] * determinant;
                }
            }
        }
    }
}
