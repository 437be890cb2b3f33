//! What is wrong in every case: drawn at the sizes that a careful team would have, times the scale
//! of the family.

use super::recorder::{CHANNELS, delays};
use super::sled::Sled;
use crate::world::noise::Source;

/// Factor of everything that is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Family {
    /// A tenth.
    Quiet,
    /// As stated.
    Ordinary,
    /// Twice.
    Bad,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 3] = [Self::Quiet, Self::Ordinary, Self::Bad];

    /// Its name in the list of cases.
    pub fn name(self) -> &'static str {
        match self {
            Self::Quiet => "open-quiet",
            Self::Ordinary => "open-ordinary",
            Self::Bad => "open-bad",
        }
    }

    /// The factor.
    pub fn scale(self) -> f64 {
        match self {
            Self::Quiet => 0.1,
            Self::Ordinary => 1.0,
            Self::Bad => 2.0,
        }
    }
}

/// What stays the same through a campaign. Standard deviations are of scale 1.
#[derive(Debug, Clone)]
pub struct Faults {
    /// Factor of everything.
    pub scale: f64,
    /// Rotation of the inertial unit: roll, pitch, yaw, 0.5 degrees each [rad].
    pub misaligned_rad: [f64; 3],
    /// What a specific force along each axis adds to each gyro: 0.05 degrees/s/g
    /// [rad/s per m/s2].
    pub g_sensitivity: [[f64; 3]; 3],
    /// Delay of each channel: uniform, up to 4 ms [s].
    pub delay_s: [f64; CHANNELS],
    /// Relative error of the slip and steering logger's clock: 50 ppm.
    pub clock: f64,
    /// Factors of the channels less one: 0.3 %; none of the roll split.
    pub channel_scale: [f64; CHANNELS],
    /// Change of mu and of the lateral forces with the ice: 1.5 and 0.7 % a kelvin, times the scale
    /// [1/K].
    pub ice_per_k: [f64; 2],
    /// Error of the stated friction: 3 %.
    pub stated: [f64; 5],
    /// Error of the weighed sled: mass 0.5 %, inertias 3 %, places of the sensors 1 cm.
    pub weighed: [f64; 6],
}

impl Faults {
    /// Draws the faults of a campaign, and the sled that has them.
    pub fn draw(scale: f64, source: &mut Source) -> (Self, Sled) {
        let c = scale;
        let mut sled = Sled::ideal();
        sled.mass_kg *= 1.0 + source.uniform(-0.04, 0.04);
        sled.j_yy_kgm2 *= 1.0 + source.uniform(-0.05, 0.05);
        sled.j_zz_kgm2 *= 1.0 + source.uniform(-0.05, 0.05);
        sled.mu *= 1.0 + source.uniform(-0.15, 0.15);
        for grip in &mut sled.grip {
            grip.stiffness_n_per_rad *= 1.0 + source.uniform(-0.15, 0.15);
            grip.peak *= 1.0 + source.uniform(-0.15, 0.15);
            // Another form than the magic formula.
            grip.exponent *= (0.25 * c * source.normal()).exp();
        }
        // Rubber mounts and a torsion bar.
        for mount in &mut sled.mounts {
            let softer = 0.1 + 0.9 * c;
            mount[0] /= softer;
            mount[1] /= softer.sqrt();
        }
        sled.torsion[0] = c * source.uniform(1500.0, 4000.0);
        sled.compliance_rad_per_n = c * source.uniform(1e-6, 3e-6);
        sled.play_rad = c * 0.3_f64.to_radians();
        sled.toe_rad = [(); 4].map(|()| c * 0.1_f64.to_radians() * source.normal());
        let mut normal = |sd: f64| c * sd * source.normal();
        let faults = Self {
            scale,
            misaligned_rad: [(); 3].map(|()| normal(0.5_f64.to_radians())),
            g_sensitivity: [(); 3].map(|()| [(); 3].map(|()| normal(0.05_f64.to_radians() / 9.81))),
            delay_s: [0.0; CHANNELS],
            clock: normal(50e-6),
            channel_scale: std::array::from_fn(|k| if k < 9 { normal(3e-3) } else { 0.0 }),
            ice_per_k: [0.015 * c, 0.007 * c],
            stated: [(); 5].map(|()| normal(0.03)),
            weighed: [5e-3, 0.03, 0.03, 0.01, 0.01, 0.01].map(&mut normal),
        };
        let delay_s = [(); CHANNELS].map(|()| c * source.uniform(0.0, 0.004));
        (Self { delay_s, ..faults }, sled)
    }

    /// The sled as it was weighed and measured.
    pub fn weighed(&self, sled: &Sled) -> Sled {
        let [mass, pitch, yaw, x, z, slip] = self.weighed;
        let mut stated = *sled;
        stated.mass_kg *= 1.0 + mass;
        stated.j_yy_kgm2 *= 1.0 + pitch;
        stated.j_zz_kgm2 *= 1.0 + yaw;
        stated.accel_m[0] += x;
        stated.accel_m[2] += z;
        stated.slip_m += slip;
        stated
    }

    /// Names that are true in this campaign besides what is hidden.
    ///
    /// A name that has a tolerance in models is true where the fault is larger than the default
    /// tolerance; a scale without one, from 0.1 %. What changes forces is true always.
    pub fn true_names(&self, sessions: &[Session]) -> Vec<String> {
        let rms = |of: &dyn Fn(&Session) -> f64| {
            let squares: f64 = sessions.iter().map(|session| of(session).powi(2)).sum();
            (squares / sessions.len() as f64).sqrt()
        };
        let most = |values: &[f64]| values.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let mut names = vec![
            "temperature",
            "temperature-grip",
            "asperities",
            "headwind",
            "track-profile",
        ];
        let mut add = |true_ones: &[&'static str], size: f64, tolerance: f64| {
            if size > tolerance {
                names.extend(true_ones);
            }
        };
        let misaligned = most(&self.misaligned_rad);
        add(
            &["imu-misalignment", "accelerometer-tilt"],
            misaligned,
            5e-3,
        );
        add(
            &["gyro-g-sensitivity"],
            most(&self.g_sensitivity.concat()),
            9e-5,
        );
        for (axis, [bias, scale]) in [
            ["roll-rate-bias", "roll-rate-scale"],
            ["pitch-rate-bias", "pitch-rate-scale"],
            ["yaw-rate-bias", "yaw-rate-scale"],
        ]
        .into_iter()
        .enumerate()
        {
            add(&[bias], rms(&|s| s.gyro_bias_radps[axis]), 1e-3);
            add(&[scale], self.channel_scale[3 + axis].abs(), 5e-3);
        }
        add(
            &["accelerometer-scale"],
            most(&self.channel_scale[..3]),
            5e-3,
        );
        add(&["speed-scale"], self.channel_scale[6].abs(), 1e-3);
        add(&["slip-scale"], self.channel_scale[7].abs(), 1e-3);
        add(&["steer-scale"], self.channel_scale[8].abs(), 1e-2);
        add(&["slip-offset"], rms(&|s| s.offset_rad[0]), 1e-3);
        add(&["steer-offset"], rms(&|s| s.offset_rad[1]), 1e-3);
        // Against the accelerometer, which has no name for being late.
        let delays = delays(self);
        let reference = delays[..3].iter().sum::<f64>() / 3.0;
        for (channel, name) in [
            (3, "roll-rate-lag"),
            (4, "pitch-rate-lag"),
            (5, "yaw-rate-lag"),
            (6, "speed-lag"),
            (7, "slip-lag"),
            (8, "steer-lag"),
            (9, "roll-split-lag"),
        ] {
            add(&[name], (delays[channel] - reference).abs(), 2e-3);
        }
        let [mass, _, inertia, x, z, _] = self.weighed.map(f64::abs);
        add(&["mass"], mass, 0.01);
        add(&["yaw-inertia"], inertia, 0.05);
        add(&["lever-arm"], x.max(z), 0.02);
        names.into_iter().map(str::to_owned).collect()
    }
}

/// What changes from session to session.
#[derive(Debug, Clone)]
pub struct Session {
    /// Bias of the gyros since the unit was switched on: 0.1 degrees/s [rad/s].
    pub gyro_bias_radps: [f64; 3],
    /// Offset of the slip and the steering sensor since they were mounted: 2 mrad [rad].
    pub offset_rad: [f64; 2],
    /// Ice temperature at its start, as it is and as it is recorded [C].
    pub ice_c: [f64; 2],
    /// Air temperature [C] and pressure [Pa].
    pub air: [f64; 2],
    /// Wind along the sled, against it positive: 1.5 m/s [m/s].
    pub wind_mps: f64,
    /// Factors of mu and of lateral forces that nothing explains: 1 %.
    pub factors: [f64; 2],
    /// Friction that frost adds, in one session: 8 %.
    pub frost: f64,
}

impl Session {
    /// Draws a session.
    pub fn draw(scale: f64, has_frost: bool, source: &mut Source) -> Self {
        let ice_c = (10.0 * source.uniform(-12.0, -3.0)).round() / 10.0;
        let air_c = (10.0 * source.uniform(-8.0, 6.0)).round() / 10.0;
        let air_pa = source.uniform(91_000.0, 96_000.0).round();
        let mut normal = |sd: f64| scale * sd * source.normal();
        Self {
            gyro_bias_radps: [(); 3].map(|()| normal(0.1_f64.to_radians())),
            offset_rad: [(); 2].map(|()| normal(2e-3)),
            ice_c: [ice_c + normal(0.5), ice_c],
            air: [air_c, air_pa],
            wind_mps: normal(1.5),
            factors: [(); 2].map(|()| 1.0 + normal(0.01)),
            frost: if has_frost { scale * 0.08 } else { 0.0 },
        }
    }
}
