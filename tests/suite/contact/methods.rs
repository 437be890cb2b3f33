//! One problem, three ways to solve it; and the same bits whatever the number of threads.

use kufe_contact::{
    ElasticRunner, Error, Foundation, Load, Method, Mount, Options, Place, Solution, Tilt, solve,
};
use kufe_mesh::{BobRunner, Paraboloid};
use kufe_tests::contact::on_half_space;

fn solved(method: Method, cells: usize) -> Solution {
    let hull = Paraboloid::new(0.02, 0.01).unwrap();
    solve(&on_half_space(hull, 500.0), &with(method, cells)).unwrap()
}

fn with(method: Method, cells: usize) -> Options {
    Options {
        cells: Some(cells),
        method,
        residual: 1e-11,
        ..Options::default()
    }
}

fn largest_difference(a: &Solution, b: &Solution) -> f64 {
    assert_eq!(a.surface.pressure.len(), b.surface.pressure.len());
    let difference = a
        .surface
        .pressure
        .iter()
        .zip(&b.surface.pressure)
        .map(|(a, b)| (a - b).abs());
    difference.fold(0.0, f64::max) / a.p_max
}

#[test]
fn cholesky_active_set_gives_the_same_pressures_to_1e_6() {
    let (fast, slow) = (
        solved(Method::Accelerated, 5),
        solved(Method::CholeskyActiveSet, 5),
    );
    assert!(
        largest_difference(&fast, &slow) < 1e-6,
        "{:.1e}",
        largest_difference(&fast, &slow)
    );
    assert!((fast.approach / slow.approach - 1.0).abs() < 1e-6);
}

#[test]
fn plain_psor_on_the_stiffness_gives_the_same_pressures_to_1e_6() {
    let (fast, slow) = (solved(Method::Accelerated, 3), solved(Method::PlainSor, 3));
    assert!(
        largest_difference(&fast, &slow) < 1e-6,
        "{:.1e}",
        largest_difference(&fast, &slow)
    );
    assert!((fast.fz / slow.fz - 1.0).abs() < 1e-6);
    assert!((fast.approach / slow.approach - 1.0).abs() < 1e-6);
}

/// On meshes of two sizes, of 840,000 unknowns the larger one, and under a runner that places hold.
#[test]
fn one_and_two_threads_give_the_same_bits() {
    let small = on_half_space(Paraboloid::new(0.02, 0.01).unwrap(), 500.0);
    let mut large = on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1000.0);
    large.ice.foundation = Foundation::RigidBed { thickness: 0.05 };
    let mut held = on_half_space(BobRunner::default().swept().unwrap(), 1000.0);
    held.ice = large.ice.clone();
    held.runner.elastic = Some(ElasticRunner {
        mount: Mount::Places([-0.3, 0.3].map(|x| Place { x, length: 0.05 }).to_vec()),
        ..ElasticRunner::held_at_top(210e9, 0.3, 0.03)
    });
    for (problem, cells, least) in [(small, 8, 1e4), (large, 24, 8e5), (held, 3, 1e4)] {
        let on = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
            let pool = pool.build().unwrap();
            let options = Options {
                cells: Some(cells),
                ..Options::default()
            };
            pool.install(|| solve(&problem, &options).unwrap())
        };
        let (one, two) = (on(1), on(2));
        assert!(one.dofs as f64 > least, "{} unknowns", one.dofs);
        let bits = |s: &Solution| -> Vec<u64> {
            let pressure = s.surface.pressure.iter();
            pressure.map(|p| p.to_bits()).collect()
        };
        assert!(bits(&one) == bits(&two), "{} unknowns", one.dofs);
        assert!(one.volume.displacement == two.volume.displacement);
        assert_eq!(
            (one.p_max, one.approach, one.area),
            (two.p_max, two.approach, two.area)
        );
    }
}

/// Off its middle, so that the runner tilts, on ice that yields: a motion of two numbers and three kinds of nodes.
#[test]
fn cholesky_active_set_finds_tilt_and_yielding_nodes_by_itself() {
    let hull = Paraboloid::new(0.02, 0.01).unwrap();
    let mut problem = on_half_space(hull, 500.0);
    problem.load = Load::Force {
        fz: 500.0,
        offset_x: 0.5e-3,
        offset_y: 0.0,
        tilt: Tilt::Free,
    };
    let elastic = solve(&problem, &with(Method::Accelerated, 4)).unwrap();
    problem.ice.hardness = Some(0.8 * elastic.p_max);
    let by = |method| solve(&problem, &with(method, 4)).unwrap();
    let (fast, slow) = (by(Method::Accelerated), by(Method::CholeskyActiveSet));
    let difference = largest_difference(&fast, &slow);
    assert!(difference < 1e-6, "{difference:.1e}");
    assert!((fast.approach / slow.approach - 1.0).abs() < 1e-6);
    assert!(fast.pitch > 1e-3 && (fast.pitch / slow.pitch - 1.0).abs() < 1e-6);
    assert!(fast.p_max < elastic.p_max);
    let refused = solve(&problem, &with(Method::PlainSor, 4));
    assert!(matches!(
        refused,
        Err(Error::OutOfRange {
            name: "ice hardness",
            ..
        })
    ));
}
