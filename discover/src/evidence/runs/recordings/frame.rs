//! One run, smoothed and thinned: what all later work sees of it.

use std::collections::BTreeMap;

use crate::evidence::runs::recordings::smooth::Kernel;

/// One run, or one segment of a single long run.
#[derive(Clone, Debug)]
pub struct Frame {
    /// Name for reports.
    pub name: String,
    /// Track.
    pub track: String,
    /// Session.
    pub session: String,
    /// Ice and air temperature [deg C], air pressure [Pa].
    pub ice_c: f64,
    /// Air temperature [deg C].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Relative humidity [%]; NaN where nothing states it.
    pub humidity_pct: f64,
    /// Distance run on this finish of the runners before this run [m].
    pub distance_before: f64,
    /// Time between samples of the recording [s].
    pub recorded_dt: f64,
    /// Low pass from kept samples to rows.
    pub sieve: Kernel,
    /// Time [s].
    pub t: Vec<f64>,
    /// Distance along the track [m].
    pub s: Vec<f64>,
    /// Specific force at the sensor, three axes [m/s2].
    pub acceleration: [Vec<f64>; 3],
    /// Rates about x, y, z [rad/s].
    pub rate: [Vec<f64>; 3],
    /// Their derivatives [rad/s2].
    pub rate_slope: [Vec<f64>; 3],
    /// Speed [m/s] and its derivative [m/s2].
    pub v: Vec<f64>,
    /// Derivative of the speed [m/s2].
    pub v_slope: Vec<f64>,
    /// Slip angle at the sensor [rad].
    pub slip: Vec<f64>,
    /// Its rate [rad/s].
    pub slip_rate: Vec<f64>,
    /// Steering [rad].
    pub steer: Vec<f64>,
    /// Its rate [rad/s].
    pub steer_rate: Vec<f64>,
    /// Roll-split [rad].
    pub roll_split: Vec<f64>,
    /// Slope of the track as surveyed [rad]; empty where there is no survey.
    pub slope: Vec<f64>,
    /// Further columns of the file.
    pub extra: BTreeMap<String, Vec<f64>>,
}

impl Frame {
    /// Number of kept samples.
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// Columns that effects may ask for and that nothing states for this run.
    pub fn stated_nowhere(&self) -> Vec<&'static str> {
        let humidity = self.humidity_pct.is_finite() || self.extra.contains_key("humidity_pct");
        if humidity {
            Vec::new()
        } else {
            vec!["humidity_pct"]
        }
    }

    /// A signal at kept samples, low-passed and thinned to rows.
    pub fn rows(&self, x: &[f64]) -> Vec<f64> {
        self.sieve.smooth(x)
    }

    /// Number of rows.
    pub fn row_count(&self) -> usize {
        self.sieve.centres(self.len()).count()
    }

    /// The samples `from..to` alone.
    pub fn piece(&self, from: usize, to: usize) -> Self {
        let mut piece = self.clone();
        for column in piece
            .acceleration
            .iter_mut()
            .chain(&mut piece.rate)
            .chain(&mut piece.rate_slope)
            .chain(piece.extra.values_mut())
            .chain([
                &mut piece.t,
                &mut piece.s,
                &mut piece.v,
                &mut piece.v_slope,
                &mut piece.slip,
                &mut piece.slip_rate,
                &mut piece.steer,
                &mut piece.steer_rate,
                &mut piece.roll_split,
                &mut piece.slope,
            ])
        {
            *column = column.get(from..to).map_or_else(Vec::new, <[f64]>::to_vec);
        }
        piece
    }
}
