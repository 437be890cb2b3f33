//! Runs, tracks and tables as files of an output folder.

use std::io::{BufWriter, Write};
use std::path::PathBuf;

use kufe::charts::{Slice, table_picture};
use kufe::jobs::{Failure, table::read_table, write_document_mat};
use kufe_lut::{MatValue, Sample};
use kufe_sled::{Run, RunFormat, Track, Vehicle, run_file, track_file, write_index, write_run};
use rayon::prelude::*;
use serde::Serialize;

use crate::output::OutputDir;

/// The pictures of the model's tables, front and rear; a model without tables has none.
pub const TABLE_PICTURES: [&str; 2] = ["table_front.png", "table_rear.png"];

/// The format that `--parquet` selects.
pub fn run_format(parquet: bool) -> RunFormat {
    if parquet {
        RunFormat::Parquet
    } else {
        RunFormat::Csv
    }
}

/// Writes the runs and, last, the index; names each run's file.
pub fn write_runs(output: &OutputDir, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
    for run in runs.iter_mut() {
        run.entry.file = PathBuf::from(run_file(&run.entry.run, format));
    }
    runs.par_iter()
        .map(|run| {
            let name = run.entry.file.display().to_string();
            output.write(&name, |mut file| write_run(run, &mut file, format))
        })
        .collect::<Result<Vec<()>, Failure>>()?;
    let entries: Vec<_> = runs.iter().map(|run| run.entry.clone()).collect();
    output.write("runs.csv", |file| write_index(file, &entries))
}

/// Writes the table of a track.
pub fn write_track(output: &OutputDir, track: &Track) -> Result<(), Failure> {
    output.write(&track_file(&track.name), |file| {
        track.write_csv(std::io::BufWriter::new(file))
    })
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
    samples: &[Vec<Sample>; 2],
) -> Result<Vec<String>, Failure> {
    let mut drawn = Vec::new();
    for ((name, table), requested) in TABLE_PICTURES.iter().zip(vehicle.tables()).zip(samples) {
        let Some(file) = table.map(|table| PathBuf::from(&table.file)) else {
            continue;
        };
        let table = read_table(&file)?;
        let picture = table_picture(&table, table.judged(), Slice::default(), requested)
            .map_err(|error| Failure::BadInput(format!("{}: {error}", file.display())))?;
        output.picture(name, &picture.figure)?;
        drawn.push((*name).to_owned());
    }
    Ok(drawn)
}
