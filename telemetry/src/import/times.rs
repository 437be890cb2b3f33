//! When the samples of a recording were taken, by its own clock.

use crate::error::Error;
use crate::import::convert::Conversions;
use crate::mapping::{ChannelSource, LoggerFiles};
use crate::source::Log;

/// Largest share of samples that may repeat the time before them: a row written twice now and then, not a clock too coarse.
const REPEATED: f64 = 0.1;

/// Times of a channel's samples [s], NaN where a sample cannot be placed, and what is odd about them.
///
/// The channel's own time channel, or the logger's, or the clock that the file has for it, or the stated rate. Of samples at
/// one time the first counts: some loggers write a row twice.
///
/// # Errors
/// [`Error::NoChannel`]; [`Error::Channel`] where there is no time, its unit is unknown, it runs backwards or is too coarse.
pub(crate) fn times(
    log: &Log,
    source: &ChannelSource,
    logger: &str,
    files: &LoggerFiles,
    units: &Conversions,
    file: &str,
) -> Result<(Vec<f64>, Option<String>), Error> {
    let channel = &log.channels[log.find(&source.from, file)?];
    let wrong = |name: &str, found: String, expected: String| Error::Channel {
        file: file.to_string(),
        channel: name.to_string(),
        found,
        expected,
    };
    let stated = source.time.as_ref().or(files.time.as_ref());
    let (name, mut time) = match (stated, channel.clock, files.rate_hz) {
        (Some(name), _, _) => {
            let time = &log.channels[log.find(name, file)?];
            let unit = files
                .time_unit
                .as_deref()
                .or(time.unit.as_deref())
                .unwrap_or("s");
            let second = units.of(unit, "s").map_err(|reason| {
                let expected =
                    format!("a unit of time ({reason}); logger.{logger}.time_unit states it");
                wrong(name, format!("unit {unit:?}"), expected)
            })?;
            (
                name.as_str(),
                time.values
                    .iter()
                    .map(|t| second.factor * t)
                    .collect::<Vec<f64>>(),
            )
        }
        (None, Some(clock), _) => (channel.name.as_str(), log.clocks[clock].clone()),
        (None, None, Some(rate)) => {
            let count = channel.values.len();
            (
                channel.name.as_str(),
                (0..count).map(|i| i as f64 / rate).collect(),
            )
        }
        (None, None, None) => {
            let expected = format!(
                "logger.{logger}.time, the channel that holds it, or logger.{logger}.rate_hz"
            );
            return Err(wrong(&source.from, "no time".to_string(), expected));
        }
    };
    if time.len() != channel.values.len() {
        let found = format!("{} values", channel.values.len());
        return Err(wrong(
            &channel.name,
            found,
            format!("{}, one for each of {name}", time.len()),
        ));
    }
    let mut last = f64::NEG_INFINITY;
    let mut repeated = 0;
    for (row, t) in time.iter_mut().enumerate() {
        if *t < last {
            let line = row as u64 + log.first_row.max(1);
            return Err(wrong(
                name,
                format!("{t} s after {last} s in row {line}"),
                "times that do not run backwards".to_string(),
            ));
        }
        if *t == last {
            repeated += 1;
            *t = f64::NAN;
        } else if t.is_finite() {
            last = *t;
        }
    }
    if repeated as f64 > REPEATED * time.len() as f64 {
        let found = format!(
            "{repeated} of {} samples at the time of the one before",
            time.len()
        );
        let expected = format!("a time that tells samples apart, or logger.{logger}.rate_hz");
        return Err(wrong(name, found, expected));
    }
    let remark = (repeated > 0).then(|| {
        format!("{file}: {repeated} samples repeat the time before them and are left out")
    });
    Ok((time, remark))
}
