//! Remedies that are tried on the channels of a run: units, signs, exchanged names, gravity, clock.

use std::f64::consts::PI;

use crate::column::Sensor::{self, Ax, Ay, Az, PitchRate, RollRate, RollSplit};
use crate::column::Sensor::{Slip, Speed, Steering, YawRate};
use crate::fault::FaultKind;
use crate::friction::GRAVITY;
use crate::record::check::rigid_body::Slow;

/// How channels are mended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    /// Times a factor.
    Scale(f64),
    /// Exchanged.
    Swap,
    /// Gravity added.
    Weigh,
    /// The clock, times a factor.
    Clock(f64),
}

/// One possible fault, undone.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mend {
    /// The channels.
    pub channels: &'static [Sensor],
    /// What is wrong.
    pub kind: FaultKind,
    /// In words.
    pub looks_like: &'static str,
    /// What to write in the mapping.
    pub line: String,
    act: Act,
}

impl Mend {
    /// Names of the channels.
    pub fn columns(&self) -> Vec<&'static str> {
        match self.kind {
            FaultKind::Clock => vec!["t_s"],
            _ => self.channels.iter().map(|sensor| sensor.name()).collect(),
        }
    }

    /// The factor on its channels, where it is one.
    pub fn factor(&self) -> Option<f64> {
        match self.act {
            Act::Scale(factor) => Some(factor),
            _ => None,
        }
    }

    /// Whether a run has all of its channels.
    pub fn applies(&self, slow: &Slow) -> bool {
        self.channels.iter().all(|sensor| slow[*sensor].is_some())
    }

    /// The channels mended.
    pub fn applied(&self, slow: &Slow) -> Slow {
        let mut mended = slow.clone();
        let mut change = |of: &dyn Fn(&mut f64)| {
            for sensor in self.channels {
                mended[*sensor].iter_mut().flatten().for_each(of);
            }
        };
        match self.act {
            Act::Scale(factor) => change(&|x| *x *= factor),
            Act::Weigh => change(&|x| *x += GRAVITY),
            Act::Swap => {
                let [a, b] = [self.channels[0], self.channels[1]];
                mended.channels.swap(a as usize, b as usize);
            }
            Act::Clock(factor) => mended.dt_s *= factor,
        }
        mended
    }
}

/// Channels that may be in another unit: its name, how it is written, and the factor to the
/// column's.
const UNITS: [(&[Sensor], &str, &str, f64); 13] = [
    (&[Ax], "multiples of g", "g", GRAVITY),
    (&[Ay], "multiples of g", "g", GRAVITY),
    (&[Az], "multiples of g", "g", GRAVITY),
    (&[Ax, Ay], "multiples of g", "g", GRAVITY),
    (&[Ax, Ay, Az], "multiples of g", "g", GRAVITY),
    (&[RollRate], "degrees per second", "deg/s", PI / 180.0),
    (&[PitchRate], "degrees per second", "deg/s", PI / 180.0),
    (&[YawRate], "degrees per second", "deg/s", PI / 180.0),
    (
        &Sensor::GYROSCOPE,
        "degrees per second",
        "deg/s",
        PI / 180.0,
    ),
    (&[Speed], "km/h", "km/h", 1.0 / 3.6),
    (&[Speed], "miles per hour", "mph", 0.447_04),
    (&[Speed], "knots", "kn", 1852.0 / 3600.0),
    (&[Slip], "degrees", "deg", PI / 180.0),
];

/// Channels whose sign may be wrong.
const SIGNS: [&[Sensor]; 7] = [
    &[Ax],
    &[Ay],
    &[Az],
    &[RollRate],
    &[PitchRate],
    &[YawRate],
    &[Slip],
];

/// Channels whose names may be exchanged.
const PAIRS: [&[Sensor]; 8] = [
    &[Ax, Ay],
    &[Ax, Az],
    &[Ay, Az],
    &[RollRate, PitchRate],
    &[RollRate, YawRate],
    &[PitchRate, YawRate],
    &[Slip, Steering],
    &[Slip, RollSplit],
];

/// All remedies that are tried, the likelier of two that fit equally first.
pub(super) fn mends() -> Vec<Mend> {
    let mend = |channels, kind, looks_like, line, act| Mend {
        channels,
        kind,
        looks_like,
        line,
        act,
    };
    let names = |channels: &[Sensor], between: &str| {
        let names: Vec<&str> = channels.iter().map(|sensor| sensor.name()).collect();
        names.join(between)
    };
    let units = UNITS.iter().map(|(channels, looks_like, unit, factor)| {
        let line = format!("unit = \"{unit}\" for {}", names(channels, ", "));
        mend(
            *channels,
            FaultKind::Unit,
            *looks_like,
            line,
            Act::Scale(*factor),
        )
    });
    let signs = SIGNS.iter().map(|channels| {
        let line = format!("sign = -1 for {}", names(channels, ", "));
        mend(
            *channels,
            FaultKind::Sign,
            "the other sign",
            line,
            Act::Scale(-1.0),
        )
    });
    let swaps = PAIRS.iter().map(|channels| {
        let line = format!("exchange the names of {}", names(channels, " and "));
        mend(
            *channels,
            FaultKind::Swapped,
            "one another",
            line,
            Act::Swap,
        )
    });
    let gravity = Mend {
        channels: &[Az],
        kind: FaultKind::Gravity,
        looks_like: "an acceleration without gravity",
        line: "zero = -9.81 for az_mps2".to_string(),
        act: Act::Weigh,
    };
    let clock = Mend {
        channels: &[],
        kind: FaultKind::Clock,
        looks_like: "milliseconds",
        line: "unit = \"ms\" for the clock".to_string(),
        act: Act::Clock(1e-3),
    };
    units
        .chain(signs)
        .chain(swaps)
        .chain([gravity, clock])
        .collect()
}
