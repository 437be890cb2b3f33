//! Friction of a runner that ploughs ice and floats on its melt, by closed forms and one equation
//! along the patch.
//!
//! Rigid-plastic groove of a round section r on a rocker R_e (as the track leaves it) at hardness H
//! under a load F:
//!
//! ```text
//! l = sqrt(2 F sqrt(R_e/r) / (pi H)),   w(x) = 2 sqrt(r/R_e) sqrt(l^2 - x^2),   mu_plough = 4 l / (3 pi R_e)
//! ```
//!
//! Film on a long strip, xi from the front (x = l - xi), ice alone taking heat:
//!
//! ```text
//! rho L v_m = eta V^2 / h - k (T_m - T) / sqrt(pi kappa xi / V),   (V/2) dh/dxi = v_m - H h^3 / (eta w^2)
//! mu = mu_plough + 1/F integral of eta V / h w dxi
//! ```
//!
//! It begins as h = a sqrt(xi), the balance of melt and heat alone.

use std::f64::consts::PI;

/// Viscosity of water at its freezing point [Pa s].
const ETA: f64 = 1.79e-3;
/// Density of ice times its heat of melting [J/m3].
const MELT: f64 = 917.0 * 3.34e5;
/// Conductivity of ice [W/mK], and its diffusivity [m2/s].
const CONDUCTIVITY: f64 = 2.2;
const DIFFUSIVITY: f64 = 1.17e-6;
/// Slope of the melting point over the pressure [K/Pa].
const MELTING: f64 = -7.4e-8;
/// Steps along the patch.
const STEPS: usize = 300;

/// A runner's round section and rocker.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shape {
    /// Radius of the rocker [m].
    pub rocker_m: f64,
    /// Radius of the section [m].
    pub section_m: f64,
}

/// Pressure at which ice yields or melts, whichever is less [Pa].
pub fn hardness_pa(ice_c: f64) -> f64 {
    (1e6 * (14.7 - 0.6 * ice_c)).min(ice_c / MELTING)
}

/// Length of the patch [m].
pub fn length_m(shape: Shape, load_n: f64, hardness_pa: f64) -> f64 {
    (2.0 * load_n * (shape.rocker_m / shape.section_m).sqrt() / (PI * hardness_pa)).sqrt()
}

/// Coefficient of friction: ploughing and film.
pub fn friction(shape: Shape, load_n: f64, speed_mps: f64, ice_c: f64) -> [f64; 2] {
    let hardness = hardness_pa(ice_c);
    let length = length_m(shape, load_n, hardness);
    let width = |x: f64| {
        2.0 * ((shape.section_m / shape.rocker_m) * (length * length - x * x).max(0.0)).sqrt()
    };
    let drag = film_drag_n(&width, length, hardness, speed_mps, ice_c);
    [4.0 * length / (3.0 * PI * shape.rocker_m), drag / load_n]
}

/// Drag of the film on a strip of this width [m] over x from 0 to its front at `length` [m], at a
/// pressure [Pa].
pub fn film_drag_n(
    width: &dyn Fn(f64) -> f64,
    length: f64,
    pressure_pa: f64,
    v: f64,
    ice_c: f64,
) -> f64 {
    let heat = CONDUCTIVITY * (MELTING * pressure_pa - ice_c) * (v / (PI * DIFFUSIVITY)).sqrt();
    let c = heat / MELT;
    let x = ETA * v.powi(3) / MELT;
    // The difference of root and c, without cancellation.
    let start = 2.0 / v * x / ((c * c + x).sqrt() + c);
    // g = h / u over u = sqrt(xi), where both ends are smooth: g' = a/g - b g^3 - k - g/u.
    let slope = |u: f64| {
        let w = width(length - u * u);
        let squeezed = if w > 0.0 {
            4.0 / v * pressure_pa * u.powi(3) / (ETA * w * w)
        } else {
            0.0
        };
        let melt = 4.0 / v * ETA * v * v / (MELT * u);
        [melt, squeezed, 4.0 / v * heat / (MELT * u), 1.0 / u]
    };
    let at = |[a, b, k, s]: [f64; 4], g: f64| a / g - b * g.powi(3) - k - s * g;
    // g with g = known + step g'(u, g), by Newton's method.
    let implicit = |u: f64, known: f64, step: f64, guess: f64| {
        let of = slope(u);
        let [a, b, _, s] = of;
        let mut g = guess;
        for _ in 0..50 {
            let residual = g - known - step * at(of, g);
            let change = residual / (1.0 + step * (a / (g * g) + 3.0 * b * g * g + s));
            g -= change.min(0.5 * g);
            if change.abs() < 1e-13 * g {
                break;
            }
        }
        g
    };
    // Slow and cold the film follows its balance within a hair of the way: an L-stable method of
    // second order (SDIRK).
    let part = 1.0 - 0.5f64.sqrt();
    let du = length.sqrt() / STEPS as f64;
    let mut g = start;
    let mut drag = 0.0;
    let shear = |u: f64, g: f64| 2.0 * ETA * v / g * width(length - u * u);
    for n in 0..STEPS {
        let u = n as f64 * du;
        let before = shear(u, g);
        // The self-similar start holds to the order of the first step.
        if n > 0 {
            let first = implicit(u + part * du, g, part * du, g);
            let rate = at(slope(u + part * du), first);
            g = implicit(u + du, g + (1.0 - part) * du * rate, part * du, first);
        }
        drag += 0.5 * du * (before + shear(u + du, g));
    }
    drag
}

/// Friction of one runner on the ice of one run, tabulated for millions of evaluations.
#[derive(Debug, Clone)]
pub struct Glide {
    /// mu at loads, speeds and curvatures, the last fastest.
    mu: Vec<f64>,
}

/// Ends of load [N], speed [m/s] and curvature [1/m], and how many steps lie between.
const LOAD: (f64, f64, usize) = (100.0, 9000.0, 24);
const SPEED: (f64, f64, usize) = (2.0, 50.0, 24);
const CURVATURE: (f64, f64, usize) = (-0.06, 0.08, 14);

impl Glide {
    /// For ice of a temperature [C].
    pub fn new(shape: Shape, ice_c: f64) -> Self {
        let mut mu = Vec::new();
        let power = |(from, to, n): (f64, f64, usize), i: usize| {
            from * f64::powf(to / from, i as f64 / n as f64)
        };
        for i in 0..=LOAD.2 {
            for j in 0..=SPEED.2 {
                for k in 0..=CURVATURE.2 {
                    let (from, to, n) = CURVATURE;
                    let curvature = from + (to - from) * k as f64 / n as f64;
                    let there = Shape {
                        rocker_m: 1.0 / (1.0 / shape.rocker_m - curvature),
                        ..shape
                    };
                    let parts = friction(there, power(LOAD, i), power(SPEED, j), ice_c);
                    mu.push(parts.iter().sum());
                }
            }
        }
        Glide { mu }
    }

    /// mu at a load [N], a speed [m/s] and a curvature of the track [1/m]; at the edge beyond the
    /// ends.
    pub fn mu(&self, load_n: f64, speed_mps: f64, curvature_1pm: f64) -> f64 {
        let place = |x: f64, n: usize| {
            let x = x.clamp(0.0, 1.0) * n as f64;
            let low = (x as usize).min(n - 1);
            (low, x - low as f64)
        };
        let power = |value: f64, (from, to, _): (f64, f64, usize)| {
            (value.max(1e-9) / from).ln() / (to / from).ln()
        };
        let (i, a) = place(power(load_n, LOAD), LOAD.2);
        let (j, b) = place(power(speed_mps, SPEED), SPEED.2);
        let (from, to, n) = CURVATURE;
        let (k, c) = place((curvature_1pm - from) / (to - from), n);
        let at = |i: usize, j: usize, k: usize| self.mu[(i * (SPEED.2 + 1) + j) * (n + 1) + k];
        let along = |i, j| at(i, j, k) * (1.0 - c) + at(i, j, k + 1) * c;
        let plane = |i| along(i, j) * (1.0 - b) + along(i, j + 1) * b;
        plane(i) * (1.0 - a) + plane(i + 1) * a
    }
}
