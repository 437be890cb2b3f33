//! The sample data set.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::runs::{write_runs, write_track};
use kufe::results::SampleTruth;
use kufe_sled::Model;
use kufe_sled::sample_data::{drive_sample, sample_plan, sample_track};

use crate::output::OutputDir;
use crate::runs::files::run_format;
use crate::runs::simulate::Args;
use crate::terminal::Global;

/// Makes and writes it.
pub fn run(
    args: &Args,
    folder: &Path,
    model_file: Option<&Path>,
    global: &Global,
) -> Result<(), Failure> {
    let model = match model_file {
        Some(path) => Model::load(path)?,
        None => Model::published(),
    };
    let inputs: Vec<PathBuf> = model_file.map(Path::to_path_buf).into_iter().collect();
    let command = "simulate --sample-data";
    let output = OutputDir::begin(command, &inputs, folder, global.force)?;
    let plan = sample_plan(args.seed);
    let mut runs = global.during("driving 44 runs", || drive_sample(&plan, &model))?;
    write_runs(output.files(), &mut runs, run_format(args.parquet))?;
    for name in ["east", "west"] {
        write_track(output.files(), &sample_track(name))?;
    }
    output.text("model.toml", &model.to_toml())?;
    let truth = SampleTruth::new(args.seed, &plan);
    output.json("truth.json", &truth)?;
    output.commit()?;
    global.print(&truth, || {
        format!(
            "{}: runs.csv, {} runs, track_east.csv, track_west.csv, model.toml and truth.json (what they were driven with)\n",
            folder.display(),
            runs.len()
        )
    })
}
