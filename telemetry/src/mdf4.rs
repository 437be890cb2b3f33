//! Numeric channels of MDF 4 logs, decoded block by block.

use std::collections::BTreeMap;
use std::io::{Read, Seek};
use std::sync::Arc;

use falcon_mdf::io::range::read_seek_source;
use falcon_mdf::{Channel as MdfChannel, Mf4Error, Mf4File, OpenOptions};
use kufe_files::shown_name;
use kufe_sled::MOST_NUMBERS;

use crate::error::Error;
use crate::log::{Channel, Log};

/// Largest size of an unpacked block [bytes]: writers make blocks of 4 MB.
const MAX_BLOCK_BYTES: u64 = 1 << 27;

/// Number of samples of a group that are decoded at a time.
const WINDOW: usize = 1 << 16;

/// Reads the channels of an MDF 4 log with the names `wanted`, or all numeric channels.
///
/// Values are physical: the conversion that the file states is applied. Samples that the file marks
/// as invalid are NaN.
///
/// # Errors
/// [`Error::File`] if the file is not MDF 4, a wanted channel cannot be decoded, or the channels
/// have more than [`MOST_NUMBERS`] values.
pub fn read_mdf4(
    reader: impl Read + Seek + Send + 'static,
    wanted: Option<&[&str]>,
    file: &str,
) -> Result<Log, Error> {
    let failure = |error: Mf4Error| Error::file(file, error);
    let options = OpenOptions {
        max_decompressed: MAX_BLOCK_BYTES,
        ..OpenOptions::default()
    };
    let source = Arc::new(read_seek_source(reader).map_err(failure)?);
    let mdf = Mf4File::from_source_with_options(source, options).map_err(failure)?;
    let of: Vec<&MdfChannel> = mdf.channels().collect();
    let channels = of.iter().map(|channel| Channel {
        name: shown_name(&channel.name),
        unit: Some(channel.unit.clone()).filter(|unit| !unit.trim().is_empty()),
        ..Channel::default()
    });
    let mut log = Log {
        channels: channels.collect(),
        ..Log::default()
    };
    let group = |place: usize| (of[place].data_group_index, of[place].channel_group_index);
    log.distinguish(|place| {
        let (data, channels) = group(place);
        match channels {
            0 => format!("group {data}"),
            _ => format!("group {data}.{channels}"),
        }
    });
    log.remarks.clear();
    let mut groups: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
    for place in log.places(wanted, file)? {
        groups.entry(group(place)).or_default().push(place);
    }
    let mut read = vec![false; of.len()];
    for ((data, channels), places) in groups {
        let clock = mdf.master_channel(data, channels);
        let clock = clock.filter(|master| master.is_time_channel());
        let of_group = places.iter().map(|place| of[*place]).chain(clock);
        let mut values = match values(&mdf, &of_group.collect::<Vec<_>>(), file) {
            Ok(values) => values,
            Err(error) if wanted.is_some() => return Err(error),
            // Groups without numbers are skipped.
            Err(_) => continue,
        };
        let times = clock.and_then(|_| values.pop().flatten());
        let clock = times.is_some().then_some(log.clocks.len());
        log.clocks.extend(times);
        for (place, values) in places.into_iter().zip(values) {
            let channel = &mut log.channels[place];
            if let Some(values) = values {
                (channel.values, channel.clock) = (values, clock);
                read[place] = true;
            } else if wanted.is_some() {
                let reason = format!("channel {}: it holds no numbers", channel.name);
                return Err(Error::file(file, reason));
            }
        }
        if log.numbers() > MOST_NUMBERS {
            return Err(Error::too_many(file));
        }
    }
    if wanted.is_none() {
        let mut read = read.into_iter();
        log.channels.retain(|_| read.next().unwrap_or(false));
    }
    log.with_channels(file, "no group has one")
}

/// Values of channels of one group; `None` for a channel that is not numeric.
///
/// # Errors
/// [`Error::File`] if the group cannot be decoded, or has more than [`MOST_NUMBERS`] values.
fn values(
    mdf: &Mf4File,
    channels: &[&MdfChannel],
    file: &str,
) -> Result<Vec<Option<Vec<f64>>>, Error> {
    let failure = |error: Mf4Error| Error::file(file, error);
    let numeric = |channel: &MdfChannel| channel.is_numeric() && channel.unreadable().is_none();
    let read = channels.iter().copied();
    let read: Vec<&MdfChannel> = read.filter(|channel| numeric(channel)).collect();
    let mut count = 0_u64;
    for channel in &read {
        let shape = channel.array_shape().unwrap_or_default().iter();
        count = count.saturating_add(shape.fold(channel.sample_count, |n, k| n.saturating_mul(*k)));
    }
    if count > MOST_NUMBERS {
        return Err(Error::too_many(file));
    }
    let start = |channel: &&MdfChannel| numeric(channel).then(Vec::new);
    let mut columns: Vec<Option<Vec<f64>>> = channels.iter().map(start).collect();
    for window in mdf.signals_chunks(&read, WINDOW).map_err(failure)? {
        let mut signals = window.map_err(failure)?.into_iter();
        for (column, _) in columns.iter_mut().zip(channels).filter(|(_, c)| numeric(c)) {
            let Some(signal) = signals.next() else { break };
            match (column.as_mut(), signal.values_f64()) {
                (Some(values), Ok(more)) => {
                    let valid = signal.validity();
                    let valid = |i: usize| valid.as_ref().is_none_or(|valid| valid[i]);
                    let more = more.into_iter().enumerate();
                    values.extend(more.map(|(i, x)| if valid(i) { x } else { f64::NAN }));
                }
                _ => *column = None,
            }
        }
    }
    Ok(columns)
}
