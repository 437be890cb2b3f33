//! Channels of numbers in MDF 4 logs, decoded a block at a time.

use std::io::{Read, Seek};
use std::sync::Arc;

use falcon_mdf::io::range::read_seek_source;
use falcon_mdf::{Channel, Mf4Error, Mf4File, OpenOptions};

use crate::columns::{Columns, MOST_NUMBERS, collect, too_many};
use crate::error::Error;

/// Longest block that is unpacked [bytes]: writers make blocks of 4 MB.
const LONGEST_BLOCK: u64 = 1 << 27;

/// Samples of a group that are decoded at a time.
const WINDOW: usize = 1 << 16;

/// An MDF 4 log.
pub struct Mdf4 {
    log: Mf4File,
    file: String,
}

impl Mdf4 {
    /// Reads what the log holds, without its samples.
    ///
    /// # Errors
    /// [`Error::File`] where it is no MDF 4.
    pub fn open(reader: impl Read + Seek + Send + 'static, file: &str) -> Result<Mdf4, Error> {
        let failure = |error: Mf4Error| Error::file(file, error);
        let options = OpenOptions {
            max_decompressed: LONGEST_BLOCK,
            ..OpenOptions::default()
        };
        let source = Arc::new(read_seek_source(reader).map_err(failure)?);
        Ok(Mdf4 {
            log: Mf4File::from_source_with_options(source, options).map_err(failure)?,
            file: file.to_string(),
        })
    }

    /// Every channel in the file's order.
    pub fn channels(&self) -> Vec<&Channel> {
        self.log.channels().collect()
    }

    /// The channel of times [s] of another channel's group.
    pub fn clock_of(&self, channel: &Channel) -> Option<&Channel> {
        self.log
            .master_channel(channel.data_group_index, channel.channel_group_index)
            .filter(|master| master.is_time_channel())
    }

    /// Physical values of channels of one group, NaN where the file marks them invalid; nothing for
    /// a channel that holds no numbers.
    ///
    /// # Errors
    /// [`Error::File`] where the group cannot be decoded, or they are more than [`MOST_NUMBERS`].
    pub fn values(&self, channels: &[&Channel]) -> Result<Vec<Option<Vec<f64>>>, Error> {
        let failure = |error: Mf4Error| Error::file(&self.file, error);
        let numeric = |channel: &Channel| channel.is_numeric() && channel.unreadable().is_none();
        let read = channels.iter().copied();
        let read: Vec<&Channel> = read.filter(|channel| numeric(channel)).collect();
        let mut count = 0_u64;
        for channel in &read {
            let shape = channel.array_shape().unwrap_or_default().iter();
            count =
                count.saturating_add(shape.fold(channel.sample_count, |n, k| n.saturating_mul(*k)));
        }
        if count > MOST_NUMBERS {
            return Err(too_many(&self.file));
        }
        let start = |channel: &&Channel| numeric(channel).then(Vec::new);
        let mut columns: Vec<Option<Vec<f64>>> = channels.iter().map(start).collect();
        for window in self.log.signals_chunks(&read, WINDOW).map_err(failure)? {
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
}

/// Reads every channel of numbers at the rate of `v_mps`; `t_s` is the time of its group where no
/// channel has that name.
///
/// Channels recorded at another rate are excluded: bring them to one rate before.
///
/// # Errors
/// [`Error::File`] where the file is no MDF 4 or a channel cannot be decoded.
pub(crate) fn read_mdf4(
    reader: impl Read + Seek + Send + 'static,
    file: &str,
) -> Result<Columns, Error> {
    let log = Mdf4::open(reader, file)?;
    let channels = log.channels();
    let lead = channels.iter().find(|channel| channel.name == "v_mps");
    let names = channels.iter().map(|channel| &channel.name);
    let lead = lead.ok_or_else(|| Error::missing_column(file, "v_mps", names))?;
    let group = |channel: &Channel| (channel.data_group_index, channel.channel_group_index);
    let mut groups: Vec<Vec<&Channel>> = Vec::new();
    for channel in &channels {
        match groups
            .iter_mut()
            .find(|known| group(known[0]) == group(channel))
        {
            Some(known) => known.push(channel),
            None => groups.push(vec![channel]),
        }
    }
    // The times of the group of `v_mps` are those of every column.
    let times_of = |channel: &Channel| -> Result<Option<Vec<f64>>, Error> {
        match log.clock_of(channel) {
            Some(clock) => Ok(log.values(&[clock])?.remove(0)),
            None => Ok(None),
        }
    };
    let time = times_of(lead)?;
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for group in groups {
        if times_of(group[0])? != time {
            continue;
        }
        for (channel, values) in group.iter().zip(log.values(&group)?) {
            // Every group may have its clock, called alike.
            let clock = log.clock_of(channel);
            let clock = clock.is_some_and(|clock| clock.name == channel.name);
            let known = columns.iter().any(|(name, _)| *name == channel.name);
            if let Some(values) = values.filter(|_| !(clock && known)) {
                columns.push((channel.name.clone(), values));
            }
        }
    }
    if !columns.iter().any(|(name, _)| name == "t_s")
        && let Some(time) = time
    {
        columns.push(("t_s".to_string(), time));
    }
    collect(columns.into_iter(), file)
}
