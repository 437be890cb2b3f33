//! Time of the assembled and the matrix-free stiffness, and of a Cholesky factorisation, on a block
//! of steel.

use std::time::Instant;

use kufe_fem::{Body, Constraints, ElementKind, Factor, Material, MatrixFree, assemble};
use kufe_mesh::TensorGrid;

fn main() -> Result<(), kufe_fem::Error> {
    let axis = |n: usize| (0..=n).map(|i| i as f64).collect();
    let steel = Material::new(210e9, 0.3)?;
    for (n, factorise) in [(20, true), (32, false)] {
        let grid = TensorGrid {
            x: axis(n),
            y: axis(n),
            z: axis(n),
        };
        for kind in [ElementKind::Hex8, ElementKind::Hex8Incompatible] {
            let body = Body::uniform(grid.hex_mesh(), steel, kind)?;
            let start = Instant::now();
            let stiffness = assemble(&body);
            let assembly = start.elapsed();
            let start = Instant::now();
            let mut operator = MatrixFree::new(&body);
            let setup = start.elapsed();
            let u = vec![1.0; body.dofs()];
            let mut y = vec![0.0; body.dofs()];
            let mut time = |f: &mut dyn FnMut(&[f64], &mut [f64])| {
                f(&u, &mut y);
                let start = Instant::now();
                (0..10).for_each(|_| f(&u, &mut y));
                start.elapsed() / 10
            };
            let sparse = time(&mut |u, y| stiffness.apply(u, y));
            let free = time(&mut |u, y| operator.apply(u, y));
            let sparse_bytes = size_of_val(&stiffness.blocks[..]);
            println!(
                "{} dofs, {kind:?}: assembly {assembly:.0?}, product {sparse:.1?} ({} MB); matrix-free setup {setup:.0?}, product {free:.1?} ({} MB)",
                body.dofs(),
                sparse_bytes / 1_000_000,
                operator.bytes() / 1_000_000,
            );
            if factorise && kind == ElementKind::Hex8 {
                let mut fixed = Constraints::new(body.node_count());
                fixed.clamp(0..(n + 1) * (n + 1))?;
                let map = fixed.dof_map();
                let start = Instant::now();
                let factor = Factor::of_body(&stiffness, &map, &body.mesh().points)?;
                let factorisation = start.elapsed();
                let mut rhs = vec![1.0; factor.dofs()];
                let start = Instant::now();
                factor.solve(&mut rhs);
                println!(
                    "  Cholesky {factorisation:.1?}, {} MB, solve {:.0?}",
                    factor.bytes() / 1_000_000,
                    start.elapsed()
                );
            }
        }
    }
    Ok(())
}
