//! Where the steering of a simulation comes from.

use crate::friction::GRAVITY;

use crate::model::sled::Sled;
use crate::simulate::driver::{Driver, Mood};
use crate::track::shape::TrackShape;
use crate::track::spline::Spline;

/// Who steers.
pub(crate) enum Steering<'a> {
    /// A driver, in his mood on this run.
    Driver(&'a Driver, Mood),
    /// An angle recorded over the distance [rad over m].
    Recorded(Spline),
}

/// What a driver sees.
pub(crate) struct Seen {
    /// Distance [m].
    pub s: f64,
    /// Distance off the line [m].
    pub n: f64,
    /// Rates of both [m/s].
    pub rates: [f64; 2],
    /// Speed [m/s].
    pub v: f64,
    /// Steering angle now [rad].
    pub delta: f64,
}

impl Steering<'_> {
    /// The steering angle [rad]: a driver's is integrated, a recorded one stands.
    pub(crate) fn angle(&self, s: f64, integrated: f64) -> f64 {
        match self {
            Steering::Driver(..) => integrated,
            Steering::Recorded(angle) => angle.value(s),
        }
    }

    /// Its rate [rad/s].
    pub(crate) fn rate(&self, shape: &TrackShape, sled: &Sled, seen: &Seen) -> f64 {
        let (driver, mood) = match self {
            Steering::Recorded(angle) => return angle.at(seen.s)[1] * seen.rates[0],
            Steering::Driver(driver, mood) => (driver, mood),
        };
        let ahead = seen.s + driver.preview_s * seen.v;
        let bank = shape.bank.value(ahead);
        let turn = -GRAVITY * shape.slope.value(ahead).cos() * bank.sin() / seen.v;
        let ackermann = sled.wheelbase_m() * turn / seen.v;
        let wanted = driver.feedforward * ackermann
            - driver.line_gain * (seen.n - mood.line.value(seen.s))
            - driver.course_gain * seen.rates[1] / seen.v
            + mood.noise.value(seen.s);
        let within = driver.most_rad * (wanted / driver.most_rad).tanh();
        (within - seen.delta) / driver.lag_s
    }
}
