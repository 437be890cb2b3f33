//! Contacts of many asperities, solved on the contact plane.

use std::f64::consts::PI;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use kufe_contact::{
    Error, Foundation, Ice, Iterate, Load, NextMesh, Options, Problem, Runner, Solution, Tilt,
    hertz, solve,
};
use kufe_mesh::{BobRunner, HeightMap, Paraboloid, Waviness};
use kufe_tests::contact::{ICE_E, ICE_NU, contact_modulus, on_half_space};

fn of_cells(cells: usize) -> Options {
    Options {
        cells: Some(cells),
        ..Options::default()
    }
}

/// Sums over the pixels of a field between two places along x.
fn between(s: &Solution, [from, to]: [f64; 2], of: impl Fn(usize) -> f64) -> f64 {
    let nx = s.surface.x.len();
    let inside = |n: &usize| (from..to).contains(&s.surface.x[n % nx]);
    (0..s.surface.pressure.len()).filter(inside).map(of).sum()
}

/// Westergaard (1939), in K. L. Johnson, Contact Mechanics, section 13.2. For waves of amplitude D and
/// length l, the contact length 2 a of each follows from p_mean = p* sin^2(pi a / l), p* = pi E* D /
/// l, and the peak is 2 (p_mean p*)^(1/2). This applies under a ball whose patch is many waves wide.
#[test]
fn waves_under_a_ball_have_westergaards_contact_length_and_peak() {
    let (radius, length, amplitude) = (1.0, 5e-4, 1e-6);
    let full = PI * contact_modulus() * amplitude / length;
    for load in [300.0, 900.0] {
        let mut problem = on_half_space(Paraboloid::new(radius, radius).unwrap(), load);
        problem.load = Load::central(load, Tilt::LEVEL);
        problem.ice_surface = Some(Arc::new(Waviness::new(amplitude, length).unwrap()));
        let s = solve(&problem, &of_cells(24)).unwrap();
        assert!(s.volume.is_none(), "finite elements");
        assert!((s.fz / load - 1.0).abs() < 1e-6, "{}", s.fz);
        // The middle line of cells on the middle wave.
        let nx = s.surface.x.len();
        let row = s.surface.y.len() / 2;
        let dx = s.surface.x[1] - s.surface.x[0];
        let line = &s.surface.pressure[row * nx..(row + 1) * nx];
        let wave = |i: &usize| s.surface.x[*i].abs() < 0.5 * length;
        let wave: Vec<f64> = (0..nx).filter(wave).map(|i| line[i]).collect();
        let mean = wave.iter().sum::<f64>() * dx / length;
        let peak = wave.iter().copied().fold(0.0, f64::max);
        let touches = wave.iter().filter(|p| **p > 0.0).count() as f64 * dx;
        let part = (mean / full).sqrt();
        assert!(
            (0.3..0.8).contains(&part),
            "{part}: outside the range of the test"
        );
        let expected = 2.0 * length / PI * part.asin();
        assert!(
            (touches - expected).abs() < 2.0 * dx,
            "{touches:e} {expected:e} by {dx:e}"
        );
        let of_peak = peak / (2.0 * (mean * full).sqrt());
        assert!((of_peak - 1.0).abs() < 0.01, "{of_peak}");
    }
}

/// Flat ice as a height map, which selects the solver on the contact plane.
#[test]
fn ball_on_a_flat_height_map_within_0_1_percent_of_hertz() {
    let radius = 0.5;
    let expected = hertz(radius, radius, contact_modulus(), 100.0).unwrap();
    let flat = HeightMap::new([-0.1; 2], [0.1; 2], [3, 3], vec![0.0; 9]);
    let mut problem = on_half_space(Paraboloid::new(radius, radius).unwrap(), 100.0);
    // The offset breaks the mirror symmetry.
    problem.load = Load::Force {
        fz: 100.0,
        offset_x: 1e-6,
        offset_y: 1e-6,
        tilt: Tilt::LEVEL,
    };
    problem.ice_surface = Some(Arc::new(flat.unwrap()));
    let s = solve(&problem, &of_cells(48)).unwrap();
    assert!(s.volume.is_none(), "finite elements");
    let area = PI * expected.a * expected.b;
    for (name, found, expected, most) in [
        ("p_max", s.p_max, expected.p_max, 1e-3),
        ("approach", s.approach, expected.approach, 1e-3),
        ("area", s.area, area, 5e-3),
        ("length", s.length, 2.0 * expected.a, 5e-3),
    ] {
        assert!(
            (found / expected - 1.0).abs() < most,
            "{name}: {found:e} {expected:e}"
        );
    }
}

/// A runner along waves of ice, as in the benchmarks.
fn along_waves(count: usize) -> Problem {
    let length = 0.95 / count as f64;
    let hull = BobRunner::default();
    let ice = Ice {
        foundation: Foundation::RigidBed { thickness: 5e-4 },
        ..Ice::half_space(ICE_E, ICE_NU)
    };
    let load = Load::Approach {
        approach: 1e-5,
        pitch: 1e-9,
        roll: 1e-9,
    };
    Problem {
        track_curvature: 1.0 / hull.rocker_radius,
        ice_surface: Some(Arc::new(Waviness::new(2.5e-3 * length, length).unwrap())),
        ..Problem::new(Runner::rigid(Arc::new(hull.swept().unwrap())), ice, load)
    }
}

/// The finite elements are independent of the response of the plane and its transforms.
#[test]
fn loads_of_single_asperities_within_2_percent_of_finite_elements() {
    let count = 25;
    let problem = along_waves(count);
    let plane = solve(&problem, &of_cells(8)).unwrap();
    let in_volume = Options {
        subsurface: true,
        ..of_cells(8)
    };
    let volume = solve(&problem, &in_volume).unwrap();
    assert!(plane.volume.is_none() && volume.volume.is_some());
    for (name, found, expected, most) in [
        ("p_max", plane.p_max, volume.p_max, 0.01),
        ("area", plane.area, volume.area, 0.02),
        ("load", plane.fz, volume.fz, 0.01),
    ] {
        assert!(
            (found / expected - 1.0).abs() < most,
            "{name}: {found:e} {expected:e}"
        );
    }
    let length = 0.95 / count as f64;
    let widths = |nodes: &[f64]| -> Vec<f64> {
        let last = nodes.len() - 1;
        let width = |k: usize| 0.5 * (nodes[(k + 1).min(last)] - nodes[k.saturating_sub(1)]);
        (0..=last).map(width).collect()
    };
    let share = |s: &Solution, crest: i32| {
        let (along, across) = (widths(&s.surface.x), widths(&s.surface.y));
        let nx = along.len();
        let middle = length * f64::from(crest);
        let ends = [middle - 0.5 * length, middle + 0.5 * length];
        between(s, ends, |n| {
            s.surface.pressure[n] * along[n % nx] * across[n / nx]
        }) / s.fz
    };
    for crest in -20..=20 {
        let [one, two] = [&plane, &volume].map(|s| share(s, crest));
        if two == 0.0 {
            assert_eq!(one, 0.0, "{crest}");
            continue;
        }
        assert!((one / two - 1.0).abs() < 0.02, "{crest}: {one} {two}");
    }
    // Every crest in contact is listed as an asperity, with its force.
    let asperities = plane.surface.asperities();
    let touching = (-20..=20).filter(|crest| share(&plane, *crest) > 0.0);
    assert_eq!(asperities.len(), touching.count());
    for asperity in &asperities {
        let crest = (asperity.centre[0] / length).round() as i32;
        let of_all = asperity.force / plane.fz;
        let off = of_all / share(&plane, crest) - 1.0;
        assert!(off.abs() < 1e-9, "{crest}: {off:e}");
    }
    assert!(asperities.is_sorted_by(|a, b| a.force >= b.force));
}

/// Height map with the sum of 48 random waves.
fn rough(count: usize, size: f64) -> HeightMap {
    let mut state = 20_261_128u64;
    let mut random = || {
        // P. L'Ecuyer, Math. Comput. 68 (1999) 249.
        state = state
            .wrapping_mul(2_862_933_555_777_941_757)
            .wrapping_add(3_037_000_493);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let waves: Vec<[f64; 3]> = (0..48)
        .map(|_| {
            [
                8.0 + 8.0 * random(),
                2.0 * PI * random(),
                2.0 * PI * random(),
            ]
        })
        .collect();
    let step = size / (count - 1) as f64;
    let height = |k: usize| -> f64 {
        let [x, y] = [k % count, k / count].map(|i| i as f64 / (count - 1) as f64 - 0.5);
        let wave = |[number, direction, phase]: &[f64; 3]| {
            (2.0 * PI * number * (x * direction.cos() + y * direction.sin()) + phase).cos()
        };
        2e-7 * waves.iter().map(wave).sum::<f64>()
    };
    let heights = (0..count * count).map(height).collect();
    HeightMap::new([-0.5 * size; 2], [step; 2], [count; 2], heights).unwrap()
}

/// A ball on such ice.
pub fn on_rough_ice(tilt: Tilt) -> Problem {
    Problem {
        ice_surface: Some(Arc::new(rough(97, 4e-3))),
        load: Load::central(40.0, tilt),
        ..on_half_space(Paraboloid::new(0.2, 0.2).unwrap(), 40.0)
    }
}

#[test]
fn stated_errors_on_rough_ice_cover_the_difference_from_finer_cells() {
    let problem = on_rough_ice(Tilt::LEVEL);
    let of_accuracy = |p_max_tolerance: f64| {
        let options = Options {
            p_max_tolerance,
            ..Options::default()
        };
        solve(&problem, &options).unwrap()
    };
    let (coarse, fine) = (of_accuracy(0.05), of_accuracy(0.003));
    assert!(coarse.volume.is_none() && fine.volume.is_none());
    assert!(fine.dofs > 2 * coarse.dofs, "{} {}", coarse.dofs, fine.dofs);
    for (name, off, stated) in [
        ("p_max", coarse.p_max - fine.p_max, coarse.p_max_error),
        ("area", coarse.area - fine.area, coarse.area_error),
        (
            "approach",
            coarse.approach - fine.approach,
            coarse.approach_error,
        ),
    ] {
        assert!(off.abs() <= stated, "{name}: {off:e} {stated:e}");
    }
    let share = coarse.area_error / coarse.area;
    assert!(share < 0.2, "{share}");
}

#[test]
fn pitch_and_roll_balance_the_load_on_rough_ice_and_bits_do_not_depend_on_threads() {
    let problem = on_rough_ice(Tilt::Free);
    let on = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
        let pool = pool.build().unwrap();
        pool.install(|| solve(&problem, &of_cells(9)).unwrap())
    };
    let (one, two) = (on(1), on(2));
    assert!(one.volume.is_none());
    assert!(one == two, "different bits with two threads");
    // The load acts at the origin; the contact is some 2 mm wide.
    let [x, y] = one.centre_of_pressure;
    assert!(x.abs() < 1e-8 && y.abs() < 1e-8, "{x:e} {y:e}");
    assert!(one.pitch != 0.0 && one.roll != 0.0);
    assert!(one.kkt_residual < 1e-5, "{:e}", one.kkt_residual);
}

#[test]
fn stop_ends_the_iterations_on_the_contact_plane() {
    let problem = on_rough_ice(Tilt::LEVEL);
    let stop = Arc::new(AtomicBool::new(true));
    let options = Options {
        stop: Some(stop.clone()),
        ..Options::default()
    };
    assert_eq!(solve(&problem, &options).err(), Some(Error::Stopped));
    // Set before the iterations of the second grid, which is then not solved.
    stop.store(false, Ordering::Relaxed);
    let levels = Arc::new(Mutex::new(Vec::new()));
    let (raised, solved) = (stop.clone(), levels.clone());
    let options = Options {
        next_mesh: Some(Arc::new(move |mesh: &NextMesh| {
            raised.store(mesh.level == 1, Ordering::Relaxed);
        })),
        progress: Some(Arc::new(move |iterate: &Iterate| {
            solved.lock().unwrap().push(iterate.level);
        })),
        ..options
    };
    assert_eq!(solve(&problem, &options).err(), Some(Error::Stopped));
    assert_eq!(*levels.lock().unwrap(), [0]);
}

#[test]
fn next_mesh_reports_each_grid_once_after_those_of_the_search_and_the_finest_has_its_error() {
    let problem = on_rough_ice(Tilt::LEVEL);
    let begun = Arc::new(Mutex::new(Vec::new()));
    let announced = begun.clone();
    let options = Options {
        max_dofs: 200_000,
        p_max_tolerance: 1e-4,
        next_mesh: Some(Arc::new(move |mesh: &NextMesh| {
            announced.lock().unwrap().push((mesh.level, mesh.dofs));
        })),
        ..Options::default()
    };
    let Err(Error::AccuracyNotReached {
        dofs,
        estimate,
        best,
        ..
    }) = solve(&problem, &options)
    else {
        panic!("the requested accuracy was reached");
    };
    assert!(best.volume.is_none());
    // The transforms have four times the number of cells.
    assert!(4 * dofs <= options.max_dofs && dofs == best.dofs, "{dofs}");
    assert!((best.p_max_error / best.p_max - estimate).abs() < 1e-12);
    assert!(1e-4 < estimate && estimate < 0.5, "{estimate}");
    assert!((best.fz / 40.0 - 1.0).abs() < 1e-6, "{}", best.fz);
    // The limit allows at least three grids, from which the error is estimated.
    assert!(best.history.len() >= 3, "{}", best.history.len());
    let solved: Vec<(usize, usize)> = best.history.iter().map(|i| (i.level, i.dofs)).collect();
    let begun = begun.lock().unwrap();
    // The search on coarse grids is reported first.
    let (searched, begun) = begun.split_at(begun.len() - solved.len());
    assert_eq!(begun, solved);
    assert!(!searched.is_empty() && searched.iter().all(|(level, _)| *level == 0));
    assert!(solved.iter().enumerate().all(|(k, (level, _))| k == *level));
}

#[test]
fn error_of_the_length_of_many_asperities_on_yielding_ice_is_below_1_4_cells() {
    let mut problem = on_rough_ice(Tilt::LEVEL);
    problem.ice.hardness = Some(150e6);
    let options = Options {
        p_max_tolerance: 0.05,
        ..Options::default()
    };
    let s = solve(&problem, &options).unwrap();
    assert!(s.volume.is_none(), "finite elements");
    assert_eq!((s.p_max, s.p_max_error), (150e6, 0.0));
    let cells = [&s.surface.x, &s.surface.y].map(|nodes| nodes[1] - nodes[0]);
    for (name, error, cell) in [
        ("length", s.length_error, cells[0]),
        ("width", s.width_error, cells[1]),
    ] {
        // Two thirds of a cell at either end.
        assert!(
            0.0 < error && error < 1.4 * cell,
            "{name}: {error:e} {cell:e}"
        );
    }
}
