//! Corrections of channels: units, signs, exchanged names and gravity, and the faults that they
//! remove.

use std::f64::consts::PI;

use crate::column::Sensor::{self, Ax, Ay, Az, PitchRate, RollRate, RollSplit};
use crate::column::Sensor::{Slip, Speed, Steering, YawRate};
use crate::fault::{Fault, FaultKind};
use crate::friction::GRAVITY;
use crate::record::check::relations::SlowChannels;
use crate::record::run::Run;

/// A wrong unit or sign of a channel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Scale {
    /// What the values look like.
    pub words: &'static str,
    /// The line of a mapping that corrects it.
    pub key: &'static str,
    /// Factor to the unit of the column; NaN if unknown.
    pub factor: f64,
}

const fn scale(words: &'static str, key: &'static str, factor: f64) -> Scale {
    Scale { words, key, factor }
}

pub(super) const G: Scale = scale("multiples of g", "unit = \"g\"", GRAVITY);
pub(super) const DEGREES: Scale = scale("degrees", "unit = \"deg\"", PI / 180.0);
pub(super) const DEGREES_PER_SECOND: Scale =
    scale("degrees per second", "unit = \"deg/s\"", PI / 180.0);
pub(super) const KM_PER_HOUR: Scale = scale("km/h", "unit = \"km/h\"", 1.0 / 3.6);
const MILES_PER_HOUR: Scale = scale("miles per hour", "unit = \"mph\"", 0.447_04);
const KNOTS: Scale = scale("knots", "unit = \"kn\"", 1852.0 / 3600.0);
// Speeds in km/h that were converted from another unit, and the reverse.
const NOT_MILES: Scale = scale("km/h read as mph", "unit = \"km/h\"", 1.0 / 1.609_344);
const NOT_KNOTS: Scale = scale("km/h read as knots", "unit = \"km/h\"", 1.0 / 1.852);
const MILES_NOT_KM: Scale = scale("mph read as km/h", "unit = \"mph\"", 1.609_344);
const KNOTS_NOT_KM: Scale = scale("knots read as km/h", "unit = \"kn\"", 1.852);
pub(super) const OTHER_SIGN: Scale = scale("the other sign", "sign = -1", -1.0);
pub(super) const UNKNOWN: Scale = scale("a raw count or another unit", "unit = \"...\"", f64::NAN);
pub(super) const SPIKES: Scale = scale(
    "values that are far off in a few rows",
    "the file without these values",
    f64::NAN,
);

/// Units of a distance.
pub(super) const DISTANCES: [Scale; 6] = [
    scale("kilometres", "unit = \"km\"", 1e3),
    scale("millimetres", "unit = \"mm\"", 1e-3),
    scale("centimetres", "unit = \"cm\"", 0.01),
    scale("feet", "unit = \"ft\"", 0.3048),
    scale("miles", "unit = \"mi\"", 1609.344),
    scale("a distance that runs backwards", "sign = -1", -1.0),
];

/// A correction of channels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Correction {
    /// Multiplication by a factor.
    Scale(Scale, &'static [Sensor]),
    /// Exchange of two channels.
    Exchange([Sensor; 2]),
    /// Addition of gravity to the vertical acceleration.
    AddGravity,
}

/// Scales and the channels that they are tried on.
const SCALES: [(Scale, &[&[Sensor]]); 11] = [
    (G, &[&[Ax], &[Ay], &[Az], &[Ax, Ay], &Sensor::ACCELEROMETER]),
    (
        DEGREES_PER_SECOND,
        &[&[RollRate], &[PitchRate], &[YawRate], &Sensor::GYROSCOPE],
    ),
    (KM_PER_HOUR, &[&[Speed]]),
    (MILES_PER_HOUR, &[&[Speed]]),
    (KNOTS, &[&[Speed]]),
    (NOT_MILES, &[&[Speed]]),
    (NOT_KNOTS, &[&[Speed]]),
    (MILES_NOT_KM, &[&[Speed]]),
    (KNOTS_NOT_KM, &[&[Speed]]),
    (DEGREES, &[&[Slip]]),
    (
        OTHER_SIGN,
        &[
            &[Ax],
            &[Ay],
            &[Az],
            &[RollRate],
            &[PitchRate],
            &[YawRate],
            &[Slip],
        ],
    ),
];

/// Channels whose names may be exchanged.
const EXCHANGES: [[Sensor; 2]; 8] = [
    [Ax, Ay],
    [Ax, Az],
    [Ay, Az],
    [RollRate, PitchRate],
    [RollRate, YawRate],
    [PitchRate, YawRate],
    [Slip, Steering],
    [Slip, RollSplit],
];

impl Correction {
    /// All corrections of these channels. Of two that fit equally, the likelier comes first.
    pub fn all(slow: &SlowChannels) -> Vec<Correction> {
        let scales = SCALES.iter().flat_map(|(scale, groups)| {
            groups.iter().map(|group| Correction::Scale(*scale, group))
        });
        let exchanges = EXCHANGES.into_iter().map(Correction::Exchange);
        let all = scales.chain(exchanges).chain([Correction::AddGravity]);
        // Without the vertical force the terms of roll and pitch rate are not known.
        let is_related = |one: &Correction| {
            let mut sensors = one.sensors().iter();
            slow.has(&[Az]) || sensors.any(|sensor| !matches!(sensor, RollRate | PitchRate))
        };
        all.filter(|one| slow.has(one.sensors()) && is_related(one))
            .collect()
    }

    fn sensors(&self) -> &[Sensor] {
        match self {
            Correction::Scale(_, sensors) => sensors,
            Correction::Exchange(sensors) => sensors,
            Correction::AddGravity => &[Az],
        }
    }

    /// The corrected channels.
    pub fn applied(&self, slow: &SlowChannels) -> SlowChannels {
        let mut corrected = slow.clone();
        let mut change = |sensors: &[Sensor], change: &dyn Fn(f64) -> f64| {
            for sensor in sensors {
                let values = corrected[*sensor].iter_mut().flatten();
                values.for_each(|x| *x = change(*x));
            }
        };
        match self {
            Correction::Scale(scale, sensors) => change(sensors, &|x| x * scale.factor),
            Correction::AddGravity => change(&[Az], &|x| x + GRAVITY),
            Correction::Exchange([a, b]) => corrected.channels.swap(*a as usize, *b as usize),
        }
        corrected
    }

    /// The fault that the correction removes.
    pub fn fault(&self, run: &Run, evidence: String) -> Fault {
        let names: Vec<&str> = self.sensors().iter().map(|sensor| sensor.name()).collect();
        let (kind, looks_like, mend) = match self {
            Correction::Scale(scale, _) => return scale.fault(run, &names, evidence),
            Correction::Exchange(_) => {
                let mend = format!("exchange the names of {}", names.join(" and "));
                (FaultKind::Swapped, "one another", mend)
            }
            Correction::AddGravity => {
                let mend = format!("zero = -9.81 for {}", names[0]);
                (FaultKind::Gravity, "an acceleration without gravity", mend)
            }
        };
        Fault::proven(run, &names, kind, looks_like, mend, evidence)
    }
}

impl Scale {
    /// The fault of channels in this unit or with this sign.
    pub fn fault(&self, run: &Run, columns: &[&str], evidence: String) -> Fault {
        let kind = match columns {
            ["s_m"] => FaultKind::Distance,
            _ if self.factor < 0.0 => FaultKind::Sign,
            _ => FaultKind::Unit,
        };
        let mend = format!("{} for {}", self.key, columns.join(", "));
        Fault::proven(run, columns, kind, self.words, mend, evidence)
    }
}

impl Fault {
    /// A proved fault of a run.
    pub(super) fn proven(
        run: &Run,
        columns: &[&str],
        kind: FaultKind,
        looks_like: &str,
        mend: String,
        evidence: String,
    ) -> Fault {
        Fault {
            run: run.entry.run.clone(),
            file: run.entry.file.display().to_string(),
            columns: columns.iter().map(ToString::to_string).collect(),
            kind,
            proven: true,
            looks_like: looks_like.to_owned(),
            evidence,
            mend,
        }
    }
}
