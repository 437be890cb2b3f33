//! Agreement of the solvers, balance of loads and reactions, determinism.

use kufe_fem::{Body, Constraints, ElementKind, Material, Section};
use kufe_tests::fem::cg;
use kufe_tests::fem::loads::{add_body_force, add_pressure, add_traction};
use kufe_tests::fem::statics::{Equilibrium, Solver, equilibrium};
use kufe_tests::meshes::{block, faces_where, nodes_where, shake};

const CELLS: [usize; 3] = [9, 6, 7];
const SIZE: [f64; 3] = [0.3, 0.1, 0.15];

/// A distorted mesh of ice on stone with both elements, prescribed displacement and tilt at its
/// bottom, and every kind of load.
fn problem() -> (Body, Constraints, Vec<f64>) {
    let mut mesh = block(CELLS, SIZE);
    shake(&mut mesh, CELLS, SIZE, [0.2; 3]);
    let (ice, stone) = (
        Material::new(9.0e9, 0.33).unwrap(),
        Material::new(30.0e9, 0.2).unwrap(),
    );
    let sections = (0..mesh.cells.len())
        .map(|cell| Section {
            material: if cell < mesh.cells.len() / 2 {
                stone
            } else {
                ice
            },
            kind: [ElementKind::Hex8, ElementKind::Hex8Incompatible][cell % 2],
        })
        .collect();
    let mut constraints = Constraints::new(mesh.points.len());
    for node in nodes_where(&mesh, |p| p[2] == 0.0) {
        constraints.prescribe(node, 0, 0.0).unwrap();
        constraints.prescribe(node, 1, 1e-6).unwrap();
        constraints
            .prescribe(node, 2, -1e-5 - 1e-4 * mesh.points[node][0])
            .unwrap();
    }
    constraints
        .symmetry(nodes_where(&mesh, |p| p[1] == SIZE[1] && p[2] > 0.0), 1)
        .unwrap();
    let top = faces_where(&mesh, |p| p[2] == SIZE[2]);
    let side = faces_where(&mesh, |p| p[0] == SIZE[0]);
    let body = Body::new(mesh, sections).unwrap();
    let mut loads = vec![0.0; body.dofs()];
    add_pressure(body.mesh(), &top, |p| 1.0e6 * (1.0 + p[0]), &mut loads);
    add_traction(
        body.mesh(),
        &side,
        |p| [2.0e5, 1.0e5 * p[1], -3.0e5],
        &mut loads,
    );
    add_body_force(&body, |_| [0.0, 0.0, -917.0 * 9.81], &mut loads);
    (body, constraints, loads)
}

fn solve(solver: Solver) -> Equilibrium {
    let (body, constraints, loads) = problem();
    equilibrium(&body, &constraints, &loads, solver).unwrap()
}

fn iterative() -> Solver {
    Solver::ConjugateGradients(cg::Options {
        stop: cg::Stop::Residual(1e-12),
        ..Default::default()
    })
}

#[test]
fn cholesky_and_conjugate_gradients_agree_to_1e_8() {
    let (direct, iterated) = (solve(Solver::Cholesky), solve(iterative()));
    for (a, b) in [
        (&direct.displacement, &iterated.displacement),
        (&direct.reaction, &iterated.reaction),
    ] {
        let size = a.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        let difference = a
            .iter()
            .zip(b)
            .fold(0.0f64, |s, (a, b)| s.max((a - b).abs()));
        assert!(difference < 1e-8 * size, "{}", difference / size);
    }
    assert!(iterated.history.iterations > 10);
}

#[test]
fn reactions_balance_loads_in_force_and_moment() {
    let (body, constraints, loads) = problem();
    let state = equilibrium(&body, &constraints, &loads, Solver::Cholesky).unwrap();
    let total = |f: &[f64]| -> [f64; 6] {
        let mut sum = [0.0; 6];
        for (x, f) in body.mesh().points.iter().zip(f.chunks_exact(3)) {
            for i in 0..3 {
                let (p, q) = ((i + 1) % 3, (i + 2) % 3);
                sum[i] += f[i];
                sum[3 + i] += x[p] * f[q] - x[q] * f[p];
            }
        }
        sum
    };
    let (applied, reactions) = (total(&loads), total(&state.reaction));
    let force = applied[2].abs();
    for i in 0..6 {
        assert!(
            (applied[i] + reactions[i]).abs() < 1e-9 * force,
            "{i}: {} {}",
            applied[i],
            reactions[i]
        );
    }
    for node in nodes_where(body.mesh(), |p| p[2] > 0.0 && p[1] < SIZE[1]) {
        assert_eq!(state.reaction[3 * node..3 * node + 3], [0.0; 3]);
    }
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    for solver in [Solver::Cholesky, iterative()] {
        let with = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            let state = pool.install(|| solve(solver));
            let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
            (bits(&state.displacement), bits(&state.reaction))
        };
        assert!(with(1) == with(2));
    }
}

#[test]
fn quarter_with_symmetry_planes_has_the_displacements_of_the_whole_block() {
    let material = Material::new(9.0e9, 0.33).unwrap();
    let run = |cells: [usize; 3], size: [f64; 3], shift: [f64; 2], planes: bool| {
        let mut mesh = block(cells, size);
        for p in &mut mesh.points {
            p[0] -= shift[0];
            p[1] -= shift[1];
        }
        let mut constraints = Constraints::new(mesh.points.len());
        constraints
            .clamp(nodes_where(&mesh, |p| p[2] == 0.0))
            .unwrap();
        if planes {
            constraints
                .symmetry(nodes_where(&mesh, |p| p[0] == 0.0), 0)
                .unwrap();
            constraints
                .symmetry(nodes_where(&mesh, |p| p[1] == 0.0), 1)
                .unwrap();
        }
        let top = faces_where(&mesh, |p| p[2] == size[2]);
        let body = Body::uniform(mesh, material, ElementKind::Hex8).unwrap();
        let mut loads = vec![0.0; body.dofs()];
        add_pressure(
            body.mesh(),
            &top,
            |p| 1e6 * (p[0] * p[0] + 2.0 * p[1].abs()),
            &mut loads,
        );
        let u = equilibrium(&body, &constraints, &loads, Solver::Cholesky)
            .unwrap()
            .displacement;
        let quarter = nodes_where(body.mesh(), |p| p[0] >= -1e-12 && p[1] >= -1e-12);
        quarter
            .iter()
            .flat_map(|&node| [u[3 * node], u[3 * node + 1], u[3 * node + 2]])
            .collect::<Vec<f64>>()
    };
    let quarter = run([4, 3, 5], [0.5, 0.25, 0.5], [0.0, 0.0], true);
    let whole = run([8, 6, 5], [1.0, 0.5, 0.5], [0.5, 0.25], false);
    let size = whole.iter().fold(0.0f64, |s, v| s.max(v.abs()));
    assert_eq!(quarter.len(), whole.len());
    for (a, b) in quarter.iter().zip(&whole) {
        assert!((a - b).abs() < 1e-12 * size, "{a} {b}");
    }
}
