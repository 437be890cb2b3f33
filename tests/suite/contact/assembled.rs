//! The assembled stiffness: agreement with the matrix-free operator, and its memory limit.

use std::sync::Arc;

use kufe_contact::{
    Bed, ElasticRunner, Error, Foundation, Ice, Load, Mount, Options, Place, Problem, Runner,
    RunnerSolid, Solution, StiffnessForm, Tilt, solve,
};
use kufe_fem::{Material, TensorOperator};
use kufe_mesh::{BobRunner, Paraboloid, Underside};
use kufe_tests::contact::{Formula, ICE_E, ICE_NU, on_half_space};
use kufe_tests::meshes::block;

const STEEL: (f64, f64) = (210e9, 0.3);

fn options(stiffness: StiffnessForm) -> Options {
    Options {
        cells: Some(3),
        residual: 1e-12,
        stiffness,
        ..Options::default()
    }
}

/// A short runner that bends, on a layer on a rigid bed.
fn bending(mount: Mount) -> Problem {
    let bob = BobRunner {
        length: 0.3,
        rocker_radius: 8.0,
        height: 0.02,
        ..BobRunner::default()
    };
    let elastic = ElasticRunner {
        mount,
        ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, bob.height)
    };
    on_layer(Arc::new(bob.swept().unwrap()), elastic)
}

fn on_layer(underside: Arc<dyn Underside>, elastic: ElasticRunner) -> Problem {
    let runner = Runner {
        underside,
        elastic: Some(elastic),
    };
    let ice = Ice {
        foundation: Foundation::RigidBed { thickness: 0.02 },
        ..Ice::half_space(ICE_E, ICE_NU)
    };
    Problem::new(runner, ice, Load::central(800.0, Tilt::LEVEL))
}

fn rigid() -> Problem {
    on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1000.0)
}

/// A block of steel with its own mesh of hexahedra.
fn on_own_hexahedra() -> Problem {
    let (a, b, height) = (0.02, 0.005, 0.02);
    let underneath = |x: f64, y: f64| x * x / (2.0 * 0.5) + y * y / (2.0 * 0.05);
    let mut mesh = block([8, 4, 3], [2.0 * a, 2.0 * b, height]);
    for p in &mut mesh.points {
        p[0] -= a;
        p[1] -= b;
        p[2] += (1.0 - p[2] / height) * underneath(p[0], p[1]);
    }
    let hull = Formula {
        height: move |x: f64, y: f64| {
            if x.abs() <= a && y.abs() <= b {
                underneath(x, y)
            } else {
                f64::INFINITY
            }
        },
        extent: [-a, a, -b, b],
        symmetric: [false; 2],
    };
    let solid = RunnerSolid::new(mesh, STEEL.0, STEEL.1, |p| p[2] > height - 1e-9).unwrap();
    let elastic = ElasticRunner {
        solid: Some(Arc::new(solid)),
        ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, 0.0)
    };
    on_layer(Arc::new(hull), elastic)
}

/// The solutions with both forms of the stiffness. Asserts a relative difference of displacements
/// and peak pressures below 1e-8.
fn compared(problem: &Problem) -> (Solution, Solution) {
    let free = solve(problem, &options(StiffnessForm::MatrixFree)).unwrap();
    let stored = solve(problem, &options(StiffnessForm::Assembled)).unwrap();
    assert!(free.assembled.is_empty());
    let ice = [&free, &stored].map(|s| s.volume.as_ref().unwrap().displacement.as_flattened());
    let runner = [&free, &stored].map(|s| {
        let field = s.runner_volume.as_ref();
        field.map_or(&[][..], |field| field.displacement.as_flattened())
    });
    for [free, stored] in [ice, runner] {
        assert_eq!(free.len(), stored.len());
        let size = free.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        let pairs = free.iter().zip(stored);
        let worst = pairs.fold(0.0f64, |m, (a, b)| m.max((a - b).abs()));
        println!("displacements differ by {:.1e}", worst / size);
        assert!(worst <= 1e-8 * size, "{worst} of {size}");
    }
    let peaks = stored.p_max / free.p_max - 1.0;
    println!(
        "peaks by {peaks:.1e}; {} and {} iterations",
        free.iterations, stored.iterations
    );
    assert!(peaks.abs() < 1e-8, "{peaks}");
    (free, stored)
}

#[test]
fn stiffness_forms_agree_for_a_rigid_runner() {
    let (_, stored) = compared(&rigid());
    let [ice] = &stored.assembled[..] else {
        panic!("{} bodies", stored.assembled.len());
    };
    assert_eq!(
        ice.stiffness.dofs(),
        3 * stored.volume.unwrap().displacement.len(),
        "every node of the ice"
    );
    assert_eq!(ice.stiffness.dofs() - ice.fixed.len(), stored.dofs);
}

#[test]
fn stiffness_forms_agree_for_a_runner_fixed_at_its_top() {
    let (_, stored) = compared(&bending(Mount::Top));
    let free: usize = stored
        .assembled
        .iter()
        .map(|body| body.stiffness.dofs() - body.fixed.len())
        .sum();
    assert_eq!((stored.assembled.len(), free), (2, stored.dofs));
}

#[test]
fn stiffness_forms_agree_for_a_runner_fixed_at_two_places() {
    let places = [(-0.08, 0.02), (0.08, 0.02)].map(|(x, length)| Place { x, length });
    compared(&bending(Mount::Places(places.to_vec())));
}

#[test]
fn stiffness_forms_agree_for_ice_on_an_elastic_bed() {
    let mut problem = rigid();
    problem.ice.foundation = Foundation::ElasticBed {
        thickness: 0.005,
        bed: Bed {
            youngs_modulus: 30e9,
            poissons_ratio: 0.2,
            thickness: 0.02,
        },
    };
    compared(&problem);
}

#[test]
fn stiffness_forms_agree_for_a_meshed_runner() {
    let (_, stored) = compared(&on_own_hexahedra());
    assert_eq!(stored.assembled[1].name, "runner");
}

#[test]
fn products_of_the_assembled_ice_agree_with_its_tensor_operator_to_1e_12() {
    let stored = solve(&rigid(), &options(StiffnessForm::Assembled)).unwrap();
    let ice = Material::new(ICE_E, ICE_NU).unwrap();
    let free = [[[false; 2]; 3]; 3];
    let grid = &stored.volume.as_ref().unwrap().grid;
    let operator = TensorOperator::new(grid, ice, free);
    let n = 3 * grid.node_count();
    let u: Vec<f64> = (0..n).map(|i| (0.37 * i as f64).sin()).collect();
    let (mut expected, mut found) = (vec![0.0; n], vec![f64::NAN; n]);
    operator.apply(&u, &mut expected);
    stored.assembled[0].stiffness.apply(&u, &mut found);
    let size = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
    for (expected, found) in expected.iter().zip(&found) {
        assert!((expected - found).abs() < 1e-12 * size);
    }
}

#[test]
fn stiffness_above_the_memory_limit_returns_needed_bytes_and_limit() {
    let few = Options {
        max_stiffness_bytes: 100_000,
        ..options(StiffnessForm::Assembled)
    };
    let error = solve(&rigid(), &few).unwrap_err();
    let Error::StiffnessTooLarge {
        dofs,
        needed,
        limit,
    } = error
    else {
        panic!("{error}");
    };
    assert_eq!(limit, 100_000);
    // About 27 neighbours a node, fewer at the faces.
    let bytes_per_dof = needed as f64 / dofs as f64;
    assert!((400.0..710.0).contains(&bytes_per_dof), "{needed}");
}
