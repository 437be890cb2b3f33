//! Relations between the channels of two loggers: pairs of expressions, one in each clock, that are
//! equal except for a scale and a constant.

use kufe_sled::{Spline, low_pass};
use serde::Serialize;

use crate::resample::{Stretch, stretches};

/// A column as a logger recorded it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Series {
    /// The logger.
    pub logger: String,
    /// The column.
    pub column: String,
    /// Times by the logger's clock [s], increasing; NaN where a sample cannot be placed.
    pub time: Vec<f64>,
    /// Values in the unit of the column.
    pub values: Vec<f64>,
}

impl Series {
    /// Times of the samples that have a value [s].
    pub fn samples(&self) -> impl Iterator<Item = f64> {
        let both = self.time.iter().zip(&self.values);
        let both = both.filter(|(t, x)| t.is_finite() && x.is_finite());
        both.map(|(t, _)| *t)
    }
}

/// A delay by one relation between channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Relation {
    /// The relation.
    pub relation: String,
    /// The delay [s].
    pub delay_s: f64,
    /// Its standard error [s].
    pub delay_sd_s: f64,
    /// Correlation at that delay.
    pub correlation: f64,
}

/// Fewest samples of a stretch that serve.
const LEAST: usize = 16;

/// A low-passed series as a cubic spline in each stretch without a gap.
pub(crate) struct Signal {
    parts: Vec<(f64, f64, Spline)>,
    /// The series' own rate [Hz].
    pub rate_hz: f64,
}

impl Signal {
    /// A series through a zero-phase low pass; `None` where no stretch is long enough.
    pub fn of(series: &Series, corner_hz: f64) -> Option<Signal> {
        let cut = stretches(&series.time, &series.values)?;
        let long = cut.parts.iter().filter(|part| part.values.len() >= LEAST);
        let spline = |part: &Stretch| {
            let smooth = low_pass(&part.values, 1.0 / part.step_s, corner_hz);
            let at = |i: usize| part.start_s + i as f64 * part.step_s;
            let knots: Vec<f64> = (0..smooth.len()).map(at).collect();
            (part.start_s, part.end_s(), Spline::natural(&knots, &smooth))
        };
        let parts: Vec<_> = long.map(spline).collect();
        (!parts.is_empty()).then_some(Signal {
            parts,
            rate_hz: 1.0 / cut.step_s,
        })
    }

    /// Value, first and second derivative; `None` in gaps and outside the ends.
    pub fn at(&self, t: f64) -> Option<[f64; 3]> {
        let after = self.parts.partition_point(|(start, ..)| *start <= t);
        let (_, end, spline) = self.parts.get(after.checked_sub(1)?)?;
        (t <= *end).then(|| spline.at(t))
    }

    /// First and last time [s].
    pub fn span(&self) -> [f64; 2] {
        [self.parts[0].0, self.parts[self.parts.len() - 1].1]
    }
}

/// Deviation of a sensor from its stated place [m]; it shifts a lateral acceleration by place over
/// speed.
const PLACE: f64 = 0.2;

/// By how much slip that nothing measures shifts a lateral acceleration: slip angle over yaw rate
/// [s].
const SLIP: f64 = 0.03;

/// What is compared.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// A column with itself.
    Same,
    /// `a_x` with `dv/dt`.
    Longitudinal,
    /// `a_y` with `r v - d(alpha v)/dt + x dr/dt`.
    Lateral,
    /// `a_z` with `-q v - x dq/dt`.
    Vertical,
}

/// The motions of a rigid body: their names, and the columns of both sides.
const MOTIONS: [(Kind, &str, [&str; 2]); 3] = [
    (Kind::Longitudinal, "ax = dv/dt", ["ax_mps2", "v_mps"]),
    (
        Kind::Lateral,
        "ay = yaw rate * v",
        ["ay_mps2", "yaw_rate_radps"],
    ),
    (
        Kind::Vertical,
        "az = g - pitch rate * v",
        ["az_mps2", "pitch_rate_radps"],
    ),
];

/// One relation between two loggers.
pub(crate) struct Pair<'a> {
    pub kind: Kind,
    pub name: String,
    lhs: &'a Series,
    main: &'a Series,
    /// Speed, where the relation has it, and whether it is in the clock of `lhs`.
    speed: Option<(&'a Series, bool)>,
    slip: Option<&'a Series>,
    /// Accelerometer ahead of the place of the right side [m].
    ahead_m: f64,
    /// Whether `lhs` is in the clock whose delay is sought.
    pub lhs_late: bool,
    /// Uncertainty of the delay that this relation cannot resolve [s].
    pub doubt_s: f64,
}

/// A pair's sides at a corner of the low pass.
pub(crate) struct Sides<'a> {
    pair: &'a Pair<'a>,
    lhs: Signal,
    main: Signal,
    speed: Option<Signal>,
    slip: Option<Signal>,
}

/// A place of a column along the sled, where it is stated.
pub(crate) type Place<'a> = dyn Fn(&str) -> Option<f64> + 'a;

/// The pairs between one logger and those whose clocks are known, whose series are in the clock of
/// the runs.
pub(crate) fn pairs<'a>(
    late: &'a [&'a Series],
    known: &'a [Series],
    place: &Place,
) -> Vec<Pair<'a>> {
    let mut pairs = Vec::new();
    let in_late = |column: &str| late.iter().find(|s| s.column == column).copied();
    let in_known = |column: &str| known.iter().find(|s| s.column == column);
    for own in late {
        if let Some(other) = in_known(&own.column) {
            let name = format!("{} in both", own.column);
            pairs.push(Pair::new(Kind::Same, name, other, own, false));
        }
    }
    for lhs_late in [false, true] {
        let side = |column: &str, is_lhs: bool| {
            if is_lhs == lhs_late {
                in_late(column)
            } else {
                in_known(column)
            }
        };
        for (kind, name, [acceleration, main]) in MOTIONS {
            let (Some(lhs), Some(rhs)) = (side(acceleration, true), side(main, false)) else {
                continue;
            };
            let mut pair = Pair::new(kind, name.to_string(), lhs, rhs, lhs_late);
            if kind != Kind::Longitudinal {
                let speed = side("v_mps", false).map(|v| (v, false));
                let Some(speed) = speed.or(side("v_mps", true).map(|v| (v, true))) else {
                    continue;
                };
                let is_lateral = kind == Kind::Lateral;
                let slip = side("alpha_rad", false).filter(|_| is_lateral);
                // The slip sensor's velocity is that of its own place.
                let at = slip.map_or(Some(0.0), |_| place("alpha_rad"));
                let ahead = place(acceleration).zip(at).map(|(sensor, at)| sensor - at);
                let unknown_place = match ahead {
                    Some(_) => 0.0,
                    None => PLACE / mean(speed.0).abs().max(1.0),
                };
                let unknown_slip = if slip.is_none() && is_lateral {
                    SLIP
                } else {
                    0.0
                };
                pair.speed = Some(speed);
                pair.slip = slip;
                pair.ahead_m = ahead.unwrap_or(0.0);
                pair.doubt_s = f64::hypot(unknown_place, unknown_slip);
            }
            pairs.push(pair);
        }
    }
    pairs
}

fn mean(series: &Series) -> f64 {
    let finite = series.values.iter().filter(|x| x.is_finite());
    let (sum, count) = finite.fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    sum / f64::max(count, 1.0)
}

impl<'a> Pair<'a> {
    fn new(
        kind: Kind,
        name: String,
        lhs: &'a Series,
        main: &'a Series,
        lhs_late: bool,
    ) -> Pair<'a> {
        Pair {
            kind,
            name,
            lhs,
            main,
            speed: None,
            slip: None,
            ahead_m: 0.0,
            lhs_late,
            doubt_s: 0.0,
        }
    }

    /// Both sides through a low pass; `None` where a series is too short.
    pub fn sides(&self, corner_hz: f64) -> Option<Sides<'_>> {
        let of = |series: &Series| Signal::of(series, corner_hz);
        // A speed that is too short is not that of a relation without one.
        let speed = self.speed.map(|(series, _)| of(series));
        Some(Sides {
            pair: self,
            lhs: of(self.lhs)?,
            main: of(self.main)?,
            speed: speed.map_or(Some(None), |speed| speed.map(Some))?,
            slip: self.slip.and_then(of),
        })
    }

    /// The rate of the slower side [Hz].
    pub fn rate_hz(&self) -> Option<f64> {
        let rate = |series: &Series| Signal::of(series, f64::INFINITY).map(|signal| signal.rate_hz);
        Some(rate(self.lhs)?.min(rate(self.main)?))
    }
}

impl Sides<'_> {
    /// `lhs` and its derivative at a time of its own clock.
    pub fn lhs(&self, t: f64) -> Option<[f64; 2]> {
        self.lhs.at(t).map(|[value, slope, _]| [value, slope])
    }

    /// `rhs` and its derivative at a time of its own clock; `ahead` leads from there to the clock
    /// of `lhs`.
    pub fn rhs(&self, t: f64, ahead: f64) -> Option<[f64; 2]> {
        let [w, dw, ddw] = self.main.at(t)?;
        let with_lhs = self.pair.speed.is_some_and(|(_, with_lhs)| with_lhs);
        let [v, dv, _] = match &self.speed {
            None => [1.0, 0.0, 0.0],
            Some(speed) => speed.at(if with_lhs { t + ahead } else { t })?,
        };
        let x = self.pair.ahead_m;
        Some(match self.pair.kind {
            Kind::Same => [w, dw],
            Kind::Longitudinal => [dw, ddw],
            Kind::Vertical => [-w * v - x * dw, -dw * v - w * dv - x * ddw],
            Kind::Lateral => {
                let [slip, dslip, ddslip] = match &self.slip {
                    Some(slip) => slip.at(t)?,
                    None => [0.0; 3],
                };
                // v_y = -alpha v; of its second derivative the speed's changes are small against
                // slip's.
                let sideways = -(dslip * v + slip * dv);
                let further = -(ddslip * v + 2.0 * dslip * dv);
                let slope = dw * v + w * dv + further + x * ddw;
                [w * v + sideways + x * dw, slope]
            }
        })
    }

    /// First and last time of both sides [s].
    pub fn spans(&self) -> [[f64; 2]; 2] {
        [self.lhs.span(), self.main.span()]
    }

    /// From the clock of `rhs` to that of `lhs`, by the delay of the logger whose delay is sought.
    pub fn ahead(&self, delay: f64) -> f64 {
        if self.pair.lhs_late { delay } else { -delay }
    }
}
