//! Columns of numbers in Parquet files, read and written without Arrow.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use half::f16;
use parquet::basic::{Compression, ConvertedType, LogicalType, TimeUnit, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::ColumnDescriptor;

use crate::columns::{MOST_NUMBERS, too_many};
use crate::error::Error;

/// Reads the flat columns of numbers in the file's order; nulls become NaN. Where some are
/// `wanted`, the others are empty.
///
/// Decimals have their point, unsigned integers their sign, and times and time stamps are in
/// seconds. Pages are plain, or compressed by Snappy, gzip or Zstandard.
///
/// # Errors
/// [`Error::File`] where the file is no Parquet, is cut short, states a wrong length or wrong
/// pages, is compressed otherwise, or unpacks to more numbers than [`MOST_NUMBERS`].
pub fn read_parquet(
    file: impl ChunkReader + 'static,
    wanted: Option<&dyn Fn(&str) -> bool>,
    name: &str,
) -> Result<Vec<(String, Vec<f64>)>, Error> {
    // The library panics on some damaged pages; nothing of it outlives the reading.
    catch_unwind(AssertUnwindSafe(|| read_columns(file, wanted, name))).unwrap_or_else(|panic| {
        let reason = panic.downcast_ref::<&str>().map(ToString::to_string);
        let reason = reason.or_else(|| panic.downcast_ref::<String>().cloned());
        let reason = reason.unwrap_or_else(|| "a page that cannot be decoded".into());
        Err(Error::file(name, format!("damaged Parquet: {reason}")))
    })
}

fn read_columns(
    file: impl ChunkReader + 'static,
    wanted: Option<&dyn Fn(&str) -> bool>,
    name: &str,
) -> Result<Vec<(String, Vec<f64>)>, Error> {
    let failure = |error: ParquetError| Error::file(name, error);
    let reader = SerializedFileReader::new(file).map_err(failure)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    let mut room = MOST_NUMBERS;
    for (place, descriptor) in schema.columns().iter().enumerate() {
        let flat = descriptor.max_rep_level() == 0 && descriptor.path().parts().len() == 1;
        let Some(meaning) = Meaning::of(descriptor).filter(|_| flat) else {
            continue;
        };
        let mut values = Vec::new();
        if wanted.is_some_and(|wanted| !wanted(descriptor.name())) {
            columns.push((descriptor.name().to_string(), values));
            continue;
        }
        let mut numeric = true;
        for group in 0..reader.num_row_groups() {
            // The library does not check these.
            let chunk = reader.metadata().row_group(group).column(place);
            let start = chunk.dictionary_page_offset();
            let start = start.unwrap_or_else(|| chunk.data_page_offset());
            let length = chunk.compressed_size();
            let column = descriptor.name();
            use Compression as C;
            let packed = chunk.compression();
            if !matches!(
                packed,
                C::UNCOMPRESSED | C::SNAPPY | C::GZIP(_) | C::ZSTD(_)
            ) {
                let reason = format!(
                    "column {column}: its pages are compressed by {}: expected snappy, gzip, zstd or none; write the \
                     file again with one of these",
                    packed
                        .to_string()
                        .split('(')
                        .next()
                        .unwrap_or_default()
                        .to_lowercase()
                );
                return Err(Error::file(name, reason));
            }
            if start < 0 || length < 0 {
                return Err(Error::file(
                    name,
                    format!(
                        "column {column}: begins at byte {start} and is {length} bytes long; expected neither below 0"
                    ),
                ));
            }
            let unpacked = u64::try_from(chunk.uncompressed_size()).unwrap_or(u64::MAX);
            let values_stated = u64::try_from(chunk.num_values()).unwrap_or(u64::MAX);
            if unpacked / 16 > MOST_NUMBERS || values_stated > room {
                return Err(too_many(name));
            }
            let group = reader.get_row_group(group).map_err(failure)?;
            let optional = descriptor.max_def_level() > 0;
            let read = group.get_column_reader(place).map_err(failure)?;
            let room = room as usize;
            let into = &mut values;
            use ColumnReader as R;
            let whole = match (read, &meaning) {
                (R::DoubleColumnReader(r), _) => read_all(r, optional, room, into, |v| v),
                (R::FloatColumnReader(r), _) => read_all(r, optional, room, into, f64::from),
                (R::Int32ColumnReader(r), Meaning::Unsigned) => {
                    read_all(r, optional, room, into, |v| f64::from(v as u32))
                }
                (R::Int64ColumnReader(r), Meaning::Unsigned) => {
                    read_all(r, optional, room, into, |v| v as u64 as f64)
                }
                (R::Int32ColumnReader(r), Meaning::Parts(parts)) => {
                    read_all(r, optional, room, into, |v| f64::from(v) / parts)
                }
                (R::Int64ColumnReader(r), Meaning::Parts(parts)) => {
                    read_all(r, optional, room, into, |v| v as f64 / parts)
                }
                (R::Int96ColumnReader(r), _) => {
                    read_all(r, optional, room, into, |v| v.to_nanos() as f64 / 1e9)
                }
                (R::ByteArrayColumnReader(r), Meaning::Parts(parts)) => {
                    read_all(r, optional, room, into, |v| big_endian(v.data()) / parts)
                }
                (R::FixedLenByteArrayColumnReader(r), Meaning::Half) => {
                    let number = |bytes: &[u8]| bytes.first_chunk().map(|b| f16::from_le_bytes(*b));
                    read_all(r, optional, room, into, |v| {
                        number(v.data()).map_or(f64::NAN, f64::from)
                    })
                }
                (R::FixedLenByteArrayColumnReader(r), Meaning::Parts(parts)) => {
                    read_all(r, optional, room, into, |v| big_endian(v.data()) / parts)
                }
                _ => {
                    numeric = false;
                    break;
                }
            }
            .map_err(failure)?;
            if !whole {
                return Err(too_many(name));
            }
        }
        if numeric {
            room -= values.len() as u64;
            values.shrink_to_fit();
            columns.push((descriptor.name().to_string(), values));
        }
    }
    Ok(columns)
}

/// What the stored integers of a column are.
enum Meaning {
    /// So many of them are one.
    Parts(f64),
    Unsigned,
    /// Numbers in half precision.
    Half,
}

impl Meaning {
    /// By the logical type or, in older files, the converted one; `None` for text and dates.
    fn of(column: &ColumnDescriptor) -> Option<Meaning> {
        use parquet::basic::Type;
        let power = |scale: i32| Meaning::Parts(10f64.powi(scale));
        let bytes = matches!(
            column.physical_type(),
            Type::BYTE_ARRAY | Type::FIXED_LEN_BYTE_ARRAY
        );
        Some(match (column.logical_type_ref(), column.converted_type()) {
            (Some(LogicalType::Decimal(decimal)), _) => power(decimal.scale),
            (Some(LogicalType::Time(time)), _) | (Some(LogicalType::Timestamp(time)), _) => {
                power(match time.unit {
                    TimeUnit::MILLIS => 3,
                    TimeUnit::MICROS => 6,
                    TimeUnit::NANOS => 9,
                })
            }
            (Some(LogicalType::Integer(integer)), _) if !integer.is_signed => Meaning::Unsigned,
            (Some(LogicalType::Float16), _) => Meaning::Half,
            (Some(LogicalType::Date), _) | (None, ConvertedType::DATE) => return None,
            (None, ConvertedType::DECIMAL) => power(column.type_scale()),
            (None, ConvertedType::TIME_MILLIS | ConvertedType::TIMESTAMP_MILLIS) => power(3),
            (None, ConvertedType::TIME_MICROS | ConvertedType::TIMESTAMP_MICROS) => power(6),
            (
                None,
                ConvertedType::UINT_8
                | ConvertedType::UINT_16
                | ConvertedType::UINT_32
                | ConvertedType::UINT_64,
            ) => Meaning::Unsigned,
            _ if bytes => return None,
            _ => power(0),
        })
    }
}

/// An integer in two's complement, the highest byte first.
fn big_endian(bytes: &[u8]) -> f64 {
    let Some((first, rest)) = bytes.split_first() else {
        return f64::NAN;
    };
    let first = i128::from(*first as i8);
    if bytes.len() <= 16 {
        return rest
            .iter()
            .fold(first, |sum, byte| (sum << 8) | i128::from(*byte)) as f64;
    }
    let first = first as f64;
    rest.iter()
        .fold(first, |sum, byte| sum * 256.0 + f64::from(*byte))
}

/// Reads a column in batches, so that memory follows what is really there and not what the header
/// states; `false` where that is more than `room` values.
fn read_all<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    optional: bool,
    room: usize,
    into: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<bool, ParquetError> {
    const BATCH: usize = 1 << 14;
    let mut values: Vec<T::T> = Vec::new();
    let mut levels: Vec<i16> = Vec::new();
    loop {
        values.clear();
        levels.clear();
        let (records, _, _) =
            reader.read_records(BATCH, optional.then_some(&mut levels), None, &mut values)?;
        if records == 0 {
            return Ok(true);
        }
        if into.len() + records > room {
            return Ok(false);
        }
        let mut present = values.drain(..).map(&number);
        if optional {
            into.extend(levels.iter().map(|level| {
                if *level > 0 {
                    present.next().unwrap_or(f64::NAN)
                } else {
                    f64::NAN
                }
            }));
        } else {
            into.extend(present);
        }
    }
}

/// Writes columns of 64-bit numbers, compressed with Zstandard, in the order given.
///
/// # Errors
/// [`Error::File`] from the writer.
pub fn write_parquet(writer: impl Write + Send, columns: &[(&str, &[f64])]) -> Result<(), Error> {
    let refusal = |error: parquet::errors::ParquetError| Error::file("parquet", error);
    let fields: Vec<String> = columns
        .iter()
        .map(|(name, _)| format!("REQUIRED DOUBLE {name};"))
        .collect();
    let schema =
        parse_message_type(&format!("message run {{ {} }}", fields.join(" "))).map_err(refusal)?;
    // Noise does not repeat: a dictionary only costs time.
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .build();
    let mut file = SerializedFileWriter::new(writer, Arc::new(schema), Arc::new(properties))
        .map_err(refusal)?;
    let mut group = file.next_row_group().map_err(refusal)?;
    for (_, values) in columns {
        let Some(mut column) = group.next_column().map_err(refusal)? else {
            break;
        };
        column
            .typed::<DoubleType>()
            .write_batch(values, None, None)
            .map_err(refusal)?;
        column.close().map_err(refusal)?;
    }
    group.close().map_err(refusal)?;
    file.finish().map_err(refusal)?;
    // A buffer that is dropped keeps to itself that it could not be written.
    file.inner_mut()
        .flush()
        .map_err(|error| Error::file("parquet", error))
}
