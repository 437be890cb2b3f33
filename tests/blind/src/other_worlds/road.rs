//! The road: heading, slope and bank along a line, and how fast a frame on it turns.

use std::f64::consts::PI;

use crate::world::noise::{Smooth, Source};

/// Gravity [m/s2].
pub const GRAVITY: f64 = 9.81;

/// One bend: its curvature swells and fades as a squared sine over its length, banked for a share
/// of its pull.
#[derive(Debug, Clone, Copy)]
struct Bend {
    from_m: f64,
    length_m: f64,
    turn_1pm: f64,
    /// Tangent of its steepest bank, left side up positive.
    bank: f64,
}

/// A track that falls all the way.
#[derive(Debug, Clone)]
pub struct Road {
    /// Its name.
    pub name: &'static str,
    /// Its length [m].
    pub length_m: f64,
    bends: Vec<Bend>,
    fall_rad: f64,
    waves: Smooth,
}

/// The road at one place; angles in radians, derivatives over distance.
#[derive(Debug, Clone, Copy, Default)]
pub struct Here {
    /// Slope, downhill positive.
    pub fall: f64,
    /// Bank, left side up positive.
    pub bank: f64,
    /// How the road's own frame turns about its x, y and z [rad/m].
    pub turn: [f64; 3],
}

impl Road {
    /// Draws a track with bends to both sides.
    pub fn draw(name: &'static str, source: &mut Source) -> Road {
        let length_m = source.uniform(480.0, 560.0);
        let fall_rad = source.uniform(0.085, 0.115);
        let mut bends = Vec::new();
        let mut from_m = source.uniform(30.0, 45.0);
        let mut side = source.sign();
        while from_m < length_m - 90.0 {
            let length = source.uniform(55.0, 90.0);
            // The speed that height gives less a quarter for friction and air.
            let middle = from_m + 0.5 * length;
            let speed = (150.0 + 1.5 * GRAVITY * fall_rad * middle).sqrt();
            let pull = source.uniform(0.9, 2.0) * GRAVITY;
            bends.push(Bend {
                from_m,
                length_m: length,
                turn_1pm: side * (pull / (speed * speed)).min(1.0 / 14.0),
                bank: -side * pull / GRAVITY * source.uniform(0.85, 1.0),
            });
            from_m += length + source.uniform(6.0, 25.0);
            if source.uniform(0.0, 1.0) < 0.8 {
                side = -side;
            }
        }
        let waves = Smooth::new(0.012, 0.004, 0.02, source);
        Road {
            name,
            length_m,
            bends,
            fall_rad,
            waves,
        }
    }

    /// Slope, bank, and the frame's turning at `s`.
    ///
    /// The frame is `R = R_z(psi) R_y(fall) R_x(bank)`; it turns by the vector of `R^T dR/ds`.
    pub fn at(&self, s: f64) -> Here {
        self.here(s, self.waves.with_slope_at(s))
    }

    /// The road `by` before `s`, there, and `by` behind it.
    pub fn around(&self, s: f64, by: f64) -> [Here; 3] {
        let [before, there, behind] = self.waves.around(s, by);
        [
            self.here(s - by, before),
            self.here(s, there),
            self.here(s + by, behind),
        ]
    }

    fn here(&self, s: f64, [wave, fall_s]: [f64; 2]) -> Here {
        let (mut psi_s, mut bank, mut bank_s) = (0.0, 0.0, 0.0);
        for bend in &self.bends {
            let u = (s - bend.from_m) / bend.length_m;
            if !(0.0..1.0).contains(&u) {
                continue;
            }
            let (sine, cosine) = (PI * u).sin_cos();
            psi_s += bend.turn_1pm * sine * sine;
            let tangent = bend.bank * sine * sine;
            bank += tangent.atan();
            bank_s +=
                bend.bank * 2.0 * sine * cosine * PI / bend.length_m / (1.0 + tangent * tangent);
        }
        let fall = self.fall_rad + wave;
        let ((sf, cf), (sb, cb)) = (fall.sin_cos(), bank.sin_cos());
        Here {
            fall,
            bank,
            turn: [
                bank_s - psi_s * sf,
                fall_s * cb + psi_s * cf * sb,
                psi_s * cf * cb - fall_s * sb,
            ],
        }
    }

    /// Gravity in a frame on the road turned to the left by `angle`, x, y and z [m/s2].
    pub fn gravity(here: &Here, angle: f64) -> [f64; 3] {
        let ((sf, cf), (sb, cb)) = (here.fall.sin_cos(), here.bank.sin_cos());
        let (x, y) = (GRAVITY * sf, -GRAVITY * cf * sb);
        let (sine, cosine) = angle.sin_cos();
        [
            cosine * x + sine * y,
            -sine * x + cosine * y,
            -GRAVITY * cf * cb,
        ]
    }
}
