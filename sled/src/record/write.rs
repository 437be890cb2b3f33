//! Runs written the way they are read.

use std::io::{BufWriter, Write};

use crate::error::Error;
use crate::record::csv::write_csv;
use crate::record::parquet::write_parquet;
use crate::record::run::{COLUMNS, Run};

/// File formats that runs are written in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RunFormat {
    /// Text, nine decimals.
    #[default]
    Csv,
    /// Parquet, 64-bit, compressed with Zstandard.
    Parquet,
}

impl RunFormat {
    /// Extension of the file's name.
    pub fn extension(self) -> &'static str {
        match self {
            RunFormat::Csv => "csv",
            RunFormat::Parquet => "parquet",
        }
    }
}

/// Writes one run: time, the required columns in the format's order, then the others by name. The writer need not be buffered.
///
/// # Errors
/// [`Error::File`] from the writer.
pub fn write_run(
    run: &Run,
    writer: &mut (dyn Write + Send),
    format: RunFormat,
) -> Result<(), Error> {
    let writer = BufWriter::with_capacity(1 << 18, writer);
    // Nine decimals are a nanosecond and far below any sensor's step; they keep text files short.
    let decimals = |value: f64| match format {
        RunFormat::Csv => (value * 1e9).round() / 1e9,
        RunFormat::Parquet => value,
    };
    let time: Vec<f64> = (0..run.len())
        .map(|i| ((run.t0_s + i as f64 * run.dt_s) * 1e9).round() / 1e9)
        .collect();
    let others = run
        .columns
        .keys()
        .map(String::as_str)
        .filter(|name| !COLUMNS.contains(name));
    let names = COLUMNS
        .iter()
        .copied()
        .filter(|name| run.columns.contains_key(*name))
        .chain(others);
    let columns: Vec<(&str, Vec<f64>)> = names
        .map(|name| {
            (
                name,
                run.columns[name].iter().map(|v| decimals(*v)).collect(),
            )
        })
        .collect();
    let mut table: Vec<(&str, &[f64])> = vec![("t_s", &time)];
    table.extend(
        columns
            .iter()
            .map(|(name, values)| (*name, values.as_slice())),
    );
    match format {
        RunFormat::Csv => write_csv(writer, &table)
            .map_err(|error| Error::file(&run.entry.file.display().to_string(), error)),
        RunFormat::Parquet => write_parquet(writer, &table),
    }
}
