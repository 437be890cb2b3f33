//! Runs made ready: smoothed alike, decimated, with derivatives and conditions.

use std::collections::BTreeMap;
use std::path::Path;

use kufe_sled::effects::Column;
use kufe_sled::{Entry, Model, Noise, Run, read_index, read_run};

use crate::Error;
use crate::smooth::Kernel;

/// Corner of the low pass of every signal, before the balances are taken [Hz].
pub const CUTOFF_HZ: f64 = 16.0;
/// Samples a second that are kept [1/s].
pub const RATE_HZ: f64 = 50.0;
/// Corner of the low pass of the balances [Hz].
const ROW_CUTOFF_HZ: f64 = 4.0;
/// Rows a second [1/s].
const ROW_RATE_HZ: f64 = 10.0;

/// The kernel of every signal with `dt` [s] between samples.
pub fn signal_kernel(dt: f64) -> Kernel {
    Kernel::new(dt, CUTOFF_HZ.min(0.2 / dt), RATE_HZ)
}

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

/// All runs with what is known of the whole set.
#[derive(Clone, Debug)]
pub struct Data {
    /// The runs, or the segments of a single one.
    pub frames: Vec<Frame>,
    /// White noise of each sensor at the recorded rate.
    pub noise: Noise,
    /// Names of the sensors whose noise was estimated rather than stated.
    pub noise_estimated: bool,
    /// Columns that were recorded and vary.
    pub available: Vec<Column>,
    /// Whether one run was cut into segments.
    pub segmented: bool,
    /// What a reader should know: constant columns, segments, remarks of the reader.
    pub remarks: Vec<String>,
}

/// Reads an index and its runs, and makes them ready.
///
/// A column beyond the indispensable ones may be missing; effects that need it are then not testable.
///
/// # Errors
/// Those of the sled's readers; [`Error::Duplicate`] where two runs hold the same samples; [`Error::TooFew`].
pub fn read(index: &Path, model: &Model) -> Result<Data, Error> {
    const INDISPENSABLE: [&str; 5] = [
        "ay_mps2",
        "yaw_rate_radps",
        "v_mps",
        "alpha_rad",
        "delta_rad",
    ];
    let entries: Vec<Entry> = read_index(index)?;
    let mut runs = Vec::with_capacity(entries.len());
    for entry in entries {
        runs.push(read_run(entry, &INDISPENSABLE)?);
    }
    refuse_copies(index, &runs)?;
    let folder = index.parent().unwrap_or(Path::new(""));
    prepare(&runs, model, &surveys(folder, &runs)?)
}

/// Slope over distance, by track.
pub type Surveys = BTreeMap<String, Vec<(f64, f64)>>;

fn surveys(folder: &Path, runs: &[Run]) -> Result<Surveys, Error> {
    let mut surveys = Surveys::new();
    for run in runs {
        let name = &run.entry.track;
        let path = folder.join(format!("track_{name}.csv"));
        if surveys.contains_key(name) || !path.is_file() {
            continue;
        }
        let table = crate::table::Table::read(&path)?;
        let s = table.numbers("s_m", -1e6, 1e6)?;
        let slope = table.numbers("slope_rad", -1.5, 1.5)?;
        if s.windows(2).any(|pair| pair[1] <= pair[0]) {
            return Err(Error::File {
                file: path.display().to_string(),
                reason: "column s_m does not increase from row to row".to_owned(),
            });
        }
        surveys.insert(name.clone(), s.into_iter().zip(slope).collect());
    }
    Ok(surveys)
}

fn refuse_copies(index: &Path, runs: &[Run]) -> Result<(), Error> {
    for (i, run) in runs.iter().enumerate() {
        if let Some(copy) = runs[..i].iter().find(|other| same_samples(other, run)) {
            return Err(Error::Duplicate {
                file: index.display().to_string(),
                first: format!("run {}", copy.entry.run),
                second: format!("run {}", run.entry.run),
            });
        }
    }
    Ok(())
}

/// A renamed or cut copy shares its lateral acceleration sample by sample.
fn same_samples(a: &Run, b: &Run) -> bool {
    let (Some(x), Some(y)) = (a.columns.get("ay_mps2"), b.columns.get("ay_mps2")) else {
        return false;
    };
    let n = x.len().min(y.len()).min(400);
    let lively = x[..n].iter().any(|value| *value != x[0]);
    lively && x[..n] == y[..n]
}

/// Smooths, decimates and completes runs that are already read.
///
/// # Errors
/// [`Error::TooFew`] where a run is shorter than the smoothing needs.
pub fn prepare(runs: &[Run], model: &Model, surveys: &Surveys) -> Result<Data, Error> {
    if runs.is_empty() {
        return Err(Error::TooFew {
            what: "runs".to_owned(),
            found: 0,
            needed: 1,
        });
    }
    let mut remarks: Vec<String> = runs
        .iter()
        .flat_map(|run| {
            run.remarks
                .iter()
                .map(|r| format!("run {}: {r}", run.entry.run))
        })
        .collect();
    let segmented = runs.len() == 1;
    let mut frames = Vec::new();
    let mut before: BTreeMap<&str, f64> = BTreeMap::new();
    for run in runs {
        let own = signal_kernel(run.dt_s);
        let travelled = before.entry(run.entry.session.as_str()).or_insert(0.0);
        let mut frame = frame(run, &own, surveys)?;
        frame.distance_before = run.entry.conditions.distance_m.unwrap_or(*travelled);
        *travelled += frame.s.last().unwrap_or(&0.0) - frame.s.first().unwrap_or(&0.0);
        if segmented {
            frames = cut(&frame);
            remarks.push(format!(
                "one run only: it is cut into {} segments of {:.0} s that stand for runs; what differs from run to run cannot be seen",
                frames.len(),
                frames[0].t.last().unwrap_or(&0.0) - frames[0].t[0]
            ));
        } else {
            frames.push(frame);
        }
    }
    let seen = estimate(runs);
    let (noise, noise_estimated) = match model.noise {
        Some(stated) => (quieter(&stated, &seen, &mut remarks), false),
        None => (seen, true),
    };
    turn_slopes(&mut frames, &mut remarks);
    let available = available(runs, &frames, &mut remarks);
    Ok(Data {
        frames,
        noise,
        noise_estimated,
        available,
        segmented,
        remarks,
    })
}

fn frame(run: &Run, kernel: &Kernel, surveys: &Surveys) -> Result<Frame, Error> {
    let n = run.len();
    let kept_dt = kernel.stride as f64 * run.dt_s;
    let sieve = Kernel::new(kept_dt, ROW_CUTOFF_HZ.min(0.2 / kept_dt), ROW_RATE_HZ);
    // A second of rows at least.
    let needed = 2 * kernel.margin() + (2 * sieve.margin() + 10 * sieve.stride) * kernel.stride;
    if n < needed {
        return Err(Error::TooFew {
            what: format!("run {}: samples", run.entry.run),
            found: n,
            needed,
        });
    }
    let raw = |name: &str, default: f64| -> Vec<f64> {
        run.columns
            .get(name)
            .cloned()
            .unwrap_or_else(|| vec![default; n])
    };
    let smooth = |name: &str, default: f64| kernel.smooth(&raw(name, default));
    let slope_of = |name: &str| kernel.slope(&raw(name, 0.0));
    let v = raw("v_mps", 0.0);
    let s_raw = run.columns.get("s_m").cloned().unwrap_or_else(|| {
        let mut s = 0.0;
        v.iter()
            .map(|v| {
                s += v * run.dt_s;
                s
            })
            .collect()
    });
    let s = kernel.smooth(&s_raw);
    let known: Vec<&str> = kufe_sled::COLUMNS.iter().copied().chain(["s_m"]).collect();
    let extra = run
        .columns
        .iter()
        .filter(|(name, values)| {
            !known.contains(&name.as_str()) && values.iter().all(|x| x.is_finite())
        })
        .map(|(name, values)| (name.clone(), kernel.smooth(values)))
        .collect();
    let slope = surveys
        .get(&run.entry.track)
        .map_or_else(Vec::new, |profile| {
            s.iter().map(|s| interpolate(profile, *s)).collect()
        });
    Ok(Frame {
        name: run.entry.run.clone(),
        track: run.entry.track.clone(),
        session: run.entry.session.clone(),
        ice_c: run.entry.conditions.ice_c,
        air_c: run.entry.conditions.air_c,
        air_pa: run.entry.conditions.air_pa,
        humidity_pct: run.entry.conditions.humidity_pct.unwrap_or(f64::NAN),
        distance_before: 0.0,
        recorded_dt: run.dt_s,
        sieve,
        t: kernel.centres(n).map(|i| i as f64 * run.dt_s).collect(),
        acceleration: [
            smooth("ax_mps2", 0.0),
            smooth("ay_mps2", 0.0),
            smooth("az_mps2", 9.81),
        ],
        rate: [
            smooth("roll_rate_radps", 0.0),
            smooth("pitch_rate_radps", 0.0),
            smooth("yaw_rate_radps", 0.0),
        ],
        rate_slope: [
            slope_of("roll_rate_radps"),
            slope_of("pitch_rate_radps"),
            slope_of("yaw_rate_radps"),
        ],
        v: kernel.smooth(&v),
        v_slope: slope_of("v_mps"),
        slip: smooth("alpha_rad", 0.0),
        slip_rate: slope_of("alpha_rad"),
        steer: smooth("delta_rad", 0.0),
        steer_rate: slope_of("delta_rad"),
        roll_split: smooth("gamma_rad", 0.0),
        s,
        slope,
        extra,
    })
}

/// A track table may count slope uphill: the sign that the speed agrees with is taken, downhill positive from here on.
fn turn_slopes(frames: &mut [Frame], remarks: &mut Vec<String>) {
    let mut agreement = 0.0;
    for frame in frames.iter() {
        for (i, slope) in frame.slope.iter().enumerate() {
            agreement += (frame.v_slope[i] - frame.acceleration[0][i]) * slope;
        }
    }
    if agreement < 0.0 {
        remarks.push("the track's slope is counted positive uphill, as the speeds show".to_owned());
        frames
            .iter_mut()
            .flat_map(|f| &mut f.slope)
            .for_each(|slope| *slope = -*slope);
    }
}

/// Linear interpolation, constant beyond the ends.
pub fn interpolate(profile: &[(f64, f64)], s: f64) -> f64 {
    let at = profile.partition_point(|(x, _)| *x < s);
    if at == 0 {
        return profile.first().map_or(f64::NAN, |p| p.1);
    }
    if at == profile.len() {
        return profile[at - 1].1;
    }
    let ((x0, y0), (x1, y1)) = (profile[at - 1], profile[at]);
    y0 + (y1 - y0) * (s - x0) / (x1 - x0)
}

/// Cuts one long run into segments of at least 10 s, about 24 of them, with a second left out between neighbours.
fn cut(frame: &Frame) -> Vec<Frame> {
    let n = frame.len();
    let gap = ((n as f64 / (frame.t[n - 1] - frame.t[0]).max(1e-9)).round() as usize).max(1);
    let length = (n / 24).max(10 * gap).min(n);
    let count = (n / length).max(1);
    (0..count)
        .map(|k| {
            let (from, to) = (
                k * length,
                if count == 1 {
                    n
                } else {
                    (k + 1) * length - gap
                },
            );
            let mut piece = frame.piece(from, to);
            piece.name = format!(
                "{} {:.0}-{:.0} s",
                frame.name,
                frame.t[from],
                frame.t[to - 1]
            );
            piece
        })
        .collect()
}

/// What is stated, where the recordings are not quieter still: white noise shows in full in third differences.
fn quieter(stated: &Noise, seen: &Noise, remarks: &mut Vec<String>) -> Noise {
    let mut lowered = Vec::new();
    let mut least = |name: &str, stated: f64, seen: f64| {
        if seen < 0.9 * stated {
            lowered.push(format!("{name} {stated:.2e} stated, {seen:.2e} seen"));
        }
        stated.min(seen)
    };
    let noise = Noise {
        accel_mps2: least("accelerometer [m/s2]", stated.accel_mps2, seen.accel_mps2),
        rate_radps: least("rates [rad/s]", stated.rate_radps, seen.rate_radps),
        speed_mps: least("speed [m/s]", stated.speed_mps, seen.speed_mps),
        slip_rad: least("slip [rad]", stated.slip_rad, seen.slip_rad),
        steer_rad: least("steering [rad]", stated.steer_rad, seen.steer_rad),
        roll_split_rad: least(
            "roll split [rad]",
            stated.roll_split_rad,
            seen.roll_split_rad,
        ),
    };
    if !lowered.is_empty() {
        remarks.push(format!(
            "sensors quieter from sample to sample than [noise] states are taken as they are: {}",
            lowered.join("; ")
        ));
    }
    noise
}

/// White noise from third differences at the recorded rate, the median over runs: var = mean(d3^2)/20.
fn estimate(runs: &[Run]) -> Noise {
    let sd = |name: &str| -> f64 {
        let mut each: Vec<f64> = runs
            .iter()
            .filter_map(|run| run.columns.get(name))
            .map(|x| {
                let sum: f64 = x
                    .windows(4)
                    .map(|w| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).powi(2))
                    .sum();
                (sum / (20.0 * x.len().saturating_sub(3).max(1) as f64)).sqrt()
            })
            .collect();
        each.sort_by(f64::total_cmp);
        each.get(each.len() / 2).copied().unwrap_or(0.0)
    };
    Noise {
        accel_mps2: sd("ay_mps2"),
        rate_radps: sd("yaw_rate_radps"),
        speed_mps: sd("v_mps"),
        slip_rad: sd("alpha_rad"),
        steer_rad: sd("delta_rad"),
        roll_split_rad: sd("gamma_rad"),
    }
}

fn available(runs: &[Run], frames: &[Frame], remarks: &mut Vec<String>) -> Vec<Column> {
    let recorded = |name: &str| runs.iter().all(|run| run.columns.contains_key(name));
    let first = |name: &str| runs[0].columns.get(name).and_then(|x| x.first());
    let varies = |name: &str| {
        runs.iter().any(|run| {
            run.columns
                .get(name)
                .is_some_and(|x| x.iter().any(|value| Some(value) != first(name)))
        })
    };
    let mut list = vec![Column::Time];
    let by_file = [
        (Column::Speed, "v_mps"),
        (Column::Slip, "alpha_rad"),
        (Column::Steering, "delta_rad"),
        (Column::RollSplit, "gamma_rad"),
        (Column::RollRate, "roll_rate_radps"),
        (Column::VerticalAcceleration, "az_mps2"),
        (Column::LongitudinalAcceleration, "ax_mps2"),
        (Column::Load, "az_mps2"),
        (Column::Humidity, "humidity_pct"),
    ];
    for (column, name) in by_file {
        if varies(name) {
            list.push(column);
        } else {
            let why = if recorded(name) {
                "is constant"
            } else {
                "is not recorded"
            };
            remarks.push(format!(
                "column {name} {why}: effects that need it cannot be tested"
            ));
        }
    }
    let spread = |value: fn(&Frame) -> f64| frames.iter().any(|f| value(f) != value(&frames[0]));
    for (column, varies) in [
        (Column::IceTemperature, spread(|f| f.ice_c)),
        (Column::AirTemperature, spread(|f| f.air_c)),
        (Column::AirPressure, spread(|f| f.air_pa)),
        (
            Column::Humidity,
            !list.contains(&Column::Humidity)
                && frames.iter().all(|f| f.humidity_pct.is_finite())
                && spread(|f| f.humidity_pct),
        ),
        (
            Column::Wear,
            varies("distance_m") || spread(|f| f.distance_before),
        ),
    ] {
        if varies {
            list.push(column);
        }
    }
    if runs.len() > 1 || recorded("s_m") {
        list.push(Column::Distance);
    }
    if frames.iter().all(|f| f.slope.len() == f.len()) {
        list.push(Column::Slope);
    }
    list
}
