//! Agreement with exact responses, and determinism.

use kufe_contact::{ElasticRunner, Foundation, Load, Mount, Options, Place, Solution, Tilt, solve};
use kufe_mesh::{BobRunner, Paraboloid};
use kufe_tests::contact::on_half_space;
use kufe_tests::exact_response::by_exact_responses;

#[test]
fn forces_agree_with_exact_responses_to_1e_6() {
    let hull = Paraboloid::new(0.02, 0.01).unwrap();
    let found = by_exact_responses(&on_half_space(hull, 500.0), 5);
    assert!(found.force < 1e-6 && found.motion < 1e-6);
    assert!(found.nodes[0] > 15 && found.nodes[1] == 0);
}

/// On a small mesh, on one of 840,000 unknowns, and with an elastic runner fixed at two places.
#[test]
fn one_and_two_threads_give_the_same_bits() {
    let small = on_half_space(Paraboloid::new(0.02, 0.01).unwrap(), 500.0);
    let mut large = on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1000.0);
    large.ice.foundation = Foundation::RigidBed { thickness: 0.05 };
    let mut fixed = on_half_space(BobRunner::default().swept().unwrap(), 1000.0);
    fixed.ice = large.ice.clone();
    fixed.runner.elastic = Some(ElasticRunner {
        mount: Mount::Places([-0.3, 0.3].map(|x| Place { x, length: 0.05 }).to_vec()),
        ..ElasticRunner::fixed_at_top(210e9, 0.3, 0.03)
    });
    for (problem, cells, least) in [(small, 8, 1e4), (large, 24, 8e5), (fixed, 3, 1e4)] {
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
        assert!(one.volume.is_some() && one.volume == two.volume);
        assert_eq!(
            (one.p_max, one.approach, one.area),
            (two.p_max, two.approach, two.area)
        );
    }
}

/// An offset load on yielding ice: approach and pitch are unknown, and nodes are open, closed or
/// yielding.
#[test]
fn tilt_and_yielding_nodes_agree_with_exact_responses_to_1e_6() {
    let hull = Paraboloid::new(0.02, 0.01).unwrap();
    let mut problem = on_half_space(hull, 500.0);
    problem.load = Load::Force {
        fz: 500.0,
        offset_x: 0.5e-3,
        offset_y: 0.0,
        tilt: Tilt::Free,
    };
    let elastic = by_exact_responses(&problem, 4);
    problem.ice.hardness = Some(0.8 * elastic.solution.p_max);
    let found = by_exact_responses(&problem, 4);
    assert!(found.force < 1e-6 && found.motion < 1e-6);
    assert!(found.solution.pitch > 1e-3 && found.nodes[1] > 3);
    assert!(found.solution.p_max < elastic.solution.p_max);
}
