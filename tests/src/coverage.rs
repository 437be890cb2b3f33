//! Whether stated errors hold the true ones, class by class of contacts drawn at random.

use std::sync::Arc;

use kufe_contact::{Bed, ElasticRunner, Error, Foundation, Ice, Load, Options, Problem, Runner};
use kufe_contact::{Solution, Tilt, solve};
use kufe_mesh::{BobRunner, Paraboloid, Rocker, Section, Swept, Underside};

use crate::contact::{Formula, ICE_E, ICE_NU};

/// A contact with what others say of it: `tests/data/coverage.py` writes them.
#[derive(Clone, Debug)]
pub struct Row {
    /// The class of contacts that it was drawn from.
    pub class: String,
    /// As the file has it.
    pub text: String,
    /// Rocker and section radius [m], share of x^4 [1/m^3], force [N], offset x and y [m],
    /// thickness [m], Young's modulus [Pa] and thickness of a bed [m], whether the runner is steel,
    /// hardness [Pa], depth of a worn flat and radius of its edges [m], track's curvature [1/m].
    numbers: [f64; 14],
    /// Peak pressure [Pa], area [m2] and approach [m]; 0 where nothing is known.
    truth: [f64; 3],
    /// What the truth of peak and approach itself may be off by, relative.
    truth_error: f64,
}

/// The rows of `tests/data/coverage.csv`.
pub fn rows() -> Vec<Row> {
    rows_of(include_str!("../data/coverage.csv"))
}

/// The rows of a table that `tests/data/coverage.py` wrote.
///
/// # Panics
/// Where it is none.
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

/// A figure beside the truth.
#[derive(Clone, Copy, Debug)]
pub struct Miss {
    /// Relative difference from the truth.
    pub off: f64,
    /// Relative error stated.
    pub stated: f64,
}

/// What a solve at one accuracy says of one row.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Peak pressure, area, approach; `None` where the truth says nothing of it.
    pub figures: [Option<Miss>; 3],
    /// Whether the accuracy asked was reached.
    pub reached: bool,
}

impl Row {
    /// The problem that the row states.
    ///
    /// # Panics
    /// Where a number is out of range.
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

    /// Solves to an accuracy and compares.
    ///
    /// # Errors
    /// Those of the solver but for an accuracy that is not reached.
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
            figures: self.compared(&solution),
            reached,
        })
    }

    fn compared(&self, s: &Solution) -> [Option<Miss>; 3] {
        let stated = [
            (s.p_max, s.p_max_error),
            (s.area, s.area_error),
            (s.approach, s.approach_error),
        ];
        std::array::from_fn(|k| self.miss(k, stated[k].0, stated[k].1))
    }

    /// A figure (0: peak, 1: area, 2: approach) with its stated error beside the truth; `None`
    /// where the truth says nothing of it.
    pub fn miss(&self, figure: usize, value: f64, error: f64) -> Option<Miss> {
        let truth = self.truth[figure];
        (truth > 0.0).then(|| Miss {
            off: (value / truth - 1.0).abs(),
            stated: error / truth,
        })
    }

    /// Whether what is stated, and what the truth is known to, holds a miss. An area of rectangles
    /// is known to some of them at its rim.
    pub fn holds(&self, figure: usize, miss: Miss) -> bool {
        let rectangles = match self.class.as_str() {
            "no paraboloid" | "ice that yields" if figure == 1 => 0.01,
            _ => 0.0,
        };
        miss.off <= miss.stated + self.truth_error.max(rectangles)
    }
}
