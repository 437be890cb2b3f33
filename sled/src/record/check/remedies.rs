//! Remedies that are tried on the channels of a run: units, signs, exchanged names, gravity, clock.

use std::f64::consts::PI;

use crate::column::Sensor::{self, Ax, Ay, Az, PitchRate, RollRate, RollSplit};
use crate::column::Sensor::{Slip, Speed, Steering, YawRate};
use crate::fault::FaultKind;
use crate::friction::GRAVITY;
use crate::record::check::rigid_body::Slow;

/// A unit in words, as a mapping states it, and its factor to the column's.
type Unit = (&'static str, &'static str, f64);

const G: Unit = ("multiples of g", "g", GRAVITY);
const DEGREES: Unit = ("degrees", "deg", PI / 180.0);
const DEGREES_PER_SECOND: Unit = ("degrees per second", "deg/s", PI / 180.0);
const KM_PER_HOUR: Unit = ("km/h", "km/h", 1.0 / 3.6);
const MILES_PER_HOUR: Unit = ("miles per hour", "mph", 0.447_04);
const KNOTS: Unit = ("knots", "kn", 1852.0 / 3600.0);

/// How channels are mended.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Act {
    /// Converted from a unit.
    Convert(Unit),
    /// With the other sign.
    Negate,
    /// Exchanged.
    Swap,
    /// Gravity added.
    Weigh,
    /// The clock, from milliseconds.
    Clock,
}

/// One possible fault, undone: the channels and what is done to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Remedy(pub &'static [Sensor], Act);

/// All remedies that are tried, the likelier of two that fit equally first.
pub(super) static REMEDIES: [Remedy; 30] = [
    Remedy(&[Ax], Act::Convert(G)),
    Remedy(&[Ay], Act::Convert(G)),
    Remedy(&[Az], Act::Convert(G)),
    Remedy(&[Ax, Ay], Act::Convert(G)),
    Remedy(&[Ax, Ay, Az], Act::Convert(G)),
    Remedy(&[RollRate], Act::Convert(DEGREES_PER_SECOND)),
    Remedy(&[PitchRate], Act::Convert(DEGREES_PER_SECOND)),
    Remedy(&[YawRate], Act::Convert(DEGREES_PER_SECOND)),
    Remedy(&Sensor::GYROSCOPE, Act::Convert(DEGREES_PER_SECOND)),
    Remedy(&[Speed], Act::Convert(KM_PER_HOUR)),
    Remedy(&[Speed], Act::Convert(MILES_PER_HOUR)),
    Remedy(&[Speed], Act::Convert(KNOTS)),
    Remedy(&[Slip], Act::Convert(DEGREES)),
    Remedy(&[Ax], Act::Negate),
    Remedy(&[Ay], Act::Negate),
    Remedy(&[Az], Act::Negate),
    Remedy(&[RollRate], Act::Negate),
    Remedy(&[PitchRate], Act::Negate),
    Remedy(&[YawRate], Act::Negate),
    Remedy(&[Slip], Act::Negate),
    Remedy(&[Ax, Ay], Act::Swap),
    Remedy(&[Ax, Az], Act::Swap),
    Remedy(&[Ay, Az], Act::Swap),
    Remedy(&[RollRate, PitchRate], Act::Swap),
    Remedy(&[RollRate, YawRate], Act::Swap),
    Remedy(&[PitchRate, YawRate], Act::Swap),
    Remedy(&[Slip, Steering], Act::Swap),
    Remedy(&[Slip, RollSplit], Act::Swap),
    Remedy(&[Az], Act::Weigh),
    Remedy(&[], Act::Clock),
];

impl Remedy {
    /// Names of the channels.
    pub fn columns(&self) -> Vec<&'static str> {
        match self.1 {
            Act::Clock => vec!["t_s"],
            _ => self.0.iter().map(|sensor| sensor.name()).collect(),
        }
    }

    /// What is wrong, what the channels resemble, and what to write in the mapping.
    pub fn describe(&self) -> (FaultKind, &'static str, String) {
        let names = |between: &str| self.columns().join(between);
        match self.1 {
            Act::Convert((looks_like, unit, _)) => {
                let line = format!("unit = \"{unit}\" for {}", names(", "));
                (FaultKind::Unit, looks_like, line)
            }
            Act::Negate => {
                let line = format!("sign = -1 for {}", names(", "));
                (FaultKind::Sign, "the other sign", line)
            }
            Act::Swap => {
                let line = format!("exchange the names of {}", names(" and "));
                (FaultKind::Swapped, "one another", line)
            }
            Act::Weigh => {
                let line = "zero = -9.81 for az_mps2".to_string();
                (FaultKind::Gravity, "an acceleration without gravity", line)
            }
            Act::Clock => {
                let line = "unit = \"ms\" for the clock".to_string();
                (FaultKind::Clock, "milliseconds", line)
            }
        }
    }

    /// The factor on its channels, where it is one.
    pub fn factor(&self) -> Option<f64> {
        match self.1 {
            Act::Convert((.., factor)) => Some(factor),
            Act::Negate => Some(-1.0),
            _ => None,
        }
    }

    /// Whether a run has all of its channels.
    pub fn applies(&self, slow: &Slow) -> bool {
        self.0.iter().all(|sensor| slow[*sensor].is_some())
    }

    /// The channels mended.
    pub fn applied(&self, slow: &Slow) -> Slow {
        let mut mended = slow.clone();
        match self.1 {
            Act::Swap => mended.channels.swap(self.0[0] as usize, self.0[1] as usize),
            Act::Clock => mended.dt_s *= 1e-3,
            Act::Convert(_) | Act::Negate | Act::Weigh => {
                let (factor, added) = match self.factor() {
                    Some(factor) => (factor, 0.0),
                    None => (1.0, GRAVITY),
                };
                for sensor in self.0 {
                    let values = mended[*sensor].iter_mut().flatten();
                    values.for_each(|x| *x = *x * factor + added);
                }
            }
        }
        mended
    }
}
