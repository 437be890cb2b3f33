//! A runner of unstructured hexahedra as a body of the contact problem.

use std::sync::Arc;

use kufe_mesh::TensorGrid;

use crate::RunnerSolid;
use crate::bodies::elastic_body::{ElasticBody, Inverse, Stiffness, Trace};
use crate::precondition::factored::{FactoredInverse, Mortar, mortar_rows};

/// A solid with its factor as exact preconditioner, connected by a mortar with the plane of the
/// ice's `grid`.
pub(crate) fn solid_body(solid: &Arc<RunnerSolid>, grid: &TensorGrid) -> ElasticBody {
    let place = |node: usize| solid.surface.partition_point(|&s| s < node);
    let faces: Vec<_> = solid
        .faces
        .iter()
        .map(|face| {
            let corners = face.map(|node| solid.mesh().points[node]);
            (face.map(place), corners.map(|p| [p[0], p[1]]))
        })
        .collect();
    let vertical = 2 * solid.mesh().points.len();
    let mortar = Arc::new(Mortar {
        rows: mortar_rows(grid, &faces),
        entries: solid.surface.iter().map(|node| vertical + node).collect(),
    });
    ElasticBody {
        stiffness: Stiffness::Solid(solid.clone()),
        assembled: None,
        inverse: Inverse::Factored(FactoredInverse::new(solid.clone(), mortar.clone())),
        trace: Trace::Means(mortar),
        fixed: Vec::new(),
        load: Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe_mesh::{HexMesh, TensorGrid};

    const HEIGHT: f64 = 0.01;
    const HALF: [f64; 2] = [0.03, 0.02];
    const YOUNGS: f64 = 210e9;
    const PRESSURE: f64 = 5e6;

    /// A block of 7 x 5 x 3 cells, without Poisson's effect, its top fixed: uneven ones with
    /// rectangular faces, and `skewed` by a part.
    fn uneven(skewed: f64) -> Arc<RunnerSolid> {
        let even = |half: f64, n: i32| -> Vec<f64> {
            let place = |i: i32| half * (2.0 * f64::from(i) / f64::from(n) - 1.0);
            (0..=n).map(place).collect()
        };
        let grid = TensorGrid {
            x: even(HALF[0], 7),
            y: even(HALF[1], 5),
            z: (0..=3).map(|k| HEIGHT * f64::from(k) / 3.0).collect(),
        };
        let mut mesh: HexMesh = grid.hex_mesh();
        for p in &mut mesh.points {
            let [s, t] = [p[0] / HALF[0], p[1] / HALF[1]];
            let rim = (1.0 - s * s) * (1.0 - t * t);
            p[0] += HALF[0] * (0.1 * (1.0 - s * s) + skewed * rim * (t + 0.2));
            p[1] += HALF[1] * (0.1 * (1.0 - t * t) + skewed * rim);
        }
        let fixed = |p: [f64; 3]| p[2] > HEIGHT - 1e-9;
        Arc::new(RunnerSolid::new(mesh, YOUNGS, 0.0, fixed).expect("a block"))
    }

    /// How the gap closes at the nodes of an ice plane whose forces are those of one pressure, for
    /// lines that match no face of the block.
    fn closing(reach: f64, skewed: f64) -> (Vec<f64>, Vec<f64>) {
        let line = |half: f64, places: &[f64]| -> Vec<f64> {
            let whole = places.iter().map(|t| half * t);
            whole.collect()
        };
        let grid = TensorGrid {
            x: line(
                HALF[0],
                &[-reach, -0.71, -0.4, -0.13, 0.02, 0.3, 0.55, 0.8, reach],
            ),
            y: line(HALF[1], &[-reach, -0.62, -0.1, 0.17, 0.5, reach]),
            z: vec![-1.0, 0.0],
        };
        let body = solid_body(&uneven(skewed), &grid);
        let hat = |nodes: &[f64], k: usize| {
            let low = if k > 0 { nodes[k] - nodes[k - 1] } else { 0.0 };
            0.5 * (low + nodes.get(k + 1).map_or(0.0, |next| next - nodes[k]))
        };
        let nx = grid.x.len();
        let forces: Vec<(usize, f64)> = (0..nx * grid.y.len())
            .map(|n| (n, PRESSURE * hat(&grid.x, n % nx) * hat(&grid.y, n / nx)))
            .collect();
        let mut load = vec![0.0; body.len()];
        body.trace.add_forces(&forces, &mut load);
        load.iter_mut().for_each(|force| *force = -*force);
        let mut closed = vec![0.0; nx * grid.y.len()];
        body.begin(&load, &mut closed, &mut body.work());
        (closed, load)
    }

    /// The mortar's patch test: the block is compressed by p H / E at every node of the plane, to
    /// rounding where faces are parallelograms and to what the rule on triangles is off by where
    /// the faces' functions are no polynomials.
    #[test]
    fn a_constant_pressure_compresses_a_block_evenly_through_a_mesh_that_does_not_match() {
        let expected = -PRESSURE * HEIGHT / YOUNGS;
        for (skewed, part) in [(0.0, 1e-10), (0.1, 1e-7)] {
            let (closed, load) = closing(1.0, skewed);
            for found in &closed {
                assert!((found / expected - 1.0).abs() < part, "{found} {expected}");
            }
            let area = 4.0 * HALF[0] * HALF[1];
            let total: f64 = load.iter().sum();
            assert!(
                (total.abs() / (PRESSURE * area) - 1.0).abs() < 1e-12,
                "{total}"
            );
        }
    }

    /// Its defect: nodes whose functions reach past the block have forces for all of their
    /// functions, which are defined on the part that is covered: with lines a tenth outside its
    /// sides the block bears that tenth at its rims, and not a pressure that is the same
    /// everywhere.
    #[test]
    fn a_pressure_on_functions_that_reach_past_the_block_stands_on_its_rims() {
        let (closed, load) = closing(1.1, 0.0);
        let total: f64 = load.iter().sum();
        let area = 4.0 * HALF[0] * HALF[1];
        assert!(
            (total.abs() / (PRESSURE * area) - 1.21).abs() < 1e-12,
            "{total}"
        );
        let expected = -PRESSURE * HEIGHT / YOUNGS;
        let off: Vec<f64> = closed.iter().map(|c| c / expected - 1.0).collect();
        println!("{off:.3?}");
        assert!(off.iter().any(|o| *o > 0.05));
    }
}
