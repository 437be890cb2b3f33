//! Columns of numbers in Parquet files, read and written without Arrow.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use half::f16;
use parquet::basic::{Compression, ConvertedType, LogicalType, TimeUnit, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::ColumnChunkMetaData;
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::ColumnDescriptor;

use crate::columns::{MOST_NUMBERS, too_many};
use crate::error::Error;

/// Reads the flat columns of numbers in the file's order; nulls become NaN. If `wanted` is given,
/// columns for which it is false are empty.
///
/// Decimals are scaled, and times and time stamps are in seconds. Pages are plain, or compressed by
/// Snappy, gzip or Zstandard.
///
/// # Errors
/// [`Error::File`] if the file is no Parquet, is cut short, has wrong lengths or pages, has another
/// compression, or contains more than [`MOST_NUMBERS`] numbers.
pub fn read_parquet(
    file: impl ChunkReader + 'static,
    wanted: Option<&dyn Fn(&str) -> bool>,
    name: &str,
) -> Result<Vec<(String, Vec<f64>)>, Error> {
    // The library panics on some damaged pages. No state of it remains after a panic.
    catch_unwind(AssertUnwindSafe(|| read_columns(file, wanted, name))).unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<&str>().copied();
        let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str));
        let reason = text.unwrap_or("a page that cannot be decoded");
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
        let Some(decoding) = Decoding::of(descriptor).filter(|_| flat) else {
            continue;
        };
        let column = descriptor.name();
        let groups = match wanted {
            Some(wanted) if !wanted(column) => 0,
            _ => reader.num_row_groups(),
        };
        let mut values = Values {
            optional: descriptor.max_def_level() > 0,
            room: room as usize,
            all: Vec::new(),
        };
        let mut numeric = true;
        for group in 0..groups {
            let chunk = reader.metadata().row_group(group).column(place);
            check(chunk, column, room, name)?;
            let group = reader.get_row_group(group).map_err(failure)?;
            let read = group.get_column_reader(place).map_err(failure)?;
            let read = values.read_chunk(read, &decoding).map_err(failure)?;
            if read == Some(false) {
                return Err(too_many(name));
            }
            numeric &= read.is_some();
        }
        if numeric {
            room -= values.all.len() as u64;
            values.all.shrink_to_fit();
            columns.push((column.to_string(), values.all));
        }
    }
    Ok(columns)
}

/// Checks compression, position and length of a column's part in a row group, which the library does
/// not; at most `room` values may be read.
fn check(chunk: &ColumnChunkMetaData, column: &str, room: u64, file: &str) -> Result<(), Error> {
    use Compression as C;
    let start = chunk.dictionary_page_offset();
    let start = start.unwrap_or_else(|| chunk.data_page_offset());
    let length = chunk.compressed_size();
    let packed = chunk.compression();
    if !matches!(
        packed,
        C::UNCOMPRESSED | C::SNAPPY | C::GZIP(_) | C::ZSTD(_)
    ) {
        let packed = packed.to_string().to_lowercase();
        let packed = packed.split('(').next().unwrap_or_default();
        let reason = format!(
            "column {column}: its pages are compressed by {packed}: expected snappy, gzip, zstd or none; \
             write the file again with one of these"
        );
        return Err(Error::file(file, reason));
    }
    if start < 0 || length < 0 {
        let reason = format!(
            "column {column}: begins at byte {start} and is {length} bytes long; expected neither below 0"
        );
        return Err(Error::file(file, reason));
    }
    let [unpacked, stated] = [chunk.uncompressed_size(), chunk.num_values()]
        .map(|count| u64::try_from(count).unwrap_or(u64::MAX));
    if unpacked / 16 > MOST_NUMBERS || stated > room {
        return Err(too_many(file));
    }
    Ok(())
}

/// How the stored values of a column become numbers.
enum Decoding {
    /// The number is the stored value over this divisor.
    Divisor(f64),
    Unsigned,
    /// Half precision.
    Half,
}

impl Decoding {
    /// From the logical type or, in older files, the converted one; `None` for text and dates.
    fn of(column: &ColumnDescriptor) -> Option<Decoding> {
        use parquet::basic::Type;
        let power = |scale: i32| Decoding::Divisor(10f64.powi(scale));
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
            (Some(LogicalType::Integer(integer)), _) if !integer.is_signed => Decoding::Unsigned,
            (Some(LogicalType::Float16), _) => Decoding::Half,
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
            ) => Decoding::Unsigned,
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

/// The values of a column read so far.
struct Values {
    /// Whether the column may contain nulls.
    optional: bool,
    /// Most values that may be read.
    room: usize,
    all: Vec<f64>,
}

impl Values {
    /// Reads a column's part in a row group; `None` if it does not contain numbers, `false` if the
    /// column is too long.
    fn read_chunk(
        &mut self,
        reader: ColumnReader,
        decoding: &Decoding,
    ) -> Result<Option<bool>, ParquetError> {
        use ColumnReader as R;
        let read = match (reader, decoding) {
            (R::DoubleColumnReader(r), _) => self.read(r, |v| v),
            (R::FloatColumnReader(r), _) => self.read(r, f64::from),
            (R::Int32ColumnReader(r), Decoding::Unsigned) => self.read(r, |v| f64::from(v as u32)),
            (R::Int64ColumnReader(r), Decoding::Unsigned) => self.read(r, |v| v as u64 as f64),
            (R::Int32ColumnReader(r), Decoding::Divisor(n)) => self.read(r, |v| f64::from(v) / n),
            (R::Int64ColumnReader(r), Decoding::Divisor(n)) => self.read(r, |v| v as f64 / n),
            (R::Int96ColumnReader(r), _) => self.read(r, |v| v.to_nanos() as f64 / 1e9),
            (R::ByteArrayColumnReader(r), Decoding::Divisor(n)) => {
                self.read(r, |v| big_endian(v.data()) / n)
            }
            (R::FixedLenByteArrayColumnReader(r), Decoding::Divisor(n)) => {
                self.read(r, |v| big_endian(v.data()) / n)
            }
            (R::FixedLenByteArrayColumnReader(r), Decoding::Half) => {
                let number = |bytes: &[u8]| bytes.first_chunk().map(|b| f16::from_le_bytes(*b));
                self.read(r, |v| number(v.data()).map_or(f64::NAN, f64::from))
            }
            _ => return Ok(None),
        };
        read.map(Some)
    }

    /// Reads in batches, so that the memory depends on the data and not on the length in the header;
    /// `false` if the column is too long.
    fn read<T: DataType>(
        &mut self,
        mut reader: ColumnReaderImpl<T>,
        number: impl Fn(T::T) -> f64,
    ) -> Result<bool, ParquetError> {
        const BATCH: usize = 1 << 14;
        let mut values: Vec<T::T> = Vec::new();
        let mut levels: Vec<i16> = Vec::new();
        loop {
            values.clear();
            levels.clear();
            let known = self.optional.then_some(&mut levels);
            let (records, ..) = reader.read_records(BATCH, known, None, &mut values)?;
            if records == 0 {
                return Ok(true);
            }
            if self.all.len() + records > self.room {
                return Ok(false);
            }
            let mut present = values.drain(..).map(&number);
            if self.optional {
                let mut value = |level: &i16| if *level > 0 { present.next() } else { None };
                let column = levels.iter().map(|level| value(level).unwrap_or(f64::NAN));
                self.all.extend(column);
            } else {
                self.all.extend(present);
            }
        }
    }
}

/// Writes columns of 64-bit numbers, compressed with Zstandard, in the order given.
///
/// # Errors
/// [`Error::File`] from the writer.
pub fn write_parquet(writer: impl Write + Send, columns: &[(&str, &[f64])]) -> Result<(), Error> {
    let failure = |error: ParquetError| Error::file("parquet", error);
    let fields = columns
        .iter()
        .map(|(name, _)| format!("REQUIRED DOUBLE {name};"));
    let fields = fields.collect::<Vec<String>>().join(" ");
    let schema = parse_message_type(&format!("message run {{ {fields} }}")).map_err(failure)?;
    // Noisy values do not repeat, so a dictionary only costs time.
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .build();
    let mut file = SerializedFileWriter::new(writer, Arc::new(schema), Arc::new(properties))
        .map_err(failure)?;
    let mut group = file.next_row_group().map_err(failure)?;
    for (_, values) in columns {
        let Some(mut column) = group.next_column().map_err(failure)? else {
            break;
        };
        column
            .typed::<DoubleType>()
            .write_batch(values, None, None)
            .map_err(failure)?;
        column.close().map_err(failure)?;
    }
    group.close().map_err(failure)?;
    file.finish().map_err(failure)?;
    // A buffer reports no error when it is dropped.
    file.inner_mut()
        .flush()
        .map_err(|error| Error::file("parquet", error))
}
