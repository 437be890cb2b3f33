//! Columns of numbers in Parquet files, read and written without Arrow.

use std::io::Write;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;

use parquet::basic::{Compression, ZstdLevel};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::file::properties::WriterProperties;
use parquet::file::reader::{ChunkReader, FileReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;

use crate::columns::{Columns, collect};
use crate::error::Error;

/// Reads every flat column of 32- or 64-bit numbers; nulls become NaN, other columns are left out.
///
/// # Errors
/// [`Error::File`] where the file is no Parquet, is cut short, or lies about its length or its pages.
pub fn read_parquet(file: impl ChunkReader + 'static, name: &str) -> Result<Columns, Error> {
    // The library panics on some damaged pages; nothing of it outlives the reading.
    catch_unwind(AssertUnwindSafe(|| read_columns(file, name))).unwrap_or_else(|panic| {
        let reason = panic.downcast_ref::<&str>().map(ToString::to_string);
        let reason = reason.or_else(|| panic.downcast_ref::<String>().cloned());
        let reason = reason.unwrap_or_else(|| "a page that cannot be decoded".into());
        Err(Error::file(name, format!("damaged Parquet: {reason}")))
    })
}

fn read_columns(file: impl ChunkReader + 'static, name: &str) -> Result<Columns, Error> {
    let told = |error: parquet::errors::ParquetError| Error::file(name, error);
    let reader = SerializedFileReader::new(file).map_err(told)?;
    let schema = reader.metadata().file_metadata().schema_descr_ptr();
    let mut columns: Vec<(String, Vec<f64>)> = Vec::new();
    for (place, descriptor) in schema.columns().iter().enumerate() {
        let flat = descriptor.max_rep_level() == 0 && descriptor.path().parts().len() == 1;
        let mut values = Vec::new();
        let mut numeric = flat;
        for group in 0..reader.num_row_groups() {
            if !numeric {
                break;
            }
            // The library takes these for granted.
            let chunk = reader.metadata().row_group(group).column(place);
            let start = chunk.dictionary_page_offset();
            let start = start.unwrap_or_else(|| chunk.data_page_offset());
            let length = chunk.compressed_size();
            if start < 0 || length < 0 {
                let column = descriptor.name();
                return Err(Error::file(
                    name,
                    format!(
                        "column {column}: begins at byte {start} and is {length} bytes long; expected neither below 0"
                    ),
                ));
            }
            let group = reader.get_row_group(group).map_err(told)?;
            let optional = descriptor.max_def_level() > 0;
            match group.get_column_reader(place).map_err(told)? {
                ColumnReader::DoubleColumnReader(r) => read_all(r, optional, &mut values, |v| v),
                ColumnReader::FloatColumnReader(r) => read_all(r, optional, &mut values, f64::from),
                ColumnReader::Int32ColumnReader(r) => read_all(r, optional, &mut values, f64::from),
                ColumnReader::Int64ColumnReader(r) => {
                    read_all(r, optional, &mut values, |v| v as f64)
                }
                _ => {
                    numeric = false;
                    Ok(())
                }
            }
            .map_err(told)?;
        }
        if numeric {
            columns.push((descriptor.name().to_string(), values));
        }
    }
    collect(columns.into_iter(), name)
}

/// Reads a column in batches, so that memory follows what is really there and not what the header claims.
fn read_all<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    optional: bool,
    into: &mut Vec<f64>,
    number: impl Fn(T::T) -> f64,
) -> Result<(), parquet::errors::ParquetError> {
    const BATCH: usize = 1 << 14;
    let mut values: Vec<T::T> = Vec::new();
    let mut levels: Vec<i16> = Vec::new();
    loop {
        values.clear();
        levels.clear();
        let (records, _, _) =
            reader.read_records(BATCH, optional.then_some(&mut levels), None, &mut values)?;
        if records == 0 {
            return Ok(());
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
    let told = |error: parquet::errors::ParquetError| Error::file("parquet", error);
    let fields: Vec<String> = columns
        .iter()
        .map(|(name, _)| format!("REQUIRED DOUBLE {name};"))
        .collect();
    let schema =
        parse_message_type(&format!("message run {{ {} }}", fields.join(" "))).map_err(told)?;
    // Noise does not repeat: a dictionary only costs time.
    let properties = WriterProperties::builder()
        .set_compression(Compression::ZSTD(ZstdLevel::default()))
        .set_dictionary_enabled(false)
        .build();
    let mut file =
        SerializedFileWriter::new(writer, Arc::new(schema), Arc::new(properties)).map_err(told)?;
    let mut group = file.next_row_group().map_err(told)?;
    for (_, values) in columns {
        let Some(mut column) = group.next_column().map_err(told)? else {
            break;
        };
        column
            .typed::<DoubleType>()
            .write_batch(values, None, None)
            .map_err(told)?;
        column.close().map_err(told)?;
    }
    group.close().map_err(told)?;
    file.finish().map_err(told)?;
    // A buffer that is dropped keeps to itself that it could not be written.
    file.inner_mut()
        .flush()
        .map_err(|error| Error::file("parquet", error))
}
