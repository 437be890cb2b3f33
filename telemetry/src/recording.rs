//! Recordings of any format: text, Parquet, MATLAB and MDF 4.

use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::path::Path;

use falcon_mdf::Mf4File;
use hdf5_pure::{AttrValue, DType, Dataset, File, Group};
use kufe_sled::{matlab_remark, most_values, read_columns, read_matlab};

use crate::error::Error;
use crate::log::{Channel, Log};
use crate::text::{TextOptions, read_text};
use crate::unit::name_unit;

/// Longest recording [bytes].
const LONGEST: u64 = 4 << 30;

/// Structs within structs that are read.
const DEPTH: usize = 6;

/// A recording's bytes; pipes, devices and files of more than 4 GiB are refused.
///
/// # Errors
/// [`Error::File`].
pub(crate) fn bytes_of(path: &Path) -> Result<Vec<u8>, Error> {
    kufe_files::read_regular(path, LONGEST)
        .map_err(|error| Error::file(&path.display().to_string(), error))
}

/// Reads a recording: Parquet (`.parquet`), MATLAB (`.mat`), MDF 4 (`.mf4`, `.mdf`) or, with any
/// other ending, text.
///
/// Of text, MDF 4 and MATLAB v7.3 only the channels `wanted` by name are read, where some are.
///
/// # Errors
/// Those of the format's reader.
pub fn read_log(
    path: &Path,
    bytes: Vec<u8>,
    options: TextOptions,
    wanted: Option<&[&str]>,
) -> Result<Log, Error> {
    let file = path.display().to_string();
    let ending = path.extension().and_then(|ending| ending.to_str());
    let failure = |error: kufe_sled::Error| match error {
        kufe_sled::Error::File { file, reason } => Error::File { file, reason },
        error => Error::file(&file, error),
    };
    match ending.unwrap_or("").to_ascii_lowercase().as_str() {
        "parquet" => {
            let columns = read_columns(path, &[]).map_err(failure)?;
            of_vectors(columns, Vec::new())
                .with_channels(&file, "every column holds text, dates or nested values")
        }
        "mat" if bytes.starts_with(b"MATLAB 7.3") => read_matlab73(bytes, wanted, &file),
        "mat" => {
            let found = read_matlab(&bytes, &file).map_err(failure)?;
            of_vectors(found.vectors, found.remarks)
                .with_channels(&file, "no variable is a vector of more than one number")
        }
        "mf4" | "mdf" => read_mdf4(bytes, wanted, &file),
        _ => read_text(&bytes, options, wanted, &file),
    }
}

/// Reads every channel of a recording.
///
/// # Errors
/// As [`read_log`]; [`Error::File`] where it cannot be read.
pub fn read_recording(path: &Path, options: TextOptions) -> Result<Log, Error> {
    read_log(path, bytes_of(path)?, options, None)
}

/// Channels with the units that their names end in.
fn of_vectors(vectors: impl IntoIterator<Item = (String, Vec<f64>)>, remarks: Vec<String>) -> Log {
    let channels = vectors.into_iter().map(|(name, values)| Channel {
        unit: name_unit(&name),
        name,
        values,
        ..Channel::default()
    });
    Log {
        channels: channels.collect(),
        remarks,
        ..Log::default()
    }
}

/// Places of the channels to read.
fn places(log: &Log, wanted: Option<&[&str]>, file: &str) -> Result<Vec<usize>, Error> {
    match wanted {
        Some(names) => names.iter().map(|name| log.find(name, file)).collect(),
        None => Ok((0..log.channels.len()).collect()),
    }
}

/// Numbers of an array of this shape, as many as can be counted; 1 without one.
fn numbers_of(shape: &[u64]) -> u64 {
    shape.iter().fold(1, |n: u64, k| n.saturating_mul(*k))
}

/// Counts numbers that a file unpacks to.
struct Room(u64);

impl Room {
    fn take(&mut self, count: u64, name: &str, file: &str) -> Result<(), Error> {
        match self.0.checked_sub(count) {
            Some(rest) => {
                self.0 = rest;
                Ok(())
            }
            None => Err(Error::file(
                file,
                format!("channel {name}: the file unpacks to more numbers than a recording has"),
            )),
        }
    }
}

/// Reads an MDF 4 log; of the channels only those `wanted` by name, or all that hold numbers.
///
/// Values are physical: the file's own conversion is done. Samples that the file marks invalid are
/// NaN.
///
/// # Errors
/// [`Error::File`] where it is no MDF 4, or a channel that is wanted cannot be decoded.
pub fn read_mdf4(bytes: Vec<u8>, wanted: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    let failure = |error: falcon_mdf::Mf4Error| Error::file(file, error);
    let mut room = Room(most_values(bytes.len() as u64));
    let mdf = Mf4File::from_bytes(bytes).map_err(failure)?;
    let mut log = Log::default();
    let mut clocks: BTreeMap<(usize, usize), usize> = BTreeMap::new();
    let mut of: Vec<&falcon_mdf::Channel> = Vec::new();
    for channel in mdf.channels() {
        of.push(channel);
        log.channels.push(Channel {
            name: channel.name.clone(),
            unit: Some(channel.unit.clone()).filter(|unit| !unit.trim().is_empty()),
            ..Channel::default()
        });
    }
    let group = |place: usize| (of[place].data_group_index, of[place].channel_group_index);
    log.distinguish(|place| {
        let (data, channels) = group(place);
        match channels {
            0 => format!("group {data}"),
            _ => format!("group {data}.{channels}"),
        }
    });
    log.remarks.clear();
    let mut read = vec![false; of.len()];
    for place in places(&log, wanted, file)? {
        let shape = of[place].array_shape().unwrap_or_default();
        let count = of[place].sample_count.saturating_mul(numbers_of(shape));
        room.take(count, &log.channels[place].name, file)?;
        let values = || -> Result<Vec<f64>, falcon_mdf::Mf4Error> {
            let signal = mdf.signal(of[place])?;
            let mut values = signal.values_f64()?;
            for (value, valid) in values.iter_mut().zip(signal.validity().unwrap_or_default()) {
                if !valid {
                    *value = f64::NAN;
                }
            }
            Ok(values)
        };
        log.channels[place].values = match values() {
            Ok(values) => values,
            Err(error) if wanted.is_some() => return Err(failure(error)),
            Err(_) => continue,
        };
        read[place] = true;
        if let Entry::Vacant(clock) = clocks.entry(group(place)) {
            // A group without times leaves its channels without a clock.
            if let Ok(times) = mdf.channel_timestamps(of[place]) {
                clock.insert(log.clocks.len());
                log.clocks.push(times);
            }
        }
        log.channels[place].clock = clocks.get(&group(place)).copied();
    }
    if wanted.is_none() {
        let mut read = read.iter();
        log.channels.retain(|_| *read.next().unwrap_or(&false));
    }
    log.with_channels(file, "no group has one")
}

/// Reads a MATLAB v7.3 file, which is HDF5: vectors, and vectors in structs as `struct.field`; only
/// those `wanted` by name, or all of numbers.
///
/// # Errors
/// [`Error::File`] where it is no HDF5, or a vector that is wanted cannot be read.
pub fn read_matlab73(bytes: Vec<u8>, wanted: Option<&[&str]>, file: &str) -> Result<Log, Error> {
    let failure = |error: hdf5_pure::Error| Error::file(file, error);
    let mut room = Room(most_values(bytes.len() as u64));
    let hdf = File::from_bytes(bytes).map_err(failure)?;
    let mut found = Found::default();
    found.collect(&hdf.root(), "", DEPTH).map_err(failure)?;
    let names = found
        .vectors
        .iter()
        .map(|(name, _)| (name.clone(), Vec::new()));
    let mut log = of_vectors(names, found.remarks);
    for place in places(&log, wanted, file)? {
        let (name, data) = &found.vectors[place];
        room.take(numbers_of(&data.shape().map_err(failure)?), name, file)?;
        log.channels[place].values = numbers(data).map_err(failure)?;
    }
    log.with_channels(file, "no variable is a vector of more than one number")
}

/// Vectors of an HDF5 file by their names, and what its other variables are.
#[derive(Default)]
struct Found {
    vectors: Vec<(String, Dataset)>,
    remarks: Vec<String>,
}

impl Found {
    fn collect(
        &mut self,
        group: &Group,
        before: &str,
        depth: usize,
    ) -> Result<(), hdf5_pure::Error> {
        for name in group.datasets()? {
            let data = group.dataset(&name)?;
            let name = format!("{before}{name}");
            let class = match data.attrs()?.remove("MATLAB_class") {
                Some(
                    AttrValue::String(class)
                    | AttrValue::AsciiString(class)
                    | AttrValue::StringSized { value: class, .. }
                    | AttrValue::AsciiStringSized { value: class, .. },
                ) => class,
                _ => "double".to_string(),
            };
            let shape = data.shape()?;
            let vector = numbers_of(&shape) > 1 && shape.iter().filter(|n| **n != 1).count() == 1;
            let numeric = ["double", "single", "logical"].contains(&class.as_str())
                || class.trim_start_matches('u').starts_with("int");
            let number = !matches!(
                data.dtype()?,
                DType::String
                    | DType::VariableLengthString
                    | DType::ObjectReference
                    | DType::Compound(_)
                    | DType::Other(_)
                    | DType::Array(..)
            );
            if !numeric {
                let kind = match class.as_str() {
                    "char" => "char array",
                    "cell" => "cell array",
                    class => class,
                };
                self.remarks.push(matlab_remark(&name, kind));
            } else if vector && number {
                self.vectors.push((name, data));
            }
        }
        for name in group.groups()? {
            // #refs# and #subsystem# are MATLAB's own.
            if depth > 0 && !name.starts_with('#') {
                self.collect(&group.group(&name)?, &format!("{before}{name}."), depth - 1)?;
            }
        }
        Ok(())
    }
}

fn numbers(data: &Dataset) -> Result<Vec<f64>, hdf5_pure::Error> {
    fn floats<T>(values: Vec<T>, number: impl Fn(T) -> f64) -> Vec<f64> {
        values.into_iter().map(number).collect()
    }
    Ok(match data.dtype()? {
        DType::F32 => floats(data.read_f32()?, f64::from),
        DType::I8 => floats(data.read_i8()?, f64::from),
        DType::I16 => floats(data.read_i16()?, f64::from),
        DType::I32 => floats(data.read_i32()?, f64::from),
        DType::I64 => floats(data.read_i64()?, |v| v as f64),
        DType::U8 => floats(data.read_u8()?, f64::from),
        DType::U16 => floats(data.read_u16()?, f64::from),
        DType::U32 => floats(data.read_u32()?, f64::from),
        DType::U64 => floats(data.read_u64()?, |v| v as f64),
        _ => data.read_f64()?,
    })
}
