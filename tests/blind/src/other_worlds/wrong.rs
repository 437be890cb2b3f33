//! What is wrong in a world besides noise.

use crate::world::noise::Source;

/// The worlds by name.
pub const WORLDS: [World; 14] = [
    World::Clean,
    World::Delays,
    World::Gyros,
    World::Body,
    World::Curvature,
    World::Lines,
    World::Sessions,
    World::Filters,
    World::Coloured,
    World::Bare,
    World::Few,
    World::Many,
    World::Walls,
    World::Uphill,
];

/// A way in which data are wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum World {
    Clean,
    Delays,
    Gyros,
    Body,
    Curvature,
    Lines,
    Sessions,
    Filters,
    Coloured,
    Bare,
    Few,
    Many,
    Walls,
    Uphill,
    /// Noise of so many thousandths of what each channel spreads over a run, which nobody states.
    Noise(u32),
}

/// Noise for the recovery of laws, in thousandths of what each channel spreads.
pub const LEVELS: [u32; 4] = [0, 1, 10, 100];

impl World {
    /// Families of its cases without and with a hidden effect.
    pub fn families(self) -> [&'static str; 2] {
        match self {
            World::Clean => ["clean-null", "clean-effect"],
            World::Delays => ["delays-null", "delays-effect"],
            World::Gyros => ["gyros-null", "gyros-effect"],
            World::Body => ["body-null", "body-effect"],
            World::Curvature => ["curvature-null", "curvature-effect"],
            World::Lines => ["lines-null", "lines-effect"],
            World::Sessions => ["sessions-null", "sessions-effect"],
            World::Filters => ["filters-null", "filters-effect"],
            World::Coloured => ["coloured-null", "coloured-effect"],
            World::Bare => ["bare-null", "bare-effect"],
            World::Few => ["few-null", "few-effect"],
            World::Many => ["many-null", "many-effect"],
            World::Walls => ["walls-null", "walls-effect"],
            World::Uphill => ["uphill-null", "uphill-effect"],
            World::Noise(_) => ["recovery-null", "recovery"],
        }
    }
}

/// Channels of a record in the order of its columns: ax, ay, az, roll, pitch and yaw rate, speed,
/// slip, steering, roll split.
pub const CHANNELS: usize = 10;
/// The speed's.
pub const SPEED: usize = 6;

/// A fault of one channel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Fault {
    /// Reads so much too high.
    Bias(usize),
    /// Reads this share too high.
    Scale(usize),
    /// Is late by so much [s].
    Delay(usize),
    /// Comes no further than this limit, softly: `limit tanh(x / limit)`.
    Saturating(usize),
    /// Comes to read so much too high as it warms up, within six seconds by a factor of e.
    Warming(usize),
    /// Reads so much too high from 21 on.
    Stepping(usize),
    /// Reads so much times its square too high.
    Bowed(usize),
}

impl Fault {
    /// The channel that it is of.
    pub fn channel(self) -> usize {
        use Fault::*;
        match self {
            Bias(c) | Scale(c) | Delay(c) | Saturating(c) | Warming(c) | Stepping(c) | Bowed(c) => {
                c
            }
        }
    }

    /// Reading of channel `c` for the value `x` at time `t` [s], in time, `size` being the fault's.
    pub fn read(self, c: usize, size: f64, x: f64, t: f64) -> f64 {
        match self {
            Fault::Bias(at) if at == c => x + size,
            Fault::Scale(at) if at == c => (1.0 + size) * x,
            Fault::Saturating(at) if at == c => size * (x / size).tanh(),
            Fault::Warming(at) if at == c => x + size * (1.0 - (-t / 6.0).exp()),
            Fault::Stepping(at) if at == c && x >= 21.0 => x + size,
            Fault::Bowed(at) if at == c => x + size * x * x,
            _ => x,
        }
    }
}

/// What is wrong, drawn for one campaign.
#[derive(Debug, Clone)]
pub struct Wrong {
    /// How late each channel is [s].
    pub delay_s: [f64; CHANNELS],
    /// Scale errors of the gyroscopes.
    pub gyro_scale: [f64; 3],
    /// Biases of the gyroscopes [rad/s].
    pub gyro_bias_radps: [f64; 3],
    /// True pitch and yaw inertia over those of the model.
    pub inertia: [f64; 2],
    /// The true centre of gravity ahead of the model's [m].
    pub centre_m: f64,
    /// The table's curvature over the true one.
    pub curvature: f64,
    /// How far drivers differ from the line, a standard deviation [m].
    pub line_m: f64,
    /// Relative scatter of friction and grip from session to session.
    pub session: f64,
    /// Noise over what a channel spreads in a run; none where sensors have their usual one.
    pub noise: Option<f64>,
    /// Correlation of each channel's noise from one millisecond to the next.
    pub colour: [f64; CHANNELS],
    /// Corner of the anti-alias filters [Hz]; none where infinite.
    pub filter_hz: f64,
    /// Stated over true noise; `None` where nobody states it.
    pub stated: Option<f64>,
    /// Whether nothing but the required columns is recorded and no track table is there.
    pub bare: bool,
    /// Sessions and runs in each.
    pub runs: [usize; 2],
    /// Probability that a run hits a wall.
    pub wall: f64,
    /// Whether track tables count slope uphill.
    pub uphill: bool,
}

impl Wrong {
    /// Draws what is wrong in a world.
    pub fn draw(world: World, source: &mut Source) -> Wrong {
        let mut wrong = Wrong {
            delay_s: [0.0; CHANNELS],
            gyro_scale: [0.0; 3],
            gyro_bias_radps: [0.0; 3],
            inertia: [1.0; 2],
            centre_m: 0.0,
            curvature: 1.0,
            line_m: 0.0,
            session: 0.0,
            noise: None,
            colour: [0.0; CHANNELS],
            filter_hz: f64::INFINITY,
            stated: Some(1.0),
            bare: false,
            runs: [8, 3],
            wall: 0.0,
            uphill: false,
        };
        match world {
            World::Clean => {}
            World::Noise(thousandths) => wrong.noise = Some(f64::from(thousandths) / 1e3),
            World::Delays => wrong.delay_s = [(); CHANNELS].map(|()| source.uniform(0.0, 0.02)),
            World::Gyros => {
                wrong.gyro_scale = [(); 3].map(|()| 0.01 * source.normal());
                wrong.gyro_bias_radps = [(); 3].map(|()| 0.002 * source.normal());
            }
            World::Body => {
                wrong.inertia = [(); 2].map(|()| 1.0 + 0.1 * source.sign());
                wrong.centre_m = 0.03 * source.sign();
            }
            World::Curvature => wrong.curvature = 1.0 + 0.1 * source.sign(),
            World::Lines => wrong.line_m = 0.15,
            World::Sessions => wrong.session = 0.05,
            World::Filters => {
                wrong.colour = [0.97; CHANNELS];
                wrong.filter_hz = source.uniform(25.0, 40.0);
                wrong.stated = Some(if source.sign() > 0.0 { 2.0 } else { 0.5 });
            }
            World::Coloured => {
                wrong.colour = [(); CHANNELS].map(|()| source.uniform(0.9, 0.985));
                if source.sign() > 0.0 {
                    wrong.filter_hz = source.uniform(20.0, 45.0);
                }
                wrong.stated = None;
            }
            World::Bare => wrong.bare = true,
            World::Few => wrong.runs = [2, 3 + source.uniform(0.0, 3.0) as usize],
            World::Many => wrong.runs = [10, 4],
            World::Walls => wrong.wall = 0.4,
            World::Uphill => wrong.uphill = true,
        }
        wrong
    }
}
