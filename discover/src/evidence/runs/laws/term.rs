//! Terms of laws on one run: derivatives by each channel, times functions of recorded columns.

use kufe_sled::effects::{Active, Channel, Custom, Kind, State};
use nalgebra::DMatrix;

use crate::evidence::runs::laws::shape::Shape;
use crate::evidence::runs::model::design::Design;
use crate::evidence::runs::model::on_run::ModelOnRun;
use crate::evidence::runs::model::residual_model::BALANCES;
use crate::evidence::runs::recordings::frame::Frame;

/// A column's name and value.
type NamedColumn = (&'static str, fn(&State) -> f64);

/// Columns that a law may depend on: names in expressions, and values at an instant.
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

/// Number of columns of the model; recorded columns outside the model follow them.
pub const KNOWN: usize = COLUMNS.len();

/// A function on a channel.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Index of the channel.
    pub channel: usize,
    pub shape: Shape,
}

/// One run: the columns of the fit, the channels' derivatives, and the columns that laws depend on.
pub struct TermsOnRun {
    /// Levels, fitted parameters, named candidates and the residual, whitened rows.
    pub fitted: DMatrix<f64>,
    /// Derivative of each balance by each channel, at every sample.
    units: Vec<[Vec<f64>; BALANCES]>,
    /// By column, at every sample.
    columns: Vec<Vec<f64>>,
}

impl TermsOnRun {
    /// Prepares a run; `extra` lists recorded columns outside the model.
    pub fn new(design: &Design, frame: &Frame, channels: &[Channel], extra: &[String]) -> Self {
        // Any small size will do: forces are proportional to it.
        const SIZES: [f64; 2] = [1e-4, 1e-2];
        let on_run = ModelOnRun::new(design.residual_model, frame);
        let trial = |channel: &Channel| {
            let size = match channel {
                Channel::Lateral | Channel::Yaw | Channel::Longitudinal => SIZES[1],
                _ => SIZES[0],
            };
            let one = Custom::new(*channel, "1", None).expect("a formula");
            let trial = Active {
                name: String::new(),
                kind: Kind::Custom(one),
                values: vec![size],
                track: None,
            };
            (size, trial)
        };
        let trials: Vec<(f64, Active)> = channels.iter().map(trial).collect();
        let mut units: Vec<[Vec<f64>; BALANCES]> = vec![Default::default(); trials.len()];
        let count = KNOWN + extra.len();
        let mut columns: Vec<Vec<f64>> = vec![Vec::with_capacity(frame.len()); count];
        for i in 0..frame.len() {
            let at = on_run.instant(i);
            let rest = at.residuals();
            for ((size, trial), unit) in trials.iter().zip(&mut units) {
                let with = on_run.residuals_with_effect(i, trial, &at, None);
                for (c, unit) in unit.iter_mut().enumerate() {
                    unit.push((rest[c] - with[c]) / size);
                }
            }
            for (column, (_, of)) in columns.iter_mut().zip(COLUMNS) {
                column.push(of(&at.seen));
            }
            for (column, name) in columns[KNOWN..].iter_mut().zip(extra) {
                let recorded = frame.extra.get(name);
                column.push(recorded.map_or(f64::NAN, |x| x[i]));
            }
        }
        Self {
            fitted: design.columns(frame),
            units,
            columns,
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
        let scales = frame.row_scales();
        for (k, term) in terms.iter().enumerate() {
            let values: Vec<f64> = (0..frame.len())
                .map(|i| term.shape.value(|column| self.columns[column][i]))
                .collect();
            let unit = &self.units[term.channel];
            let mut white: [Vec<f64>; BALANCES] = std::array::from_fn(|c| {
                if !whitener.used[c] {
                    return Vec::new();
                }
                let both = values.iter().zip(&unit[c]);
                frame.rows(&both.map(|(f, u)| f * u).collect::<Vec<_>>())
            });
            whitener.whiten(&scales, &mut white);
            all.column_mut(before + k).copy_from_slice(&white.concat());
        }
        all
    }
}
