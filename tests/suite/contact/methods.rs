//! One problem, three ways to solve it; and the same bits whatever the number of threads.

use kufe_contact::{Error, Ice, Load, Method, Options, Solution, Tilt, solve};
use kufe_mesh::Paraboloid;
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

/// On meshes of two sizes: the second has more than 400 nodes along an axis and half a million unknowns.
#[test]
fn one_and_two_threads_give_the_same_bits() {
    let needle = || Paraboloid::new(30.0, 0.005).unwrap();
    let small = on_half_space(Paraboloid::new(0.02, 0.01).unwrap(), 500.0);
    for (problem, cells, least) in [(small, 8, 1e4), (on_half_space(needle(), 1000.0), 20, 4e5)] {
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
        println!(
            "{} unknowns, {:?} nodes",
            one.dofs,
            (
                one.volume.grid.x.len(),
                one.volume.grid.y.len(),
                one.volume.grid.z.len()
            )
        );
        assert!(one.dofs as f64 > least, "{} unknowns", one.dofs);
        let bits = |s: &Solution| -> Vec<u64> {
            let pressure = s.surface.pressure.iter();
            pressure.map(|p| p.to_bits()).collect()
        };
        assert_eq!(bits(&one), bits(&two));
        assert_eq!(one.volume.displacement, two.volume.displacement);
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
}

/// What no file can state, since its reader refuses it: a program that calls the library can.
#[test]
fn what_is_no_number_or_nothing_is_an_error() {
    let hull = || Paraboloid::new(0.02, 0.01).unwrap();
    let good = on_half_space(hull(), 500.0);
    let options = |cells| Options {
        cells,
        ..Options::default()
    };
    let tilted = |pitch, roll| Load::central(500.0, Tilt::Fixed { pitch, roll });
    let loads = [
        tilted(f64::NAN, 0.0),
        tilted(0.0, f64::NAN),
        tilted(0.0, f64::INFINITY),
        Load::central(f64::NAN, Tilt::Free),
    ];
    for load in loads {
        let mut problem = good.clone();
        problem.load = load;
        let refused = solve(&problem, &options(None));
        assert!(matches!(refused, Err(Error::OutOfRange { .. })), "{load:?}");
    }
    let mut thin = good.clone();
    thin.ice = Ice::half_space(f64::NAN, 0.3);
    assert!(solve(&thin, &options(None)).is_err());
    let refused = solve(&good, &options(Some(0)));
    assert!(matches!(refused, Err(Error::OutOfRange { .. })));
}
