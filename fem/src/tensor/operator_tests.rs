//! The operator against assembled matrices, and its bits for any slabs and bands.

use kufe_mesh::TensorGrid;

use super::operator::{LowerLayer, TensorOperator};
use crate::body::Body;
use crate::body::Material;
use crate::body::Section;
use crate::precondition::elimination::End;
use crate::precondition::fast_diagonal::FastDiagonal;
use crate::precondition::planewise_diagonal::PlanewiseDiagonal;
use crate::sparse::assembly::assemble;

/// The assembled stiffness of the same hexahedra, on graded grids whose rows are shorter and longer
/// than a register.
#[test]
fn operator_is_the_assembled_stiffness() {
    for shape in [
        [2, 2, 2],
        [3, 5, 4],
        [9, 2, 3],
        [12, 6, 5],
        [16, 3, 4],
        [17, 3, 3],
        [35, 4, 3],
    ] {
        let axis = |n: usize, growth: f64| -> Vec<f64> {
            (0..n).map(|i| 1e-2 * growth.powi(i as i32)).collect()
        };
        let grid = TensorGrid {
            x: axis(shape[0], 1.4),
            y: axis(shape[1], 1.3),
            z: axis(shape[2], 1.7),
        };
        let nodes = grid.node_count();
        let ice = Material::new(9e9, 0.33).unwrap();
        let free = [[[false; 2]; 3]; 3];
        let plain = TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), free);
        for operator in [plain.clone(), plain.with_mean_dilatation()] {
            let body = Body::uniform(grid.hex_mesh(), ice, operator.element_kind()).unwrap();
            let u: Vec<f64> = (0..3 * nodes).map(|i| (1.3 * i as f64).sin()).collect();
            let (mut expected, mut found) = (vec![0.0; 3 * nodes], vec![f64::NAN; 3 * nodes]);
            assemble(&body).apply(&u, &mut expected);
            let by_component: Vec<f64> = (0..3 * nodes)
                .map(|i| u[3 * (i % nodes) + i / nodes])
                .collect();
            operator.apply(&by_component, &mut found);
            let size = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (i, found) in found.iter().enumerate() {
                let expected = expected[3 * (i % nodes) + i / nodes];
                assert!(
                    (found - expected).abs() < 1e-13 * size,
                    "{shape:?}, {i}: {found} instead of {expected}"
                );
            }
        }
    }
}

fn layered() -> (TensorGrid, Material, Material, LowerLayer) {
    let grid = TensorGrid {
        x: vec![0.0, 0.1, 0.3, 0.6],
        y: vec![-0.2, 0.0, 0.1],
        z: vec![-1.0, -0.6, -0.3, -0.1, 0.0],
    };
    let ice = Material::new(9.0e9, 0.33).unwrap();
    let concrete = Material::new(30.0e9, 0.2).unwrap();
    let layer = LowerLayer {
        cells: 2,
        lambda: concrete.lame_lambda(),
        mu: concrete.shear_modulus(),
    };
    (grid, ice, concrete, layer)
}

#[test]
fn two_layers_have_the_assembled_stiffness_of_their_hexahedra() {
    let (grid, ice, concrete, layer) = layered();
    let free = [[[false; 2]; 3]; 3];
    let plain =
        TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), free).on_layer(layer);
    for operator in [plain.clone(), plain.with_mean_dilatation()] {
        let mesh = grid.hex_mesh();
        let of = |material| Section {
            material,
            kind: operator.element_kind(),
        };
        let mut sections = vec![of(ice); mesh.cells.len()];
        sections[..mesh.cells.len() / 2].fill(of(concrete));
        let assembled = assemble(&Body::new(mesh, sections).unwrap());
        let nodes = grid.node_count();
        let u: Vec<f64> = (0..3 * nodes).map(|i| (1.7 * i as f64).sin()).collect();
        let by_node: Vec<f64> = (0..3 * nodes).map(|i| u[i % 3 * nodes + i / 3]).collect();
        let (mut out, mut expected) = (vec![0.0; 3 * nodes], vec![0.0; 3 * nodes]);
        operator.apply(&u, &mut out);
        assembled.apply(&by_node, &mut expected);
        let largest = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for i in 0..3 * nodes {
            let error = (out[i % 3 * nodes + i / 3] - expected[i]).abs();
            assert!(error < 1e-12 * largest, "{error:e} of {largest:e}");
        }
    }
}

#[test]
fn slabs_give_the_same_bits_for_any_number_of_threads() {
    let (_, ice, concrete, _) = layered();
    let axis = |n: usize| -> Vec<f64> { (0..n).map(|i| 1.1f64.powi(i as i32)).collect() };
    let grid = TensorGrid {
        x: axis(11),
        y: axis(6),
        z: axis(23),
    };
    let fixed = [[[true, false], [false, true], [true, false]]; 3];
    let plain = TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), fixed);
    let lower = |cells: usize| {
        plain.clone().on_layer(LowerLayer {
            cells,
            lambda: concrete.lame_lambda(),
            mu: concrete.shear_modulus(),
        })
    };
    // Slabs of two threads begin at plane 12, those of five at planes 5, 10, 15 and 20.
    let layered = [lower(4), lower(5), lower(11), lower(12)];
    let means = lower(5).with_mean_dilatation();
    for operator in layered.into_iter().chain([plain.clone(), means]) {
        let n = 3 * operator.node_count();
        let u: Vec<f64> = (0..n).map(|i| (0.9 * i as f64).sin()).collect();
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let mut out = vec![f64::NAN; n];
            pool.build()
                .unwrap()
                .install(|| operator.apply(&u, &mut out));
            out
        };
        let one = with(1);
        assert!(one.iter().all(|v| v.is_finite()));
        for threads in [2, 3, 5] {
            assert_eq!(one, with(threads), "{threads} threads");
        }
    }
}

#[test]
fn bands_give_the_same_bits_for_any_number_of_rows() {
    let (_, ice, concrete, _) = layered();
    let axis = |n: usize| -> Vec<f64> { (0..n).map(|i| 1.1f64.powi(i as i32)).collect() };
    let fixed = [[[true, false], [false, true], [true, false]]; 3];
    for nx in [5, 8, 21] {
        let grid = TensorGrid {
            x: axis(nx),
            y: axis(17),
            z: axis(9),
        };
        let operator = TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), fixed)
            .on_layer(LowerLayer {
                cells: 3,
                lambda: concrete.lame_lambda(),
                mu: concrete.shear_modulus(),
            });
        let n = 3 * operator.node_count();
        let u: Vec<f64> = (0..n).map(|i| (0.9 * i as f64).sin()).collect();
        let with = |height: usize| {
            let mut out = vec![f64::NAN; n];
            operator.apply_in_bands(&u, &mut out, height);
            out
        };
        let whole = with(17);
        assert!(whole.iter().all(|v| v.is_finite()));
        for height in [1, 2, 5, 8, 16] {
            assert_eq!(whole, with(height), "{height} rows of {nx}");
        }
    }
}

/// With one Poisson's ratio the preconditioner is the inverse of the stiffness' diagonal blocks,
/// layers included: on a displacement of one component P^-1 K u gives u back in that component.
#[test]
fn layers_of_one_poissons_ratio_are_inverted_exactly_in_each_component() {
    let (grid, ice, _, _) = layered();
    let stiff = Material::new(30.0e9, 0.33).unwrap();
    let layer = LowerLayer {
        cells: 2,
        lambda: stiff.lame_lambda(),
        mu: stiff.shear_modulus(),
    };
    let fixed = [[[true; 2], [true; 2], [true, false]]; 3];
    let operator =
        TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), fixed).on_layer(layer);
    let fast = FastDiagonal::new(&operator);
    let nodes = grid.node_count();
    for c in 0..3 {
        let mut u = vec![0.0; 3 * nodes];
        (0..nodes).for_each(|n| u[c * nodes + n] = (2.3 * n as f64).cos());
        operator.mask(&mut u);
        let mut force = vec![0.0; 3 * nodes];
        operator.apply(&u, &mut force);
        let mut back = vec![0.0; 3 * nodes];
        let mut modal = vec![0.0; fast.mode_count()];
        let mut scratch = vec![0.0; fast.scratch_len()];
        fast.apply(&force, &mut back, &mut modal, &mut scratch);
        for n in c * nodes..(c + 1) * nodes {
            assert!((back[n] - u[n]).abs() < 1e-10, "{} {}", back[n], u[n]);
        }
        let eliminated = PlanewiseDiagonal::new(&operator, End::High);
        eliminated.apply(&force, &mut back, &mut modal);
        // Its products are done in single precision.
        for n in c * nodes..(c + 1) * nodes {
            assert!((back[n] - u[n]).abs() < 1e-5, "{} {}", back[n], u[n]);
        }
    }
}
