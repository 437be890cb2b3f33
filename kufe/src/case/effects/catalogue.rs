//! Effects on pressures: one table.
//!
//! A new effect is an entry of a table: description, law, and an example with the number that it
//! must give.

use std::sync::Arc;

use kufe_contact::{Foundation, Load, Problem, Tilt};
use kufe_mesh::Underside;
use kufe_sled::effects::{ActsOn, Form, Info, amplitude};

use crate::case::effects::effect::{Adds, Effect, Example, Growth, Measure, Search};

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    CATALOGUE.iter().find(|effect| effect.info.name == name)
}

/// An effect on the contact problem.
const CONTACT: Info = Info {
    acts_on: &[ActsOn::Contact],
    ..Effect::ON_PRESSURE
};

/// An effect on the measured map.
const MAP: Info = Info {
    acts_on: &[ActsOn::Map],
    ..Effect::ON_PRESSURE
};

/// Rounding of a worn flat's edges over its depth.
const ROUNDED: f64 = 0.1;

/// All effects: of the ice, of the runner, of the pressure film or sensor array.
pub static CATALOGUE: &[Effect] = &[
    // A bound on the pressure: p <= H with 1/H the parameter, 0 for no bound.
    Effect {
        info: Info {
            name: "hardness",
            summary: "the ice yields under a largest pressure",
            formula: "p <= H, k = 1/H",
            signature: "a plateau in the middle of the map, growing with load",
            parameters: &[amplitude("inverse_per_pa", "1/Pa", 0.0, 1.0e-6, 2.0e-9)],
            looks_like: &["section-wear", "sensor-blur"],
            decides: "an imprint that remains in the ice after lifting",
            source: "L. Poirier, E.P. Lozowski, R.I. Thompson, Cold Reg. Sci. Technol. 67 (2011) 129-134; K.L. Johnson, Contact Mechanics (1985), ch. 6",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            let own = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
            problem.ice.hardness = Some(1.0 / (own + value).max(1.0e-12));
        }),
        search: Search {
            growth: Growth::Bent,
            // A bound acts only below the peak: it starts at the largest one measured.
            begins: Some(|problem, largest| {
                let own = problem.ice.hardness.map_or(0.0, |h| 1.0 / h);
                (1.0 / largest - own).max(0.0)
            }),
            ..Search::NEW
        },
        example: Example {
            size: 2.0e-8,
            of: "hardness [Pa]",
            measure: Measure::OfProblem(|problem| problem.ice.hardness.unwrap_or(f64::NAN)),
            gives: 5.0e7,
        },
        ..Effect::NEW
    },
    // Another Young's modulus of the ice. For a rigid runner in the model, a yielding runner is
    // exactly the same.
    Effect {
        info: Info {
            name: "ice-modulus",
            summary: "the ice is stiffer or softer than stated",
            formula: "E (1 + k)",
            signature: "peak pressure up, area down, alike at all loads",
            parameters: &[amplitude("factor", "", -0.9, 9.0, 0.1)],
            looks_like: &["runner-compliance", "sensor-gain"],
            decides: "the speed of sound in the ice",
            source: "E.M. Schulson, P. Duval, Creep and Fracture of Ice (2009)",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            problem.ice.youngs_modulus *= 1.0 + value;
        }),
        search: Search {
            adds: Adds::Factors,
            ..Search::NEW
        },
        example: Example {
            size: 0.1,
            of: "Young's modulus of the ice [Pa]",
            measure: Measure::OfProblem(|problem| problem.ice.youngs_modulus),
            gives: 9.9e9,
        },
        ..Effect::NEW
    },
    // Another thickness t of the ice layer; 1/t = 0 is a half-space.
    Effect {
        info: Info {
            name: "ice-thickness",
            summary: "the ice is thicker or thinner than stated",
            formula: "1/t + k",
            signature: "stiffer under large loads, where the contact is as wide as the layer is thick",
            parameters: &[amplitude("inverse_per_m", "1/m", -19.0, 5000.0, 20.0)],
            looks_like: &["ice-modulus"],
            decides: "a drill hole",
            source: "K.L. Johnson, Contact Mechanics (1985), ch. 5.8",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            let own = match problem.ice.foundation {
                Foundation::HalfSpace => 0.0,
                Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                    1.0 / thickness
                }
            };
            let inverse = own + value;
            let thickness = 1.0 / inverse;
            problem.ice.foundation = match problem.ice.foundation {
                _ if inverse <= 1.0e-6 => Foundation::HalfSpace,
                Foundation::ElasticBed { bed, .. } => Foundation::ElasticBed { thickness, bed },
                _ => Foundation::RigidBed { thickness },
            };
        }),
        // A layer acts once it is as thin as the contact is wide.
        search: Search {
            growth: Growth::Far,
            ..Search::NEW
        },
        example: Example {
            size: 20.0,
            of: "thickness of the layer [m]",
            measure: Measure::OfProblem(|problem| match problem.ice.foundation {
                Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                    thickness
                }
                Foundation::HalfSpace => f64::INFINITY,
            }),
            gives: 0.05,
        },
        ..Effect::NEW
    },
    // Waves along the track, 50 mm long.
    Effect {
        info: Info {
            name: "waviness",
            summary: "the ice is wavy",
            formula: "z + a (cos(2 pi x / 50 mm) - 1)",
            signature: "the pressure modulated along the runner",
            parameters: &[amplitude("amplitude_m", "m", -1.0e-4, 1.0e-4, 1.0e-6)],
            looks_like: &["rocker-radius"],
            decides: "the ice seen under grazing light",
            source: "H.M. Westergaard, J. Appl. Mech. 6 (1939) 49-53",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            let number = std::f64::consts::TAU / 0.05;
            problem.runner.underside = Arc::new(Shaped {
                inner: problem.runner.underside.clone(),
                change: move |x: f64, _, height| height + value * ((number * x).cos() - 1.0),
                keeps: [true, true],
            });
        }),
        search: Search {
            needs_map: true,
            ..Search::NEW
        },
        example: Example {
            size: 1.0e-6,
            of: "height of the underside at x = 25 mm [m]",
            measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.025, 0.0)),
            gives: 8.416666666666667e-6,
        },
        ..Effect::NEW
    },
    // The runner turned about y by an angle that the model does not have. With a fixed tilt the
    // angle adds to it; with a free one the underside is turned against the frame of the map.
    Effect {
        info: Info {
            name: "pitch-offset",
            summary: "the runner is pitched",
            formula: "fixed pitch + a",
            signature: "the map shifted along the runner",
            parameters: &[amplitude("angle_rad", "rad", -0.3, 0.3, 1.0e-4)],
            looks_like: &["rocker-radius"],
            decides: "the runner seen from the side",
            source: "rigid-body geometry",
            ..CONTACT
        },
        on_problem: Some(|value, problem| turn(problem, About::Y, value)),
        search: Search {
            needs_map: true,
            ..Search::NEW
        },
        example: Example {
            size: 0.1,
            of: "height of the underside 6 mm ahead [m]",
            measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.006, 0.0)),
            gives: -6.0140803251270e-4,
        },
        ..Effect::NEW
    },
    // The rocker's curvature 1/R is off; the track's vertical curvature adds to it.
    Effect {
        info: Info {
            name: "rocker-radius",
            summary: "the rocker is another",
            formula: "1/R + k: z + k x^2/2",
            signature: "the map longer or shorter along the runner",
            parameters: &[amplitude("curvature_1pm", "1/m", -0.2, 0.2, 0.003)],
            looks_like: &["pitch-offset", "waviness"],
            decides: "a straightedge with feeler gauges",
            source: "H. Hertz (1881), by K.L. Johnson, Contact Mechanics (1985), ch. 4",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            problem.runner.underside = Arc::new(Shaped {
                inner: problem.runner.underside.clone(),
                change: move |x, _, height| height + 0.5 * value * x * x,
                keeps: [true, true],
            });
        }),
        example: Example {
            size: 0.02,
            of: "height of the underside at x = 0.1 m [m]",
            measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.1, 0.0)),
            gives: 0.8e-3 / 3.0,
        },
        ..Effect::NEW
    },
    // The runner turned about x by an angle that the model does not have. With a fixed tilt the
    // angle adds to it; with a free one the underside is turned against the frame of the map.
    Effect {
        info: Info {
            name: "roll-tilt",
            summary: "the runner is rolled",
            formula: "fixed roll + a",
            signature: "the map shifted across and skewed",
            parameters: &[amplitude("angle_rad", "rad", -0.3, 0.3, 0.002)],
            looks_like: &["section-wear"],
            decides: "the runner seen from the front",
            source: "rigid-body geometry",
            ..CONTACT
        },
        on_problem: Some(|value, problem| turn(problem, About::X, value)),
        search: Search {
            needs_map: true,
            ..Search::NEW
        },
        example: Example {
            size: 0.1,
            of: "height of the underside 1 mm to the left [m]",
            measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.0, 0.001)),
            gives: 2.0033467208545054e-4,
        },
        ..Effect::NEW
    },
    // The runner gives k times as much as the ice: about 0.04 for steel on ice as a block, more
    // where the runner bends.
    Effect {
        info: Info {
            name: "runner-compliance",
            summary: "the runner yields elastically under its load",
            formula: "E*/(1 + k)",
            signature: "that of a softer ice",
            parameters: &[amplitude("factor", "", 0.0, 3.0, 0.1)],
            looks_like: &["ice-modulus"],
            decides: "the same runner on a plate of known modulus",
            source: "K.L. Johnson, Contact Mechanics (1985), ch. 4.2",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            problem.ice.youngs_modulus /= 1.0 + value;
        }),
        search: Search {
            adds: Adds::Factors,
            ..Search::NEW
        },
        example: Example {
            size: 0.25,
            of: "Young's modulus of the ice [Pa]",
            measure: Measure::OfProblem(|problem| problem.ice.youngs_modulus),
            gives: 7.2e9,
        },
        ..Effect::NEW
    },
    // The section is worn to a flat of depth d, its edges rounded by max(a, b) = (a + b +
    // sqrt((a - b)^2 + (d/10)^2))/2. Wear leaves no kink, under which the pressure would have no
    // bound. How sharp the edges are is not known: between a kink and this rounding the height
    // at an edge differs by d/20, which a fitted depth may take up; its interval holds that,
    // spread evenly.
    Effect {
        info: Info {
            name: "section-wear",
            summary: "the section is worn to a flat",
            formula: "max(z, keel + d), edges rounded over d/10",
            signature: "two ridges of pressure at the edges of the flat",
            parameters: &[amplitude("depth_m", "m", 0.0, 5.0e-4, 5.0e-6)],
            form: Form::Open(0.5 * ROUNDED / 1.732_050_807_568_877_2),
            looks_like: &["hardness", "roll-tilt"],
            decides: "a profile of the section",
            source: "K.L. Johnson, Contact Mechanics (1985), ch. 2.8 (flat punch with rounded edges)",
            ..CONTACT
        },
        on_problem: Some(|value, problem| {
            let keel = problem.runner.underside.clone();
            problem.runner.underside = Arc::new(Shaped {
                inner: problem.runner.underside.clone(),
                change: move |x, _, height: f64| {
                    let flat = keel.height(x, 0.0) + value;
                    0.5 * (height + flat + (height - flat).hypot(ROUNDED * value))
                },
                keeps: [true, true],
            });
        }),
        // A flat grows with the root of its depth.
        search: Search {
            needs_map: true,
            growth: Growth::Far,
            ..Search::NEW
        },
        example: Example {
            size: 1.0e-5,
            of: "height of the underside at its lowest place [m]",
            measure: Measure::OfProblem(|problem| problem.runner.underside.height(0.0, 0.0)),
            gives: 1.0024937810560446e-5,
        },
        ..Effect::NEW
    },
    // The map is convolved with a Gaussian of deviation w in both directions; another modulus
    // keeps the edges sharp.
    Effect {
        info: Info {
            name: "sensor-blur",
            summary: "the sensor washes the map out",
            formula: "Gaussian of deviation w",
            signature: "the peak lower, the edges blurred, the sum unchanged",
            parameters: &[amplitude("width_m", "m", 0.0, 0.02, 0.0005)],
            looks_like: &["ice-modulus", "hardness"],
            decides: "a map of a sharp edge",
            source: "point-spread function of pressure-sensitive film",
            ..MAP
        },
        on_map: Some(|value, map| {
            // Separable: along the rows, then along the columns; what leaves the map is lost as on
            // a film.
            let pass = |values: &[f64], n: usize, step: f64| -> Vec<f64> {
                let reach = ((4.0 * value / step).ceil() as usize).min(n);
                let weight = |k: usize| (-0.5 * (k as f64 * step / value).powi(2)).exp();
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
        }),
        search: Search {
            needs_map: true,
            growth: Growth::Square,
            adds: Adds::Squares,
            ..Search::NEW
        },
        example: Example {
            size: 2.0e-3,
            of: "largest pixel [Pa]",
            measure: Measure::OfMap(|map| map.pressure.iter().copied().fold(0.0, f64::max)),
            gives: 39_790.135_140_764_02,
        },
        ..Effect::NEW
    },
    // The sensor reads a share too much.
    Effect {
        info: Info {
            name: "sensor-gain",
            summary: "the sensor reads a share too much",
            formula: "(1 + k) p",
            signature: "the map does not add up to the load",
            parameters: &[amplitude("factor", "", -0.8, 4.0, 0.05)],
            looks_like: &["ice-modulus"],
            decides: "the sensor under a known weight: the map must add up to the load",
            source: "calibration of pressure-sensitive film",
            ..MAP
        },
        on_map: Some(|value, map| {
            map.pressure.iter_mut().for_each(|p| *p *= 1.0 + value);
        }),
        on_peak: Some(|value| 1.0 + value),
        search: Search {
            adds: Adds::Factors,
            ..Search::NEW
        },
        example: Example {
            size: 0.1,
            of: "sum of the pixels [Pa]",
            measure: Measure::OfMap(|map| map.pressure.iter().sum()),
            gives: 1.1e6,
        },
        ..Effect::NEW
    },
];

/// `height(x, y) + change(x, y, height)`.
struct Shaped<F> {
    /// The underside as it was.
    inner: Arc<dyn Underside>,
    /// The new height from place and old height [m].
    change: F,
    /// Which mirror symmetries survive.
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

/// The axis that it is turned about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum About {
    /// x: positive lifts the left side.
    X,
    /// y: positive lowers the nose.
    Y,
}

/// Adds the angle to a fixed tilt; with a free one the underside is turned against the frame of the
/// map.
fn turn(problem: &mut Problem, about: About, angle: f64) {
    if let Load::Force {
        tilt: Tilt::Fixed { pitch, roll },
        ..
    } = &mut problem.load
    {
        match about {
            About::X => *roll += angle,
            About::Y => *pitch += angle,
        }
        return;
    }
    let slope = match about {
        About::X => [0.0, angle.tan()],
        About::Y => [-angle.tan(), 0.0],
    };
    problem.runner.underside = Arc::new(Shaped {
        inner: problem.runner.underside.clone(),
        change: move |x, y, height| height + slope[0] * x + slope[1] * y,
        keeps: [about == About::X, about == About::Y],
    });
}
