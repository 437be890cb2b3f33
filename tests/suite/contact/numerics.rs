//! Regression values of the present version of the numerics. Results on disk carry this version, so
//! it must change with the results.

use kufe_contact::{Foundation, Ice, NUMERICS, Options, Problem, Tilt, slide, solve};
use kufe_mesh::{BobRunner, Paraboloid};
use kufe_tests::contact::{ICE_E, ICE_NU, on_half_space};

use super::asperities::on_rough_ice;

/// The version, and its peak pressure [Pa], error of the peak [Pa] and approach [m] of each problem.
const RECORDED: (u32, [[f64; 3]; 5]) = (
    22,
    [
        [1.383_323_919e8, 694_406.204, 1.246_156_263e-5],
        [1.074_944_370e8, 552_295.746, 8.396_038_653e-6],
        [60e6, 0.0, 1.359_928_873e-5],
        [1.545_148_305e8, 998_420.809, 7.504_054_925e-6],
        [2.500_366_286e8, 1_690_403.726, 4.918_946_013e-6],
    ],
);

/// Depth [m], ploughing force [N] and front [m] of the groove in the third problem.
const GROOVE: [f64; 3] = [4.233_356_116e-6, 7.673_649_465e-2, 2.777_781_654e-2];

/// Relative tolerance for differences of processors and orders of summation.
const ROUNDING: f64 = 1e-4;

fn problems() -> [Problem; 5] {
    let paraboloid = || on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1000.0);
    let bob = on_half_space(BobRunner::default().swept().unwrap(), 1000.0);
    let with_ice = |ice: Ice| Problem {
        ice,
        ..paraboloid()
    };
    [
        paraboloid(),
        Problem {
            track_curvature: 1.0 / 40.0,
            ..bob
        },
        with_ice(Ice {
            hardness: Some(60e6),
            ..Ice::half_space(ICE_E, ICE_NU)
        }),
        with_ice(Ice {
            foundation: Foundation::RigidBed { thickness: 2e-3 },
            ..Ice::half_space(ICE_E, ICE_NU)
        }),
        // Many asperities, solved on the contact plane.
        on_rough_ice(Tilt::LEVEL),
    ]
}

#[test]
fn results_are_those_recorded_for_the_version_of_the_numerics() {
    let options = Options {
        p_max_tolerance: 0.02,
        ..Options::default()
    };
    let found = problems().map(|problem| {
        let s = solve(&problem, &options).unwrap();
        [s.p_max, s.p_max_error, s.approach]
    });
    let same = found.as_flattened().iter().zip(RECORDED.1.as_flattened());
    let same = same
        .into_iter()
        .all(|(a, b)| (a - b).abs() <= ROUNDING * b.abs());
    let [_, _, yielding, ..] = problems();
    let slid = slide(&yielding, None, &options).unwrap().groove;
    let groove = [slid.deepest, slid.ploughing, slid.front].map(|figure| figure.value);
    let same = same
        && groove
            .iter()
            .zip(GROOVE)
            .all(|(a, b)| (a - b).abs() <= ROUNDING * b.abs());
    assert!(
        same && RECORDED.0 == NUMERICS,
        "the results differ from those recorded for version {} of the numerics: increase NUMERICS in contact/src/options.rs, and \
         record ({}, {found:?}), {groove:?} here",
        RECORDED.0,
        NUMERICS + 1
    );
}
