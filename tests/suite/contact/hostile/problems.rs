//! Contact problems with one invalid or extreme number. The result is an error or finite, in bounded
//! time, without panic.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use super::NUMBERS;
use kufe_contact::{
    Bed, ElasticRunner, Error, Foundation, Ice, Load, LoadedPlace, Mount, Options, Place, Problem,
    Runner, Solution, StiffnessForm, Tilt, boundary_elements, check_problem, slide, solve,
};
use kufe_mesh::{BobRunner, IceSurface, Paraboloid};
use kufe_tests::contact::{Formula, ICE_E, ICE_NU};

/// Time limit of one solve, more than ten times the usual time on these small meshes.
const TIME_LIMIT: Duration = Duration::from_secs(60);

fn quick() -> Options {
    Options {
        p_max_tolerance: 0.1,
        max_dofs: 4_000,
        ..Options::default()
    }
}

/// A slender paraboloid, with a value in every field of a rigid runner's problem.
fn rigid() -> Problem {
    let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005).unwrap()));
    let ice = Ice {
        foundation: Foundation::ElasticBed {
            thickness: 0.03,
            bed: Bed {
                youngs_modulus: 30e9,
                poissons_ratio: 0.2,
                thickness: 0.1,
            },
        },
        hardness: Some(60e6),
        ..Ice::half_space(ICE_E, ICE_NU)
    };
    let load = Load::Force {
        fz: 1000.0,
        offset_x: 0.01,
        offset_y: 0.0,
        tilt: Tilt::Free,
    };
    Problem {
        track_curvature: 0.01,
        ..Problem::new(runner, ice, load)
    }
}

/// An elastic bar on a mount, on ice with a rigid bed.
fn elastic(mount: Mount) -> Problem {
    let runner = Runner {
        underside: Arc::new(BobRunner::default().swept().unwrap()),
        elastic: Some(ElasticRunner {
            mount,
            flank: Some(0.3),
            ..ElasticRunner::fixed_at_top(210e9, 0.3, 0.03)
        }),
    };
    let ice = Ice {
        foundation: Foundation::RigidBed { thickness: 0.05 },
        ..Ice::half_space(ICE_E, ICE_NU)
    };
    Problem::new(runner, ice, Load::central(1000.0, Tilt::Free))
}

fn places() -> Mount {
    let place = |x: f64| Place { x, length: 0.05 };
    Mount::Places(vec![place(-0.3), place(0.3)])
}

fn carriers() -> Mount {
    let loaded = |x: f64| LoadedPlace {
        place: Place { x, length: 0.05 },
        share: 0.5,
    };
    Mount::Loads(vec![loaded(-0.3), loaded(0.3)])
}

/// Results that are not finite, and stated errors that are NaN or negative.
fn invalid(s: &Solution) -> Vec<(&'static str, f64)> {
    let figures = [
        ("p_max", s.p_max),
        ("p_mean", s.p_mean),
        ("area", s.area),
        ("length", s.length),
        ("width", s.width),
        ("approach", s.approach),
        ("pitch", s.pitch),
        ("roll", s.roll),
        ("fz", s.fz),
    ];
    let errors = [
        ("p_max_error", s.p_max_error),
        ("area_error", s.area_error),
        ("length_error", s.length_error),
        ("width_error", s.width_error),
        ("approach_error", s.approach_error),
        ("pitch_error", s.pitch_error),
        ("roll_error", s.roll_error),
    ];
    let errors = errors.into_iter().filter(|(_, e)| e.is_nan() || *e < 0.0);
    let figures = figures.into_iter().filter(|(_, f)| !f.is_finite());
    figures.chain(errors).collect()
}

/// Passes the problem to every function that takes one, and checks the results.
fn check(what: &str, problem: &Problem, options: &Options) {
    let stop = Arc::new(AtomicBool::new(false));
    let options = Options {
        stop: Some(stop.clone()),
        ..options.clone()
    };
    let done = AtomicBool::new(false);
    std::thread::scope(|scope| {
        scope.spawn(|| {
            let step = Duration::from_millis(2);
            let mut waited = Duration::ZERO;
            while !done.load(Ordering::Relaxed) && waited < TIME_LIMIT {
                std::thread::sleep(step);
                waited += step;
            }
            stop.store(true, Ordering::Relaxed);
        });
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let checked = check_problem(problem, &options);
            let _ = boundary_elements(problem);
            let solved = solve(problem, &options);
            assert!(
                checked.is_ok() || solved.is_err(),
                "{what}: rejected and solved"
            );
            (solved, slide(problem, None, &options))
        }));
        done.store(true, Ordering::Relaxed);
        let (solved, slid) = outcome.unwrap_or_else(|_| panic!("{what}: panics"));
        let assert_valid =
            |figures: Vec<(&str, f64)>| assert!(figures.is_empty(), "{what}: {figures:?}");
        match &solved {
            Ok(solution) => assert_valid(invalid(solution)),
            Err(Error::AccuracyNotReached { best, .. }) => assert_valid(invalid(best)),
            Err(error) => assert_ne!(error, &Error::Stopped, "{what}: exceeds the time limit"),
        }
        match &slid {
            Ok(slid) => assert_valid(invalid(&slid.contact)),
            Err(error) => assert_ne!(
                error,
                &Error::Stopped,
                "{what}: sliding exceeds the time limit"
            ),
        }
    });
}

type Field<T> = (&'static str, fn(&mut T) -> &mut f64);

fn ice_fields() -> Vec<Field<Problem>> {
    fn bed(problem: &mut Problem) -> &mut Bed {
        match &mut problem.ice.foundation {
            Foundation::ElasticBed { bed, .. } => bed,
            other => panic!("{other:?} has no bed"),
        }
    }
    vec![
        ("modulus", |p| &mut p.ice.youngs_modulus),
        ("ratio", |p| &mut p.ice.poissons_ratio),
        ("hardness", |p| p.ice.hardness.as_mut().unwrap()),
        ("thickness", |p| match &mut p.ice.foundation {
            Foundation::ElasticBed { thickness, .. } => thickness,
            other => panic!("{other:?} has no thickness"),
        }),
        ("bed's modulus", |p| &mut bed(p).youngs_modulus),
        ("bed's ratio", |p| &mut bed(p).poissons_ratio),
        ("bed's thickness", |p| &mut bed(p).thickness),
        ("curvature", |p| &mut p.track_curvature),
    ]
}

#[test]
fn invalid_numbers_of_ice_and_track() {
    for (name, field) in ice_fields() {
        for number in NUMBERS {
            let mut problem = rigid();
            *field(&mut problem) = number;
            if name.starts_with("bed") {
                // Sliding on a bed a million times softer than the ice takes 30 s.
                problem.ice.hardness = None;
            }
            check(&format!("{name} {number:e}"), &problem, &quick());
        }
    }
}

#[test]
fn invalid_numbers_of_loads() {
    for number in NUMBERS {
        let force = |fz, offset_x, offset_y, tilt| Load::Force {
            fz,
            offset_x,
            offset_y,
            tilt,
        };
        let fixed = |pitch, roll| Tilt::Fixed { pitch, roll };
        let approach = |approach, pitch, roll| Load::Approach {
            approach,
            pitch,
            roll,
        };
        for load in [
            force(number, 0.0, 0.0, Tilt::Free),
            force(1000.0, number, 0.0, Tilt::Free),
            force(1000.0, 0.0, number, Tilt::Free),
            force(1000.0, number, number, Tilt::LEVEL),
            force(1000.0, 0.0, 0.0, fixed(number, 0.0)),
            force(1000.0, 0.0, 0.0, fixed(0.0, number)),
            approach(number, 0.0, 0.0),
            approach(1e-5, number, 0.0),
            approach(1e-5, 0.0, number),
        ] {
            let mut problem = rigid();
            problem.load = load;
            check(&format!("{load:?}"), &problem, &quick());
        }
    }
}

#[test]
fn invalid_numbers_of_elastic_runners() {
    fn runner(problem: &mut Problem) -> &mut ElasticRunner {
        problem.runner.elastic.as_mut().unwrap()
    }
    let fields: [Field<ElasticRunner>; 4] = [
        ("modulus", |r| &mut r.youngs_modulus),
        ("ratio", |r| &mut r.poissons_ratio),
        ("top", |r| &mut r.top),
        ("flank", |r| r.flank.as_mut().unwrap()),
    ];
    let of_places: [Field<Mount>; 3] = [
        ("place", |mount| match mount {
            Mount::Places(places) => &mut places[0].x,
            Mount::Loads(loads) => &mut loads[0].place.x,
            Mount::Top => panic!("no place"),
        }),
        ("length", |mount| match mount {
            Mount::Places(places) => &mut places[0].length,
            Mount::Loads(loads) => &mut loads[0].place.length,
            Mount::Top => panic!("no place"),
        }),
        ("share", |mount| match mount {
            Mount::Loads(loads) => &mut loads[0].share,
            _ => panic!("no share"),
        }),
    ];
    for number in NUMBERS {
        for (name, field) in fields {
            let mut problem = elastic(Mount::Top);
            *field(runner(&mut problem)) = number;
            check(&format!("{name} {number:e}"), &problem, &quick());
        }
        for (name, field) in of_places {
            for mount in [places(), carriers()] {
                if matches!((&mount, name), (Mount::Places(_), "share")) {
                    continue;
                }
                let mut problem = elastic(mount);
                *field(&mut runner(&mut problem).mount) = number;
                check(&format!("{name} {number:e}"), &problem, &quick());
            }
        }
    }
    for mount in [Mount::Places(Vec::new()), Mount::Loads(Vec::new())] {
        check("no places", &elastic(mount), &quick());
    }
}

#[test]
fn invalid_options() {
    for number in NUMBERS {
        let tolerance = Options {
            p_max_tolerance: number,
            ..quick()
        };
        check(&format!("tolerance {number:e}"), &rigid(), &tolerance);
        let residual = Options {
            residual: number,
            ..quick()
        };
        check(&format!("residual {number:e}"), &rigid(), &residual);
    }
    for cells in [0, 1, 2, 1001, usize::MAX] {
        let options = Options {
            cells: Some(cells),
            ..quick()
        };
        check(&format!("{cells} cells"), &rigid(), &options);
    }
    for (max_dofs, max_stiffness_bytes) in [(0, 0), (1, 1), (1000, 1000), (4_000, 0)] {
        for stiffness in [StiffnessForm::MatrixFree, StiffnessForm::Assembled] {
            let options = Options {
                max_dofs,
                max_stiffness_bytes,
                stiffness,
                ..quick()
            };
            check(&format!("{max_dofs} unknowns"), &rigid(), &options);
        }
    }
}

/// Ice surface given by a formula.
struct FormulaIce(fn(f64, f64) -> f64);

impl IceSurface for FormulaIce {
    fn height(&self, x: f64, y: f64) -> f64 {
        (self.0)(x, y)
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        [false; 2]
    }
}

#[test]
fn invalid_heights_and_extents_of_hulls_and_ice() {
    let heights: [fn(f64, f64) -> f64; 9] = [
        |_, _| f64::NAN,
        |_, _| f64::INFINITY,
        |_, _| f64::NEG_INFINITY,
        |_, _| 0.0,
        |_, _| 1e300,
        |x, y| if x > 0.0 { f64::NAN } else { x * x + y * y },
        |x, y| {
            if y.abs() < 1e-4 {
                f64::NEG_INFINITY
            } else {
                x * x + y * y
            }
        },
        |x, y| -x * x - y * y,
        |x, y| 1e-300 * (x * x + y * y),
    ];
    let extents = [
        [-0.5, 0.5, -0.01, 0.01],
        [
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
        ],
        [f64::NAN, 0.5, -0.01, 0.01],
        [0.5, -0.5, 0.01, -0.01],
        [0.0; 4],
        [-f64::MAX, f64::MAX, -1.0, 1.0],
    ];
    for (k, height) in heights.into_iter().enumerate() {
        for extent in extents {
            for symmetric in [[true; 2], [false; 2]] {
                let mut problem = rigid();
                problem.runner = Runner::rigid(Arc::new(Formula {
                    height,
                    extent,
                    symmetric,
                }));
                check(&format!("hull {k} on {extent:?}"), &problem, &quick());
            }
        }
        let mut problem = rigid();
        problem.ice_surface = Some(Arc::new(FormulaIce(height)));
        check(&format!("ice {k}"), &problem, &quick());
    }
}
