//! Runs of one driver on one track.

use std::path::Path;

use kufe::charts::run_picture;
use kufe::jobs::runs::{write_runs, write_track};
use kufe::jobs::simulate::{DrivenRuns, NamedDriver, SimulatedDrives};
use kufe::jobs::{Failure, channel_series};
use kufe_sled::{Model, PrepareOptions, Run, SimulateOptions, Vehicle, prepare};

use crate::output::OutputDir;
use crate::runs::files::{draw_tables, run_format, write_mat};
use crate::runs::simulate::Args;
use crate::terminal::{Global, warn_if_cut};

/// Drives the runs and writes them.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(args: &Args, model: &Path, track: &Path, global: &Global) -> Result<(), Failure> {
    let drives = SimulatedDrives {
        model: model.to_path_buf(),
        track: track.to_path_buf(),
        driver: NamedDriver::of(args.driver.as_deref(), args.skill)?,
        runs: args.runs,
        session: args.session.clone(),
        noise: !args.no_noise,
        options: SimulateOptions {
            step_s: args.step_s,
            rate_hz: args.rate_hz,
            start_speed_mps: args.start_speed_mps,
            most_s: args.most_s,
            conditions: args.conditions()?,
            seed: args.seed,
            ..SimulateOptions::default()
        },
    };
    warn_if_cut(track);
    let output = OutputDir::begin("simulate", &drives.inputs(), &args.out, global.force)?;
    let DrivenRuns {
        model,
        vehicle,
        track,
        mut runs,
        document,
        samples,
    } = global.watched(|watch| drives.drive(watch))?;
    write_runs(output.files(), &mut runs, run_format(args.parquet))?;
    write_track(output.files(), &track)?;
    if args.mat {
        write_mat(&output, "simulation.mat", &document, channel_series(&runs))?;
    }
    let mut pictures = draw_first(&output, &runs, &model, &vehicle)?;
    pictures.extend(draw_tables(&output, &vehicle, &samples)?);
    output.json("simulation.json", &document)?;
    output.commit()?;
    global.print(&document, || {
        let mut text = String::new();
        for run in document.runs.iter().take(20) {
            let finish = if run.finished {
                ""
            } else {
                ", finish not reached"
            };
            let (name, time, error) = (&run.run, run.time_s, run.energy_balance_relative_error);
            text += &format!(
                "{name}  {time:.2} s{finish}  relative error of the energy balance {error:.1e}\n"
            );
        }
        let (out, count) = (args.out.display(), runs.len());
        let plural = if count == 1 { "" } else { "s" };
        let track = kufe_sled::track_file(&track.name);
        let pictures: String = pictures.iter().map(|name| format!(", {name}")).collect();
        text + &format!(
            "{out}: runs.csv, {count} run{plural}, {track}, simulation.json{pictures}\n"
        )
    })
}

/// Draws the first run where it is long enough to be prepared; names the picture for the summary.
fn draw_first(
    output: &OutputDir,
    runs: &[Run],
    model: &Model,
    vehicle: &Vehicle,
) -> Result<Vec<String>, Failure> {
    let options = PrepareOptions::default();
    let Ok(prepared) = prepare(&runs[0], vehicle, model.noise.as_ref(), &options) else {
        return Ok(Vec::new());
    };
    output.picture("overview.png", &run_picture(&prepared))?;
    Ok(vec!["overview.png".to_owned()])
}
