//! One run, smoothed and thinned: the input of all later steps.

use std::collections::BTreeMap;
use std::sync::Arc;

use kufe_sled::Sled;
use kufe_sled::effects::Sensor;

use crate::evidence::runs::contacts::run_contacts::OwnContact;
use crate::evidence::runs::recordings::place_scales::PlaceScales;
use crate::evidence::runs::recordings::smooth::Kernel;

/// One run, or one segment of a single long run.
#[derive(Clone, Debug, Default)]
pub struct Frame {
    pub name: String,
    pub track: String,
    pub driver: String,
    pub session: String,
    /// Ice temperature [deg C]; NaN if not stated, and in `extra` if it varies within the run.
    pub ice_c: f64,
    /// Air temperature [deg C].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Mass of the sled with its crew [kg]; `None`: the model's.
    pub mass_kg: Option<f64>,
    /// Relative humidity [%]; NaN if not stated.
    pub humidity_pct: f64,
    /// Distance run on this finish of the runners before this run [m].
    pub distance_before: f64,
    /// Time between samples of the recording [s].
    pub recorded_dt: f64,
    /// Low pass from retained samples to rows.
    pub row_kernel: Kernel,
    /// Whether each retained sample is used; samples next to a gap are interpolated and unused.
    pub is_used: Vec<bool>,
    /// Retained samples at which rows are centred.
    pub centres: Vec<usize>,
    /// Time [s].
    pub t: Vec<f64>,
    /// Distance along the track [m].
    pub s: Vec<f64>,
    /// Specific force at the sensor, three axes [m/s2].
    pub acceleration: [Vec<f64>; 3],
    /// Rates about x, y, z [rad/s].
    pub rate: [Vec<f64>; 3],
    /// Derivatives of the rates [rad/s2].
    pub rate_slope: [Vec<f64>; 3],
    /// Speed [m/s].
    pub v: Vec<f64>,
    /// Derivative of the speed [m/s2].
    pub v_slope: Vec<f64>,
    /// Slip angle at the sensor [rad].
    pub slip: Vec<f64>,
    /// Derivative of the slip angle [rad/s].
    pub slip_rate: Vec<f64>,
    /// Steering angle [rad].
    pub steer: Vec<f64>,
    /// Derivative of the steering angle [rad/s].
    pub steer_rate: Vec<f64>,
    /// Roll-split angle [rad].
    pub roll_split: Vec<f64>,
    /// Surveyed slope of the track [rad]; empty without a survey.
    pub slope: Vec<f64>,
    /// The survey, slope [rad] over distance [m].
    pub survey: Vec<(f64, f64)>,
    /// Whether the distance is integrated from the speed, so that an error of the speed changes it.
    pub s_of_speed: bool,
    /// The run's own contacts with walls, if places of contacts are known.
    pub contacts: Vec<OwnContact>,
    /// Intervals of distance in which this run alone was pushed \[m\].
    pub pushed: Vec<[f64; 2]>,
    /// Standard deviations of the residuals by place; `None`: equal.
    pub scales: Option<Arc<PlaceScales>>,
    /// Sensor noise of its rows.
    pub noise: Option<Arc<RowNoise>>,
    /// Further columns of the file.
    pub extra: BTreeMap<String, Vec<f64>>,
}

/// Sensor noise of the rows of a run.
#[derive(Clone, Debug)]
pub struct RowNoise {
    /// Some samples of the run.
    pub samples: Frame,
    /// Variances of the noise of each reading and of its derivative in a row, by sensor.
    pub variances: ReadingVariances,
}

/// Sum and number of values in a bin of distance.
#[derive(Clone, Copy, Debug, Default)]
pub struct BinSum {
    pub sum: f64,
    pub count: f64,
}

impl BinSum {
    pub fn mean(&self) -> f64 {
        self.sum / self.count
    }
}

/// Number of the bin of width `width` \[m\] at a distance \[m\].
pub fn bin_of(s: f64, width: f64) -> i64 {
    (s / width).floor() as i64
}

/// Variances of each reading and of its derivative, by sensor.
pub type ReadingVariances = [[f64; 2]; Sensor::ALL.len()];

impl Frame {
    pub fn len(&self) -> usize {
        self.t.len()
    }

    /// The constants of a sled in this run: with the run's mass, if it is stated.
    pub fn sled(&self, stated: Sled) -> Sled {
        Sled {
            mass_kg: self.mass_kg.unwrap_or(stated.mass_kg),
            ..stated
        }
    }

    /// Time between retained samples [s].
    pub fn sample_s(&self) -> f64 {
        match self.t.as_slice() {
            [first, .., last] => (last - first) / (self.t.len() - 1) as f64,
            _ => self.recorded_dt,
        }
    }

    /// A condition by sample: a column of the run, else its stated value; NaN if not stated.
    pub fn condition(&self, name: &str) -> Vec<f64> {
        let once = match name {
            "ice_c" => self.ice_c,
            "air_c" => self.air_c,
            "air_pa" => self.air_pa,
            "humidity_pct" => self.humidity_pct,
            "distance_m" => self.distance_before,
            _ => f64::NAN,
        };
        let own = self.extra.get(name).cloned();
        own.unwrap_or_else(|| vec![once; self.len()])
    }

    /// Columns that effects may need and that are not stated for this run.
    pub fn unstated_conditions(&self) -> Vec<&'static str> {
        let stated = [
            ("humidity_pct", self.humidity_pct),
            ("ice_c", self.ice_c),
            ("air_c", self.air_c),
            ("air_pa", self.air_pa),
        ];
        let nowhere = stated
            .into_iter()
            .filter(|(name, value)| !value.is_finite() && !self.extra.contains_key(*name));
        nowhere.map(|(name, _)| name).collect()
    }

    /// A signal at retained samples, low-passed and thinned to rows.
    pub fn rows(&self, x: &[f64]) -> Vec<f64> {
        if x.is_empty() {
            return Vec::new();
        }
        self.row_kernel.smooth_at(x, &self.centres)
    }

    /// A signal at the rows that are omitted because of gaps.
    pub fn omitted_rows(&self, x: &[f64]) -> Vec<f64> {
        let centres = self.row_kernel.centres(self.len());
        let omitted = centres.filter(|i| self.centres.binary_search(i).is_err());
        let omitted: Vec<usize> = omitted.collect();
        self.row_kernel.smooth_at(x, &omitted)
    }

    /// Sums of values of the rows by bin of distance of width `width` [m].
    pub fn sums_by_bin(
        &self,
        values: impl IntoIterator<Item = f64>,
        width: f64,
    ) -> BTreeMap<i64, BinSum> {
        let mut sums: BTreeMap<i64, BinSum> = BTreeMap::new();
        for (s, value) in self.rows(&self.s).into_iter().zip(values) {
            let bin = sums.entry(bin_of(s, width)).or_default();
            (bin.sum, bin.count) = (bin.sum + value, bin.count + 1.0);
        }
        sums
    }

    /// The relative standard deviation of each balance by row; empty if equal.
    pub fn row_scales(&self) -> Vec<[f64; 3]> {
        match self.scales {
            Some(_) => self.scales_at(&self.rows(&self.s)),
            None => Vec::new(),
        }
    }

    /// The relative standard deviation of each balance at these places; empty if equal.
    pub fn scales_at(&self, places: &[f64]) -> Vec<[f64; 3]> {
        let scales = self.scales.as_ref();
        scales.map_or(Vec::new(), |scales| scales.along(&self.track, places))
    }

    /// The retained samples that are used.
    pub fn samples(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.len()).filter(|i| self.is_used[*i])
    }

    pub fn row_count(&self) -> usize {
        self.centres.len()
    }

    /// The run with a row at every sample: sums of squares then do not depend on the phase of the
    /// rows.
    pub fn at_every_sample(&self) -> Self {
        let mut dense = self.clone();
        dense.row_kernel.stride = 1;
        dense.centres = dense.row_kernel.clear_centres(&dense.is_used);
        dense
    }

    /// The samples `from..to` alone.
    pub fn piece(&self, from: usize, to: usize) -> Self {
        let mut piece = self.with_columns(|column| {
            let part = column.get(from..to);
            part.map_or_else(Vec::new, <[f64]>::to_vec)
        });
        piece.is_used = self.is_used[from..to].to_vec();
        piece.centres = piece.row_kernel.clear_centres(&piece.is_used);
        piece
    }

    /// The run at `count` of the used samples, evenly spread, without rows.
    pub fn thinned(&self, count: usize) -> Self {
        let used: Vec<usize> = self.samples().collect();
        let every = used.len().div_ceil(count.max(1)).max(1);
        let samples: Vec<usize> = used.into_iter().step_by(every).collect();
        let mut thinned = self.with_columns(|column| {
            let at_samples = samples.iter().filter_map(|i| column.get(*i));
            at_samples.copied().collect()
        });
        thinned.is_used = vec![true; samples.len()];
        thinned.centres.clear();
        thinned
    }

    /// A sensor's signal, and its derivative if the model uses it.
    pub fn series(&self, sensor: Sensor) -> (&Vec<f64>, Option<&Vec<f64>>) {
        match sensor {
            Sensor::Ax => (&self.acceleration[0], None),
            Sensor::Ay => (&self.acceleration[1], None),
            Sensor::Az => (&self.acceleration[2], None),
            Sensor::RollRate => (&self.rate[0], Some(&self.rate_slope[0])),
            Sensor::PitchRate => (&self.rate[1], Some(&self.rate_slope[1])),
            Sensor::YawRate => (&self.rate[2], Some(&self.rate_slope[2])),
            Sensor::Speed => (&self.v, Some(&self.v_slope)),
            Sensor::Slip => (&self.slip, Some(&self.slip_rate)),
            Sensor::Steering => (&self.steer, Some(&self.steer_rate)),
            Sensor::RollSplit => (&self.roll_split, None),
        }
    }

    /// [`series`](Self::series), to be changed.
    pub fn series_mut(&mut self, sensor: Sensor) -> (&mut Vec<f64>, Option<&mut Vec<f64>>) {
        match sensor {
            Sensor::Ax => (&mut self.acceleration[0], None),
            Sensor::Ay => (&mut self.acceleration[1], None),
            Sensor::Az => (&mut self.acceleration[2], None),
            Sensor::RollRate => (&mut self.rate[0], Some(&mut self.rate_slope[0])),
            Sensor::PitchRate => (&mut self.rate[1], Some(&mut self.rate_slope[1])),
            Sensor::YawRate => (&mut self.rate[2], Some(&mut self.rate_slope[2])),
            Sensor::Speed => (&mut self.v, Some(&mut self.v_slope)),
            Sensor::Slip => (&mut self.slip, Some(&mut self.slip_rate)),
            Sensor::Steering => (&mut self.steer, Some(&mut self.steer_rate)),
            Sensor::RollSplit => (&mut self.roll_split, None),
        }
    }

    /// The run with `of` applied to every column of samples.
    pub fn with_columns(&self, of: impl Fn(&[f64]) -> Vec<f64>) -> Self {
        let mut changed = self.clone();
        for sensor in Sensor::ALL {
            let (signal, derivative) = changed.series_mut(sensor);
            *signal = of(signal);
            if let Some(derivative) = derivative {
                *derivative = of(derivative);
            }
        }
        let others = [&mut changed.t, &mut changed.s, &mut changed.slope];
        for column in others.into_iter().chain(changed.extra.values_mut()) {
            *column = of(column);
        }
        changed
    }
}

/// Columns outside the model that every run has: those that vary within a run, or those that differ
/// from run to run only (covariates of an index, and constant channels).
pub fn further_columns(frames: &[Frame], within_runs: bool) -> Vec<String> {
    const CONDITIONS: [&str; 3] = ["humidity_pct", "distance_m", "ice_c"];
    let Some(first) = frames.first() else {
        return Vec::new();
    };
    let varies = |column: &[f64]| column.iter().any(|x| *x != column[0]);
    let further = |name: &&String| {
        let columns: Option<Vec<_>> = frames.iter().map(|f| f.extra.get(*name)).collect();
        let varying = |columns: Vec<&Vec<f64>>| columns.iter().any(|column| varies(column));
        columns.is_some_and(|columns| varying(columns) == within_runs)
            && !CONDITIONS.contains(&name.as_str())
    };
    first.extra.keys().filter(further).cloned().collect()
}
