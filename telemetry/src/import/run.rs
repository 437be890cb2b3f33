//! A run from its recordings.

use std::collections::BTreeMap;

use kufe_sled::{Columns, Conditions, Entry, Gaps, Run};
use sha2::{Digest, Sha256};

use crate::clock::{Aligned, LoggerSeries, Series, align};
use crate::error::Error;
use crate::import::convert::{Conversions, Recipe, recipe};
use crate::import::note::{ChannelNote, LISTED_GAPS, LoggerNote, Note};
use crate::import::times::times;
use crate::mapping::{ChannelSource, Mapping, PlannedRun};
use crate::resample::{Base, resample};
use crate::source::{Log, TextOptions, bytes_of, read_log};

/// Most rows of a run: a day at 100 Hz and more.
const MOST_ROWS: f64 = 1e7;

/// Imports the runs of one mapping.
#[derive(Debug)]
pub struct Importer {
    mapping: Mapping,
    file: String,
    sha256: String,
    units: Conversions,
}

/// A run, and how it was made.
#[derive(Clone, Debug, PartialEq)]
pub struct Imported {
    /// The run; its entry has the conditions as far as the mapping states them.
    pub run: Run,
    /// What was done.
    pub note: Note,
}

/// A channel of a run before it is resampled.
struct Read {
    logger: String,
    recipe: Recipe,
    series: Series,
}

impl Importer {
    /// For a mapping with its text and the name of its file.
    ///
    /// # Errors
    /// Those of [`Mapping::parse`].
    pub fn new(text: &str, file: &str) -> Result<Importer, Error> {
        Ok(Importer {
            mapping: Mapping::parse(text, file)?,
            file: file.to_string(),
            sha256: hexadecimal(text.as_bytes()),
            units: Conversions::default(),
        })
    }

    /// The mapping.
    pub fn mapping(&self) -> &Mapping {
        &self.mapping
    }

    /// Imports one run: reads its recordings, converts, brings them to the clock of the mapping's lead and to its rate.
    ///
    /// The run spans the time that every logger recorded.
    ///
    /// # Errors
    /// Those of the readers; [`Error::Channel`], [`Error::Clock`] where clocks cannot be brought together or the loggers
    /// share no time.
    pub fn run(&self, planned: &PlannedRun) -> Result<Imported, Error> {
        let mut remarks = Vec::new();
        let mut loggers: BTreeMap<String, LoggerNote> = BTreeMap::new();
        let mut read: BTreeMap<String, Read> = BTreeMap::new();
        let mut also: Vec<LoggerSeries> = Vec::new();
        for (name, path) in &planned.files {
            let bytes = bytes_of(path)?;
            let file = path.display().to_string();
            let sha256 = hexadecimal(&bytes);
            let log = self.log(name, path, bytes)?;
            remarks.extend(log.remarks.iter().cloned());
            loggers.insert(
                name.clone(),
                LoggerNote {
                    sha256,
                    clock: "the runs'",
                    delay_s: 0.0,
                    delay_sd_s: None,
                    delay_includes: None,
                    relations: Vec::new(),
                    file: file.clone(),
                },
            );
            for (column, source) in self.channels_of(name) {
                let (recipe, series, remark) = self.series(column, source, name, &log, &file)?;
                remarks.extend(remark.filter(|text| !remarks.contains(text)));
                read.insert(
                    column.clone(),
                    Read {
                        logger: name.clone(),
                        recipe,
                        series,
                    },
                );
            }
            for (column, source) in &self.mapping.logger[name].also {
                let (_, series, _) = self.series(column, source, name, &log, &file)?;
                also.push(LoggerSeries {
                    logger: name.clone(),
                    column: column.clone(),
                    series,
                });
            }
        }
        let delays = self.delays(planned, &read, also)?;
        for (name, aligned) in delays {
            if let Some(note) = loggers.get_mut(&name) {
                note.clock = aligned.clock;
                note.delay_s = aligned.delay_s;
                note.delay_sd_s = aligned.delay_sd_s;
                note.delay_includes = aligned
                    .delay_sd_s
                    .map(|_| "the lag of the sensors that it was found from");
                note.relations = aligned.relations;
            }
            remarks.extend(aligned.remark);
        }
        for channel in read.values_mut() {
            let delay = loggers[&channel.logger].delay_s;
            channel.series.time.iter_mut().for_each(|t| *t -= delay);
        }
        let base = self.base(planned, &read)?;
        let mut columns = Columns::new();
        let mut channels = BTreeMap::new();
        for (column, channel) in read {
            let file = &loggers[&channel.logger].file;
            let source = &self.mapping.channels[&column];
            let note = self.resampled(&column, source, channel, &base, &mut columns, file)?;
            channels.insert(column, note);
        }
        let note = Note {
            run: planned.name.clone(),
            mapping: self.file.clone(),
            mapping_sha256: self.sha256.clone(),
            version: env!("CARGO_PKG_VERSION"),
            rate_hz: base.rate_hz,
            rows: base.count,
            start_s: base.start_s,
            clock: self.mapping.lead().to_string(),
            loggers,
            channels,
            mass_kg: planned.index.mass_kg,
            remarks,
        };
        let run = Run {
            entry: entry(planned),
            t0_s: 0.0,
            dt_s: 1.0 / base.rate_hz,
            columns,
            // Told when it is read.
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
        self.mapping
            .channels
            .iter()
            .filter(move |(_, source)| self.mapping.logger_of(source) == logger)
    }

    /// A logger's recording, with the channels that the mapping names.
    fn log(&self, logger: &str, path: &std::path::Path, bytes: Vec<u8>) -> Result<Log, Error> {
        let files = &self.mapping.logger[logger];
        let sources = || {
            self.channels_of(logger)
                .map(|(_, s)| s)
                .chain(files.also.values())
        };
        let mut wanted: Vec<&str> = sources().map(|source| source.from.as_str()).collect();
        wanted.extend(files.time.as_deref());
        wanted.extend(sources().filter_map(|source| source.time.as_deref()));
        let options = TextOptions {
            delimiter: files.delimiter.map(|c| c as u8),
            decimal_comma: files.decimal.map(|c| c == ','),
        };
        read_log(path, bytes, options, Some(&wanted))
    }

    /// A channel in its column's unit, by its logger's clock less its own delay.
    fn series(
        &self,
        column: &str,
        source: &ChannelSource,
        logger: &str,
        log: &Log,
        file: &str,
    ) -> Result<(Recipe, Series, Option<String>), Error> {
        let files = &self.mapping.logger[logger];
        let (mut time, remark) = times(log, source, logger, files, &self.units, file)?;
        let delay = source.delay_s.unwrap_or(0.0);
        time.iter_mut().for_each(|t| *t -= delay);
        let channel = &log.channels[log.find(&source.from, file)?];
        let recipe = recipe(column, source, channel, &self.units, file)?;
        let values = channel
            .values
            .iter()
            .map(|x| recipe.factor * x + recipe.offset)
            .collect();
        Ok((recipe, Series { time, values }, remark))
    }

    fn delays(
        &self,
        planned: &PlannedRun,
        read: &BTreeMap<String, Read>,
        also: Vec<LoggerSeries>,
    ) -> Result<BTreeMap<String, Aligned>, Error> {
        let several = self.mapping.logger.len() > 1;
        let mut series: Vec<LoggerSeries> = Vec::new();
        // What is recorded once needs no copy where there is one clock only.
        for (column, channel) in read.iter().filter(|_| several) {
            series.push(LoggerSeries {
                logger: channel.logger.clone(),
                column: column.clone(),
                series: channel.series.clone(),
            });
        }
        series.extend(also);
        align(&self.mapping, planned, &series)
    }

    /// The rows of the run: from the last logger's first sample to the first logger's last one.
    fn base(&self, planned: &PlannedRun, read: &BTreeMap<String, Read>) -> Result<Base, Error> {
        let mut spans: BTreeMap<&str, [f64; 2]> = BTreeMap::new();
        for (column, channel) in read {
            // A channel that is late does not move the logger's first sample.
            let late = self.mapping.channels[column].delay_s.unwrap_or(0.0);
            let span = spans
                .entry(&channel.logger)
                .or_insert([f64::INFINITY, f64::NEG_INFINITY]);
            for t in channel.series.time.iter().filter(|t| t.is_finite()) {
                *span = [span[0].min(*t + late), span[1].max(*t + late)];
            }
        }
        let start = spans
            .values()
            .map(|span| span[0])
            .fold(f64::NEG_INFINITY, f64::max);
        let end = spans
            .values()
            .map(|span| span[1])
            .fold(f64::INFINITY, f64::min);
        let rate = self.mapping.rate_hz;
        // Rows stand at samples of the lead, so that they need no interpolation where rates are multiples.
        let lead = spans.get(self.mapping.lead()).map_or(start, |span| span[0]);
        let start = lead + ((start - lead) * rate - 1e-6).ceil() / rate;
        let rows = ((end - start) * rate + 1e-6).floor() + 1.0;
        if !(2.0..=MOST_ROWS).contains(&rows) {
            let told: Vec<String> = spans
                .iter()
                .map(|(name, span)| format!("{name} {:.3} to {:.3} s", span[0], span[1]))
                .collect();
            return Err(Error::Clock {
                run: planned.name.clone(),
                logger: self.mapping.lead().to_string(),
                reason: format!(
                    "found {}, expected a time of at least two rows and at most {MOST_ROWS:e} that all share",
                    told.join(", ")
                ),
            });
        }
        Ok(Base {
            start_s: start,
            rate_hz: rate,
            count: rows as usize,
        })
    }

    fn resampled(
        &self,
        column: &str,
        source: &ChannelSource,
        channel: Read,
        base: &Base,
        columns: &mut Columns,
        file: &str,
    ) -> Result<ChannelNote, Error> {
        let found =
            resample(&channel.series.time, &channel.series.values, base).ok_or_else(|| {
                Error::Channel {
                    file: file.to_string(),
                    channel: source.from.clone(),
                    found: "fewer than two samples".to_string(),
                    expected: "samples".to_string(),
                }
            })?;
        let seconds = |row: usize| (row as f64 / base.rate_hz * 1e9).round() / 1e9;
        let gaps = found.gaps.iter().take(LISTED_GAPS);
        let note = ChannelNote {
            logger: channel.logger,
            from: source.from.clone(),
            unit: channel.recipe.unit,
            unit_from: channel.recipe.unit_from,
            factor: channel.recipe.factor,
            offset: channel.recipe.offset,
            sign: source.sign.unwrap_or(1.0),
            delay_s: source.delay_s.unwrap_or(0.0),
            place_m: source.place_m,
            rate_hz: found.rate_hz,
            jitter_steps: found.jitter,
            filter_hz: found.filter_hz,
            interpolated: found.interpolated,
            missing_rows: found.gaps.iter().map(|gap| gap.rows).sum(),
            gap_count: found.gaps.len(),
            gaps_s: gaps
                .map(|gap| [seconds(gap.row), seconds(gap.row + gap.rows - 1)])
                .collect(),
        };
        columns.insert(column.to_string(), found.values);
        Ok(note)
    }
}

fn entry(planned: &PlannedRun) -> Entry {
    let text = |name: &str| planned.index.cell(name).unwrap_or_default();
    let number = |name: &str| planned.index.number(name).unwrap_or(f64::NAN);
    Entry {
        ice_along: kufe_sled::IceAlong::default(),
        ice_of_track: kufe_sled::IceAlong::default(),
        run: planned.name.clone(),
        file: planned.name.clone().into(),
        track: text("track"),
        driver: text("driver"),
        driver_class: text("driver_class"),
        session: text("session"),
        conditions: Conditions {
            ice_c: number("ice_c"),
            air_c: number("air_c"),
            air_pa: number("air_pa"),
            humidity_pct: planned.index.humidity_pct,
            distance_m: planned.index.distance_m,
            mass_kg: planned.index.mass_kg,
        },
    }
}

fn hexadecimal(bytes: &[u8]) -> String {
    Sha256::digest(bytes)
        .iter()
        .map(|byte| format!("{byte:02x}"))
        .collect()
}
