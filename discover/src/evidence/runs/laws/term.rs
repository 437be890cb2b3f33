//! Terms of laws on one run: what a unit of each channel does to the rows, times functions of recorded columns.

use kufe_sled::effects::{Active, Channel, Custom, Kind, SENSORS, Sensor, Signals, State};
use nalgebra::DMatrix;

use crate::evidence::runs::laws::formulas::shape::Shape;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::BALANCES;
use crate::evidence::runs::recordings::frame::Frame;

/// A column's name and where its value is found.
type NamedColumn = (&'static str, fn(&State) -> f64);

/// Columns that a law on forces may depend on: as an expression names them, and what they are at an instant. What the sensors say
/// follows them, for laws on sensors.
pub const COLUMNS: [NamedColumn; 10] = [
    ("v_mps", |at| at.point.v),
    ("fz_n", |at| at.load[0] + at.load[1]),
    ("alpha_rad", |at| at.chassis_slip),
    ("delta_rad", |at| at.steering),
    ("gamma_rad", |at| at.roll_split),
    ("roll_rate_radps", |at| at.roll_rate),
    ("roll_acceleration_radps2", |at| at.roll_acceleration),
    ("pitch_rate_radps", |at| at.pitch_rate),
    ("yaw_rate_radps", |at| at.yaw_rate),
    ("t_s", |at| at.point.t),
];

/// Columns that the model knows; recorded ones that it has no name for follow them.
pub const KNOWN: usize = COLUMNS.len() + SENSORS;

/// The place of what a sensor says.
pub const fn said_by(sensor: Sensor) -> usize {
    COLUMNS.len() + sensor as usize
}

/// Whether a law on this channel may depend on the column in this place: on a sensor what it says itself, the speed and the time.
pub fn drives(channel: Channel, column: usize) -> bool {
    match channel {
        Channel::Sensor(sensor) => {
            let other = COLUMNS.get(column).map(|(name, _)| *name);
            column == said_by(sensor)
                || other == Some("t_s")
                || other == Some("v_mps") && sensor != Sensor::Speed
        }
        _ => !(COLUMNS.len()..KNOWN).contains(&column),
    }
}

/// One function on one channel, both by their places.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// The channel.
    pub channel: usize,
    /// The function.
    pub shape: Shape,
}

/// What a unit on a channel does to each balance, at every sample.
#[derive(Default)]
struct Unit {
    /// A unit of the law's value.
    by_value: [Vec<f64>; BALANCES],
    /// A unit of its derivative by time; nothing where it is a force.
    by_rate: [Vec<f64>; BALANCES],
}

/// One run: the columns of the fit, what a unit of each channel does, and the columns that laws depend on.
pub struct TermsOnRun {
    /// Levels, fitted parameters, named candidates and the residual, whitened rows.
    pub fitted: DMatrix<f64>,
    /// By channel.
    units: Vec<Unit>,
    /// By column, at every sample.
    columns: Vec<Vec<f64>>,
    /// Derivatives by time of those that laws on sensors depend on; the others' are empty.
    rates: Vec<Vec<f64>>,
}

impl TermsOnRun {
    /// Prepares a run; `extra` names recorded columns other than those of the model.
    pub fn new(design: &Design, frame: &Frame, channels: &[Channel], extra: &[String]) -> Self {
        // Any small size does: forces go in proportion, and sensors nearly.
        const SIZES: [f64; 2] = [1e-4, 1e-2];
        let on_run = ModelOnRun::new(design.residual_model, frame);
        let size = |channel: &Channel| match channel {
            Channel::Lateral | Channel::Yaw | Channel::Longitudinal => SIZES[1],
            _ => SIZES[0],
        };
        let on = |channel: &Channel, text: &str| Active {
            name: String::new(),
            kind: Kind::Custom(Custom::new(*channel, text, None).expect("a formula of the time")),
            values: vec![size(channel)],
            track: None,
        };
        let sensors = channels.iter().any(|c| matches!(c, Channel::Sensor(_)));
        let trials: Vec<(f64, Active, Option<Active>)> = channels
            .iter()
            .map(|channel| {
                // What reads the time too much reads its rate a second a second too much as well.
                let growing = matches!(channel, Channel::Sensor(_)).then(|| on(channel, "t_s"));
                (size(channel), on(channel, "1"), growing)
            })
            .collect();
        let mut units: Vec<Unit> = trials.iter().map(|_| Unit::default()).collect();
        let count = KNOWN + extra.len();
        let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(frame.len()); count];
        let mut rates: Vec<Vec<f64>> = vec![Vec::new(); count];
        for i in 0..frame.len() {
            let at = on_run.instant(i, &on_run.measured(i));
            let forces = on_run.forces(&at);
            let rest = on_run.balances(&at, &forces);
            let by = sensors
                .then(|| on_run.residual_jacobian(&at, &forces))
                .flatten();
            for ((size, constant, growing), unit) in trials.iter().zip(&mut units) {
                let of = |trial: &Active| {
                    let with = on_run.balances_with(i, trial, &at, &forces, by.as_ref());
                    [0, 1, 2].map(|c| (rest[c] - with[c]) / size)
                };
                let by_value = of(constant);
                let both = growing.as_ref().map(of);
                for c in 0..BALANCES {
                    unit.by_value[c].push(by_value[c]);
                    if let Some(both) = both {
                        unit.by_rate[c].push(both[c] - frame.t[i] * by_value[c]);
                    }
                }
            }
            for (column, (_, of)) in columns.iter_mut().zip(COLUMNS) {
                column.push(of(&at.seen));
            }
            for (column, name) in columns[KNOWN..].iter_mut().zip(extra) {
                let recorded = frame.extra.get(name);
                column.push(recorded.map_or(f64::NAN, |x| x[i]));
            }
            if sensors {
                let signals = at.signals();
                for sensor in Sensor::ALL {
                    columns[said_by(sensor)].push(signals[sensor]);
                    rates[said_by(sensor)].push(signals.rate(sensor));
                }
                for (rate, (name, _)) in rates.iter_mut().zip(COLUMNS) {
                    rate.push(rate_of(name, signals));
                }
            }
        }
        Self {
            fitted: design.columns(frame),
            units,
            columns,
            rates,
        }
    }

    /// A column at every sample.
    pub fn column(&self, column: usize) -> &[f64] {
        &self.columns[column]
    }

    /// All columns of the rows: levels and fitted parameters, terms, named candidates, residual.
    pub fn with(&self, design: &Design, frame: &Frame, terms: &[Term]) -> DMatrix<f64> {
        let before = self.fitted.ncols() - 1 - design.candidates.len();
        let whitener = design.whitener;
        let mut all = DMatrix::zeros(self.fitted.nrows(), self.fitted.ncols() + terms.len());
        all.columns_mut(0, before)
            .copy_from(&self.fitted.columns(0, before));
        let behind = design.candidates.len() + 1;
        all.columns_mut(before + terms.len(), behind)
            .copy_from(&self.fitted.columns(before, behind));
        for (k, term) in terms.iter().enumerate() {
            let values: Vec<f64> = (0..frame.len())
                .map(|i| term.shape.value(|column| self.columns[column][i]))
                .collect();
            let unit = &self.units[term.channel];
            let rates: Vec<f64> = match unit.by_rate[0].is_empty() {
                true => Vec::new(),
                false => (0..frame.len()).map(|i| self.rate(term, i)).collect(),
            };
            let mut white: [Vec<f64>; BALANCES] = std::array::from_fn(|c| {
                if !whitener.used[c] {
                    return Vec::new();
                }
                let both = values.iter().zip(&unit.by_value[c]);
                let mut raw: Vec<f64> = both.map(|(f, u)| f * u).collect();
                for ((raw, rate), u) in raw.iter_mut().zip(&rates).zip(&unit.by_rate[c]) {
                    *raw += rate * u;
                }
                frame.rows(&raw)
            });
            whitener.mix(&mut white);
            all.column_mut(before + k).copy_from_slice(&white.concat());
        }
        all
    }

    /// The derivative of a term by time at a sample [1/s], as effects on sensors take it: along the rates of the signals.
    fn rate(&self, term: &Term, i: usize) -> f64 {
        const MOMENT_S: f64 = 1e-3;
        let at = |by: f64| {
            let moved = |column: usize| self.columns[column][i] + by * self.rates[column][i];
            term.shape.value(moved)
        };
        (at(MOMENT_S) - at(-MOMENT_S)) / (2.0 * MOMENT_S)
    }
}

/// The derivative by time of a column that laws on sensors share with those on forces; 0 of others.
fn rate_of(column: &str, signals: &Signals) -> f64 {
    match column {
        "v_mps" => signals.rate(Sensor::Speed),
        "t_s" => 1.0,
        _ => 0.0,
    }
}
