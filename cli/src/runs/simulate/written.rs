//! Simulated runs and their track as files.

use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe_sled::{Run, RunFormat, Track, write_index, write_run};
use rayon::prelude::*;

use crate::output::staging::Staging;

/// Writes the runs and, last, the index; names each run's file.
pub fn write_runs(staging: &Staging, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
    for run in runs.iter_mut() {
        run.entry.file = PathBuf::from(format!("{}.{}", run.entry.run, format.extension()));
    }
    runs.par_iter()
        .map(|run| {
            let name = run.entry.file.display().to_string();
            staging.write(&name, |mut file| write_run(run, &mut file, format))
        })
        .collect::<Result<Vec<()>, Failure>>()?;
    let entries: Vec<_> = runs.iter().map(|run| run.entry.clone()).collect();
    staging.write("runs.csv", |file| write_index(file, &entries))
}

/// Writes the track beside them.
pub fn write_track(staging: &Staging, track: &Track) -> Result<(), Failure> {
    let name = format!("track_{}.csv", track.name);
    staging.write(&name, |file| track.write_csv(std::io::BufWriter::new(file)))
}
