//! Stress under elliptic Hertz contacts by numerical integration, as the reference for the stated
//! errors of the solver.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use kufe_contact::{
    Error, Hertz, Ice, LargestShear, Load, Options, Problem, Runner, Tilt, UnderPeak, hertz, solve,
};
use kufe_fem::maximum_shear;
use kufe_mesh::Paraboloid;

use crate::coverage::ErrorPair;

/// Stresses (xx, yy, zz) at depth `z` under the centre of a Hertz contact of half-axes `a` >= `b`
/// and unit peak pressure.
///
/// Integrates Boussinesq's point load (Johnson, Contact Mechanics, eq. 3.19) over the ellipse with
/// the substitutions x = b sinh(u), which is dense near the centre, and y = Y sin(v), where Y is the
/// half-width at x.
pub fn hertz_stress(a: f64, b: f64, nu: f64, z: f64) -> [f64; 3] {
    const STRIPS: usize = 600;
    const POINTS: usize = 300;
    let mut sum = [0.0; 3];
    let du = (a / b).asinh() / STRIPS as f64;
    let dv = PI / POINTS as f64;
    for m in 0..STRIPS {
        let u = (m as f64 + 0.5) * du;
        let x = b * u.sinh();
        let half = b * (1.0 - (x / a).powi(2)).max(0.0).sqrt();
        for n in 0..POINTS {
            let v = -0.5 * PI + (n as f64 + 0.5) * dv;
            let y = half * v.sin();
            // Both halves of the ellipse; the pressure is half / b cos(v).
            let area = 2.0 * b * u.cosh() * du * half * v.cos() * dv;
            let load = half / b * v.cos() * area;
            let r2 = x * x + y * y;
            let rho = (r2 + z * z).sqrt();
            let side = |u: f64, v: f64| {
                (1.0 - 2.0 * nu) / r2
                    * ((1.0 - z / rho) * (u * u - v * v) / r2 + z * v * v / rho.powi(3))
                    - 3.0 * z * u * u / rho.powi(5)
            };
            let each = [side(x, y), side(y, x), -3.0 * z.powi(3) / rho.powi(5)];
            for (total, value) in sum.iter_mut().zip(each) {
                *total += load / TAU * value;
            }
        }
    }
    sum
}

/// The largest shear stress on the axis of a Hertz contact of half-axes `a` >= `b` and unit peak
/// pressure, and its depth.
pub fn hertz_shear(a: f64, b: f64, nu: f64) -> LargestShear {
    let shear = |z: f64| {
        let [xx, yy, zz] = hertz_stress(a, b, nu, z);
        maximum_shear([xx, yy, zz, 0.0, 0.0, 0.0])
    };
    // Long contacts on ice of a low Poisson's ratio have two maxima, because the smallest
    // horizontal stress changes its direction with depth.
    let coarse = (1..=50).map(|i| 0.02 * b * f64::from(i));
    let top = coarse
        .map(|z| (z, shear(z)))
        .max_by(|p, q| p.1.total_cmp(&q.1))
        .expect("depths");
    let (mut low, mut high) = (top.0 - 0.02 * b, top.0 + 0.02 * b);
    for _ in 0..12 {
        let [left, right] = [low + (high - low) / 3.0, high - (high - low) / 3.0];
        if shear(left) < shear(right) {
            low = left
        } else {
            high = right
        }
    }
    let depth = 0.5 * (low + high);
    LargestShear {
        value: shear(depth),
        depth,
    }
}

/// A random paraboloid on a half-space.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// Radii along and across [m].
    pub radii: [f64; 2],
    /// Force [N].
    pub force: f64,
    /// Offset of the load over the half-axes of the patch; a non-zero offset breaks the mirror
    /// symmetry.
    pub offset: [f64; 2],
    /// Young's modulus [Pa] and Poisson's ratio of the ice.
    pub ice: [f64; 2],
}

/// Uniform random numbers in [0, 1) by xorshift (G. Marsaglia, 2003).
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// `count` random contacts: aspect ratios of the patch 1 to 200, Poisson's ratios 0.2 to 0.4, every
/// second load with an offset.
pub fn random_contacts(seed: u64, count: usize) -> Vec<Sample> {
    let mut random = Random(seed.max(1).wrapping_mul(0x9e37_79b9_7f4a_7c15));
    // The first numbers after a small seed are small.
    for _ in 0..20 {
        random.next();
    }
    let each = |k: usize| {
        let section = random.between(2e-3, 20e-3);
        let ratio = 10f64.powf(random.between(0.0, 3.85));
        let offset = [random.between(-1.0, 1.0), random.between(-1.0, 1.0)];
        Sample {
            radii: [ratio * section, section],
            force: 10f64.powf(random.between(1.5, 3.5)),
            offset: offset.map(|part| if k % 2 == 1 { part } else { 0.0 }),
            ice: [random.between(4e9, 10e9), random.between(0.2, 0.4)],
        }
    };
    (0..count).map(each).collect()
}

impl Sample {
    /// Hertz's solution.
    ///
    /// # Panics
    /// If the radii, modulus or force are out of range.
    pub fn hertz(&self) -> Hertz {
        let [young, poisson] = self.ice;
        let modulus = young / (1.0 - poisson * poisson);
        hertz(self.radii[0], self.radii[1], modulus, self.force).expect("a contact")
    }

    /// The contact problem. An offset load rotates the paraboloid and leaves Hertz's solution
    /// unchanged.
    ///
    /// # Panics
    /// If a radius is out of range.
    pub fn problem(&self) -> Problem {
        let [rocker, section] = self.radii;
        let runner = Runner::rigid(Arc::new(Paraboloid::new(rocker, section).expect("radii")));
        let Hertz { a, b, .. } = self.hertz();
        let load = Load::Force {
            fz: self.force,
            offset_x: a * self.offset[0],
            offset_y: b * self.offset[1],
            tilt: Tilt::Free,
        };
        Problem::new(runner, Ice::half_space(self.ice[0], self.ice[1]), load)
    }

    /// Actual and stated errors of the largest shear stress and of its depth, at a requested
    /// relative error of the peak pressure. The reference is [`hertz_shear`].
    ///
    /// # Errors
    /// Those of the solver.
    ///
    /// # Panics
    /// If the solution has no largest shear stress under the surface.
    pub fn errors(&self, accuracy: f64) -> Result<[ErrorPair; 2], Error> {
        let options = Options {
            p_max_tolerance: accuracy,
            subsurface: true,
            ..Options::default()
        };
        let UnderPeak {
            shear,
            shear_error,
            depth,
            depth_error,
        } = solve(&self.problem(), &options)?
            .under_peak
            .expect("a largest shear under the surface");
        let Hertz { a, b, p_max, .. } = self.hertz();
        let truth = hertz_shear(a, b, self.ice[1]);
        Ok([
            ErrorPair::of(shear, shear_error, truth.value * p_max),
            ErrorPair::of(depth, depth_error, truth.depth),
        ])
    }
}
