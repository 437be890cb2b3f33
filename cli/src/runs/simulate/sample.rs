//! The sample data set.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, runs::failure};
use kufe_sled::Model;
use kufe_sled::sample_data::{DRIVERS, drive_sample, sample_driver, sample_plan, sample_track};
use serde_json::json;

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::say::say;
use crate::runs::simulate::args::Args;
use crate::runs::simulate::written::{write_runs, write_track};

/// Makes and writes it.
pub fn sample(
    args: &Args,
    folder: &Path,
    model_file: Option<&Path>,
    global: &Global,
) -> Result<(), Failure> {
    let refusal = |error: kufe_sled::Error| failure(&error);
    let model = match model_file {
        Some(path) => Model::load(path).map_err(refusal)?,
        None => Model::published(),
    };
    let inputs: Vec<PathBuf> = model_file.map(Path::to_path_buf).into_iter().collect();
    let command = "simulate --sample-data";
    let output = OutputDir::begin(command, &inputs, folder, global.force)?;
    let bar = global.progress();
    bar.set_message("driving 44 runs");
    let plan = sample_plan(args.seed);
    let mut runs = drive_sample(&plan, &model).map_err(refusal)?;
    bar.set_message("writing");
    write_runs(&output, &mut runs, args.format())?;
    for name in ["east", "west"] {
        write_track(&output, &sample_track(name))?;
    }
    output.text("model.toml", &model.to_toml())?;
    let truth = json!({
        "seed": args.seed,
        "model": "model.toml, and beside it the contacts with walls that each run lists here",
        "drivers": DRIVERS.iter().map(|(name, class, count)| {
            let driver = sample_driver(name);
            json!({
                "driver": name, "class": class, "runs": count,
                "feedforward": driver.feedforward, "preview_s": driver.preview_s,
                "line_gain_rad_per_m": driver.line_gain, "course_gain": driver.course_gain,
                "lag_s": driver.lag_s, "most_rad": driver.most_rad,
                "noise_rad": driver.noise_rad, "wander_m": driver.wander_m, "length_m": driver.length_m,
            })
        }).collect::<Vec<_>>(),
        "runs": plan.iter().map(|run| json!({
            "run": run.run, "track": run.track, "session": run.session,
            "seed": run.options.seed, "start_speed_mps": run.options.start_speed_mps,
            "wall_contacts": run.options.contacts.iter().map(|contact| json!({
                "s_m": contact.s_m, "length_m": contact.length_m,
                "force_n": contact.force_n, "x_m": contact.x_m,
            })).collect::<Vec<_>>(),
        })).collect::<Vec<_>>(),
        "version": env!("CARGO_PKG_VERSION"),
    });
    output.json("truth.json", &truth)?;
    output.commit()?;
    bar.finish_and_clear();
    if global.json {
        say(&format!("{truth:#}\n"));
    } else if !global.quiet {
        say(&format!(
            "{}: runs.csv, {} runs, track_east.csv, track_west.csv, model.toml and truth.json (what they were driven with)\n",
            folder.display(),
            runs.len()
        ));
    }
    Ok(())
}
