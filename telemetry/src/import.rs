//! Import of one run: reading, conversion, common clock and rate, with a note of the steps.

use std::collections::BTreeMap;

use kufe_sled::{
    COLUMNS, Columns, Gaps, LARGEST_VALUE, MOST_NUMBERS, Run, Saturation, Sensor, rows_held,
};
use serde::Serialize;

use crate::delay::{LoggerClock, align};
use crate::error::Error;
use crate::log::{Channel, Log};
use crate::mapping::{ChannelSource, LoggerFiles, Mapping, PlannedRun};
use crate::recording::read_log;
use crate::relation::Series;
use crate::resample::{Base, resample};
use crate::text::{TextOptions, continue_days};
use crate::unit::{column_unit, conversion};

/// Imports the runs of one mapping.
#[derive(Debug)]
pub struct Importer {
    mapping: Mapping,
    file: String,
    sha256: String,
}

/// Largest time that is cut off the end of a run for a slow channel [s].
const MAX_CUT_S: f64 = 0.25;

/// An imported run, and the note of its import.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The run; its entry has the conditions that the mapping states.
    pub run: Run,
    /// The steps of the import.
    pub note: Note,
}

/// A channel before it is resampled.
struct ImportedChannel<'a> {
    series: Series,
    source: &'a ChannelSource,
    recipe: Recipe,
    /// Whether it is written as a column; otherwise it is only used for its logger's clock.
    written: bool,
}

impl Importer {
    /// An importer for the text of a mapping; `file` is its name in messages.
    ///
    /// # Errors
    /// Those of [`Mapping::parse`].
    pub fn new(text: &str, file: &str) -> Result<Importer, Error> {
        Ok(Importer {
            mapping: Mapping::parse(text, file)?,
            file: file.to_string(),
            sha256: kufe_files::sha256(text.as_bytes()),
        })
    }

    /// The mapping.
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// Imports one run: reads and converts its recordings, and resamples them in the clock of the
    /// lead at the mapping's rate.
    ///
    /// The run spans the time that all loggers recorded.
    ///
    /// # Errors
    /// Those of the readers; [`Error::Channel`]; [`Error::Clock`] if a clock cannot be related
    /// to the lead, or the loggers do not overlap in time.
    pub fn run(&self, planned: &PlannedRun) -> Result<Imported, Error> {
        let mut remarks = Vec::new();
        let mut files: BTreeMap<&str, (String, String)> = BTreeMap::new();
        let mut read: Vec<ImportedChannel> = Vec::new();
        let mut room = MOST_NUMBERS;
        for (name, path) in &planned.files {
            let file = path.display().to_string();
            let sha256 = kufe_files::open_regular(path)
                .and_then(|file| kufe_files::sha256_of_file(&file))
                .map_err(|error| Error::file(&file, error))?;
            let log = self.log(name, path, room)?;
            room -= log.numbers();
            remarks.extend(log.remarks.iter().cloned());
            files.insert(name, (file.clone(), sha256));
            let also = self.mapping.logger[name].also.iter();
            let written = self.channels_of(name).map(|own| (own, true));
            for ((column, source), written) in written.chain(also.map(|own| (own, false))) {
                let (recipe, series, odd) = self.series(column, source, name, &log, &file)?;
                for text in odd.into_iter().filter(|_| written) {
                    if !remarks.contains(&text) {
                        remarks.push(text);
                    }
                }
                read.push(ImportedChannel {
                    series,
                    source,
                    recipe,
                    written,
                });
            }
            if let Some(rotation) = self.mapping.logger[name].rotation {
                let own = read.iter_mut().map(|read| &mut read.series);
                let own = own.filter(|own| own.logger == *name).collect();
                rotate(own, rotation).map_err(|(found, expected)| Error::Key {
                    file: self.file.clone(),
                    key: format!("logger.{name}.rotation"),
                    found,
                    expected,
                })?;
            }
        }
        // After the rotation, which needs all three axes at common times.
        for read in &mut read {
            drop_repetitions(&mut read.series);
        }
        let series: Vec<&Series> = read.iter().map(|read| &read.series).collect();
        let (clocks, odd) = align(&self.mapping, planned, &series)?;
        remarks.extend(odd);
        read.retain(|read| read.written);
        for own in read.iter_mut().map(|read| &mut read.series) {
            let delay = clocks[&own.logger].delay_s;
            own.time.iter_mut().for_each(|t| *t -= delay);
        }
        let base = self.base(planned, &read)?;
        let (mut columns, mut channels) = (Columns::new(), BTreeMap::new());
        for channel in read {
            let (file, _) = &files[channel.series.logger.as_str()];
            let column = channel.series.column.clone();
            let (values, note) = resampled(channel, &base, file)?;
            columns.insert(column.clone(), values);
            channels.insert(column, note);
        }
        let logger = |(name, (file, sha256)): (&str, (String, String))| {
            let note = LoggerNote {
                file,
                sha256,
                clock: clocks[name].clone(),
                rotation: self.mapping.logger[name].rotation,
            };
            (name.to_string(), note)
        };
        let note = Note {
            run: planned.name.clone(),
            mapping: self.file.clone(),
            mapping_sha256: self.sha256.clone(),
            version: env!("CARGO_PKG_VERSION"),
            rate_hz: base.rate_hz,
            rows: base.count,
            start_s: base.start_s,
            clock: self.mapping.lead().to_string(),
            loggers: files.into_iter().map(logger).collect(),
            channels,
            mass_kg: planned.index.mass_kg,
            remarks,
        };
        let run = Run {
            entry: planned.entry(planned.name.clone().into()),
            t0_s: 0.0,
            dt_s: 1.0 / base.rate_hz,
            columns,
            // Gaps are detected when the run is read.
            gaps: Gaps::none(base.count),
            saturated: BTreeMap::new(),
            remarks: Vec::new(),
        };
        Ok(Imported { run, note })
    }

    fn channels_of<'a>(
        &'a self,
        logger: &'a str,
    ) -> impl Iterator<Item = (&'a String, &'a ChannelSource)> {
        let channels = self.mapping.channels.iter();
        channels.filter(move |(_, source)| self.mapping.logger_of(source) == logger)
    }

    /// A logger's recording with the channels that the mapping names, of at most `max_numbers`
    /// values.
    fn log(&self, logger: &str, path: &std::path::Path, max_numbers: u64) -> Result<Log, Error> {
        let files = &self.mapping.logger[logger];
        let mut wanted: Vec<&str> = files.time.as_deref().into_iter().collect();
        let own = self.channels_of(logger).map(|(_, source)| source);
        for source in own.chain(files.also.values()) {
            wanted.push(&source.from);
            wanted.extend(source.time.as_deref());
        }
        let options = TextOptions {
            delimiter: files.delimiter.map(|c| c as u8),
            decimal_comma: files.decimal.map(|c| c == ','),
        };
        read_log(path, options, Some(&wanted), max_numbers)
    }

    /// A channel in its column's unit, with times in its logger's clock less the delay of the
    /// channel, and remarks.
    fn series(
        &self,
        column: &str,
        source: &ChannelSource,
        logger: &str,
        log: &Log,
        file: &str,
    ) -> Result<(Recipe, Series, Vec<String>), Error> {
        let files = &self.mapping.logger[logger];
        let (mut time, remark) = times(log, source, logger, files, file)?;
        let delay = source.delay_s.unwrap_or(0.0);
        time.iter_mut().for_each(|t| *t -= delay);
        let channel = &log.channels[log.find(&source.from, file)?];
        let recipe = recipe(column, source, channel, file)?;
        let value = |x: &f64| recipe.factor * x + recipe.offset;
        let values: Vec<f64> = channel.values.iter().map(value).collect();
        let mut both = values.iter().zip(&channel.values);
        let beyond = |value: f64| !value.is_finite() || value.abs() > LARGEST_VALUE;
        if let Some(row) = both.position(|(value, x)| x.is_finite() && beyond(*value)) {
            let (found, line) = (channel.values[row], log.line(row));
            let found = format!("{found:e} {} in row {line}", recipe.unit);
            let expected = format!("at most {LARGEST_VALUE:e} {}", column_unit(column));
            return Err(Error::channel(file, &source.from, found, expected));
        }
        // A constant 0 is a sensor at rest, not saturation.
        let stop = Saturation::of(&channel.values).filter(|stop| stop.at != 0.0);
        let stop = stop.filter(|_| COLUMNS.contains(&column));
        let saturated = stop.map(|stop| {
            let (name, unit, at) = (&source.from, &recipe.unit, stop.at);
            let line = log.line(stop.begins);
            format!(
                "{file}: {name} stays at its extreme {at} {unit} for {} samples from row {line} on: saturated? if so, record it with a larger range, and leave the run out of fits",
                stop.longest
            )
        });
        let remarks = remark.into_iter().chain(saturated).collect();
        let series = Series {
            logger: logger.to_string(),
            column: column.to_string(),
            time,
            values,
        };
        Ok((recipe, series, remarks))
    }

    /// The uniform times of the run: the intersection of the time spans of all loggers.
    fn base(&self, planned: &PlannedRun, read: &[ImportedChannel]) -> Result<Base, Error> {
        let mut spans: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        let delay = |read: &ImportedChannel| read.source.delay_s.unwrap_or(0.0);
        for read in read {
            // The delay of a channel does not change the span of its logger.
            let delay = delay(read);
            let empty = [f64::INFINITY, f64::NEG_INFINITY];
            let span = spans.entry(&read.series.logger).or_insert(empty);
            for t in read.series.time.iter().filter(|t| t.is_finite()) {
                *span = [span[0].min(*t + delay), span[1].max(*t + delay)];
            }
        }
        let rate = self.mapping.rate_hz;
        // A channel slower than the run may end before its logger by less than one of its steps:
        // the run then ends with the channel, to avoid a gap at the end.
        for read in read {
            let times: Vec<f64> = read.series.samples().map(|t| t + delay(read)).collect();
            let (Some(first), Some(last)) = (times.first(), times.last()) else {
                continue;
            };
            let step = (last - first) / (times.len() - 1).max(1) as f64;
            let short = 0.0..step.min(MAX_CUT_S);
            let span = spans.get_mut(read.series.logger.as_str());
            if let Some([_, end]) = span.filter(|[_, end]| short.contains(&(end - last)))
                && step * rate > 1.5
            {
                *end = *last;
            }
        }
        let all = [f64::NEG_INFINITY, f64::INFINITY];
        let shared =
            |[start, end]: [f64; 2], span: &[f64; 2]| [start.max(span[0]), end.min(span[1])];
        let [start, end] = spans.values().fold(all, shared);
        // Rows coincide with samples of the lead, which avoids interpolation if its rate is a
        // multiple.
        let lead = spans.get(self.mapping.lead()).map_or(start, |span| span[0]);
        // Times since 1970 are rounded to 2.4e-7 s.
        let slack = 1e-6 + rate * f64::EPSILON * start.abs().max(end.abs());
        let start = lead + ((start - lead) * rate - slack).ceil() / rate;
        let rows = ((end - start) * rate + 2.0 * slack).floor() + 1.0;
        let most = MOST_NUMBERS / (read.len() as u64).max(1);
        if !(2.0..=most as f64).contains(&rows) {
            let part =
                |(name, [from, to]): (&&str, &[f64; 2])| format!("{name} {from:.3} to {to:.3} s");
            let parts: Vec<String> = spans.iter().map(part).collect();
            return Err(Error::Clock {
                run: planned.name.clone(),
                logger: self.mapping.lead().to_string(),
                reason: format!(
                    "found {}, expected a time of at least two rows and at most {most} that all share",
                    parts.join(", ")
                ),
            });
        }
        Ok(Base {
            start_s: start,
            rate_hz: rate,
            count: rows as usize,
        })
    }
}

/// A channel resampled to the run's base, with its note.
fn resampled(
    channel: ImportedChannel,
    base: &Base,
    file: &str,
) -> Result<(Vec<f64>, ChannelNote), Error> {
    let (series, source) = (channel.series, channel.source);
    let times = || series.time.iter().filter(|t| t.is_finite());
    let span = match (times().next(), times().next_back()) {
        (Some(first), Some(last)) => last - first,
        _ => 0.0,
    };
    let samples = series.samples().count();
    let found = resample(&series.time, &series.values, base);
    let few = "fewer than two samples".to_string();
    let found = found.ok_or_else(|| Error::channel(file, &source.from, few, "samples".into()))?;
    let seconds = |row: usize| (row as f64 / base.rate_hz * 1e9).round() / 1e9;
    let gaps = found.gaps.iter().take(MAX_LISTED_GAPS);
    let note = ChannelNote {
        logger: series.logger,
        from: source.from.clone(),
        recipe: channel.recipe,
        sign: source.sign.unwrap_or(1.0),
        delay_s: source.delay_s.unwrap_or(0.0),
        place_m: source.place_m,
        rate_hz: found.rate_hz,
        samples,
        expected_samples: ((span * found.rate_hz).round() as usize + 1).max(samples),
        jitter_steps: found.jitter,
        filter_hz: found.filter_hz,
        interpolated: found.interpolated,
        missing_rows: found.gaps.iter().map(|gap| gap.rows).sum(),
        gap_count: found.gaps.len(),
        gaps_s: gaps
            .map(|gap| [seconds(gap.row), seconds(gap.row + gap.rows - 1)])
            .collect(),
    };
    Ok((found.values, note))
}

/// Rotates the vectors of a sensor box into the sled's axes: `R_z(yaw) R_y(pitch) R_x(roll) v`.
///
/// # Errors
/// What was found and what was expected, if a vector does not have three axes at common times.
fn rotate(
    mut series: Vec<&mut Series>,
    [roll, pitch, yaw]: [f64; 3],
) -> Result<(), (String, String)> {
    let ((sr, cr), (sp, cp), (sy, cy)) = (roll.sin_cos(), pitch.sin_cos(), yaw.sin_cos());
    let rows = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ];
    let mut turned = 0;
    for axes in [Sensor::ACCELEROMETER, Sensor::GYROSCOPE] {
        let axes = axes.map(Sensor::name);
        let mut vector = Vec::new();
        for axis in axes {
            vector.extend(series.extract_if(.., |own| own.column == axis));
        }
        let count = vector.len();
        let expected = || format!("{} in this logger, at the same times", axes.join(", "));
        let [x, y, z] = &mut vector[..] else {
            if count == 0 {
                continue;
            }
            return Err((format!("{count} of 3 axes"), expected()));
        };
        let has_same_times = |a: &Series, b: &Series| {
            let mut pairs = a.time.iter().zip(&b.time);
            a.time.len() == b.time.len() && pairs.all(|(a, b)| a.total_cmp(b).is_eq())
        };
        if !(has_same_times(x, y) && has_same_times(x, z)) {
            return Err(("axes at different times".to_string(), expected()));
        }
        for i in 0..x.values.len() {
            let own = [x.values[i], y.values[i], z.values[i]];
            let [a, b, c] = rows.map(|row| row[0] * own[0] + row[1] * own[1] + row[2] * own[2]);
            (x.values[i], y.values[i], z.values[i]) = (a, b, c);
        }
        turned += 1;
    }
    if turned == 0 {
        let expected = "an accelerometer or a gyroscope in this logger";
        return Err(("no axes".to_string(), expected.to_string()));
    }
    Ok(())
}

/// Keeps one sample of each value that a logger repeats until a slower sensor sends the next value:
/// the repetitions would delay the channel by half of the sensor's step.
fn drop_repetitions(series: &mut Series) {
    let Series { time, values, .. } = series;
    let Some(rows) = rows_held(std::iter::once(values.as_slice())) else {
        return;
    };
    let mut begin = 0;
    while begin < values.len() {
        let value = values[begin];
        let length = values[begin..].iter().take_while(|x| **x == value).count();
        // A longer repetition is several equal samples of the sensor.
        let samples = (length as f64 / rows as f64).round().max(1.0) as usize;
        for i in (0..length).filter(|i| i % rows != 0 || i / rows >= samples) {
            (time[begin + i], values[begin + i]) = (f64::NAN, f64::NAN);
        }
        begin += length.max(1);
    }
}

/// Conversion of a channel into a column.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Recipe {
    /// The channel's unit.
    pub unit: String,
    /// Source of the unit: "mapping" or "file".
    pub unit_from: &'static str,
    /// `column = factor * value + offset`.
    pub factor: f64,
    /// See `factor`.
    pub offset: f64,
}

/// `sign * unit(scale * (value - zero))` as one factor and one offset.
///
/// # Errors
/// [`Error::Channel`] if neither mapping nor file state a unit that converts.
pub(crate) fn recipe(
    column: &str,
    source: &ChannelSource,
    channel: &Channel,
    file: &str,
) -> Result<Recipe, Error> {
    let target = column_unit(column);
    let (unit, unit_from) = match (&source.unit, &channel.unit) {
        (Some(unit), _) => (unit.clone(), "mapping"),
        (None, Some(unit)) => (unit.clone(), "file"),
        // A pure number needs no unit.
        (None, None) if target == "1" => (String::new(), "mapping"),
        (None, None) => {
            let expected =
                format!("channels.{column}.unit in the mapping, a unit that converts to {target}");
            return Err(Error::channel(
                file,
                &source.from,
                "no unit".into(),
                expected,
            ));
        }
    };
    let unit_of = conversion(&unit, target).map_err(|reason| {
        let expected = format!("a unit that converts to {target} ({reason}); channels.{column}.unit in the mapping takes precedence");
        Error::channel(file, &source.from, format!("unit {unit:?}"), expected)
    })?;
    let sign = source.sign.unwrap_or(1.0);
    let scale = source.scale.unwrap_or(1.0);
    let zero = source.zero.unwrap_or(0.0);
    let factor = sign * unit_of.factor * scale;
    Ok(Recipe {
        unit,
        unit_from,
        factor,
        // Adding 0 avoids an offset of -0.
        offset: 0.0 + sign * unit_of.offset - factor * zero,
    })
}

/// Largest fraction of samples that may repeat the previous time: some loggers write a row twice
/// now and then, but a larger fraction means a coarse clock.
const MAX_REPEATED: f64 = 0.1;

/// Times of a channel's samples [s], NaN for unusable samples, and a remark.
///
/// The source is, in this order, the channel's time channel, that of the logger, the clock that the
/// file states, or the stated rate. Of several samples at one time the first is used.
///
/// # Errors
/// [`Error::NoChannel`]; [`Error::File`] if there is no time; [`Error::Channel`] if its unit is
/// unknown, it runs backwards or is too coarse.
pub(crate) fn times(
    log: &Log,
    source: &ChannelSource,
    logger: &str,
    files: &LoggerFiles,
    file: &str,
) -> Result<(Vec<f64>, Option<String>), Error> {
    let channel = &log.channels[log.find(&source.from, file)?];
    let wrong = |name: &str, found, expected| Error::channel(file, name, found, expected);
    let stated = source.time.as_ref().or(files.time.as_ref());
    let name = stated.unwrap_or(&channel.name);
    let mut time: Vec<f64> = match (stated, channel.clock, files.rate_hz) {
        (Some(name), _, _) => {
            let time = &log.channels[log.find(name, file)?];
            let unit = files.time_unit.as_ref().or(time.unit.as_ref());
            let unit = unit.map_or("s", String::as_str);
            let second = conversion(unit, "s").map_err(|reason| {
                let expected =
                    format!("a unit of time ({reason}); logger.{logger}.time_unit states it");
                wrong(name, format!("unit {unit:?}"), expected)
            })?;
            time.values.iter().map(|t| second.factor * t).collect()
        }
        (None, Some(clock), _) => log.clocks[clock].clone(),
        (None, None, Some(rate)) => {
            let rows = 0..channel.values.len();
            rows.map(|i| i as f64 / rate).collect()
        }
        (None, None, None) => {
            let reason = format!(
                "no channel is its time: expected logger.{logger}.time, or logger.{logger}.rate_hz, in the mapping"
            );
            return Err(Error::file(file, reason));
        }
    };
    if time.len() != channel.values.len() {
        let found = format!("{} values", channel.values.len());
        let expected = format!("{}, one for each of {name}", time.len());
        return Err(wrong(&channel.name, found, expected));
    }
    continue_days(&mut time, true);
    let mut last = f64::NEG_INFINITY;
    let mut repeated = 0;
    for (row, t) in time.iter_mut().enumerate() {
        if *t < last {
            let line = log.line(row);
            let found = format!("{t} s after {last} s in row {line}");
            let expected = "times that do not run backwards".to_string();
            return Err(wrong(name, found, expected));
        }
        if *t == last {
            repeated += 1;
            *t = f64::NAN;
        } else if t.is_finite() {
            last = *t;
        }
    }
    if repeated as f64 > MAX_REPEATED * time.len() as f64 {
        let count = time.len();
        let found = format!("{repeated} of {count} samples at the time of the one before");
        let expected = format!("a time that distinguishes samples, or logger.{logger}.rate_hz");
        return Err(wrong(name, found, expected));
    }
    let remark = (repeated > 0).then(|| {
        format!("{file}: {repeated} samples repeat the time before them and take no part")
    });
    Ok((time, remark))
}

/// Largest number of gaps of a channel that a note lists; further gaps are only counted.
pub(crate) const MAX_LISTED_GAPS: usize = 200;

/// The note of a run's import.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Note {
    /// Name of the run.
    pub run: String,
    /// The mapping's file.
    pub mapping: String,
    /// SHA-256 of the mapping.
    pub mapping_sha256: String,
    /// Version of kufe that imported it.
    pub version: &'static str,
    /// Rate of the run [Hz].
    pub rate_hz: f64,
    /// Number of rows.
    pub rows: usize,
    /// Time of the runs' clock at `t_s` = 0 [s].
    pub start_s: f64,
    /// The logger whose clock is that of the runs.
    pub clock: String,
    /// The recordings.
    pub loggers: BTreeMap<String, LoggerNote>,
    /// The columns.
    pub channels: BTreeMap<String, ChannelNote>,
    /// Mass of the sled with its crew [kg], if it is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mass_kg: Option<f64>,
    /// Anomalies of the recordings.
    pub remarks: Vec<String>,
}

/// File, clock and rotation of a logger.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct LoggerNote {
    /// The file.
    pub file: String,
    /// SHA-256 of the file.
    pub sha256: String,
    /// Clock of the logger.
    #[serde(flatten)]
    pub clock: LoggerClock,
    /// Roll, pitch and yaw of the sensor box by which its axes were rotated [rad].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rotation: Option<[f64; 3]>,
}

/// Conversion and resampling of a channel.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ChannelNote {
    /// The logger.
    pub logger: String,
    /// The channel's name in the file.
    pub from: String,
    /// Conversion of the channel into a column.
    #[serde(flatten)]
    pub recipe: Recipe,
    /// Stated sign, 1 or -1, which `factor` includes.
    pub sign: f64,
    /// Stated delay of the channel relative to its logger's clock [s].
    pub delay_s: f64,
    /// Position of the sensor from the centre of gravity [m], if it is stated.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub place_m: Option<[f64; 3]>,
    /// Sample rate of the channel [Hz].
    pub rate_hz: f64,
    /// Number of samples with a value.
    pub samples: usize,
    /// Number of samples that follows from the rate and the time span of the channel.
    pub expected_samples: usize,
    /// Largest deviation of the sample times from uniform times [steps].
    pub jitter_steps: f64,
    /// Cutoff frequency of the anti-aliasing filter [Hz]; `None` if the channel is not faster than
    /// the run.
    pub filter_hz: Option<f64>,
    /// Whether values are interpolated between samples.
    pub interpolated: bool,
    /// Number of rows without a value.
    pub missing_rows: usize,
    /// Number of gaps.
    pub gap_count: usize,
    /// Start and end of the first gaps [s].
    pub gaps_s: Vec<[f64; 2]>,
}

/// The lines of `[sled]` in `model.toml` with the positions of a mapping's sensors; `None` if it
/// states no positions.
///
/// The three axes of the accelerometer are one sensor. Of the slip sensor the model has only the
/// position along the sled.
///
/// # Errors
/// [`Error::Key`] if the axes of the accelerometer have different positions.
pub fn model_fragment(mapping: &Mapping, file: &str) -> Result<Option<String>, Error> {
    let place = |column: &str| mapping.channels.get(column)?.place_m;
    let axes = Sensor::ACCELEROMETER.map(Sensor::name);
    let mut places = axes.iter().filter_map(|axis| Some((axis, place(axis)?)));
    let accelerometer = places.next();
    let differs = |(_, own): &(_, _)| accelerometer.is_some_and(|(_, first)| first != *own);
    if let (Some((first, place)), Some((column, own))) = (accelerometer, places.find(differs)) {
        return Err(Error::Key {
            file: file.to_string(),
            key: format!("channels.{column}.place_m"),
            found: format!("{own:?}"),
            expected: format!("{place:?}, as for {first}: the model has one accelerometer"),
        });
    }
    let slip = place("alpha_rad");
    if accelerometer.is_none() && slip.is_none() {
        return Ok(None);
    }
    let mut text = "# Positions of the sensors in the mapping, from the centre of gravity [m]; lines of model.toml.\n[sled]\n".to_string();
    if let Some((_, [x, y, z])) = accelerometer {
        text += &format!("accel_x_m = {x:?}\naccel_y_m = {y:?}\naccel_z_m = {z:?}\n");
    }
    if let Some([x, ..]) = slip {
        text += &format!("slip_x_m = {x:?}\n");
    }
    Ok(Some(text))
}
