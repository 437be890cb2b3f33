//! `kufe press`: one contact problem, from its case to its pressure map.

mod device;
mod files;
mod series;
mod series_table;
mod subsurface;
mod summary;

use std::path::PathBuf;
use std::sync::Arc;

use kufe_contact::{CentreLine, Iterate, Options, Watcher, centre_line};
use kufe_jobs::{Pressed, Watch, press_with};
use serde_json::Value;

use crate::case_file::LoadedCase;
use crate::failure::Failure;
use crate::output::{Global, say};
use crate::staging::Staging;

/// Arguments of `kufe press`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; a built-in bobsled runner on flat ice where none is given
    pub case: Option<PathBuf>,
    /// Folder for result.json, pressure.exr, pressure.png, field.vtu and hull.glb (runner.vtu too where the runner deforms)
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Stress on the line under the peak too: subsurface.csv and subsurface.png, figures in result.json, maximum shear in
    /// the VTU files
    #[arg(long)]
    pub subsurface: bool,
    /// Solve on a graphics processor (Vulkan, Metal, Direct3D 12), to the same residual; rigid runners only, in a kufe built
    /// with `--features gpu`
    #[arg(long)]
    pub gpu: bool,
    #[command(flatten)]
    pub lists: series::Lists,
}

/// Solves the case and writes its files, all or none.
///
/// # Errors
/// [`Failure::Usage`] for `--gpu` where there is no graphics processor, [`Failure::BadInput`] for the case and for an output
/// that cannot be written, [`Failure::NotConverged`] where the solver stops short of the accuracy asked.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let loaded = match &args.case {
        Some(path) => LoadedCase::read(path)?,
        None => LoadedCase::example()?,
    };
    let options = device::options(args.gpu, global)?;
    if args.lists.is_series() {
        return series::run(args, &loaded, global, &options);
    }
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
    let options = Options {
        progress: Some(watcher),
        ..options
    };
    let pressed = press_with(loaded, &watch, options);
    bar.finish_and_clear();
    let pressed = pressed?;
    let (document, line) = solved_document(&pressed, args.subsurface)?;
    files::write(&staging, &pressed, &document, line.as_ref())?;
    staging.commit()?;
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&summary::text(&pressed, &args.out));
    }
    Ok(())
}

/// result.json's content, and the centre line where it is asked for.
fn solved_document(
    pressed: &Pressed,
    with_subsurface: bool,
) -> Result<(Value, Option<CentreLine>), Failure> {
    let mut document = pressed.document();
    if !with_subsurface {
        return Ok((document, None));
    }
    let line = centre_line(&pressed.solution).map_err(Failure::bad_input)?;
    document["subsurface"] = subsurface::document(&line, &pressed.solution);
    Ok((document, Some(line)))
}
