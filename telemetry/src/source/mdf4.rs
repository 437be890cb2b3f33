//! MDF 4 logs: groups of channels, each with its own clock and rate.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;

use falcon_mdf::Mf4File;

use crate::error::Error;
use crate::source::log::{Channel, Log};
use crate::source::unpacked::{most_unpacked, numbers_of};

/// Reads a log; of the channels only those `wanted` by name, or all that hold numbers.
///
/// Values are physical: the file's own conversion is done. Samples that the file marks invalid are NaN.
///
/// # Errors
/// [`Error::File`] where it is no MDF 4, or a channel that is wanted cannot be decoded.
pub fn read_mdf4(bytes: Vec<u8>, wanted: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    let told = |error: falcon_mdf::Mf4Error| Error::file(file, error);
    let most = most_unpacked(bytes.len());
    let mdf = Mf4File::from_bytes(bytes).map_err(told)?;
    let mut log = Log::default();
    let mut clocks: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut of: Vec<&falcon_mdf::Channel> = Vec::new();
    for channel in mdf.channels() {
        of.push(channel);
        log.channels.push(Channel {
            name: channel.name.clone(),
            unit: Some(channel.unit.clone()).filter(|unit| !unit.trim().is_empty()),
            clock: None,
            values: Vec::new(),
        });
    }
    let mut places: Vec<usize> = (0..of.len()).collect();
    if let Some(names) = wanted {
        places = names
            .iter()
            .map(|name| log.find(name, file))
            .collect::<Result<_, _>>()?;
    }
    let mut kept = vec![false; of.len()];
    for place in places {
        let shape = of[place].array_shape().unwrap_or_default();
        if of[place].sample_count.saturating_mul(numbers_of(shape)) > most {
            let name = &log.channels[place].name;
            let reason = format!("channel {name}: more samples than a file of this size can hold");
            match wanted {
                Some(_) => return Err(Error::file(file, reason)),
                None => continue,
            }
        }
        let read = || -> Result<Vec<f64>, falcon_mdf::Mf4Error> {
            let signal = mdf.signal(of[place])?;
            let mut values = signal.values_f64()?;
            for (value, valid) in values.iter_mut().zip(signal.validity().unwrap_or_default()) {
                if !valid {
                    *value = f64::NAN;
                }
            }
            Ok(values)
        };
        log.channels[place].values = match read() {
            Ok(values) => values,
            Err(error) if wanted.is_some() => return Err(told(error)),
            Err(_) => continue,
        };
        kept[place] = true;
        let group = (of[place].data_group_index, of[place].channel_group_index);
        if let Entry::Vacant(clock) = clocks.entry(group) {
            // A group without times leaves its channels without a clock.
            if let Ok(times) = mdf.channel_timestamps(of[place]) {
                clock.insert(log.clocks.len());
                log.clocks.push(times);
            }
        }
        log.channels[place].clock = clocks.get(&group).copied();
    }
    if wanted.is_none() {
        let mut kept = kept.iter();
        log.channels.retain(|_| *kept.next().unwrap_or(&false));
    }
    Ok(log)
}
