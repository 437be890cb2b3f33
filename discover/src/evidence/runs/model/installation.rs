//! What the installation may be off by: delays, scales, biases, places, mass and inertia, as random effects.
//!
//! Each error a has a standard deviation that `[tolerances]` states, and is counted in units of it. With N its columns beside
//! those of the base, J, the fit is that of least squares with a penalty, and rows have a covariance of their own:
//!
//! ```text
//! min |r - J b - N a|^2 + |a|^2        V = 1 + N N'
//! ```
//!
//! Source: G. K. Robinson, That BLUP is a good thing: the estimation of random effects, Statistical Science 6 (1991) 15.

use kufe_sled::Tolerances;
use kufe_sled::effects::{Constants, Sensor};
use nalgebra::DMatrix;

use crate::evidence::runs::model::channels::Channels;

/// What an installation error does.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Wrong {
    /// A channel is late.
    Late(Sensor),
    /// A channel reads a share too much.
    Scaled(Sensor),
    /// A channel reads a constant too much.
    Biased(Sensor),
    /// The accelerometer stands further along an axis.
    Accelerometer(usize),
    /// The slip sensor stands further ahead.
    SlipSensor,
    /// The centre of gravity lies further ahead.
    Centre,
    /// The sled is heavier by a share.
    Mass,
    /// Its pitch or yaw inertia is larger by a share.
    PitchInertia,
    /// The same about the vertical.
    YawInertia,
}

/// One thing that may be off.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What it is, in words.
    pub what: String,
    /// Unit of its size.
    pub unit: &'static str,
    /// Standard deviation, in its unit.
    pub sd: f64,
    /// The same as it is stated.
    pub stated: f64,
    wrong: Wrong,
}

impl Part {
    /// Whether it is a delay.
    pub fn is_delay(&self) -> bool {
        matches!(self.wrong, Wrong::Late(_))
    }

    /// The sensor that it stands before.
    pub fn sensor(&self) -> Option<Sensor> {
        match self.wrong {
            Wrong::Late(sensor) | Wrong::Scaled(sensor) | Wrong::Biased(sensor) => Some(sensor),
            _ => None,
        }
    }
}

/// Everything that may be off, and by how much it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Installation {
    /// What may be off.
    pub parts: Vec<Part>,
    /// By how much, in standard deviations.
    pub sizes: Vec<f64>,
    /// Orthonormal combinations of the parts that are fitted, by the share of each part in them.
    pub directions: Vec<Vec<f64>>,
    /// Whether fits leave the sizes as they are.
    pub held: bool,
}

impl Installation {
    /// What the tolerances leave open; a standard deviation of 0 leaves nothing.
    pub fn new(tolerances: &Tolerances) -> Self {
        let t = tolerances;
        let gyros = [Sensor::RollRate, Sensor::PitchRate, Sensor::YawRate];
        let accelerometers = [Sensor::Ax, Sensor::Ay, Sensor::Az];
        let mut parts = Vec::new();
        let mut add = |what: String, unit, sd, wrong| {
            if sd > 0.0 {
                let part = Part {
                    what,
                    unit,
                    sd,
                    stated: sd,
                    wrong,
                };
                parts.push(part);
            }
        };
        for s in Sensor::ALL {
            let what = format!("delay of {}", s.name());
            add(what, "s", t.delay_s, Wrong::Late(s));
        }
        for s in gyros {
            let name = s.name();
            add(
                format!("scale of {name}"),
                "",
                t.gyro_scale,
                Wrong::Scaled(s),
            );
            let (sd, what) = (t.gyro_bias_radps, format!("bias of {name}"));
            add(what, "rad/s", sd, Wrong::Biased(s));
        }
        for s in accelerometers {
            let name = s.name();
            add(
                format!("scale of {name}"),
                "",
                t.accel_scale,
                Wrong::Scaled(s),
            );
            let (sd, what) = (t.accel_bias_mps2, format!("bias of {name}"));
            add(what, "m/s2", sd, Wrong::Biased(s));
        }
        let steer = Sensor::Steering;
        let what = format!("scale of {}", steer.name());
        add(what, "", t.steer_scale, Wrong::Scaled(steer));
        for (axis, name) in ["x", "y", "z"].into_iter().enumerate() {
            let what = format!("place of the accelerometer, {name}");
            add(what, "m", t.place_m, Wrong::Accelerometer(axis));
        }
        let places = [
            ("place of the slip sensor, x", Wrong::SlipSensor),
            ("place of the centre of gravity, x", Wrong::Centre),
        ];
        for (what, wrong) in places {
            add(what.to_owned(), "m", t.place_m, wrong);
        }
        add("mass, relative".to_owned(), "", t.mass, Wrong::Mass);
        let inertias = [("pitch", Wrong::PitchInertia), ("yaw", Wrong::YawInertia)];
        for (axis, wrong) in inertias {
            add(format!("{axis} inertia, relative"), "", t.inertia, wrong);
        }
        Self::of(parts)
    }

    /// All parts, each by itself.
    fn of(parts: Vec<Part>) -> Self {
        let count = parts.len();
        let alone = |k: usize| (0..count).map(|j| f64::from(u8::from(j == k))).collect();
        Self {
            sizes: vec![0.0; count],
            directions: (0..count).map(alone).collect(),
            held: false,
            parts,
        }
    }

    /// Number of combinations that are fitted.
    pub fn fitted(&self) -> usize {
        match self.held {
            true => 0,
            false => self.directions.len(),
        }
    }

    /// The same, held or not.
    pub fn hold(&self, held: bool) -> Self {
        Self {
            held,
            ..self.clone()
        }
    }

    /// What its sizes cost, as the logarithm of a density, and the deviations beyond those stated.
    pub fn cost(&self) -> f64 {
        let squares: f64 = self.sizes.iter().map(|size| size * size).sum();
        let wider: f64 = self.parts.iter().map(|p| (p.sd / p.stated).ln()).sum();
        0.5 * squares + wider
    }

    /// Whether a part is off by more than so many of its standard deviations.
    pub fn is_beyond(&self, deviations: f64) -> bool {
        self.sizes.iter().any(|size| size.abs() > deviations)
    }

    /// Whether the clocks of the channels were found to lie further apart than is stated.
    pub fn has_own_clocks(&self) -> bool {
        self.parts.iter().any(|part| part.sd > part.stated)
    }

    /// The same with such parts as they are stated.
    pub fn within(&self, deviations: f64) -> Self {
        let mut within = self.clone();
        let beyond = |size: &&mut f64| size.abs() > deviations;
        within
            .sizes
            .iter_mut()
            .filter(beyond)
            .for_each(|s| *s = 0.0);
        within
    }

    /// By how much a combination is off, in standard deviations.
    pub fn along(&self, direction: usize) -> f64 {
        let shares = self.directions[direction].iter();
        shares.zip(&self.sizes).map(|(v, size)| v * size).sum()
    }

    /// The combinations of parts of which one standard deviation shows, from their products in the rows (parts by parts).
    ///
    /// With G these products beyond the base, the eigenvectors of G are told apart by the data, and one of eigenvalue g moves no
    /// statistic by more than the root of g: those below `least` are left out, and with them what no fit could hold.
    pub fn told_apart(&self, products: &DMatrix<f64>, least: f64) -> Self {
        let eigen = products.clone().symmetric_eigen();
        let kept = (0..eigen.eigenvalues.len()).filter(|k| eigen.eigenvalues[*k] >= least);
        Self {
            directions: kept
                .map(|k| eigen.eigenvectors.column(k).iter().copied().collect())
                .collect(),
            ..self.clone()
        }
    }

    /// The same with delays as they are stated, nothing found of them.
    pub fn with_stated_clocks(&self) -> Self {
        let mut stated = self.clone();
        for (part, size) in stated.parts.iter_mut().zip(&mut stated.sizes) {
            if part.sd > part.stated {
                (part.sd, *size) = (part.stated, 0.0);
            }
        }
        stated
    }

    /// The same with each part fitted by itself.
    pub fn part_by_part(&self) -> Self {
        Self {
            sizes: self.sizes.clone(),
            ..Self::of(self.parts.clone())
        }
    }

    /// The same with delays of another deviation, nothing found yet.
    pub fn with_delays(&self, factor: f64) -> Self {
        let mut parts = self.parts.clone();
        for part in &mut parts {
            if part.is_delay() {
                part.sd *= factor;
            }
        }
        Self::of(parts)
    }

    /// Moves all combinations, in standard deviations.
    pub fn step(&mut self, by: &[f64]) {
        for (direction, by) in self.directions.iter().zip(by) {
            for (size, share) in self.sizes.iter_mut().zip(direction) {
                *size += by * share;
            }
        }
    }

    /// The same with one part moved by so many standard deviations.
    pub fn moved(&self, part: usize, by: f64) -> Self {
        let mut moved = self.clone();
        moved.sizes[part] += by;
        moved
    }

    /// Each combination that is fitted, of series of the parts.
    pub fn combined(&self, parts: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let combined = |direction: &Vec<f64>| {
            let mut sum = vec![0.0; parts[0].len()];
            let taking_part = direction.iter().zip(parts).filter(|(by, _)| **by != 0.0);
            for (by, part) in taking_part {
                for (sum, x) in sum.iter_mut().zip(part) {
                    *sum += by * x;
                }
            }
            sum
        };
        let fitted = &self.directions[..self.fitted()];
        fitted.iter().map(combined).collect()
    }

    /// Size and standard error of each part, in its unit, from the errors of the combinations in standard deviations: what no
    /// combination holds is open as it was stated.
    pub fn found(&self, errors: &[f64]) -> Vec<(f64, f64)> {
        let part = |(j, part): (usize, &Part)| {
            let (mut open, mut known) = (1.0, 0.0);
            for (direction, error) in self.directions.iter().zip(errors) {
                let share = direction[j].powi(2);
                (open, known) = (open - share, known + share * error * error);
            }
            let error = (known + f64::max(open, 0.0)).sqrt();
            (part.sd * self.sizes[j], part.sd * error)
        };
        self.parts.iter().enumerate().map(part).collect()
    }

    /// From the stated constants of a sled to the true ones.
    pub fn find_constants(&self, sled: &mut Constants) {
        for (part, size) in self.parts.iter().zip(&self.sizes) {
            let size = size * part.sd;
            match part.wrong {
                Wrong::Accelerometer(axis) => sled.accelerometer[axis] += size,
                Wrong::SlipSensor => sled.slip_sensor += size,
                Wrong::Centre => {
                    sled.axles[0] -= size;
                    sled.axles[1] += size;
                    sled.accelerometer[0] -= size;
                    sled.slip_sensor -= size;
                }
                Wrong::Mass => sled.mass *= 1.0 + size,
                Wrong::PitchInertia => sled.pitch_inertia *= 1.0 + size,
                Wrong::YawInertia => sled.yaw_inertia *= 1.0 + size,
                Wrong::Late(_) | Wrong::Scaled(_) | Wrong::Biased(_) => {}
            }
        }
    }

    /// How late a sensor is [s].
    pub fn delay(&self, sensor: Sensor) -> f64 {
        let parts = self.parts.iter().zip(&self.sizes);
        let late = parts.filter(|(part, _)| part.wrong == Wrong::Late(sensor));
        late.map(|(part, size)| part.sd * size).sum()
    }

    /// From what a sensor said to what was true: what the installation is off by, then this delay [s] by effects.
    pub fn correct(&self, of: Sensor, delay_s: f64, channels: &mut Channels) {
        let parts = self.parts.iter().zip(&self.sizes);
        for (part, size) in parts.filter(|(part, s)| **s != 0.0 && part.sensor() == Some(of)) {
            let size = size * part.sd;
            match part.wrong {
                Wrong::Late(sensor) => channels.catch_up(sensor, size),
                Wrong::Biased(sensor) => channels.take_off(sensor, size),
                Wrong::Scaled(sensor) => channels.divide(sensor, 1.0 + size),
                Wrong::Accelerometer(_) | Wrong::SlipSensor | Wrong::Centre => {}
                Wrong::Mass | Wrong::PitchInertia | Wrong::YawInertia => {}
            }
        }
        if delay_s != 0.0 {
            channels.catch_up(of, delay_s);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_exact_has_no_part_and_the_rest_one_each() {
        assert_eq!(Installation::new(&Tolerances::EXACT).fitted(), 0);
        let delays = Tolerances {
            delay_s: 0.002,
            ..Tolerances::EXACT
        };
        let parts = Installation::new(&delays).parts;
        assert_eq!(parts.len(), Sensor::ALL.len());
        assert_eq!(parts[5].what, "delay of yaw_rate_radps");
    }

    #[test]
    fn what_no_combination_holds_stays_as_open_as_it_was_stated() {
        let places = Tolerances {
            mass: 0.01,
            steer_scale: 0.03,
            ..Tolerances::EXACT
        };
        let both = Installation::new(&places);
        // Only the sum of the two shows.
        let products = DMatrix::from_element(2, 2, 50.0);
        let mut told = both.told_apart(&products, 1.0);
        assert_eq!(told.fitted(), 1);
        told.step(&[told.directions[0][0].signum() * 2.0_f64.sqrt()]);
        assert!(told.sizes.iter().all(|size| (size - 1.0).abs() < 1e-12));
        for ((size, error), part) in told.found(&[0.1]).iter().zip(&told.parts) {
            assert!((size - part.sd).abs() < 1e-12);
            assert!((error / part.sd - 0.505_f64.sqrt()).abs() < 1e-12);
        }
    }
}
