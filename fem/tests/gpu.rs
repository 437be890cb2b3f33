//! The kernels on a graphics processor beside those of this processor.
//!
//! Any Vulkan, Metal or Direct3D 12 adapter will do, software too (Mesa's lavapipe). Without one the tests say that they skip,
//! unless `KUFE_GPU=1` demands one.

use kufe_fem::gpu::{Device, DeviceCg, Options, Solver};
use kufe_fem::{End, Error, HeldFaces, LowerLayer, PlanewiseDiagonal, TensorOperator, cg};
use kufe_mesh::TensorGrid;

fn device() -> Option<Device> {
    match Device::open() {
        Ok(device) => Some(device),
        Err(Error::NoAdapter) if std::env::var_os("KUFE_GPU").is_none() => {
            kufe_outside::missing("there is no Vulkan/Metal/DX12 adapter");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// Nodes whose cells grow from the contact on, up to a thousand times as large.
fn graded(cells: usize, growth: f64) -> Vec<f64> {
    let mut nodes = vec![0.0];
    let mut h = 1e-4;
    for _ in 0..cells {
        nodes.push(nodes[nodes.len() - 1] + h);
        h *= growth;
    }
    nodes
}

/// Grids of no whole tiles, held as a contact's block is (two planes of symmetry, the outer faces), as a half of it, and on
/// single faces; in one material and two. Elimination goes towards both ends.
fn problems() -> Vec<(TensorOperator, End)> {
    let quarter: HeldFaces =
        std::array::from_fn(|c| [[c == 0, true], [c == 1, true], [true, false]]);
    let half: HeldFaces = std::array::from_fn(|c| [[c == 0, true], [true, true], [false, true]]);
    let mut single = [[[false; 2]; 3]; 3];
    (single[0][0], single[1][1], single[2][2]) = ([true, false], [false, true], [true, false]);
    let cases = [
        ([17, 5, 9], [1.5, 1.2, 1.4], quarter, End::High),
        ([33, 32, 11], [1.22, 1.23, 1.6], quarter, End::High),
        ([40, 9, 26], [1.18, 1.1, 1.3], half, End::Low),
        ([2, 37, 18], [1.1, 1.2, 1.1], single, End::High),
    ];
    let mut problems = Vec::new();
    for (cells, growth, held, end) in cases {
        let [x, y, z] = [0, 1, 2].map(|axis| graded(cells[axis], growth[axis]));
        let grid = match end {
            // The finest planes lie at the contact.
            End::High => TensorGrid {
                x,
                y,
                z: z.iter().rev().map(|v| -v).collect(),
            },
            End::Low => TensorGrid { x, y, z },
        };
        let operator = TensorOperator::new(&grid, 6.6e9, 3.4e9, held);
        let lower = LowerLayer {
            cells: cells[2] / 3,
            lambda: 8.3e9,
            mu: 12.5e9,
        };
        problems.push((operator.clone(), end));
        problems.push((operator.on_layer(lower), end));
    }
    problems
}

fn numbers(n: usize, step: f64) -> Vec<f64> {
    (0..n).map(|i| (step * i as f64).sin()).collect()
}

/// The diagonal of K, or more where two materials meet: single entries of a row are below it.
fn diagonal(operator: &TensorOperator) -> Vec<f64> {
    let [nx, ny, nz] = operator.shape();
    let lower = operator.lower_layer();
    let mu = lower.map_or(operator.mu, |l| l.mu.max(operator.mu));
    let lambda = lower.map_or(operator.lambda, |l| l.lambda.max(operator.lambda));
    let mut diagonal = Vec::new();
    for c in 0..3 {
        for node in 0..nx * ny * nz {
            let place = [node % nx, node / nx % ny, node / (nx * ny)];
            let terms = [0, 1, 2].map(|of| {
                let along = |axis: usize| {
                    let (stiffness, mass) =
                        (&operator.axes[axis].stiffness, &operator.axes[axis].mass);
                    let matrix = if axis == of { stiffness } else { mass };
                    matrix[place[axis]][1]
                };
                let modulus = if of == c { lambda + 2.0 * mu } else { mu };
                modulus * along(0) * along(1) * along(2)
            });
            diagonal.push(terms.iter().sum());
        }
    }
    diagonal
}

#[test]
fn stiffness_is_the_operators_to_single_precision() {
    let Some(device) = device() else { return };
    for (operator, end) in problems() {
        let layered = PlanewiseDiagonal::new(&operator, end);
        let mut kernels = DeviceCg::new(&device, &operator, &layered).unwrap();
        let n = 3 * operator.node_count();
        let diagonal = diagonal(&operator);
        for (size, step) in [(1.0, 1.3), (1e-250, 0.01), (1e250, 2.9)] {
            let u: Vec<f64> = numbers(n, step).iter().map(|v| size * v).collect();
            let (mut expected, mut found) = (vec![0.0; n], vec![f64::NAN; n]);
            operator.apply(&u, &mut expected);
            kernels.apply(&u, &mut found).unwrap();
            let mut worst = 0.0f64;
            for ((expected, found), diagonal) in expected.iter().zip(&found).zip(&diagonal) {
                let error = (expected - found).abs() / (size * diagonal);
                worst = worst.max(error);
                assert_eq!(*expected == 0.0, *found == 0.0, "{expected} {found}");
            }
            assert!(worst < 2e-6, "{:?}: {worst:e}", operator.shape());
        }
    }
}

#[test]
fn preconditioner_is_that_of_layers_to_single_precision() {
    let Some(device) = device() else { return };
    for (operator, end) in problems() {
        let layered = PlanewiseDiagonal::new(&operator, end);
        let mut kernels = DeviceCg::new(&device, &operator, &layered).unwrap();
        let n = 3 * operator.node_count();
        let mut modal = vec![0.0; layered.mode_count()];
        for (size, step) in [(1.0, 1.3), (1e-250, 0.01), (1e250, 2.9)] {
            let r: Vec<f64> = numbers(n, step).iter().map(|v| size * v).collect();
            let (mut expected, mut found) = (vec![0.0; n], vec![f64::NAN; n]);
            layered.apply(&r, &mut expected, &mut modal);
            kernels.precondition(&r, &mut found).unwrap();
            for (expected, found) in expected.chunks(n / 3).zip(found.chunks(n / 3)) {
                let worst = largest_difference(expected, found);
                assert!(worst < 1e-5, "{:?}: {worst:e}", operator.shape());
            }
        }
    }
}

/// Lengths and moduli whose products no number of single precision holds.
#[test]
fn units_of_the_caller_do_not_matter() {
    let Some(device) = device() else { return };
    for (length, modulus) in [(1e-20, 1e-40), (1e15, 1e90)] {
        let axis = |cells: usize| graded(cells, 1.3).iter().map(|v| length * v).collect();
        let grid = TensorGrid {
            x: axis(12),
            y: axis(7),
            z: axis(9),
        };
        let held = [[[false, true], [true, false], [true, false]]; 3];
        let operator = TensorOperator::new(&grid, 2.0 * modulus, modulus, held);
        let layered = PlanewiseDiagonal::new(&operator, End::High);
        let mut kernels = DeviceCg::new(&device, &operator, &layered).unwrap();
        let n = 3 * operator.node_count();
        let v = masked(&operator, 0.7, 1.0);
        let mut modal = vec![0.0; layered.mode_count()];
        let [mut expected, mut found] = [(); 2].map(|()| vec![0.0; n]);
        operator.apply(&v, &mut expected);
        kernels.apply(&v, &mut found).unwrap();
        assert!(largest_difference(&expected, &found) < 1e-6);
        layered.apply(&v, &mut expected, &mut modal);
        kernels.precondition(&v, &mut found).unwrap();
        assert!(largest_difference(&expected, &found) < 1e-5);
    }
}

/// In parts of the largest number.
fn largest_difference(expected: &[f64], found: &[f64]) -> f64 {
    let largest = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    let differences = expected.iter().zip(found).map(|(e, f)| (e - f).abs());
    differences.fold(0.0, f64::max) / largest
}

#[test]
fn grids_beyond_the_device_are_refused_with_its_limit() {
    let Some(device) = device() else { return };
    let planes = 1 << 17;
    let grid = TensorGrid {
        x: vec![0.0, 1.0],
        y: vec![0.0, 1.0],
        z: (0..planes).map(f64::from).collect(),
    };
    let held = [[[false; 2], [false; 2], [true, false]]; 3];
    let operator = TensorOperator::new(&grid, 2.0, 1.0, held);
    let layered = PlanewiseDiagonal::new(&operator, End::High);
    let error = DeviceCg::new(&device, &operator, &layered).err();
    let Some(Error::DeviceLimit { needed, limit, .. }) = error else {
        // A device that starts so many groups.
        assert_eq!(error, None);
        return;
    };
    assert!(needed == planes as u64 - 1 && limit < needed, "{error:?}");
}

fn masked(operator: &TensorOperator, step: f64, size: f64) -> Vec<f64> {
    let mut b = numbers(3 * operator.node_count(), step);
    operator.mask(&mut b);
    b.iter().map(|v| size * v).collect()
}

/// Also from sizes that no number of single precision has. Solutions are compared in the energy norm: by its residual a
/// solve to 1e-12 is only as close as the condition of K lets it be.
#[test]
fn refined_solves_are_those_of_double_precision() {
    let Some(device) = device() else { return };
    // Each grid once, in one material or two.
    for place in [0, 3, 4, 7] {
        let (operator, end) = problems().swap_remove(place);
        let layered = PlanewiseDiagonal::new(&operator, end);
        let mut solver = Solver::new(&device, &operator, &layered).unwrap();
        let mut modal = vec![0.0; layered.mode_count()];
        let [mut x, mut kx] = [(); 2].map(|()| vec![0.0; 3 * operator.node_count()]);
        for (tolerance, size) in [(1e-6, 1e-250), (1e-10, 1.0), (1e-12, 1e250)] {
            let b = masked(&operator, 0.37, size);
            x.fill(0.0);
            let options = Options {
                tolerance,
                ..Options::default()
            };
            let history = solver.solve(&b, &mut x, &options).unwrap();
            operator.apply(&x, &mut kx);
            let squares =
                |v: &mut dyn Iterator<Item = f64>| v.map(|v| (v / size).powi(2)).sum::<f64>();
            let left = squares(&mut b.iter().zip(&kx).map(|(b, kx)| b - kx)).sqrt();
            let residual = left / squares(&mut b.iter().copied()).sqrt();
            assert!(residual <= tolerance, "{residual:e}");
            assert!((history.residuals.last().unwrap() - residual).abs() < 1e-14);

            let mut expected = vec![0.0; b.len()];
            let options = cg::Options {
                stop: cg::Stop::Residual(1e-13),
                ..cg::Options::default()
            };
            let apply = |v: &[f64], out: &mut [f64]| operator.apply(v, out);
            let precondition = |r: &[f64], z: &mut [f64]| layered.apply(r, z, &mut modal);
            // The same direction of b at a size whose squares are numbers.
            let plain: Vec<f64> = b.iter().map(|b| b / size).collect();
            let by_double = cg::solve(
                apply,
                precondition,
                &plain,
                &mut expected,
                &mut Default::default(),
                &options,
            )
            .unwrap();
            let energy =
                |v: &[f64], kv: &[f64]| v.iter().zip(kv).map(|(v, kv)| v * kv).sum::<f64>();
            let difference: Vec<f64> = x.iter().zip(&expected).map(|(x, e)| x / size - e).collect();
            operator.apply(&difference, &mut kx);
            let error = energy(&difference, &kx).sqrt();
            operator.apply(&expected, &mut kx);
            let error = error / energy(&expected, &kx).sqrt();
            assert!(error < 20.0 * tolerance, "{error:e}");
            // Beginning anew with every correction costs a few iterations.
            let steps = by_double.residuals.iter().position(|r| *r <= tolerance);
            let most = 1.3 * steps.unwrap() as f64 + 2.0;
            assert!((history.iterations as f64) < most, "{history:?}, {steps:?}");
        }
    }
}

#[test]
fn two_solves_of_one_problem_have_the_same_bits() {
    let Some(device) = device() else { return };
    let (operator, end) = problems().swap_remove(4);
    let layered = PlanewiseDiagonal::new(&operator, end);
    let b = masked(&operator, 0.11, 1.0);
    let solve = |device: &Device| {
        let mut solver = Solver::new(device, &operator, &layered).unwrap();
        let mut x = vec![0.0; b.len()];
        solver.solve(&b, &mut x, &Options::default()).unwrap();
        let again = x.clone();
        x.fill(0.0);
        solver.solve(&b, &mut x, &Options::default()).unwrap();
        assert!(x == again && x.iter().any(|v| *v != 0.0));
        x
    };
    let first = solve(&device);
    assert!(first == solve(&Device::open().unwrap()));
}

#[test]
fn what_cannot_be_solved_is_an_error_with_its_numbers() {
    let Some(device) = device() else { return };
    let (operator, end) = problems().swap_remove(0);
    let layered = PlanewiseDiagonal::new(&operator, end);
    let mut solver = Solver::new(&device, &operator, &layered).unwrap();
    let mut b = masked(&operator, 0.2, 1.0);
    let mut x = vec![0.0; b.len()];
    let few = Options {
        tolerance: 1e-10,
        max_iterations: 4,
    };
    let error = solver.solve(&b, &mut x, &few).unwrap_err();
    assert!(
        matches!(error, Error::NotConverged { iterations: 4, residual, .. } if residual > 1e-10),
        "{error}"
    );
    // Beyond rounding there is nothing to gain.
    let beyond = Options {
        tolerance: 1e-19,
        ..Options::default()
    };
    let error = solver.solve(&b, &mut x, &beyond).unwrap_err();
    assert!(
        matches!(error, Error::NotConverged { residual, .. } if residual < 1e-13),
        "{error}"
    );
    b[0] = f64::NAN;
    let error = solver.solve(&b, &mut x, &Options::default()).unwrap_err();
    assert!(matches!(error, Error::Indefinite { energy, .. } if energy.is_nan()));
    b.fill(0.0);
    x.fill(0.0);
    let history = solver.solve(&b, &mut x, &Options::default()).unwrap();
    assert_eq!((history.iterations, history.residuals), (0, vec![0.0]));
}
