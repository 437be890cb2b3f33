//! Remedies that are tried on the channels of a run: units, signs, exchanged names, gravity, clock.

use std::f64::consts::PI;

use crate::column::Sensor::{self, Ax, Ay, Az, PitchRate, RollRate, RollSplit};
use crate::column::Sensor::{Slip, Speed, Steering, YawRate};
use crate::fault::{Fault, FaultKind};
use crate::friction::GRAVITY;
use crate::record::check::rigid_body::Slow;
use crate::record::run::Run;

/// A unit in words, as a mapping states it, and its factor to the column's.
pub(super) type Unit = (&'static str, &'static str, f64);

pub(super) const G: Unit = ("multiples of g", "g", GRAVITY);
pub(super) const DEGREES: Unit = ("degrees", "deg", PI / 180.0);
pub(super) const DEGREES_PER_SECOND: Unit = ("degrees per second", "deg/s", PI / 180.0);
pub(super) const KM_PER_HOUR: Unit = ("km/h", "km/h", 1.0 / 3.6);
const MILES_PER_HOUR: Unit = ("miles per hour", "mph", 0.447_04);
const KNOTS: Unit = ("knots", "kn", 1852.0 / 3600.0);

/// What is wrong with channels, by what mends it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Mend {
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
    /// From another source: one value throughout.
    Replace,
    /// With its own clock at this rate [Hz]: each value is repeated over so many rows.
    OwnClock(f64, usize),
    /// A distance converted from a unit, or turned round where its factor is negative.
    Distance(Unit),
    /// Turned by roll, pitch and yaw [rad].
    Rotate([f64; 3]),
}

impl Fault {
    /// A fault of a run that is proved.
    pub(super) fn proven(run: &Run, columns: &[&str], mend: Mend, evidence: String) -> Fault {
        let all = columns.join(", ");
        let values;
        let (kind, looks_like, line) = match mend {
            Mend::Convert((unit, key, _)) => {
                (FaultKind::Unit, unit, format!("unit = \"{key}\" for {all}"))
            }
            Mend::Negate => {
                let line = format!("sign = -1 for {all}");
                (FaultKind::Sign, "the other sign", line)
            }
            Mend::Swap => {
                let line = format!("exchange the names of {}", columns.join(" and "));
                (FaultKind::Swapped, "one another", line)
            }
            Mend::Weigh => {
                let line = format!("zero = -9.81 for {all}");
                (FaultKind::Gravity, "an acceleration without gravity", line)
            }
            Mend::Clock => {
                let line = "unit = \"ms\" for the clock".to_owned();
                (FaultKind::Clock, "milliseconds", line)
            }
            Mend::Replace => {
                let line = format!("another source for {all}: this one does not measure");
                (FaultKind::Constant, "one value throughout", line)
            }
            Mend::OwnClock(rate, rows) => {
                values = format!("values of {rate:.4} Hz, each repeated over {rows} rows");
                let clock = format!("its own clock ({rate:.4} Hz)");
                let line = format!("import {all} from its own logger with {clock}");
                (FaultKind::Held, values.as_str(), line)
            }
            Mend::Distance((unit, key, factor)) => {
                let line = match factor < 0.0 {
                    true => format!("sign = -1 for {all}"),
                    false => format!("unit = \"{key}\" for {all}"),
                };
                (FaultKind::Distance, unit, line)
            }
            Mend::Rotate([roll, pitch, yaw]) => {
                let angles = format!("[{roll:.4}, {pitch:.4}, {yaw:.4}]");
                let line = format!("rotation = {angles} in [logger.NAME] of these channels");
                (
                    FaultKind::Rotation,
                    "the axes of a box that is turned",
                    line,
                )
            }
        };
        Fault {
            run: run.entry.run.clone(),
            file: run.entry.file.display().to_string(),
            columns: columns.iter().map(ToString::to_string).collect(),
            kind,
            proven: true,
            looks_like: looks_like.to_owned(),
            evidence,
            mend: line,
        }
    }
}

/// One possible fault, undone: the channels and what is done to them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Remedy(pub &'static [Sensor], pub Mend);

/// All remedies that are tried, the likelier of two that fit equally first.
pub(super) static REMEDIES: [Remedy; 30] = [
    Remedy(&[Ax], Mend::Convert(G)),
    Remedy(&[Ay], Mend::Convert(G)),
    Remedy(&[Az], Mend::Convert(G)),
    Remedy(&[Ax, Ay], Mend::Convert(G)),
    Remedy(&[Ax, Ay, Az], Mend::Convert(G)),
    Remedy(&[RollRate], Mend::Convert(DEGREES_PER_SECOND)),
    Remedy(&[PitchRate], Mend::Convert(DEGREES_PER_SECOND)),
    Remedy(&[YawRate], Mend::Convert(DEGREES_PER_SECOND)),
    Remedy(&Sensor::GYROSCOPE, Mend::Convert(DEGREES_PER_SECOND)),
    Remedy(&[Speed], Mend::Convert(KM_PER_HOUR)),
    Remedy(&[Speed], Mend::Convert(MILES_PER_HOUR)),
    Remedy(&[Speed], Mend::Convert(KNOTS)),
    Remedy(&[Slip], Mend::Convert(DEGREES)),
    Remedy(&[Ax], Mend::Negate),
    Remedy(&[Ay], Mend::Negate),
    Remedy(&[Az], Mend::Negate),
    Remedy(&[RollRate], Mend::Negate),
    Remedy(&[PitchRate], Mend::Negate),
    Remedy(&[YawRate], Mend::Negate),
    Remedy(&[Slip], Mend::Negate),
    Remedy(&[Ax, Ay], Mend::Swap),
    Remedy(&[Ax, Az], Mend::Swap),
    Remedy(&[Ay, Az], Mend::Swap),
    Remedy(&[RollRate, PitchRate], Mend::Swap),
    Remedy(&[RollRate, YawRate], Mend::Swap),
    Remedy(&[PitchRate, YawRate], Mend::Swap),
    Remedy(&[Slip, Steering], Mend::Swap),
    Remedy(&[Slip, RollSplit], Mend::Swap),
    Remedy(&[Az], Mend::Weigh),
    Remedy(&[], Mend::Clock),
];

impl Remedy {
    /// Names of the channels.
    pub fn columns(&self) -> Vec<&'static str> {
        match self.1 {
            Mend::Clock => vec!["t_s"],
            _ => self.0.iter().map(|sensor| sensor.name()).collect(),
        }
    }

    /// The factor on its channels, where it is one.
    pub fn factor(&self) -> Option<f64> {
        match self.1 {
            Mend::Convert((.., factor)) => Some(factor),
            Mend::Negate => Some(-1.0),
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
            Mend::Swap => mended.channels.swap(self.0[0] as usize, self.0[1] as usize),
            Mend::Clock => mended.dt_s *= 1e-3,
            _ => {
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
