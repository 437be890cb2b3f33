//! Channels of numbers in MDF 4 logs, decoded a block at a time.

use std::io::{Read, Seek};
use std::sync::Arc;

use falcon_mdf::io::range::read_seek_source;
use falcon_mdf::{Channel, Mf4Error, Mf4File, OpenOptions};

use crate::columns::{MOST_NUMBERS, too_many};
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
