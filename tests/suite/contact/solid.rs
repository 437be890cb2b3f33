//! Meshed runners, coupled to the ice by a mortar method.

use std::sync::Arc;

use kufe_contact::{
    ElasticRunner, Error, Foundation, Ice, Load, Mount, Options, Problem, Runner, RunnerSolid,
    Solution, Tilt, solve,
};
use kufe_mesh::{
    BobRunner, FittedUnderside, HexMesh, Underside, graded_levels, mapped_runner_mesh,
    mesh_over_heights,
};
use kufe_tests::contact::{Formula, ICE_E, ICE_NU};
use kufe_tests::meshes::block;

const STEEL: (f64, f64) = (210e9, 0.3);

fn solid(mesh: HexMesh, material: (f64, f64), top: f64) -> Arc<RunnerSolid> {
    let fixed = |p: [f64; 3]| p[2] > top - 1e-9;
    Arc::new(RunnerSolid::new(mesh, material.0, material.1, fixed).unwrap())
}

fn pressed(
    underside: Arc<dyn Underside>,
    solid: Arc<RunnerSolid>,
    ice: (f64, f64),
    thickness: f64,
    load: Load,
) -> Problem {
    let elastic = ElasticRunner {
        solid: Some(solid),
        ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, 0.0)
    };
    let runner = Runner {
        underside,
        elastic: Some(elastic),
    };
    let ice = Ice {
        foundation: Foundation::RigidBed { thickness },
        ..Ice::half_space(ice.0, ice.1)
    };
    Problem::new(runner, ice, load)
}

fn fixed_level(fz: f64) -> Load {
    Load::central(fz, Tilt::LEVEL)
}

fn at(cells: usize) -> Options {
    Options {
        cells: Some(cells),
        ..Options::default()
    }
}

/// Pressures at nodes well inside a rectangle of half lengths `a` and `b`.
fn inside(s: &Solution, a: f64, b: f64) -> Vec<f64> {
    let nx = s.surface.x.len();
    let field = s.surface.pressure.iter().enumerate();
    field
        .filter(|(n, _)| s.surface.x[n % nx].abs() < a && s.surface.y[n / nx].abs() < b)
        .map(|(_, p)| *p)
        .collect()
}

/// A block of skewed cells; both materials have nu = 0, so that columns are independent. The pressure
/// is F / A and the compression of the block F H / (E A), independent of the mesh.
#[test]
fn constant_pressure_is_transferred_between_non_matching_meshes() {
    let (a, b, height, thickness, fz) = (0.03, 0.02, 0.01, 0.001, 1200.0);
    let mut mesh = block([7, 5, 3], [2.0 * a, 2.0 * b, height]);
    for p in &mut mesh.points {
        let rim = (p[0] * (2.0 * a - p[0]) / (a * a)) * (p[1] * (2.0 * b - p[1]) / (b * b));
        p[0] += 0.15 * a * rim * (p[1] / b - 0.8) - a;
        p[1] += 0.1 * b * rim - b;
    }
    let soft = 1e7;
    let flat = Formula {
        height: move |x: f64, y: f64| {
            if x.abs() <= a && y.abs() <= b {
                0.0
            } else {
                f64::INFINITY
            }
        },
        extent: [-a, a, -b, b],
        symmetric: [true; 2],
    };
    let steel = solid(mesh, (STEEL.0, 0.0), height);
    let problem = pressed(
        Arc::new(flat),
        steel,
        (soft, 0.0),
        thickness,
        fixed_level(fz),
    );
    let s = solve(&problem, &at(6)).unwrap();
    let expected = fz / (4.0 * a * b);
    // Next to the block the layer deforms over a cell of 5 mm: exclude the rim.
    let found = inside(&s, a - 12.0 * thickness, b - 12.0 * thickness);
    let (least, most) = found
        .iter()
        .fold((f64::INFINITY, 0.0f64), |m, p| (m.0.min(*p), m.1.max(*p)));
    println!(
        "{} nodes: pressures {:.6} to {:.6} F / A",
        found.len(),
        least / expected,
        most / expected
    );
    assert!(found.len() > 20);
    // The deformed layer next to the block carries a part of the load.
    let middle = inside(&s, 0.3 * a, 0.3 * b);
    let mean = middle.iter().sum::<f64>() / middle.len() as f64;
    assert!(
        found.iter().all(|p| (p / mean - 1.0).abs() < 5e-3),
        "{least} {most} {mean}"
    );
    assert!((mean / expected - 1.0).abs() < 0.12, "{mean} {expected}");
    // Approach: compression of layer and block under that pressure.
    let approach = mean * (thickness / soft + height / STEEL.0);
    assert!(
        (s.approach / approach - 1.0).abs() < 2e-3,
        "{} {approach}",
        s.approach
    );
    assert!((s.fz / fz - 1.0).abs() < 1e-8);
}

/// A short runner with its own mesh and a fitted smooth surface, and the same runner meshed on the
/// columns of the ice.
#[test]
fn meshed_runner_agrees_with_the_runner_on_the_columns_of_the_ice() {
    let bob = BobRunner {
        length: 0.2,
        rocker_radius: 8.0,
        height: 0.02,
        ..BobRunner::default()
    };
    let hull = bob.swept().unwrap();
    let axis = |half: f64, n: usize, power: f64| -> Vec<f64> {
        (0..=n)
            .map(|i| 2.0 * i as f64 / n as f64 - 1.0)
            .map(|t: f64| half * t.signum() * t.abs().powf(power))
            .collect()
    };
    let (x, y) = (axis(0.1, 44, 1.6), axis(0.0035, 40, 2.2));
    let levels = graded_levels(5, 2.5).unwrap();
    let mesh = mapped_runner_mesh(&x, &y, &hull, bob.height, &levels).unwrap();
    let steel = solid(mesh, STEEL, bob.height);
    let surface = FittedUnderside::new(&steel.underside(), 0.0).unwrap();
    for (at_x, at_y) in [(0.0, 0.0), (0.02, 2e-4), (-0.05, -1e-3)] {
        let error = surface.height(at_x, at_y) - hull.height(at_x, at_y);
        assert!(error.abs() < 2e-7, "{error:e}");
    }
    let own = pressed(
        Arc::new(surface),
        steel.clone(),
        (ICE_E, ICE_NU),
        0.02,
        fixed_level(600.0),
    );
    let own = solve(&own, &at(8)).unwrap();
    let mut on_columns = pressed(
        Arc::new(hull),
        steel.clone(),
        (ICE_E, ICE_NU),
        0.02,
        fixed_level(600.0),
    );
    on_columns.runner.elastic = Some(ElasticRunner {
        mount: Mount::Top,
        ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, bob.height)
    });
    let on_columns = solve(&on_columns, &at(8)).unwrap();
    println!(
        "own mesh {:.3} MPa in {} iterations, on columns {:.3} MPa in {}",
        1e-6 * own.p_max,
        own.iterations,
        1e-6 * on_columns.p_max,
        on_columns.iterations
    );
    assert!((own.p_max / on_columns.p_max - 1.0).abs() < 0.01);
    // The mesh ends 3.5 mm from the middle and has no flanks.
    assert!((own.approach / on_columns.approach - 1.0).abs() < 0.02);
    assert!(own.iterations <= 45, "{}", own.iterations);
    assert!((own.fz / 600.0 - 1.0).abs() < 1e-8);
}

/// Nodes from -`end` to `end`, with cells of equal `size` up to a distance `even` from 0 and then
/// growing by a third. A node (`edge`) or the middle of a cell is at 0.
fn line(size: f64, even: f64, end: f64, edge: bool) -> Vec<f64> {
    let mut half = vec![if edge { 0.0 } else { 0.5 * size }];
    let mut step = size;
    while half[half.len() - 1] < end {
        let last = half[half.len() - 1];
        if last >= even {
            step *= 4.0 / 3.0;
        }
        half.push(last + step);
    }
    let below = half.iter().rev().map(|x| -x);
    let below: Vec<f64> = below.filter(|x| *x < 0.0).collect();
    [below, half].concat()
}

/// Faces of a third to half of the contact radius on runners softer and stiffer than the ice. The
/// error they cause does not depend on the mesh of the ice. Reference peaks by Hankel transforms
/// (`tests/data/layered.py`): a paraboloid of radius 2 m, 20 mm high, fixed at its top, 1000 N.
#[test]
fn stated_errors_cover_the_discretisation_error_of_meshed_runners() {
    const RADIUS: f64 = 2.0;
    const HEIGHT: f64 = 0.02;
    let mut stated = Vec::new();
    // Young's modulus [Pa], contact radius [m], peak [Pa], cells over the radius, whether a node is
    // at the lowest point.
    for (young, a, peak, cells, edge) in [
        (6e9, 7.187e-3, 9.247_650e6, 2.0, true),
        (6e9, 7.187e-3, 9.247_650e6, 3.0, true),
        (6e9, 7.187e-3, 9.247_650e6, 3.0, false),
        (21e9, 5.969e-3, 13.401_187e6, 3.0, false),
        (75e9, 5.502e-3, 15.774_308e6, 2.0, true),
    ] {
        let size = a / cells;
        let x = line(size, 1.5 * a, 3.0 * (a + HEIGHT), edge);
        let up: Vec<f64> = line(size, 0.5 * a, HEIGHT, true)
            .into_iter()
            .filter(|z| *z >= 0.0)
            .collect();
        let levels: Vec<f64> = up.iter().map(|z| z / up[up.len() - 1]).collect();
        let height = |x: f64, y: f64| (x * x + y * y) / (2.0 * RADIUS);
        let heights: Vec<f64> = x
            .iter()
            .flat_map(|y| x.iter().map(|x| height(*x, *y)))
            .collect();
        let mesh = mesh_over_heights(&x, &x, &heights, HEIGHT, &levels).unwrap();
        let runner = solid(mesh, (young, 0.3), HEIGHT);
        let surface = FittedUnderside::new(&runner.underside(), 0.0).unwrap();
        let mut problem = pressed(
            Arc::new(surface),
            runner,
            (ICE_E, ICE_NU),
            1.0,
            fixed_level(1000.0),
        );
        problem.ice.foundation = Foundation::HalfSpace;
        if let Some(elastic) = &mut problem.runner.elastic {
            elastic.youngs_modulus = young;
        }
        let options = Options {
            p_max_tolerance: 0.02,
            ..Options::default()
        };
        let s = match solve(&problem, &options) {
            Ok(solution) => solution,
            Err(Error::AccuracyNotReached { best, .. }) => *best,
            Err(error) => panic!("{error}"),
        };
        let (off, error) = (s.p_max / peak - 1.0, s.p_max_error / peak);
        println!(
            "{young:e} {cells} {edge}: error {:.2} %, {:.2} % stated",
            100.0 * off,
            100.0 * error
        );
        // The height changes over the contact, which the reference neglects: relative error
        // a^2 / (2 R H).
        assert!(
            off.abs() < error + a * a / (2.0 * RADIUS * HEIGHT),
            "{off} {error}"
        );
        stated.push(error);
    }
    // Stated errors decrease with the size of the faces and with the stiffness of the runner.
    assert!(
        stated[0] > stated[1] && stated[4] < 0.5 * stated[0],
        "{stated:?}"
    );
}

#[test]
fn invalid_runner_meshes_are_rejected_with_the_reason() {
    let mesh = || block([2, 2, 2], [0.1; 3]);
    let refused = |mesh: HexMesh, top: f64| {
        let fixed = |p: [f64; 3]| p[2] > top;
        RunnerSolid::new(mesh, STEEL.0, STEEL.1, fixed)
            .unwrap_err()
            .to_string()
    };
    assert!(refused(mesh(), 1.0).contains("holds no node"));
    let mut inverted = mesh();
    inverted.cells[0].swap(0, 6);
    assert!(refused(inverted, 0.05).contains("cell 0"));
}
