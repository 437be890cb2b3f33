//! Ice tracks: heading, bank and slope along the line, and what a sled feels on it.

use crate::world::noise::{Smooth, Source};

/// One corner: a raised-cosine entry and exit around a constant horizontal curvature.
#[derive(Debug, Clone, Copy)]
struct Corner {
    start_m: f64,
    length_m: f64,
    /// Horizontal curvature, left positive [1/m].
    curvature_1pm: f64,
    /// Speed for which its bank is built [m/s].
    design_mps: f64,
}

/// A track, sampled on an even grid so that every reader sees one function.
#[derive(Debug, Clone)]
pub struct Track {
    /// Its name, as in `runs.csv`.
    pub name: String,
    /// Spacing of the samples [m].
    pub step_m: f64,
    /// Slope dh/ds, uphill positive [rad].
    pub slope_rad: Vec<f64>,
    /// Bank: roll of the surface about x, left side up positive [rad].
    pub bank_rad: Vec<f64>,
    /// Heading's derivative dpsi/ds, left positive [1/m].
    pub heading_1pm: Vec<f64>,
    /// Curvature in the vertical plane of the sled, concave positive [1/m].
    pub curvature_1pm: Vec<f64>,
    /// Roll rate per unit of speed [rad/m].
    pub roll_1pm: Vec<f64>,
    /// Yaw rate per unit of speed [rad/m].
    pub yaw_1pm: Vec<f64>,
}

const GRAVITY: f64 = 9.81;

impl Track {
    /// Draws a track of `length_m` with corners on both sides and a mean slope of `grade`.
    pub fn draw(name: &str, length_m: f64, grade: f64, source: &mut Source) -> Self {
        let step_m = 0.25;
        let count = (length_m / step_m).ceil() as usize + 1;
        let mut corners: Vec<Corner> = Vec::new();
        let mut start = source.uniform(25.0, 40.0);
        let mut side = source.sign();
        while start < length_m - 60.0 {
            let length = source.uniform(70.0, 105.0);
            let speed =
                (150.0 + 2.0 * GRAVITY * 0.75 * grade.abs() * (start + 0.5 * length)).sqrt();
            // 1.2 to 2.6 g of centripetal acceleration at the design speed
            let wanted = source.uniform(1.2, 2.6) * GRAVITY / (speed * speed);
            corners.push(Corner {
                start_m: start,
                length_m: length,
                curvature_1pm: side * wanted.min(1.0 / 13.0),
                design_mps: speed,
            });
            start += length + source.uniform(4.0, 18.0);
            side = if source.uniform(0.0, 1.0) < 0.75 {
                -side
            } else {
                side
            };
        }
        let undulation = Smooth::new(0.006, 0.004, 0.02, source);
        let mut track = Self {
            name: name.to_owned(),
            step_m,
            slope_rad: Vec::with_capacity(count),
            bank_rad: Vec::with_capacity(count),
            heading_1pm: Vec::with_capacity(count),
            curvature_1pm: Vec::new(),
            roll_1pm: Vec::new(),
            yaw_1pm: Vec::new(),
        };
        for i in 0..count {
            let s = i as f64 * step_m;
            let mut heading = 0.0;
            let mut bank = 0.0;
            for corner in &corners {
                let shape = window((s - corner.start_m) / corner.length_m);
                heading += corner.curvature_1pm * shape;
                let balance = corner.design_mps.powi(2) * corner.curvature_1pm * shape / GRAVITY;
                bank -= 0.985 * balance.atan();
            }
            track.heading_1pm.push(heading);
            track.bank_rad.push(bank);
            track.slope_rad.push(-grade.abs() + undulation.at(s));
        }
        track.derive();
        track
    }

    /// Body rates per unit of speed from the Euler angles of the surface.
    ///
    /// With pitch `theta = -slope`, bank `phi` and heading `psi`, derivatives in s:
    /// `p/v = phi' - psi' sin(theta)`, `q/v = theta' cos(phi) + psi' sin(phi) cos(theta)`,
    /// `r/v = psi' cos(phi) cos(theta) - theta' sin(phi)`; curvature `= -q/v`.
    fn derive(&mut self) {
        let n = self.slope_rad.len();
        let slope_of = |values: &[f64], i: usize| {
            let (low, high) = (i.saturating_sub(1), (i + 1).min(n - 1));
            (values[high] - values[low]) / ((high - low) as f64 * self.step_m)
        };
        for i in 0..n {
            let theta = -self.slope_rad[i];
            let theta_s = -slope_of(&self.slope_rad, i);
            let phi = self.bank_rad[i];
            let phi_s = slope_of(&self.bank_rad, i);
            let psi_s = self.heading_1pm[i];
            self.roll_1pm.push(phi_s - psi_s * theta.sin());
            self.curvature_1pm
                .push(-(theta_s * phi.cos() + psi_s * phi.sin() * theta.cos()));
            self.yaw_1pm
                .push(psi_s * phi.cos() * theta.cos() - theta_s * phi.sin());
        }
    }

    /// Length [m].
    pub fn length_m(&self) -> f64 {
        (self.slope_rad.len() - 1) as f64 * self.step_m
    }

    /// Linear interpolation of one of its profiles, constant beyond the ends.
    pub fn at(&self, profile: &[f64], s_m: f64) -> f64 {
        let x = (s_m / self.step_m).clamp(0.0, (profile.len() - 1) as f64);
        let i = (x as usize).min(profile.len() - 2);
        let f = x - i as f64;
        profile[i] * (1.0 - f) + profile[i + 1] * f
    }

    /// The track's table as surveyed: `s_m, slope_rad, curvature_1pm, bank_rad`, the slope with
    /// an error that is the same in every run.
    pub fn table(&self, survey_error: &dyn Fn(f64) -> f64) -> String {
        let mut text = String::from("s_m,slope_rad,curvature_1pm,bank_rad\n");
        let stride = 4;
        for i in (0..self.slope_rad.len()).step_by(stride) {
            let s = i as f64 * self.step_m;
            let slope = self.slope_rad[i] + survey_error(s);
            text.push_str(&format!(
                "{:.2},{:.6},{:.6},{:.5}\n",
                s, slope, self.curvature_1pm[i], self.bank_rad[i]
            ));
        }
        text
    }
}

/// A window with smooth flanks over 0.42 of its length each.
fn window(x: f64) -> f64 {
    let flank = |u: f64| {
        let u = u.clamp(0.0, 1.0);
        u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
    };
    if !(0.0..=1.0).contains(&x) {
        return 0.0;
    }
    flank(x / 0.42) * flank((1.0 - x) / 0.42)
}
