//! Catalogue of effects on pressures.
//!
//! A new effect needs an entry in `catalogue.toml`, its law in `add_law`, and a test of its result.

use std::sync::{Arc, LazyLock};

use kufe_contact::{Foundation, Load, Problem, Tilt};
use kufe_mesh::Underside;
use kufe_sled::effects::read_catalogue;

use crate::case::effects::effect::{Effect, Map};

/// All effects of the ice, the runner, and the pressure film or sensor array.
pub static CATALOGUE: LazyLock<Vec<Effect>> = LazyLock::new(|| {
    let mut effects: Vec<Effect> = read_catalogue(include_str!("catalogue.toml"));
    effects.iter_mut().for_each(add_law);
    effects
});

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    CATALOGUE.iter().find(|effect| effect.info.name == name)
}

/// Ratio of the rounding of a worn flat's edges to its depth.
const ROUNDING_RATIO: f64 = 0.1;

fn add_law(effect: &mut Effect) {
    match effect.info.name {
        "hardness" => {
            effect.on_problem = Some(|value, problem| {
                let inverse = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
                problem.ice.hardness = Some(1.0 / (inverse + value).max(1.0e-12));
            });
            // A bound on the pressure has no effect until it is below the largest measured
            // pressure.
            effect.search.begins = Some(|problem, largest| {
                let inverse = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
                (1.0 / largest - inverse).max(0.0)
            });
        }
        "ice-modulus" => {
            effect.on_problem = Some(|value, problem| problem.ice.youngs_modulus *= 1.0 + value);
        }
        "ice-thickness" => effect.on_problem = Some(change_thickness),
        "waviness" => {
            effect.on_problem = Some(|value, problem| {
                let wavenumber = std::f64::consts::TAU / 0.05;
                reshape(problem, [true, true], move |x, _, height| {
                    height + value * ((wavenumber * x).cos() - 1.0)
                });
            });
        }
        "pitch-offset" => {
            effect.on_problem = Some(|value, problem| turn(problem, 1, value));
        }
        "rocker-radius" => {
            effect.on_problem = Some(|value, problem| {
                reshape(problem, [true, true], move |x, _, height| {
                    height + 0.5 * value * x * x
                });
            });
        }
        "roll-tilt" => {
            effect.on_problem = Some(|value, problem| turn(problem, 0, value));
        }
        "runner-compliance" => {
            effect.on_problem = Some(|value, problem| problem.ice.youngs_modulus /= 1.0 + value);
        }
        "section-wear" => {
            effect.on_problem = Some(|value, problem| {
                let keel = problem.runner.underside.clone();
                reshape(problem, [true, true], move |x, _, height| {
                    let flat = keel.height(x, 0.0) + value;
                    0.5 * (height + flat + (height - flat).hypot(ROUNDING_RATIO * value))
                });
            });
        }
        "sensor-blur" => effect.on_map = Some(blur),
        "sensor-gain" => {
            effect.on_map = Some(|value, map| {
                map.pressure.iter_mut().for_each(|p| *p *= 1.0 + value);
            });
            effect.on_peak = Some(|value| 1.0 + value);
        }
        name => panic!("{name}: no law"),
    }
}

/// Adds `inverse` [1/m] to the inverse thickness of the ice layer.
fn change_thickness(inverse: f64, problem: &mut Problem) {
    let (nominal, bed) = match problem.ice.foundation {
        Foundation::HalfSpace => (f64::INFINITY, None),
        Foundation::RigidBed { thickness } => (thickness, None),
        Foundation::ElasticBed { thickness, bed } => (thickness, Some(bed)),
    };
    let thickness = 1.0 / (1.0 / nominal + inverse);
    problem.ice.foundation = match bed {
        _ if !(0.0..1.0e6).contains(&thickness) => Foundation::HalfSpace,
        Some(bed) => Foundation::ElasticBed { thickness, bed },
        None => Foundation::RigidBed { thickness },
    };
}

/// Convolves the map with a Gaussian along the rows, then along the columns. Pressure that leaves
/// the map is lost, as on a film.
fn blur(width: f64, map: &mut Map) {
    let pass = |values: &[f64], n: usize, step: f64| -> Vec<f64> {
        let reach = ((4.0 * width / step).ceil() as usize).min(n);
        let weight = |k: usize| (-0.5 * (k as f64 * step / width).powi(2)).exp();
        let sum = 1.0 + 2.0 * (1..=reach).map(weight).sum::<f64>();
        (0..n)
            .map(|i| {
                (i.saturating_sub(reach)..(i + reach + 1).min(n))
                    .map(|j| weight(i.abs_diff(j)) * values[j])
                    .sum::<f64>()
                    / sum
            })
            .collect()
    };
    for row in map.pressure.chunks_mut(map.nx) {
        let blurred = pass(row, row.len(), map.dx);
        row.copy_from_slice(&blurred);
    }
    for i in 0..map.nx {
        let column: Vec<f64> = (0..map.ny).map(|j| map.pressure[j * map.nx + i]).collect();
        for (j, p) in pass(&column, map.ny, map.dy).into_iter().enumerate() {
            map.pressure[j * map.nx + i] = p;
        }
    }
}

/// Replaces the height of the underside by `change(x, y, height)` [m]. `keeps` states which mirror
/// symmetries the change preserves.
fn reshape(
    problem: &mut Problem,
    keeps: [bool; 2],
    change: impl Fn(f64, f64, f64) -> f64 + Send + Sync + 'static,
) {
    let inner = problem.runner.underside.clone();
    problem.runner.underside = Arc::new(Shaped {
        inner,
        change,
        keeps,
    });
}

/// The underside with the height `change(x, y, height(x, y))`.
struct Shaped<F> {
    /// The original underside.
    inner: Arc<dyn Underside>,
    /// New height as a function of x, y and the original height [m].
    change: F,
    /// Which mirror symmetries the change preserves.
    keeps: [bool; 2],
}

impl<F: Fn(f64, f64, f64) -> f64 + Send + Sync> Underside for Shaped<F> {
    fn height(&self, x: f64, y: f64) -> f64 {
        let height = self.inner.height(x, y);
        if height.is_finite() {
            (self.change)(x, y, height)
        } else {
            height
        }
    }

    fn extent(&self) -> [f64; 4] {
        self.inner.extent()
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        let inner = self.inner.mirror_symmetric();
        [inner[0] && self.keeps[0], inner[1] && self.keeps[1]]
    }
}

/// Adds an angle about x (axis 0, positive lifts the left side) or y (axis 1, positive lowers the
/// nose) to a fixed tilt. With a free tilt the underside is rotated relative to the map's frame.
fn turn(problem: &mut Problem, axis: usize, angle: f64) {
    if let Load::Force {
        tilt: Tilt::Fixed { pitch, roll },
        ..
    } = &mut problem.load
    {
        *[roll, pitch][axis] += angle;
        return;
    }
    let slope = [[0.0, angle.tan()], [-angle.tan(), 0.0]][axis];
    reshape(problem, [axis == 0, axis == 1], move |x, y, height| {
        height + slope[0] * x + slope[1] * y
    });
}
