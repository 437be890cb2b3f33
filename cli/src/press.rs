//! `kufe press`: one contact problem, from its case to its pressure map.

mod summary;

use std::path::PathBuf;
use std::sync::Arc;

use kufe_contact::{Iterate, Watcher};
use kufe_jobs::{Pressed, Watch};

use crate::case_file::LoadedCase;
use crate::failure::Failure;
use crate::output::{Global, say};
use crate::pressure_map::PressureMap;
use crate::staging::Staging;
use crate::{patches, pressure_exr, pressure_png, volume_vtu};

/// Arguments of `kufe press`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; a built-in bobsled runner on flat ice where none is given
    pub case: Option<PathBuf>,
    /// Folder for result.json, pressure.exr, pressure.png and field.vtu (runner.vtu too where the runner deforms)
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
}

/// Solves the case and writes its files, all or none.
///
/// # Errors
/// [`Failure::BadInput`] for the case and for an output that cannot be written,
/// [`Failure::NotConverged`] where the solver stops short of the accuracy asked.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let loaded = match &args.case {
        Some(path) => LoadedCase::read(path)?,
        None => LoadedCase::example()?,
    };
    let staging = Staging::begin(&args.out)?;
    staging.remove_on_interrupt();
    let bar = global.progress();
    let shown = bar.clone();
    let watcher: Watcher = Arc::new(move |state: &Iterate| {
        shown.set_message(summary::progress_line(state));
    });
    let watch = Watch {
        warn: Some(&|warning| eprintln!("kufe: warning: {warning}")),
        ..Watch::default()
    };
    let pressed = kufe_jobs::press(loaded, &watch, Some(watcher));
    bar.finish_and_clear();
    let pressed = pressed?;
    let document = pressed.document();
    write_files(&staging, &pressed, &document)?;
    staging.commit()?;
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&summary::text(&pressed, &args.out));
    }
    Ok(())
}

fn write_files(
    staging: &Staging,
    pressed: &Pressed,
    document: &serde_json::Value,
) -> Result<(), Failure> {
    use std::io::Write;
    let map = PressureMap::of(&pressed.solution);
    staging.write("result.json", |mut file| writeln!(file, "{document:#}"))?;
    staging.write("pressure.exr", |file| {
        let curvature = pressed.problem.track_curvature;
        pressure_exr::write(file, &map, pressed.solution.fz, curvature)
    })?;
    let title = summary::title(&pressed.solution);
    let maps = patches::maps(&pressed.solution);
    pressure_png::write(&staging.path("pressure.png"), &maps, &title)
        .map_err(|error| staging.failure("pressure.png", &error))?;
    staging.write("field.vtu", |file| {
        volume_vtu::write_ice(file, &pressed.solution.volume)
    })?;
    if let (Some(field), Some(elastic)) = (
        &pressed.solution.runner_volume,
        &pressed.problem.runner.elastic,
    ) {
        staging.write("runner.vtu", |file| {
            volume_vtu::write_runner(file, field, elastic)
        })?;
    }
    Ok(())
}
