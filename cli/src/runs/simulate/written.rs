//! Simulated runs and their track as files.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe_sled::{Run, RunFormat, Track, run_file, track_file, write_index, write_run};
use rayon::prelude::*;

use crate::output::folder::OutputDir;

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

/// Writes the track beside them.
pub fn write_track(output: &OutputDir, track: &Track) -> Result<(), Failure> {
    output.write(&track_file(&track.name), |file| {
        track.write_csv(std::io::BufWriter::new(file))
    })
}
