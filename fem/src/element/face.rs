//! Loads on the quadrilateral faces of hexahedra.

use std::collections::HashMap;

use kufe_mesh::HexMesh;

use crate::element::hex8::GAUSS;
use crate::error::Error;

/// Corners of the six faces of a cell, counter-clockwise seen from outside: -x, +x, -y, +y, -z, +z
/// in natural coordinates.
pub const FACES: [[usize; 4]; 6] = [
    [0, 4, 7, 3],
    [1, 2, 6, 5],
    [0, 1, 5, 4],
    [3, 7, 6, 2],
    [0, 3, 2, 1],
    [4, 5, 6, 7],
];

/// The faces that belong to one cell only, as nodes counter-clockwise seen from outside, in the
/// order of the cells.
pub fn boundary_faces(mesh: &HexMesh) -> Vec<[usize; 4]> {
    let key = |mut face: [usize; 4]| {
        face.sort_unstable();
        face
    };
    let faces = || {
        mesh.cells
            .iter()
            .flat_map(|cell| FACES.map(|face| face.map(|corner| cell[corner])))
    };
    let mut count: HashMap<[usize; 4], u32> = HashMap::new();
    for face in faces() {
        *count.entry(key(face)).or_default() += 1;
    }
    faces().filter(|&face| count[&key(face)] == 1).collect()
}

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
) -> Result<(), Error> {
    if loads.len() != 3 * mesh.points.len() {
        return Err(Error::Length {
            what: "loads",
            found: loads.len(),
            expected: 3 * mesh.points.len(),
        });
    }
    for (cell, face) in faces.iter().enumerate() {
        if let Some(&node) = face.iter().find(|&&node| node >= mesh.points.len()) {
            return Err(Error::NodeIndex {
                cell,
                node,
                node_count: mesh.points.len(),
            });
        }
        for point in face_points(face.map(|node| mesh.points[node])) {
            let force = force(&point);
            for (&node, n) in face.iter().zip(point.shape) {
                for i in 0..3 {
                    loads[3 * node + i] += n * force[i];
                }
            }
        }
    }
    Ok(())
}

/// Adds the consistent nodal forces [N] of a traction given by position [Pa] on faces, 2 x 2 Gauss
/// points each.
///
/// `loads` has three numbers a node. Fails where its length is another, or a face names a missing
/// node.
pub fn add_traction(
    mesh: &HexMesh,
    faces: &[[usize; 4]],
    traction: impl Fn([f64; 3]) -> [f64; 3],
    loads: &mut [f64],
) -> Result<(), Error> {
    add_force(mesh, faces, loads, |point| {
        let [x, y, z] = point.area;
        let area = (x * x + y * y + z * z).sqrt();
        traction(point.position).map(|t| t * area)
    })
}

/// Adds the consistent nodal forces [N] of a pressure given by position [Pa] on faces, against
/// their outward normals.
///
/// Faces are counter-clockwise seen from outside, as from [`boundary_faces`]. Fails as
/// [`add_traction`].
pub fn add_pressure(
    mesh: &HexMesh,
    faces: &[[usize; 4]],
    pressure: impl Fn([f64; 3]) -> f64,
    loads: &mut [f64],
) -> Result<(), Error> {
    add_force(mesh, faces, loads, |point| {
        let p = pressure(point.position);
        point.area.map(|a| -p * a)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::hex8;
    use crate::test_block::block;

    fn total(loads: &[f64], c: usize) -> f64 {
        loads.iter().skip(c).step_by(3).sum()
    }

    #[test]
    fn a_uniform_pressure_on_the_whole_boundary_has_no_resultant_and_no_moment() {
        let mesh = block([3, 4, 2], [1.0, 2.0, 0.5], 0.3);
        let faces = boundary_faces(&mesh);
        assert_eq!(faces.len(), 2 * (12 + 8 + 6));
        let mut loads = vec![0.0; 3 * mesh.points.len()];
        add_pressure(&mesh, &faces, |_| 5.0, &mut loads).unwrap();
        for c in 0..3 {
            assert!(total(&loads, c).abs() < 1e-14);
            let (p, q) = ((c + 1) % 3, (c + 2) % 3);
            let moment: f64 = mesh
                .points
                .iter()
                .zip(loads.chunks_exact(3))
                .map(|(x, f)| x[p] * f[q] - x[q] * f[p])
                .sum();
            assert!(moment.abs() < 1e-14, "{moment}");
        }
    }

    /// Divergence theorem on one distorted cell: the pressure x_c pushes with -V along c.
    #[test]
    fn a_linear_pressure_pushes_with_the_volume_of_the_cell() {
        let corners = hex8::tests::distorted([1.0, 0.5, 2.0]);
        let mesh = HexMesh {
            points: corners.to_vec(),
            cells: vec![std::array::from_fn(|a| a)],
        };
        for c in 0..3 {
            let mut loads = vec![0.0; 24];
            add_pressure(&mesh, &boundary_faces(&mesh), |p| p[c], &mut loads).unwrap();
            assert!((total(&loads, c) + hex8::volume(&corners)).abs() < 1e-13);
        }
    }

    #[test]
    fn traction_is_given_per_area_of_the_loaded_face() {
        let mesh = block([3, 4, 2], [1.0, 2.0, 0.5], 0.0);
        let top: Vec<_> = boundary_faces(&mesh)
            .into_iter()
            .filter(|f| f.iter().all(|&n| mesh.points[n][2] == 0.5))
            .collect();
        let mut loads = vec![0.0; 3 * mesh.points.len()];
        // Linear in x: mean 3 + 0.5 over the area of 2.
        add_traction(&mesh, &top, |p| [0.0, 3.0 + p[0], 0.0], &mut loads).unwrap();
        assert!((total(&loads, 1) - 7.0).abs() < 1e-14);
        assert_eq!((total(&loads, 0), total(&loads, 2)), (0.0, 0.0));
        assert!(add_traction(&mesh, &top, |_| [0.0; 3], &mut loads[1..]).is_err());
    }
}
