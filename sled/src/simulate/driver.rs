//! A driver: a steering law that follows a line, with noise that decreases with skill.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::friction::GRAVITY;
use crate::motion::state::State;
use crate::sled::Sled;
use crate::track::spline::Spline;
use crate::track::table::TrackShape;

/// Steering law of a driver.
///
/// ```text
/// delta_wanted = feedforward L w / v - line_gain (n - n_wanted) - course_gain dn/dt / v + noise
/// d(delta)/dt  = ( most tanh(delta_wanted / most) - delta ) / lag
/// ```
///
/// n is the distance left of the ideal line [m], w the yaw rate at which the line is driven without
/// lateral force `preview` seconds ahead [rad/s], L the wheelbase [m], v the speed [m/s].
/// `n_wanted` and the noise are smooth random functions of the distance.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Driver {
    /// Ratio of the feedforward steering to the steering angle of the curve (Ackermann).
    pub feedforward: f64,
    /// Preview time of the curve [s].
    pub preview_s: f64,
    /// Gain of the steering angle by the offset from the line [rad/m].
    #[serde(rename = "line_gain_rad_per_m")]
    pub line_gain: f64,
    /// Gain of the steering angle by the course angle.
    pub course_gain: f64,
    /// Time constant of arms and steering [s].
    pub lag_s: f64,
    /// Largest steering angle [rad].
    pub most_rad: f64,
    /// Standard deviation of steering noise [rad].
    pub noise_rad: f64,
    /// Standard deviation of the intended line about the ideal line [m].
    pub wander_m: f64,
    /// Correlation length of noise and intended line [m].
    pub length_m: f64,
}

impl Driver {
    /// A driver of a skill from 0 (a beginner) to 1 (steady, no noise, on the line).
    ///
    /// ```
    /// use kufe_sled::Driver;
    /// assert_eq!(Driver::of_skill(1.0).noise_rad, 0.0);
    /// assert!(Driver::of_skill(0.2).wander_m > Driver::of_skill(0.8).wander_m);
    /// ```
    pub fn of_skill(skill: f64) -> Driver {
        let clumsiness = 1.0 - skill.clamp(0.0, 1.0);
        Driver {
            feedforward: 1.0 - 0.5 * clumsiness,
            preview_s: 0.1,
            line_gain: 0.05 - 0.02 * clumsiness,
            course_gain: 0.5 - 0.2 * clumsiness,
            lag_s: 0.08 + 0.08 * clumsiness,
            most_rad: 0.12,
            noise_rad: 0.03 * clumsiness,
            wander_m: 0.4 * clumsiness,
            length_m: 18.0,
        }
    }

    /// Noise and intended line of one run from `start` to `finish` [m].
    pub(crate) fn variation(&self, start: f64, finish: f64, seed: u64) -> RunVariation {
        let mut random = ChaCha8Rng::seed_from_u64(seed);
        RunVariation {
            noise: smooth_noise(start, finish, self.length_m, self.noise_rad, &mut random),
            line: smooth_noise(start, finish, self.length_m, self.wander_m, &mut random),
        }
    }
}

/// Steering noise [rad] and intended line [m] on one run, as functions of the distance.
#[derive(Clone, Debug)]
pub(crate) struct RunVariation {
    pub noise: Spline,
    pub line: Spline,
}

/// Independent normal values every `length` metres, joined by a spline; 0 at the start.
fn smooth_noise(start: f64, finish: f64, length: f64, sd: f64, random: &mut ChaCha8Rng) -> Spline {
    let count = ((finish - start) / length).ceil().clamp(2.0, 1e6) as usize + 2;
    let knots: Vec<f64> = (0..count).map(|i| start + i as f64 * length).collect();
    let normals = StandardNormal.sample_iter(random).take(count);
    let mut values: Vec<f64> = normals.map(|normal: f64| sd * normal).collect();
    values[0] = 0.0;
    Spline::natural(&knots, &values)
}

/// Source of the steering angle.
pub(crate) enum Steering<'a> {
    /// A driver, with the variation of this run.
    Driver(&'a Driver, RunVariation),
    /// A recorded angle [rad] as a function of the distance [m].
    Recorded(Spline),
}

impl Steering<'_> {
    /// The steering angle [rad]: of a driver the `integrated` unknown, else the recorded angle at
    /// `s`.
    pub(crate) fn angle(&self, s: f64, integrated: f64) -> f64 {
        match self {
            Steering::Driver(..) => integrated,
            Steering::Recorded(angle) => angle.value(s),
        }
    }

    /// Rate of the steering angle [rad/s] at a state, the offset `n` [m], and the rates of distance
    /// and offset [m/s].
    pub(crate) fn rate(
        &self,
        shape: &TrackShape,
        sled: &Sled,
        state: &State,
        n: f64,
        [ds, dn]: [f64; 2],
    ) -> f64 {
        let (s, v) = (state.s_m, state.v_mps);
        let (driver, variation) = match self {
            Steering::Recorded(angle) => return angle.at(s)[1] * ds,
            Steering::Driver(driver, variation) => (driver, variation),
        };
        let ahead = s + driver.preview_s * v;
        let bank = shape.bank.value(ahead);
        let turn = -GRAVITY * shape.slope.value(ahead).cos() * bank.sin() / v;
        let ackermann = sled.wheelbase_m() * turn / v;
        let wanted = driver.feedforward * ackermann
            - driver.line_gain * (n - variation.line.value(s))
            - driver.course_gain * dn / v
            + variation.noise.value(s);
        let limited = driver.most_rad * (wanted / driver.most_rad).tanh();
        (limited - state.delta_rad) / driver.lag_s
    }
}
