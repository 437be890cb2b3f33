//! Loads of a runner: balance with the contact, and the stress of a beam.

use std::sync::Arc;

use super::*;
use kufe_mesh::{BobRunner, TensorGrid, Underside};

use crate::{Foundation, Ice, Load, LoadedPlace, Options, Place, Runner, RunnerSolid, Tilt, solve};

const STEEL: (f64, f64) = (210e9, 0.3);

fn fixed(places: &[(f64, f64)]) -> Mount {
    let place = |&(x, length): &(f64, f64)| Place { x, length };
    Mount::Places(places.iter().map(place).collect())
}

fn carried(places: &[(f64, f64, f64)]) -> Mount {
    let place = |&(x, length, share): &(f64, f64, f64)| LoadedPlace {
        place: Place { x, length },
        share,
    };
    Mount::Loads(places.iter().map(place).collect())
}

fn problem(
    underside: Arc<dyn Underside>,
    (top, mount): (f64, Mount),
    ice: Ice,
    load: Load,
) -> Problem {
    let elastic = ElasticRunner {
        mount,
        ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, top)
    };
    let runner = Runner {
        underside,
        elastic: Some(elastic),
    };
    Problem::new(runner, ice, load)
}

fn one_mesh(problem: &Problem, cells: usize) -> (Solution, RunnerLoads) {
    let options = Options {
        cells: Some(cells),
        residual: 1e-11,
        ..Options::default()
    };
    let solution = solve(problem, &options).expect("a solution");
    let loads = runner_loads(problem, &solution).expect("a body");
    (solution, loads.expect("an elastic runner"))
}

/// Forces on the mounts sum to the contact's, and so do their moments about the origin.
fn in_balance(solution: &Solution, loads: &RunnerLoads, said: &str) {
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    for mount in &loads.mounts {
        let ([x, y, z], [fx, fy, fz]) = (mount.at, mount.force);
        let turn = [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx];
        for axis in 0..3 {
            force[axis] += mount.force[axis];
            moment[axis] += mount.moment[axis] + turn[axis];
        }
    }
    let (fz, [x, y]) = (solution.fz, solution.centre_of_pressure);
    println!("{said}: {force:?} N, {moment:?} N m, pressed with {fz} N at {x}, {y}");
    for (found, wanted) in force.into_iter().zip([0.0, 0.0, fz]) {
        assert!((found - wanted).abs() < 1e-7 * fz, "{said}: {force:?} {fz}");
    }
    // Against the force over a hundredth of a metre.
    for (found, wanted) in moment.into_iter().zip([y * fz, -x * fz, 0.0]) {
        assert!(
            (found - wanted).abs() < 1e-7 * 0.01 * fz,
            "{said}: {moment:?} {wanted}"
        );
    }
}

#[test]
fn what_mounts_bear_sums_to_the_contacts_force_and_moments() {
    let bob = BobRunner {
        length: 0.3,
        rocker_radius: 8.0,
        height: 0.02,
        ..BobRunner::default()
    };
    let hull = Arc::new(bob.swept().expect("a runner"));
    let ice = || Ice {
        foundation: Foundation::RigidBed { thickness: 0.02 },
        ..Ice::half_space(9e9, 0.33)
    };
    let two = [(-0.08, 0.02), (0.08, 0.02)];
    let mounts = [
        (Mount::Top, 0.0, Tilt::LEVEL, 1),
        (fixed(&two), 0.0, Tilt::LEVEL, 2),
        (fixed(&[(0.0, 0.04)]), 0.0, Tilt::LEVEL, 1),
        (fixed(&[(-0.08, 0.02), (0.03, 0.01)]), 0.0, Tilt::Free, 2),
        (fixed(&[(0.1, 0.02)]), 0.0, Tilt::LEVEL, 1),
        (
            carried(&[(-0.08, 0.02, 0.5), (0.08, 0.02, 0.5)]),
            0.0,
            Tilt::Free,
            2,
        ),
        (
            carried(&[(-0.1, 0.02, 0.4), (0.05, 0.02, 0.6)]),
            -0.01,
            Tilt::Free,
            2,
        ),
    ];
    for (mount, offset_x, tilt, count) in mounts {
        let said = format!("{mount:?}");
        let shares: Vec<f64> = match &mount {
            Mount::Loads(loads) => loads.iter().map(|load| load.share).collect(),
            _ => Vec::new(),
        };
        let load = Load::Force {
            fz: 800.0,
            offset_x,
            offset_y: 0.0,
            tilt,
        };
        let problem = problem(hull.clone(), (bob.height, mount), ice(), load);
        let (solution, loads) = one_mesh(&problem, 3);
        assert_eq!(loads.mounts.len(), count, "{said}");
        in_balance(&solution, &loads, &said);
        // What carries has its own share, without a moment about its middle.
        for (mount, share) in loads.mounts.iter().zip(shares) {
            assert!(
                (mount.force[2] / (800.0 * share) - 1.0).abs() < 1e-8,
                "{said}"
            );
            assert!(
                mount.moment.iter().all(|m| m.abs() < 1e-6),
                "{said}: {mount:?}"
            );
        }
        let most = loads.mounts.iter().map(|mount| mount.von_mises);
        assert!(most.fold(0.0, f64::max) <= loads.von_mises, "{said}");
    }
}

/// A block on hexahedra of its own, fixed at two rows of its top.
#[test]
fn hexahedra_from_elsewhere_bear_on_each_place_that_holds_them() {
    let line = |half: f64, n: i32| -> Vec<f64> {
        (0..=n)
            .map(|i| half * (2.0 * f64::from(i) / f64::from(n) - 1.0))
            .collect()
    };
    let grid = TensorGrid {
        x: line(0.02, 20),
        y: line(0.002, 8),
        z: (0..=4).map(|k| 0.0015 * f64::from(k)).collect(),
    };
    let mut mesh = grid.hex_mesh();
    for p in &mut mesh.points {
        let low = p[0] * p[0] / 4.0 + p[1] * p[1] / 0.02;
        p[2] = low + (0.006 - low) * p[2] / 0.006;
    }
    let on_top = |p: [f64; 3]| p[2] > 0.006 - 1e-9 && p[0].abs() > 0.0139;
    let solid = RunnerSolid::new(mesh, STEEL.0, STEEL.1, on_top).expect("a block");
    let surface = kufe_mesh::FittedUnderside::new(&solid.underside(), 0.0).expect("a surface");
    let load = Load::central(50.0, Tilt::LEVEL);
    let mut problem = problem(
        Arc::new(surface),
        (0.006, Mount::Top),
        Ice::half_space(9e9, 0.33),
        load,
    );
    if let Some(elastic) = &mut problem.runner.elastic {
        elastic.solid = Some(Arc::new(solid));
    }
    let (solution, loads) = one_mesh(&problem, 3);
    assert_eq!(loads.mounts.len(), 2);
    assert!((loads.mounts[0].at[0] + 0.017).abs() < 1e-9, "{loads:?}");
    in_balance(&solution, &loads, "a block");
}

/// A bar that is pressed in its middle and carried at two places: by statics the bending moment in
/// the middle is half of each load's less that of the pressure on its side, and a beam's stress
/// there is 6 M / (b h^2).
#[test]
fn a_bar_carried_at_two_places_has_a_beams_stress_in_its_middle() {
    struct Bar;
    const WIDTH: f64 = 0.01;
    const HEIGHT: f64 = 0.012;
    impl Underside for Bar {
        fn height(&self, x: f64, y: f64) -> f64 {
            if x.abs() > 0.15 || y.abs() > 0.5 * WIDTH {
                return f64::INFINITY;
            }
            // A radius of 1 m in the middle that levels off at 2 mm, so that the ends stay off the
            // ice.
            let rise = 2e-3;
            rise * (1.0 - 1.0 / (1.0 + x * x / (2.0 * rise)))
        }
        fn extent(&self) -> [f64; 4] {
            [-0.15, 0.15, -0.5 * WIDTH, 0.5 * WIDTH]
        }
        fn mirror_symmetric(&self) -> [bool; 2] {
            [true; 2]
        }
    }
    let (arm, fz) = (0.1, 500.0);
    let soft = Ice {
        foundation: Foundation::RigidBed { thickness: 0.02 },
        ..Ice::half_space(1e9, 0.33)
    };
    let mount = carried(&[(-arm, 0.02, 0.5), (arm, 0.02, 0.5)]);
    let load = Load::central(fz, Tilt::Free);
    let problem = problem(Arc::new(Bar), (HEIGHT, mount), soft, load);
    let (solution, loads) = one_mesh(&problem, 6);
    // Over the half on which x is positive, by trapezoids; the patch is 10 mm wide all along.
    let surface = &solution.surface;
    let (nx, ny) = (surface.x.len(), surface.y.len());
    let share = |nodes: &[f64], i: usize| {
        let before = if i > 0 { nodes[i] - nodes[i - 1] } else { 0.0 };
        let after = if i + 1 < nodes.len() {
            nodes[i + 1] - nodes[i]
        } else {
            0.0
        };
        0.5 * (before + after)
    };
    let mut pressed = [0.0; 2];
    for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
        let force = surface.pressure[j * nx + i] * share(&surface.x, i) * share(&surface.y, j);
        pressed[0] += force;
        pressed[1] += 0.5 * force * surface.x[i].abs();
    }
    let moment = 0.5 * fz * arm - pressed[1];
    let beam = 6.0 * moment / (WIDTH * HEIGHT * HEIGHT);
    println!(
        "{:.5e} Pa at {:?} against a beam's {beam:.5e}, {pressed:?}",
        loads.von_mises, loads.at
    );
    // The trapezoids end a cell outside the patch.
    assert!((pressed[0] / fz - 1.0).abs() < 0.02, "{pressed:?}");
    assert!(
        (loads.von_mises / beam - 1.0).abs() < 0.03,
        "{loads:?} {beam}"
    );
    let [x, _, z] = loads.at;
    let outer = !(0.05 * HEIGHT..0.95 * HEIGHT).contains(&z);
    assert!(x.abs() < 0.01 && outer, "{loads:?}");
}
