//! One problem, three ways to solve it; and the same bits whatever the number of threads.

use kufe_contact::{Error, Ice, Load, Method, Options, Solution, Tilt, solve};
use kufe_mesh::Paraboloid;
use kufe_tests::contact::on_half_space;

fn solved(method: Method, cells: usize) -> Solution {
    let hull = Paraboloid::new(0.02, 0.01).unwrap();
    let options = Options {
        cells: Some(cells),
        method,
        residual: 1e-11,
        ..Options::default()
    };
    solve(&on_half_space(hull, 500.0), &options).unwrap()
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
    assert!(
        (fast.fz / slow.fz - 1.0).abs() < 1e-6,
        "{} against {}",
        fast.fz,
        slow.fz
    );
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| solved(Method::Accelerated, 8))
    };
    let (one, two) = (with(1), with(2));
    let bits = |s: &Solution| {
        s.surface
            .pressure
            .iter()
            .map(|p| p.to_bits())
            .collect::<Vec<_>>()
    };
    assert_eq!(bits(&one), bits(&two));
    assert_eq!(one.volume.displacement, two.volume.displacement);
    assert_eq!(
        (one.p_max, one.approach, one.area),
        (two.p_max, two.approach, two.area)
    );
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
