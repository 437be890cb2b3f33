//! Nodal forces of pressures, tractions and body forces.

use kufe_fem::{Body, ElementKind, Material, boundary_faces, hex8};
use kufe_mesh::HexMesh;
use kufe_tests::fem::loads::{add_body_force, add_pressure, add_traction};
use kufe_tests::meshes::{block, faces_where, shake};

const CELLS: [usize; 3] = [3, 4, 2];
const SIZE: [f64; 3] = [1.0, 2.0, 0.5];

fn total(loads: &[f64], c: usize) -> f64 {
    loads.iter().skip(c).step_by(3).sum()
}

fn distorted_cell() -> HexMesh {
    let mut mesh = block([1; 3], [1.0, 0.5, 2.0]);
    for (k, point) in mesh.points.iter_mut().enumerate() {
        for (axis, value) in point.iter_mut().enumerate() {
            *value += 0.1 * (1.3 * k as f64 + 2.1 * axis as f64).sin();
        }
    }
    mesh
}

#[test]
fn a_uniform_pressure_on_the_whole_boundary_has_no_resultant_and_no_moment() {
    let mut mesh = block(CELLS, SIZE);
    shake(&mut mesh, CELLS, SIZE, [0.3; 3]);
    let faces = boundary_faces(&mesh);
    assert_eq!(faces.len(), 2 * (12 + 8 + 6));
    let mut loads = vec![0.0; 3 * mesh.points.len()];
    add_pressure(&mesh, &faces, |_| 5.0, &mut loads);
    for c in 0..3 {
        assert!(total(&loads, c).abs() < 1e-14);
        let (p, q) = ((c + 1) % 3, (c + 2) % 3);
        let forces = mesh.points.iter().zip(loads.chunks_exact(3));
        let moment: f64 = forces.map(|(x, f)| x[p] * f[q] - x[q] * f[p]).sum();
        assert!(moment.abs() < 1e-14, "{moment}");
    }
}

/// Divergence theorem: the pressure x_c has the resultant -V along c.
#[test]
fn resultant_of_a_linear_pressure_is_the_volume_of_the_cell() {
    let mesh = distorted_cell();
    let volume = hex8::volume(&mesh.cells[0].map(|node| mesh.points[node]));
    for c in 0..3 {
        let mut loads = vec![0.0; 24];
        add_pressure(&mesh, &boundary_faces(&mesh), |p| p[c], &mut loads);
        assert!((total(&loads, c) + volume).abs() < 1e-13);
    }
}

#[test]
fn traction_is_given_per_area_of_the_loaded_face() {
    let mesh = block(CELLS, SIZE);
    let top = faces_where(&mesh, |p| p[2] == 0.5);
    let mut loads = vec![0.0; 3 * mesh.points.len()];
    // Linear in x: mean 3 + 0.5 over the area of 2.
    add_traction(&mesh, &top, |p| [0.0, 3.0 + p[0], 0.0], &mut loads);
    assert!((total(&loads, 1) - 7.0).abs() < 1e-14);
    assert_eq!((total(&loads, 0), total(&loads, 2)), (0.0, 0.0));
}

#[test]
fn a_body_force_sums_to_its_density_times_the_volume() {
    let mesh = distorted_cell();
    let volume = hex8::volume(&mesh.cells[0].map(|node| mesh.points[node]));
    let material = Material::new(9.0e9, 0.33).unwrap();
    let body = Body::uniform(mesh, material, ElementKind::Hex8).unwrap();
    let mut loads = vec![0.0; 24];
    add_body_force(&body, |_| [0.0, 2.0, -3.0], &mut loads);
    assert!((total(&loads, 1) - 2.0 * volume).abs() < 1e-14);
    assert!((total(&loads, 2) + 3.0 * volume).abs() < 1e-14);
}
