//! The track: heading, slope and bank along a line, and how a frame on the ice rotates there.

use std::f64::consts::PI;

use crate::world::noise::{Smooth, Source};

/// Gravity [m/s2].
pub const GRAVITY: f64 = 9.81;
/// Distance between the tabulated places [m].
const CELL_M: f64 = 0.25;

/// The track at one place.
#[derive(Debug, Clone, Copy, Default)]
pub struct Here {
    /// Slope, downhill positive [rad].
    pub fall: f64,
    /// Bank, left side up positive [rad].
    pub bank: f64,
    /// Rotation of the ice's frame about its x, y and z axes [rad/m].
    pub turn: [f64; 3],
    /// Its derivative over distance [rad/m2].
    pub turn_s: [f64; 3],
}

impl Here {
    /// The same off the line, where the ice's frame is rotated about x by an angle [rad].
    pub fn off_the_line(&self, angle: f64) -> Self {
        let (sine, cosine) = angle.sin_cos();
        let rotated = |[x, y, z]: [f64; 3]| [x, cosine * y + sine * z, cosine * z - sine * y];
        Self {
            bank: self.bank + angle,
            turn: rotated(self.turn),
            turn_s: rotated(self.turn_s),
            ..*self
        }
    }

    /// The upward direction in a frame on the ice with the heading `chi` against the line, where the
    /// ice rises by `climb` along the line off it [rad].
    ///
    /// The third row of `R = R_z(psi) R_y(fall) R_x(bank)`, then rotated about z.
    pub fn up(&self, chi: f64, climb: f64) -> [f64; 3] {
        let ((sf, cf), (sb, cb)) = (self.fall.sin_cos(), self.bank.sin_cos());
        let (sine, cosine) = chi.sin_cos();
        let (x, y) = (-sf + climb * cf * cb, cf * sb);
        [cosine * x + sine * y, -sine * x + cosine * y, cf * cb]
    }

    fn from_row(row: &[f64; 8]) -> Self {
        let [fall, bank, a, b, c, d, e, f] = *row;
        Self {
            fall,
            bank,
            turn: [a, b, c],
            turn_s: [d, e, f],
        }
    }
}

/// A track, tabulated; linear between the places of the table.
#[derive(Debug, Clone)]
pub struct Track {
    /// Its name.
    pub name: &'static str,
    /// Its length [m].
    pub length_m: f64,
    /// Curvature of its cross-section [1/m]: how fast the bank grows off the line.
    pub concave_1pm: f64,
    rows: Vec<[f64; 8]>,
}

impl Track {
    /// A track that is flat across, from slope [rad], bank [rad] and curvature in the horizontal plane [1/m] over
    /// distance.
    ///
    /// The frame rotates by the rates of its Euler angles:
    ///
    /// ```text
    /// w_x = bank' - psi' sin(fall)
    /// w_y = fall' cos(bank) + psi' cos(fall) sin(bank)
    /// w_z = psi' cos(fall) cos(bank) - fall' sin(bank)
    /// ```
    pub fn new(name: &'static str, length_m: f64, angles: &dyn Fn(f64) -> [f64; 3]) -> Self {
        let turn = |s: f64| -> [f64; 3] {
            let ([fall, bank, psi_s], before, behind) =
                (angles(s), angles(s - 1e-3), angles(s + 1e-3));
            let [fall_s, bank_s] = [0, 1].map(|k| (behind[k] - before[k]) / 2e-3);
            let ((sf, cf), (sb, cb)) = (fall.sin_cos(), bank.sin_cos());
            [
                bank_s - psi_s * sf,
                fall_s * cb + psi_s * cf * sb,
                psi_s * cf * cb - fall_s * sb,
            ]
        };
        let row = |cell: usize| {
            let s = cell as f64 * CELL_M;
            let [fall, bank, _] = angles(s);
            let (here, before, behind) = (turn(s), turn(s - 0.02), turn(s + 0.02));
            let [a, b, c] = here;
            let [d, e, f] = std::array::from_fn(|k| (behind[k] - before[k]) / 0.04);
            [fall, bank, a, b, c, d, e, f]
        };
        let cells = (length_m / CELL_M).ceil() as usize + 40;
        Self {
            name,
            length_m,
            concave_1pm: 0.0,
            rows: (0..cells).map(row).collect(),
        }
    }

    /// Draws a track with curves to both sides, banked for the speed that the height gives.
    pub fn draw(name: &'static str, source: &mut Source) -> Self {
        let length_m = source.uniform(620.0, 760.0);
        let mean_fall = source.uniform(0.085, 0.105);
        let waves = Smooth::new(0.01, 0.004, 0.02, source);
        let mut curves: Vec<[f64; 4]> = Vec::new();
        let (mut from, mut side) = (source.uniform(35.0, 50.0), source.sign());
        while from < length_m - 150.0 {
            let length = source.uniform(60.0, 100.0);
            let fallen = mean_fall * (from + 0.5 * length);
            let speed_2 = 110.0 + 1.3 * GRAVITY * fallen;
            let pull = source.uniform(1.0, 2.6);
            let bank = side * (pull * source.uniform(0.93, 1.0)).atan();
            curves.push([from, length, side * pull * GRAVITY / speed_2, -bank]);
            from += length + source.uniform(10.0, 30.0);
            if source.uniform(0.0, 1.0) < 0.8 {
                side = -side;
            }
        }
        let flat = Self::new(name, length_m, &|s| {
            let (mut bank, mut psi_s) = (0.0, 0.0);
            for [from, length, curvature, steepest] in &curves {
                let u = (s - from) / length;
                if (0.0..1.0).contains(&u) {
                    let swell = (PI * u).sin().powi(2);
                    psi_s += curvature * swell;
                    bank += (steepest.tan() * swell).atan();
                }
            }
            [mean_fall + waves.at(s), bank, psi_s]
        });
        Self {
            concave_1pm: 1.0 / 7.0,
            ..flat
        }
    }

    /// The track at `s`.
    pub fn at(&self, s: f64) -> Here {
        let x = (s / CELL_M).clamp(0.0, (self.rows.len() - 2) as f64);
        let (cell, part) = (x as usize, x.fract());
        let (a, b) = (&self.rows[cell], &self.rows[cell + 1]);
        Here::from_row(&std::array::from_fn(|k| a[k] + part * (b[k] - a[k])))
    }

    /// The table that a survey makes of it, `off` being its error of the slope over distance.
    pub fn survey(&self, off: &Smooth) -> String {
        let mut text = String::from("s_m,slope_rad,curvature_1pm,bank_rad\n");
        for s in 0..=(self.length_m + 5.0) as usize {
            let here = self.at(s as f64);
            let slope = here.fall + off.at(s as f64);
            let (curvature, bank) = (-here.turn[1], here.bank);
            text += &format!("{s},{slope:.6},{curvature:.6},{bank:.5}\n");
        }
        text
    }
}
