//! Coverage of stated errors by classes of random contacts.

use std::sync::Arc;

use kufe_contact::{Bed, ElasticRunner, Error, Foundation, Ice, Load, Options, Problem, Runner};
use kufe_contact::{Solution, Tilt, solve};
use kufe_mesh::{BobRunner, Paraboloid, Rocker, Section, Swept, Underside};

use crate::contact::{Formula, ICE_E, ICE_NU};

/// A contact with its reference solution, as `tests/data/coverage.py` writes it.
#[derive(Clone, Debug)]
pub struct Row {
    /// Class of contacts.
    pub class: String,
    /// Line of the file.
    pub text: String,
    /// Rocker and section radius [m], coefficient of x^4 [1/m^3], force [N], offset x and y [m],
    /// thickness [m], Young's modulus [Pa] and thickness of a bed [m], whether the runner is steel,
    /// hardness [Pa], depth of a worn flat and radius of its edges [m], track's curvature [1/m].
    numbers: [f64; 14],
    /// Reference peak pressure [Pa], area [m2] and approach [m]; 0 if there is no reference.
    truth: [f64; 3],
    /// Relative error of the reference peak and approach.
    truth_error: f64,
}

/// The rows of `tests/data/coverage.csv`.
pub fn rows() -> Vec<Row> {
    rows_of(include_str!("../data/coverage.csv"))
}

/// The rows of a table written by `tests/data/coverage.py`.
///
/// # Panics
/// If the table has another format.
pub fn rows_of(table: &str) -> Vec<Row> {
    let row = |line: &str| {
        let (class, numbers) = line.split_once(',').expect("a class and numbers");
        let numbers: Vec<f64> = numbers
            .split(',')
            .map(|number| number.parse().expect("a number"))
            .collect();
        let (problem, reported) = numbers.split_at(14);
        Row {
            class: class.to_string(),
            text: line.to_string(),
            numbers: problem.try_into().expect("14 numbers"),
            truth: reported[..3].try_into().expect("three figures"),
            truth_error: reported[3],
        }
    };
    table.lines().skip(1).map(row).collect()
}

/// Actual and stated error of a quantity, relative to its reference value.
#[derive(Clone, Copy, Debug)]
pub struct ErrorPair {
    /// Difference from the reference value.
    pub actual: f64,
    /// Error stated by the solver.
    pub stated: f64,
}

impl ErrorPair {
    /// Errors of `value` with the stated absolute error `error`.
    pub fn of(value: f64, error: f64, truth: f64) -> Self {
        Self {
            actual: (value / truth - 1.0).abs(),
            stated: error / truth,
        }
    }
}

/// Errors of one row at one requested accuracy.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Peak pressure, area, approach; `None` without a reference value.
    pub errors: [Option<ErrorPair>; 3],
    /// Whether the requested accuracy was reached.
    pub reached: bool,
}

impl Row {
    /// The contact problem.
    ///
    /// # Panics
    /// If a number is out of range.
    pub fn problem(&self) -> Problem {
        let [
            rocker,
            section,
            quartic,
            fz,
            offset_x,
            offset_y,
            thickness,
            bed,
            bed_thickness,
            steel,
            hardness,
            worn,
            worn_edge,
            curvature,
        ] = self.numbers;
        let bob = BobRunner::default();
        let underside: Arc<dyn Underside> = if curvature != 0.0 || worn > 0.0 {
            let width = bob.width.min(2.0 * section);
            let section =
                Section::arc(section, width).and_then(|arc| arc.worn(worn, worn_edge / section));
            let hull = Rocker::arc(rocker).and_then(|rocker| {
                Swept::with_rounded_ends(rocker, section?, bob.length, bob.height)
            });
            Arc::new(hull.expect("a runner"))
        } else if quartic > 0.0 {
            Arc::new(Formula {
                height: move |x: f64, y: f64| {
                    x * x / (2.0 * rocker) + quartic * x.powi(4) + y * y / (2.0 * section)
                },
                extent: [
                    f64::NEG_INFINITY,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    f64::INFINITY,
                ],
                symmetric: [true; 2],
            })
        } else {
            Arc::new(Paraboloid::new(rocker, section).expect("a paraboloid"))
        };
        let elastic = ElasticRunner::fixed_at_top(210e9, 0.30, f64::INFINITY);
        let foundation = match (thickness.is_finite(), bed > 0.0) {
            (false, _) => Foundation::HalfSpace,
            (true, false) => Foundation::RigidBed { thickness },
            (true, true) => Foundation::ElasticBed {
                thickness,
                bed: Bed {
                    youngs_modulus: bed,
                    poissons_ratio: 0.2,
                    thickness: bed_thickness,
                },
            },
        };
        let runner = Runner {
            underside,
            elastic: (steel > 0.0).then_some(elastic),
        };
        let ice = Ice {
            foundation,
            hardness: hardness.is_finite().then_some(hardness),
            ..Ice::half_space(ICE_E, ICE_NU)
        };
        let load = Load::Force {
            fz,
            offset_x,
            offset_y,
            tilt: Tilt::Free,
        };
        Problem {
            track_curvature: curvature,
            ..Problem::new(runner, ice, load)
        }
    }

    /// Solves to a relative error `accuracy` of the peak and compares with the reference.
    ///
    /// # Errors
    /// Those of the solver, except [`Error::AccuracyNotReached`].
    pub fn outcome(&self, accuracy: f64) -> Result<Outcome, Error> {
        let options = Options {
            p_max_tolerance: accuracy,
            ..Options::default()
        };
        let (solution, reached) = match solve(&self.problem(), &options) {
            Ok(solution) => (solution, true),
            Err(Error::AccuracyNotReached { best, .. }) => (*best, false),
            Err(error) => return Err(error),
        };
        Ok(Outcome {
            errors: self.compared(&solution),
            reached,
        })
    }

    fn compared(&self, s: &Solution) -> [Option<ErrorPair>; 3] {
        let stated = [
            (s.p_max, s.p_max_error),
            (s.area, s.area_error),
            (s.approach, s.approach_error),
        ];
        std::array::from_fn(|k| self.errors(k, stated[k].0, stated[k].1))
    }

    /// Errors of a quantity (0: peak, 1: area, 2: approach); `None` without a reference value.
    pub fn errors(&self, quantity: usize, value: f64, error: f64) -> Option<ErrorPair> {
        let truth = self.truth[quantity];
        (truth > 0.0).then(|| ErrorPair::of(value, error, truth))
    }

    /// Whether the stated error and the error of the reference cover the actual error.
    ///
    /// A reference area of boundary elements has an error of one percent, from the elements at the
    /// rim.
    pub fn is_covered(&self, quantity: usize, errors: ErrorPair) -> bool {
        let rectangles = match self.class.as_str() {
            "no paraboloid" | "ice that yields" if quantity == 1 => 0.01,
            _ => 0.0,
        };
        errors.actual <= errors.stated + self.truth_error.max(rectangles)
    }
}
