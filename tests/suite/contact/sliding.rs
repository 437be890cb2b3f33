//! Steady sliding on yielding ice: the rigid-plastic and elastic limits, boundary elements, and the
//! balance of forces.

use std::sync::Arc;

use kufe_contact::{
    Error, GrooveProfile, Ice, Load, Options, PressureMap, Problem, Runner, SlidingSolution, Tilt,
    hertz, slide,
};
use kufe_mesh::{BobRunner, Paraboloid, Waviness};
use kufe_tests::rigid_plastic::rigid_plastic;

const POISSONS_RATIO: f64 = 0.33;

fn problem([rocker, section]: [f64; 2], fz: f64, hardness: f64, modulus: f64) -> Problem {
    let hull = Paraboloid::new(rocker, section).unwrap();
    let mut ice = Ice::half_space(modulus, POISSONS_RATIO);
    ice.hardness = Some(hardness);
    Problem::new(
        Runner::rigid(Arc::new(hull)),
        ice,
        Load::central(fz, Tilt::LEVEL),
    )
}

fn on(cells: usize) -> Options {
    Options {
        cells: Some(cells),
        ..Options::default()
    }
}

fn near(found: f64, expected: f64, share: f64) -> bool {
    (found / expected - 1.0).abs() <= share
}

#[test]
fn sliding_accuracy_not_reached_returns_the_best_solution_with_its_error() {
    let options = Options {
        max_dofs: 200_000,
        p_max_tolerance: 1e-3,
        ..Options::default()
    };
    let problem = problem([30.0, 0.004], 950.0, 17.7e6, 9e9);
    let Err(Error::SlidingAccuracyNotReached {
        best, tolerance, ..
    }) = slide(&problem, None, &options)
    else {
        panic!("the requested accuracy was reached");
    };
    let found = best.relative_error;
    assert!(found > tolerance && found < 0.2, "{found}");
    // Depth by boundary elements [m], tests/data/groove.csv.
    let depth = best.groove.deepest;
    assert!((depth.value - 3.554e-5).abs() <= depth.error, "{depth:?}");
}

/// Young's modulus is 9000 GPa, so that the elastic recovery is negligible.
#[test]
fn groove_in_stiff_ice_within_1_percent_of_the_rigid_plastic_solution() {
    for (radii, fz, hardness) in [
        ([30.0, 0.004], 950.0, 17.7e6),
        ([24.0, 0.0045], 800.0, 16e6),
    ] {
        let s = slide(&problem(radii, fz, hardness, 9e12), None, &on(12)).unwrap();
        let exact = rigid_plastic(radii[0], radii[1], fz, hardness);
        assert!(
            near(s.groove.front.value, exact.length, 0.01),
            "{:?} {exact:?}",
            s.groove.front
        );
        assert!(
            s.groove.back.value.abs() < 0.01 * exact.length,
            "{:?}",
            s.groove.back
        );
        assert!(
            near(s.groove.deepest.value, exact.depth, 0.01),
            "{:?} {exact:?}",
            s.groove.deepest
        );
        let mu = s.groove.ploughing.value / fz;
        assert!(near(mu, exact.ploughing_friction, 0.01), "{mu} {exact:?}");
        let widest = s
            .groove
            .sections
            .iter()
            .map(|s| s.width)
            .fold(0.0, f64::max);
        assert!(near(widest, exact.width, 0.02), "{widest} {exact:?}");
    }
}

#[test]
fn ice_of_infinite_hardness_has_hertz_contact_and_no_groove() {
    let s = slide(
        &problem([30.0, 0.005], 1000.0, 1e12, 9e9),
        None,
        &Options::default(),
    )
    .unwrap();
    let exact = hertz(30.0, 0.005, 9e9 / (1.0 - POISSONS_RATIO.powi(2)), 1000.0).unwrap();
    assert!(
        near(s.contact.p_max, exact.p_max, 0.01),
        "{} {exact:?}",
        s.contact.p_max
    );
    assert_eq!(
        (s.groove.deepest.value, s.groove.ploughing.value),
        (0.0, 0.0)
    );
    assert!((s.groove.front.value + s.groove.back.value).abs() < 5e-3 * s.groove.front.value);
    assert!(s.groove.load_ahead.value.abs() < 1e-3 * s.groove.front.value);
}

/// References by boundary elements (`python tests/data/groove.py > tests/data/groove.csv`), with an
/// error of 1 % due to their grid.
#[test]
fn grooves_agree_with_boundary_elements() {
    let mut rows = include_str!("../../data/groove.csv").lines();
    let header = "rocker_radius_m,section_radius_m,fz_n,hardness_pa,depth_m,mu_ploughing,load_ahead_m,side_m,front_m";
    assert_eq!(rows.next(), Some(header));
    let mut compared = 0;
    for row in rows {
        let values: Vec<f64> = row.split(',').map(|v| v.parse().unwrap()).collect();
        let [rocker, section, fz, hardness, depth, mu, ahead, side, front] = values[..] else {
            panic!("{row}");
        };
        let s = slide(
            &problem([rocker, section], fz, hardness, 9e9),
            None,
            &Options::default(),
        )
        .unwrap();
        assert!(
            near(s.groove.deepest.value, depth, 0.015),
            "{row}: {:?}",
            s.groove.deepest
        );
        assert!(
            near(s.groove.ploughing.value / fz, mu, 0.02),
            "{row}: {:?}",
            s.groove.ploughing
        );
        assert!(
            near(s.groove.load_ahead.value, ahead, 0.025),
            "{row}: {:?}",
            s.groove.load_ahead
        );
        assert!(
            near(s.groove.front.value, front, 0.015),
            "{row}: {:?}",
            s.groove.front
        );
        let widest = s
            .groove
            .sections
            .iter()
            .map(|s| s.width)
            .fold(0.0, f64::max);
        assert!(near(widest, 2.0 * side, 0.02), "{row}: {widest}");
        assert!(
            s.groove.ploughing.error <= 0.01 * s.groove.ploughing.value,
            "{:?}",
            s.groove.ploughing
        );
        compared += 1;
    }
    assert!(compared >= 2, "{compared} rows");
}

/// Asserts the load balance, the bounds of the pressure, no penetration, and a groove that deepens
/// only where the pressure is the hardness.
fn assert_consistent(s: &SlidingSolution, fz: f64, hardness: f64) {
    assert!(near(s.contact.fz, fz, 1e-6), "{}", s.contact.fz);
    assert!(s.contact.kkt_residual < 1e-5, "{}", s.contact.kkt_residual);
    let field = &s.contact.surface;
    let nx = field.x.len();
    for (row, gaps) in s
        .groove
        .depth
        .chunks_exact(nx)
        .zip(field.gap.chunks_exact(nx))
    {
        assert!(row.windows(2).all(|pair| pair[0] >= pair[1] - 1e-15));
        assert!(gaps.iter().all(|gap| *gap > -1e-5 * s.contact.approach));
    }
    for (k, &p) in field.pressure.iter().enumerate() {
        assert!((0.0..=hardness).contains(&p));
        let deepens =
            k % nx + 1 < nx && s.groove.depth[k] > s.groove.depth[k + 1] * (1.0 + 1e-9) + 1e-12;
        assert!(!deepens || p == hardness, "{} {p}", s.groove.depth[k]);
    }
    // The ploughing force from the plastic work per distance, and from the pressures on the slope of
    // the runner.
    for mesh in &s.groove.meshes {
        assert!(
            near(mesh.plastic_work, mesh.ploughing_by_slope, 0.03),
            "{mesh:?}"
        );
    }
}

#[test]
fn sliding_solution_is_consistent_and_groove_sections_carry_the_load() {
    let s = slide(&problem([30.0, 0.004], 950.0, 17.7e6, 9e9), None, &on(10)).unwrap();
    assert_consistent(&s, 950.0, 17.7e6);
    let strip: f64 = s
        .groove
        .sections
        .windows(2)
        .map(|w| {
            0.5 * (w[0].x - w[1].x) * (w[0].width * w[0].pressure + w[1].width * w[1].pressure)
        })
        .sum();
    assert!(near(strip, 950.0, 0.02), "{strip}");
}

/// The widths of the groove sections and the rim of the map are interpolated between nodes. A rim
/// at nodes would have an error of up to half a cell at either side, 5 % with 12 cells over half the
/// width.
#[test]
fn pressure_map_has_the_widths_of_the_groove_sections_and_the_load() {
    for (radii, fz) in [([30.0, 0.004], 950.0), ([20.0, 0.006], 600.0)] {
        let s = slide(&problem(radii, fz, 17.7e6, 9e9), None, &Options::default()).unwrap();
        let map = PressureMap::of(&s.contact);
        let widest = s.groove.sections.iter().map(|s| s.width);
        let widest = widest.fold(0.0, f64::max);
        let mut off = Vec::new();
        for station in &s.groove.sections {
            // Only where the ice yields; behind, the rim is that of elastic recovery.
            if station.pressure < 17.69e6 || station.width < 0.3 * widest {
                continue;
            }
            let column = ((station.x - map.x0) / map.dx).round() as usize;
            let rows = (0..map.ny).filter(|j| map.pressure[j * map.nx + column] > 0.0);
            let width = rows.count() as f64 * map.dy;
            off.push((width - station.width).abs() / widest);
        }
        let worst = off.iter().copied().fold(0.0, f64::max);
        let mean = off.iter().sum::<f64>() / off.len() as f64;
        assert!(off.len() > 10 && worst < 0.025 && mean < 0.012, "{off:?}");
        let force = map.pressure.iter().sum::<f64>() * map.dx * map.dy;
        let stated = s.contact.p_mean_error / s.contact.p_mean;
        assert!(near(force, fz, stated), "{force} of {fz}, {stated}");
        let touched = map.pressure.iter().filter(|p| **p > 0.0).count();
        let area = touched as f64 * map.dx * map.dy;
        let stations = s.groove.sections.windows(2);
        let strips = stations.map(|w| 0.5 * (w[0].x - w[1].x) * (w[0].width + w[1].width));
        let strips = strips.sum::<f64>();
        assert!(near(area, strips, 0.01), "{area} {strips}");
    }
}

/// The pitch of a circular rocker shifts its contact by the rocker radius times the pitch.
#[test]
fn free_pitch_moves_the_centre_of_pressure_under_the_load() {
    let fixed = slide(&problem([30.0, 0.004], 950.0, 17.7e6, 9e9), None, &on(8)).unwrap();
    let mut free = problem([30.0, 0.004], 950.0, 17.7e6, 9e9);
    free.load = Load::central(950.0, Tilt::Free);
    let s = slide(&free, None, &on(8)).unwrap();
    assert!(s.contact.centre_of_pressure[0].abs() < 1e-8);
    assert!(
        near(-30.0 * s.contact.pitch, s.groove.load_ahead.value, 1e-3),
        "{}",
        s.contact.pitch
    );
    assert!(near(
        s.groove.load_ahead.value,
        fixed.groove.load_ahead.value,
        0.03
    ));
    assert!(near(
        s.groove.deepest.value,
        fixed.groove.deepest.value,
        0.02
    ));
}

#[test]
fn second_runner_has_less_ploughing_and_the_groove_does_not_become_shallower() {
    let problem = problem([30.0, 0.004], 950.0, 17.7e6, 9e9);
    let first = slide(&problem, None, &on(8)).unwrap();
    let second = slide(&problem, Some(&first.groove.profile), &on(8)).unwrap();
    assert_consistent(&second, 950.0, 17.7e6);
    assert!(
        second.groove.ploughing.value < 0.8 * first.groove.ploughing.value,
        "{:?}",
        second.groove.ploughing
    );
    assert!(second.groove.deepest.value >= first.groove.deepest.value);
    assert!(second.groove.front.value < first.groove.front.value);
    // A groove with an offset breaks the mirror symmetry.
    let offset = GrooveProfile::new(vec![0.0, 2e-4, 4e-4], vec![0.0, 2e-5, 0.0]).unwrap();
    let third = slide(&problem, Some(&offset), &on(6)).unwrap();
    assert!(near(third.contact.fz, 950.0, 1e-6));
    assert!(third.contact.centre_of_pressure[1] < -1e-6);
}

#[test]
fn sliding_has_the_same_bits_on_one_and_on_two_threads() {
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .unwrap();
        pool.install(|| slide(&problem([30.0, 0.004], 950.0, 17.7e6, 9e9), None, &on(10)).unwrap())
    };
    let (one, two) = (with(1), with(2));
    assert_eq!(one.groove.depth, two.groove.depth);
    assert_eq!(one.contact.surface.pressure, two.contact.surface.pressure);
    assert_eq!(
        (one.groove.ploughing.value, one.groove.front.value),
        (two.groove.ploughing.value, two.groove.front.value)
    );
}

/// The capacity is the hardness times the area ahead of the lowest point, 0.5 m x 8 mm, plus a small
/// load on the elastically recovered ice behind it.
#[test]
fn load_above_the_capacity_of_the_sliding_hull_returns_the_capacity() {
    let hull = BobRunner {
        section_radius: 0.004,
        width: 0.008,
        ..BobRunner::default()
    };
    let (hardness, area_ahead) = (17.7e6, 0.5 * 0.008);
    for fz in [1.2 * hardness * area_ahead, 3.0 * hardness * area_ahead] {
        let mut problem = problem([30.0, 0.004], fz, hardness, 9e9);
        problem.runner = Runner::rigid(Arc::new(hull.swept().unwrap()));
        match slide(&problem, None, &on(6)) {
            Err(Error::LoadExceedsHardness {
                fz: reported,
                capacity,
            }) => {
                assert!(reported == fz && capacity < fz, "{reported} {capacity}");
                assert!(capacity > 0.95 * hardness * area_ahead, "{capacity}");
            }
            other => panic!("{:?}", other.map(|s| s.groove.deepest)),
        }
    }
}

#[test]
fn sliding_on_waves_or_without_hardness_is_an_error() {
    let mut soft = problem([30.0, 0.004], 950.0, 17.7e6, 9e9);
    soft.ice_surface = Some(Arc::new(Waviness::new(1e-6, 0.1).unwrap()));
    let refused = slide(&soft, None, &Options::default()).unwrap_err();
    assert!(matches!(refused, Error::NotSliding { .. }), "{refused}");
    soft.ice_surface = None;
    soft.ice.hardness = None;
    let refused = slide(&soft, None, &Options::default()).unwrap_err();
    assert!(refused.to_string().contains("hardness"), "{refused}");
}
