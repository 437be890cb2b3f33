//! Registration of a measured map: shift and rotation of the film against the runner.
//!
//! ```text
//! min over z of  sum over pixels ((p_measured - p(X; z)) w)^2  +  z.z
//! z = (shift along / d, shift across / d, rotation / r)  ~  N(0, 1)
//! ```
//!
//! d [m] and r [rad] are the film's tolerances, p(X; z) is the simulated pressure on the film's
//! pixels ([`FilmPosition`]), w the weight of a pixel. Gauss-Newton with Levenberg's damping takes
//! the derivative from the gradient of the simulated map over the pixels:
//!
//! ```text
//! dp/dshift = -grad p,    dp/drotation = e_y dp/dx - e_x dp/dy,    e = X - c - shift
//! ```
//!
//! Every simulation is registered anew. The change of its residuals with the size of an effect is
//! then orthogonal to shifts and rotations, up to their prior (variable projection, G.H. Golub, V.
//! Pereyra, SIAM J. Numer. Anal. 10 (1973) 413-432), and an effect that only moves the map changes
//! the sum of squares by the prior's part alone.

use std::f64::consts::PI;

use kufe::case::effects::Map;
use nalgebra::{Matrix3, Vector3};

use crate::evidence::maps::sample::{FilmPosition, SolvedPressure, centre, place};

/// Largest number of trial steps of Gauss-Newton.
const MAX_TRIALS: usize = 30;
/// Predicted decrease of the sum of squares, in independent values, below which the iteration ends.
const TOLERANCE: f64 = 1e-4;

/// Standard deviations of a film's position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilmTolerance {
    /// Standard deviation of the shift in each direction [m].
    pub shift: f64,
    /// Standard deviation of the rotation [rad].
    pub rotation: f64,
}

impl FilmTolerance {
    fn position(&self, z: &Vector3<f64>) -> FilmPosition {
        FilmPosition {
            shift: [self.shift * z[0], self.shift * z[1]],
            rotation: self.rotation * z[2],
        }
    }

    /// A position in standard deviations; 0 where the tolerance is 0.
    fn standardised(&self, position: &FilmPosition) -> Vector3<f64> {
        let ratio = |size: f64, sd: f64| if sd > 0.0 { size / sd } else { 0.0 };
        Vector3::new(
            ratio(position.shift[0], self.shift),
            ratio(position.shift[1], self.shift),
            ratio(position.rotation, self.rotation),
        )
    }
}

/// A simulated map in the position that fits the measured one best.
pub struct Registered {
    /// The simulated map on the film's pixels.
    pub map: Map,
    /// Position of the film.
    pub position: FilmPosition,
    /// The position in standard deviations of its tolerance.
    pub z: [f64; 3],
    /// Standard errors of `z`, at most 1.
    pub errors: [f64; 3],
}

/// A measured map with the weights of its pixels [1/Pa].
pub struct Film<'a> {
    pub measured: &'a Map,
    pub weights: &'a [f64],
    pub tolerance: FilmTolerance,
}

impl Film<'_> {
    /// Registers `solved`, as the sensor reads it, to the measured map.
    ///
    /// Starts from the best of three positions: no shift, the shift that makes the centres agree,
    /// and this shift with the rotation that makes the principal axes agree.
    pub fn register(&self, solved: &SolvedPressure, sense: &dyn Fn(&mut Map)) -> Registered {
        let evaluate = |z: Vector3<f64>| {
            let mut map = solved.on(self.measured, &self.tolerance.position(&z));
            sense(&mut map);
            (self.objective(&map, &z), z, map)
        };
        let starts = self.starts(solved).into_iter().map(evaluate);
        let mut here = starts
            .reduce(|best, other| if other.0 < best.0 { other } else { best })
            .expect("three positions");
        let (mut normal, mut gradient) = self.derivatives(&here.2, &here.1);
        let mut damping = 0.0;
        for _ in 0..MAX_TRIALS {
            let damped = normal + Matrix3::from_diagonal(&(normal.diagonal() * damping));
            let step = inverse(&damped) * gradient;
            if step.dot(&gradient) < TOLERANCE {
                break;
            }
            let trial = evaluate(here.1 + step);
            if trial.0 < here.0 {
                here = trial;
                (normal, gradient) = self.derivatives(&here.2, &here.1);
                damping = if damping > 1e-3 { 0.1 * damping } else { 0.0 };
            } else {
                damping = f64::max(1e-2, 10.0 * damping);
            }
        }
        Registered {
            map: here.2,
            position: self.tolerance.position(&here.1),
            z: here.1.into(),
            errors: inverse(&normal).diagonal().map(f64::sqrt).into(),
        }
    }

    /// Weighted sum of squares of a map in position z, with the prior's part.
    fn objective(&self, map: &Map, z: &Vector3<f64>) -> f64 {
        let pairs = self.measured.pressure.iter().zip(&map.pressure);
        let weighted = pairs.zip(self.weights).map(|((m, s), w)| (m - s) * w);
        weighted.map(|r| r.powi(2)).sum::<f64>() + z.norm_squared()
    }

    /// The three starting positions of [`register`](Self::register).
    fn starts(&self, solved: &SolvedPressure) -> [Vector3<f64>; 3] {
        let measured = Moments::of_map(self.measured);
        let simulated = Moments::of(&solved.forces().collect::<Vec<_>>());
        let c = centre(self.measured);
        let position = |rotation: f64| {
            let (sin, cos) = rotation.sin_cos();
            let arm = [0, 1].map(|a| simulated.middle[a] - c[a]);
            let turned = [cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]];
            self.tolerance.standardised(&FilmPosition {
                shift: [0, 1].map(|a| measured.middle[a] - c[a] - turned[a]),
                rotation,
            })
        };
        // The principal axis is defined up to half a turn.
        let (sin, cos) = (measured.axis - simulated.axis).sin_cos();
        let turn = sin.atan2(cos);
        let turn = turn - PI * (turn / PI).round();
        [Vector3::zeros(), position(0.0), position(turn)]
    }

    /// Normal matrix and negative half gradient of the objective with respect to z.
    fn derivatives(&self, map: &Map, z: &Vector3<f64>) -> (Matrix3<f64>, Vector3<f64>) {
        let (c, position) = (centre(map), self.tolerance.position(z));
        let (mut normal, mut gradient) = (Matrix3::identity(), -z);
        for (k, (m, w)) in self.measured.pressure.iter().zip(self.weights).enumerate() {
            let (i, j) = (k % map.nx, k / map.nx);
            let value = |i: usize, j: usize| map.pressure[j * map.nx + i];
            let (left, right) = (i.saturating_sub(1), (i + 1).min(map.nx - 1));
            let (below, above) = (j.saturating_sub(1), (j + 1).min(map.ny - 1));
            // One-sided differences at the border.
            let [nx, ny] = [right - left, above - below].map(|cells| cells.max(1) as f64);
            let px = (value(right, j) - value(left, j)) / (nx * map.dx);
            let py = (value(i, above) - value(i, below)) / (ny * map.dy);
            if px == 0.0 && py == 0.0 {
                continue;
            }
            let at = place(map, k);
            let [along, across] = [0, 1].map(|a| at[a] - c[a] - position.shift[a]);
            let derivative = Vector3::new(
                -px * self.tolerance.shift,
                -py * self.tolerance.shift,
                (across * px - along * py) * self.tolerance.rotation,
            ) * *w;
            normal += derivative * derivative.transpose();
            gradient += derivative * ((m - map.pressure[k]) * w);
        }
        (normal, gradient)
    }
}

/// Inverse of a normal matrix, whose prior makes it positive definite.
fn inverse(normal: &Matrix3<f64>) -> Matrix3<f64> {
    normal.try_inverse().expect("at least the identity")
}

/// Sum, centre, spread and principal axis of a pressure.
pub struct Moments {
    pub sum: f64,
    /// Centre [m].
    pub middle: [f64; 2],
    /// Standard deviation along and across [m].
    pub spread: [f64; 2],
    /// Angle of the principal axis [rad].
    pub axis: f64,
}

impl Moments {
    /// Moments of points x [m], y [m] with a weight.
    fn of(points: &[[f64; 3]]) -> Self {
        let sum: f64 = points.iter().map(|p| p[2]).sum::<f64>().max(1e-300);
        let mean =
            |of: &dyn Fn(&[f64; 3]) -> f64| points.iter().map(|p| p[2] * of(p)).sum::<f64>() / sum;
        let middle = [mean(&|p| p[0]), mean(&|p| p[1])];
        let second = |a: usize, b: usize| mean(&|p| (p[a] - middle[a]) * (p[b] - middle[b]));
        let [xx, xy, yy] = [second(0, 0), second(0, 1), second(1, 1)];
        Self {
            sum,
            middle,
            spread: [xx.sqrt(), yy.sqrt()],
            axis: 0.5 * (2.0 * xy).atan2(xx - yy),
        }
    }

    /// Moments of the pixels above a tenth of the largest; the spread is at least a pixel.
    pub fn of_map(map: &Map) -> Self {
        let threshold = 0.1 * map.pressure.iter().copied().fold(0.0, f64::max);
        let pixels = map
            .pressure
            .iter()
            .enumerate()
            .filter(|(_, p)| **p > threshold);
        let points: Vec<[f64; 3]> = pixels
            .map(|(k, p)| {
                let [x, y] = place(map, k);
                [x, y, *p]
            })
            .collect();
        let mut moments = Self::of(&points);
        let pixel = [map.dx, map.dy];
        moments.spread = [0, 1].map(|a| moments.spread[a].max(pixel[a]));
        moments
    }
}
