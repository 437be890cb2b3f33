//! Reading of recordings: text, Parquet, MATLAB and MDF 4.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use hdf5_pure::{AttrValue, DType, Dataset, File as Hdf5, Group, ReadSeekSource};
use kufe_files::shown_name;
use kufe_sled::{
    LONGEST_MATLAB, MOST_NUMBERS, matlab_column, matlab_remark, read_matlab, read_parquet,
};

use crate::error::Error;
use crate::log::{Channel, Log, alike};
use crate::mdf4::read_mdf4;
use crate::text::{TextOptions, read_text};
use crate::unit::name_unit;

/// Largest number of values in a chunk of an HDF5 file (32 MB): each chunk is unpacked whole.
const MAX_CHUNK: u64 = 4_000_000;

/// Largest number of columns of a matrix whose columns are channels. A damaged file may state any
/// number.
const MAX_COLUMNS: u64 = 64;

/// Largest depth of nested structs.
const MAX_DEPTH: usize = 6;

/// Reason why a MATLAB file has no channels.
const NO_VECTOR: &str =
    "no variable is a vector of more than one number or a matrix of more rows than columns";

/// First bytes of a MATLAB file in HDF5 format.
const MATLAB_73: &[u8] = b"MATLAB 7.3";

/// Reads a recording: Parquet (`.parquet`), MATLAB (`.mat`), MDF 4 (`.mf4`, `.mdf`) or, with any
/// other ending, text.
///
/// With `wanted`, only channels of these names are read. `most` is the largest number of values; of
/// a text without `wanted` the first rows are read. Files are read piece by piece, except MATLAB
/// files of at most [`LONGEST_MATLAB`] bytes.
///
/// # Errors
/// Those of the format's reader; [`Error::File`] if the file cannot be read or has more values.
pub fn read_log(
    path: &Path,
    options: TextOptions,
    wanted: Option<&[&str]>,
    most: u64,
) -> Result<Log, Error> {
    let file = path.display().to_string();
    let open = || kufe_files::open_regular(path).map_err(|error| Error::file(&file, error));
    let ending = path.extension().and_then(|ending| ending.to_str());
    let log = match ending.unwrap_or("").to_ascii_lowercase().as_str() {
        "parquet" => {
            let named = |name: &str| {
                wanted.is_none_or(|w| w.iter().any(|one| alike(one, &shown_name(name))))
            };
            let columns = read_parquet(open()?, wanted.is_some().then_some(&named), &file);
            of_vectors(columns.map_err(of_sled(&file))?, Vec::new())
                .with_channels(&file, "every column holds text, dates or nested values")?
        }
        "mat" if is_matlab73(open()?) => read_matlab73(open()?, wanted, &file)?,
        "mat" => {
            let bytes = kufe_files::read_regular(path, LONGEST_MATLAB);
            let bytes = bytes.map_err(|error| {
                Error::file(
                    &file,
                    format!("{error}; save fewer variables, or with -v7.3"),
                )
            })?;
            let found = read_matlab(&bytes, &file).map_err(of_sled(&file))?;
            of_vectors(found.vectors, found.remarks).with_channels(&file, NO_VECTOR)?
        }
        "mf4" | "mdf" => read_mdf4(open()?, wanted, &file)?,
        _ => read_text(open()?, options, wanted, most, &file)?,
    };
    if log.numbers() > most {
        return Err(Error::too_many(&file));
    }
    Ok(log)
}

/// Converts an error of the readers of `kufe_sled`.
fn of_sled(file: &str) -> impl Fn(kufe_sled::Error) -> Error {
    move |error| match error {
        kufe_sled::Error::File { file, reason } => Error::File { file, reason },
        error => Error::file(file, error),
    }
}

fn is_matlab73(mut file: File) -> bool {
    let mut start = [0; MATLAB_73.len()];
    file.read_exact(&mut start).is_ok() && start == MATLAB_73
}

/// Channels with the units that their names end in.
fn of_vectors(vectors: impl IntoIterator<Item = (String, Vec<f64>)>, remarks: Vec<String>) -> Log {
    let channels = vectors.into_iter().map(|(name, values)| Channel {
        unit: name_unit(&name),
        name: shown_name(&name),
        values,
        ..Channel::default()
    });
    let mut log = Log {
        channels: channels.collect(),
        remarks,
        ..Log::default()
    };
    log.distinguish(|place| format!("column {}", place + 1));
    log
}

/// Number of elements of an array of this shape, saturating; 1 for an empty shape.
fn numbers_of(shape: &[u64]) -> u64 {
    shape.iter().fold(1, |n: u64, k| n.saturating_mul(*k))
}

/// Reads a MATLAB v7.3 file, which is HDF5: the vectors with the names `wanted`, or all numeric
/// vectors. A vector in a struct is named `struct.field`; the first column of a matrix with more rows
/// than columns is named `matrix(:,1)`.
///
/// # Errors
/// [`Error::File`] if the file is not HDF5, a wanted vector cannot be read, or the vectors have
/// more than [`MOST_NUMBERS`] values.
pub fn read_matlab73(
    mut reader: impl Read + Seek + Send + Sync + 'static,
    wanted: Option<&[&str]>,
    file: &str,
) -> Result<Log, Error> {
    let failure = |error: hdf5_pure::Error| Error::file(file, error);
    let unread = |error: std::io::Error| Error::file(file, error);
    let mut room = MOST_NUMBERS;
    let hdf = if reader.seek(SeekFrom::End(0)).map_err(unread)? <= LONGEST_MATLAB {
        let mut bytes = Vec::new();
        reader.rewind().map_err(unread)?;
        reader.read_to_end(&mut bytes).map_err(unread)?;
        Hdf5::from_bytes(bytes)
    } else {
        let source = ReadSeekSource::new(reader);
        Hdf5::from_source(source.map_err(|error| Error::file(file, error))?)
    };
    let hdf = hdf.map_err(failure)?;
    let mut found = Variables::default();
    found.collect(&hdf.root(), "", MAX_DEPTH).map_err(failure)?;
    let names = found.vectors.iter();
    let names = names.map(|vector| (vector.name.clone(), Vec::new()));
    let mut log = of_vectors(names, found.remarks);
    let mut read = (usize::MAX, Vec::new());
    for place in log.places(wanted, file)? {
        let Vector { array, column, .. } = found.vectors[place];
        let Array { data, rows } = &found.arrays[array];
        let chunk = data.chunk_shape().map_err(failure)?.unwrap_or_default();
        if numbers_of(&chunk) > MAX_CHUNK {
            let name = &log.channels[place].name;
            let expected = format!("expected at most {MAX_CHUNK}");
            let reason = format!("channel {name}: chunks of {chunk:?} numbers, {expected}");
            return Err(Error::file(file, reason));
        }
        let count = numbers_of(&data.shape().map_err(failure)?);
        if count > room {
            return Err(Error::too_many(file));
        }
        room -= *rows as u64;
        // A column is read with its whole matrix.
        if read.0 != array {
            read = (array, numbers(data).map_err(failure)?);
        }
        let own = read.1.chunks(*rows).nth(column).unwrap_or_default();
        log.channels[place].values = own.to_vec();
    }
    log.with_channels(file, NO_VECTOR)
}

/// A vector, or a matrix whose columns follow one another.
struct Array {
    data: Dataset,
    rows: usize,
}

/// A column of the array with index `array`.
struct Vector {
    name: String,
    array: usize,
    column: usize,
}

/// Vectors of an HDF5 file, and remarks on its other variables.
#[derive(Default)]
struct Variables {
    arrays: Vec<Array>,
    vectors: Vec<Vector>,
    remarks: Vec<String>,
}

impl Variables {
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
            let is_vector =
                numbers_of(&shape) > 1 && shape.iter().filter(|n| **n != 1).count() == 1;
            // MATLAB's dimensions in inverse order.
            let (columns, rows) = match shape[..] {
                _ if is_vector => (1, numbers_of(&shape)),
                [columns, rows] if rows > columns && columns <= MAX_COLUMNS => (columns, rows),
                _ => (0, 0),
            };
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
            } else if number {
                for column in 0..columns as usize {
                    self.vectors.push(Vector {
                        name: if is_vector {
                            name.clone()
                        } else {
                            matlab_column(&name, column)
                        },
                        array: self.arrays.len(),
                        column,
                    });
                }
                self.arrays.push(Array {
                    data,
                    rows: rows as usize,
                });
            }
        }
        for name in group.groups()? {
            // #refs# and #subsystem# are internal to MATLAB.
            if depth > 0 && !name.starts_with('#') {
                self.collect(&group.group(&name)?, &format!("{before}{name}."), depth - 1)?;
            }
        }
        Ok(())
    }
}

fn numbers(data: &Dataset) -> Result<Vec<f64>, hdf5_pure::Error> {
    fn floats<T: Into<f64>>(values: Vec<T>) -> Vec<f64> {
        values.into_iter().map(T::into).collect()
    }
    Ok(match data.dtype()? {
        DType::F32 => floats(data.read_f32()?),
        DType::I8 => floats(data.read_i8()?),
        DType::I16 => floats(data.read_i16()?),
        DType::I32 => floats(data.read_i32()?),
        DType::I64 => data.read_i64()?.into_iter().map(|n| n as f64).collect(),
        DType::U8 => floats(data.read_u8()?),
        DType::U16 => floats(data.read_u16()?),
        DType::U32 => floats(data.read_u32()?),
        DType::U64 => data.read_u64()?.into_iter().map(|n| n as f64).collect(),
        _ => data.read_f64()?,
    })
}
