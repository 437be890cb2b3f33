//! Relations between the channels of two loggers: pairs of expressions, one in each clock, that are
//! equal up to a scale and a constant.

use std::borrow::Cow;

use kufe_sled::{MIN_FILTER_SAMPLES, Spline, low_pass};
use nalgebra::{Rotation3, Vector3};
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
    /// Times of the samples with a finite value [s].
    pub fn samples(&self) -> impl Iterator<Item = f64> {
        let both = self.time.iter().zip(&self.values);
        let both = both.filter(|(t, x)| t.is_finite() && x.is_finite());
        both.map(|(t, _)| *t)
    }
}

/// The delay estimated from one relation between channels.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Relation {
    /// Name of the relation.
    pub relation: String,
    /// Estimated delay [s].
    pub delay_s: f64,
    /// Standard error of the delay [s].
    pub delay_sd_s: f64,
    /// Correlation of both sides at this delay.
    pub correlation: f64,
}

/// A low-pass filtered series as a cubic spline in each stretch without a gap.
pub(crate) struct Signal {
    parts: Vec<(f64, f64, Spline)>,
    /// Sample rate of the series [Hz].
    pub rate_hz: f64,
}

impl Signal {
    /// Filters a series by a zero-phase low pass; `None` if no stretch is long enough.
    pub fn of(series: &Series, cutoff_hz: f64) -> Option<Signal> {
        let cut = stretches(&series.time, &series.values)?;
        let long = cut
            .parts
            .iter()
            .filter(|part| part.values.len() >= MIN_FILTER_SAMPLES);
        let spline = |part: &Stretch| {
            let smooth = low_pass(&part.values, 1.0 / part.step_s, cutoff_hz);
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

/// Standard deviation of an unknown sensor position along the sled [m]. It shifts a lateral
/// acceleration by the ratio of position to speed [s].
const POSITION_SD: f64 = 0.2;

/// Standard deviation of the time shift of a lateral acceleration by unmeasured slip: the ratio of
/// slip angle to yaw rate [s]; that of the longitudinal relation, which neglects slip, is similar.
const SLIP_SD: f64 = 0.03;

/// Kind of a relation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Kind {
    /// The same column in both loggers. One sensor may be rotated against the other: `lhs` has the
    /// other axes of a rate or an acceleration too.
    Same,
    /// `dv/dt` with `a_x` and [`gravity_and_place`].
    Longitudinal,
    /// `a_y` with `r v - d(alpha v)/dt + x dr/dt`.
    Lateral,
    /// `a_z` with `-q v - x dq/dt`.
    Vertical,
}

/// Lateral and vertical relations: kind, name, and the columns of both sides.
const ACROSS: [(Kind, &str, [&str; 2]); 2] = [
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
    lhs: Vec<Cow<'a, Series>>,
    main: &'a Series,
    /// Speed, if the relation needs it, and whether it is in the clock of `lhs`.
    speed: Option<(&'a Series, bool)>,
    slip: Option<&'a Series>,
    /// Distance of the accelerometer ahead of the sensor of the right side [m].
    ahead_m: f64,
    /// Whether `lhs` is in the clock with the unknown delay.
    pub lhs_late: bool,
    /// Standard deviation of the delay due to unknown position and slip [s].
    pub doubt_s: f64,
}

/// Both sides of a pair, low-pass filtered.
pub(crate) struct Sides<'a> {
    pair: &'a Pair<'a>,
    lhs: Vec<Signal>,
    main: Signal,
    speed: Option<Signal>,
    slip: Option<Signal>,
}

/// Position of a column's sensor along the sled [m], if it is stated.
pub(crate) type Place<'a> = dyn Fn(&str) -> Option<f64> + 'a;

/// The relations between the series of one logger, `late`, and those of loggers with known clocks,
/// `known`, which are in the clock of the runs.
pub(crate) fn pairs<'a>(
    late: &'a [&'a Series],
    known: &'a [Series],
    place: &Place,
) -> Vec<Pair<'a>> {
    let mut pairs = Vec::new();
    let in_late = |column: &str| late.iter().find(|s| s.column == column).copied();
    let in_known = |column: &str| known.iter().find(|s| s.column == column);
    for own in late.iter().copied() {
        if let Some(other) = in_known(&own.column) {
            let name = format!("{} in both", own.column);
            let others = other_axes(&own.column);
            let usable = |axis: &&Series| Signal::of(axis, f64::INFINITY).is_some();
            let [of_known, of_late]: [Vec<&Series>; 2] = [
                others
                    .iter()
                    .filter_map(|axis| in_known(axis))
                    .filter(usable)
                    .collect(),
                others
                    .iter()
                    .filter_map(|axis| in_late(axis))
                    .filter(usable)
                    .collect(),
            ];
            // The axes of one side suffice for the rotation of both.
            let lhs_late = of_late.len() > of_known.len();
            let [lhs, axes, main] = if lhs_late {
                [vec![own], of_late, vec![other]]
            } else {
                [vec![other], of_known, vec![own]]
            };
            let lhs = lhs.into_iter().chain(axes).map(Cow::Borrowed).collect();
            pairs.push(Pair::new(Kind::Same, name, lhs, main[0], lhs_late));
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
        let rates = RATES.map(|column| side(column, true));
        if let (Some(speed), Some(force), [Some(roll), Some(pitch), Some(yaw)]) =
            (side("v_mps", false), side("ax_mps2", true), rates)
            && let Some(others) = gravity_and_place([roll, pitch, yaw])
        {
            let lhs = [Cow::Borrowed(force)].into_iter();
            let lhs = lhs.chain(others.map(Cow::Owned)).collect();
            let name = "dv/dt = ax + gravity along the sled".to_string();
            let mut pair = Pair::new(Kind::Longitudinal, name, lhs, speed, lhs_late);
            pair.doubt_s = SLIP_SD;
            pairs.push(pair);
        }
        for (kind, name, [acceleration, main]) in ACROSS {
            let (Some(lhs), Some(rhs)) = (side(acceleration, true), side(main, false)) else {
                continue;
            };
            let speed = side("v_mps", false).map(|v| (v, false));
            let Some(speed) = speed.or(side("v_mps", true).map(|v| (v, true))) else {
                continue;
            };
            let is_lateral = kind == Kind::Lateral;
            let slip = side("alpha_rad", false).filter(|_| is_lateral);
            // The slip sensor measures the velocity at its own position.
            let at = slip.map_or(Some(0.0), |_| place("alpha_rad"));
            let ahead = place(acceleration).zip(at).map(|(sensor, at)| sensor - at);
            let unknown_place = match ahead {
                Some(_) => 0.0,
                None => POSITION_SD / mean(speed.0).abs().max(1.0),
            };
            let unknown_slip = if slip.is_none() && is_lateral {
                SLIP_SD
            } else {
                0.0
            };
            let lhs = vec![Cow::Borrowed(lhs)];
            let mut pair = Pair::new(kind, name.to_string(), lhs, rhs, lhs_late);
            pair.speed = Some(speed);
            pair.slip = slip;
            pair.ahead_m = ahead.unwrap_or(0.0);
            pair.doubt_s = f64::hypot(unknown_place, unknown_slip);
            pairs.push(pair);
        }
    }
    pairs
}

/// Rates about the axes of the sled.
const RATES: [&str; 3] = ["roll_rate_radps", "pitch_rate_radps", "yaw_rate_radps"];
/// Accelerations along the axes of the sled.
const ACCELERATIONS: [&str; 3] = ["ax_mps2", "ay_mps2", "az_mps2"];

/// The columns of the other two axes of a rate or an acceleration; empty for other columns.
fn other_axes(column: &str) -> Vec<&'static str> {
    let groups = [RATES, ACCELERATIONS].into_iter();
    let own = groups.filter(|axes| axes.contains(&column)).flatten();
    own.filter(|axis| *axis != column).collect()
}

/// What a longitudinal accelerometer measures besides dv/dt, up to constant coefficients: the
/// components of the sled's forward axis in a non-rotating frame, integrated from the angular rates
/// (`dR/dt = R w`), for gravity; and `q^2 + r^2` and `dq/dt + p r` for a sensor ahead of or above
/// the centre of gravity. `None` if the rates do not overlap in time.
fn gravity_and_place(rates: [&Series; 3]) -> Option<[Series; 5]> {
    let [roll, pitch, yaw] = rates.map(|rate| Signal::of(rate, f64::INFINITY));
    let rates = [roll?, pitch?, yaw?];
    let span = |i: usize| rates.each_ref().map(|rate| rate.span()[i]).into_iter();
    let (from, to) = (
        span(0).fold(f64::MIN, f64::max),
        span(1).fold(f64::MAX, f64::min),
    );
    let step = rates[0].rate_hz.recip();
    let mut columns: [Series; 5] = Default::default();
    let (mut rotation, mut rate) = (Rotation3::identity(), Vector3::zeros());
    let mut pitch_acceleration = 0.0;
    for i in 0..((to - from) / step).max(0.0) as usize {
        let t = from + i as f64 * step;
        let axis = rotation.matrix().column(0);
        let [p, q, r] = rate.into();
        let ahead = q * q + r * r;
        let values = [axis[0], axis[1], axis[2], ahead, pitch_acceleration + p * r];
        for (value, series) in values.into_iter().zip(&mut columns) {
            series.time.push(t);
            series.values.push(value);
        }
        // In a gap the last rates are used.
        if let [Some(p), Some(q), Some(r)] = rates.each_ref().map(|rate| rate.at(t + 0.5 * step)) {
            rate = Vector3::new(p[0], q[0], r[0]);
            pitch_acceleration = q[1];
        }
        rotation *= Rotation3::from_scaled_axis(rate * step);
    }
    (to > from).then_some(columns)
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
        lhs: Vec<Cow<'a, Series>>,
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

    /// Both sides, low-pass filtered; `None` where a series is too short.
    pub fn sides(&self, cutoff_hz: f64) -> Option<Sides<'_>> {
        let filtered = |series: &Series| Signal::of(series, cutoff_hz);
        let lhs = self.lhs.iter().map(|lhs| filtered(lhs));
        // A relation whose speed is too short has no sides.
        let speed = self.speed.map(|(series, _)| filtered(series));
        Some(Sides {
            pair: self,
            lhs: lhs.collect::<Option<_>>()?,
            main: filtered(self.main)?,
            speed: speed.map_or(Some(None), |speed| speed.map(Some))?,
            slip: self.slip.and_then(filtered),
        })
    }

    /// Sample rate of the slower side [Hz].
    pub fn rate_hz(&self) -> Option<f64> {
        let rate = |series: &Series| Signal::of(series, f64::INFINITY).map(|signal| signal.rate_hz);
        Some(rate(&self.lhs[0])?.min(rate(self.main)?))
    }
}

impl Sides<'_> {
    /// Number of columns of `lhs`.
    pub fn columns(&self) -> usize {
        self.lhs.len()
    }

    /// Number of the first columns of `lhs` whose correlation counts: the others are those of a
    /// rotation.
    pub fn counted(&self) -> usize {
        match self.pair.kind {
            Kind::Longitudinal => self.lhs.len(),
            _ => 1,
        }
    }

    /// Columns of `lhs` and their derivatives at a time `t` of its clock.
    pub fn lhs(&self, t: f64) -> Option<Vec<[f64; 2]>> {
        let columns = self.lhs.iter().map(|column| column.at(t));
        let both = columns.map(|column| column.map(|[value, slope, _]| [value, slope]));
        both.collect()
    }

    /// `rhs` and its derivative at a time `t` of its clock; `t + ahead` is the time of the clock of
    /// `lhs`.
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
                // v_y = -alpha v; its second derivative without the term of d2v/dt2, which is
                // small.
                let dv_y = -(dslip * v + slip * dv);
                let ddv_y = -(ddslip * v + 2.0 * dslip * dv);
                let slope = dw * v + w * dv + ddv_y + x * ddw;
                [w * v + dv_y + x * dw, slope]
            }
        })
    }

    /// First and last time of both sides [s].
    pub fn spans(&self) -> [[f64; 2]; 2] {
        [self.lhs[0].span(), self.main.span()]
    }

    /// Time to add to the clock of `rhs` to obtain that of `lhs`, for a delay of the late logger
    /// [s].
    pub fn ahead(&self, delay: f64) -> f64 {
        if self.pair.lhs_late { delay } else { -delay }
    }
}
