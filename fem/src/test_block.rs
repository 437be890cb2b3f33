//! The mesh that tests take.

use kufe_mesh::{HexMesh, TensorGrid};

use crate::body::{Body, ElementKind, Material, Section};

/// A moved block of about `n`^3 cells of five materials, every other one with incompatible modes.
pub fn mixed(n: usize) -> Body {
    let mesh = block([n, n + 1, n + 2], [1.0, 2.0, 0.5], 0.2);
    let sections = (0..mesh.cells.len())
        .map(|cell| Section {
            material: Material::new(1.0 + (cell % 5) as f64, 0.3).unwrap(),
            kind: [ElementKind::Hex8, ElementKind::Hex8Incompatible][cell % 2],
        })
        .collect();
    Body::new(mesh, sections).unwrap()
}

/// A block of `n` cells along each axis, its inner nodes moved by up to `noise` of a cell.
pub fn block(n: [usize; 3], size: [f64; 3], noise: f64) -> HexMesh {
    let axis = |a: usize| {
        (0..=n[a])
            .map(|i| size[a] * i as f64 / n[a] as f64)
            .collect()
    };
    let grid = TensorGrid {
        x: axis(0),
        y: axis(1),
        z: axis(2),
    };
    let mut mesh = grid.hex_mesh();
    let mut seed = 7u64;
    for p in &mut mesh.points {
        let inner = (0..3).all(|a| p[a] > 0.0 && p[a] < size[a]);
        for a in 0..3 {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            let random = 2.0 * ((seed >> 33) as f64 / (1u64 << 31) as f64) - 1.0;
            if inner {
                p[a] += noise * random * size[a] / n[a] as f64;
            }
        }
    }
    mesh
}
