//! Runs, tracks and tables as files of an output folder.

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use kufe::charts::table_picture;
use kufe::jobs::{Failure, table::read_table, write_document_mat};
use kufe::report::TABLE_PICTURES;
use kufe_lut::{MatValue, Point};
use kufe_sled::{RunFormat, Vehicle};
use serde::Serialize;

use crate::output::{OutputDir, of_file};

/// The format that `--parquet` selects.
pub fn run_format(parquet: bool) -> RunFormat {
    if parquet {
        RunFormat::Parquet
    } else {
        RunFormat::Csv
    }
}

/// Writes every key of `document`, and `series`, for MATLAB.
pub fn write_mat(
    output: &OutputDir,
    name: &str,
    document: &impl Serialize,
    series: (String, MatValue),
) -> Result<(), Failure> {
    output.write(name, |file| {
        let mut writer = BufWriter::new(file);
        write_document_mat(&mut writer, document, vec![series])?;
        writer.flush().map_err(Failure::bad_input)
    })
}

/// Draws the tables of the model with the samples of the runs on them; returns the names of the
/// pictures.
///
/// # Errors
/// [`Failure::BadInput`] for a table that cannot be read, or a picture that cannot be written.
pub fn draw_tables(
    output: &OutputDir,
    vehicle: &Vehicle,
    samples: &[Vec<Point>; 2],
) -> Result<Vec<String>, Failure> {
    let mut drawn = Vec::new();
    for ((name, table), requested) in TABLE_PICTURES.iter().zip(vehicle.tables()).zip(samples) {
        let Some(file) = table.map(|table| PathBuf::from(&table.file)) else {
            continue;
        };
        let table = read_table(&file)?;
        let picture = table_picture(&table, table.judged(), Point::default(), requested);
        let picture = picture.map_err(of_file(&file))?;
        output.picture(name, &picture.figure)?;
        drawn.push((*name).to_owned());
    }
    Ok(drawn)
}
