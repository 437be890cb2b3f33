//! `kufe press`: one contact problem or a series of them, from its case to its pressure map.

pub mod compare;
mod series;
mod summary;

use std::path::PathBuf;
use std::time::Instant;

use kufe::jobs::field::write_contact;
use kufe::jobs::{Contact, Failure, Watch, case_file::LoadedCase, with_progress};
use kufe_contact::Options;

use crate::output::{OutputDir, case_inputs};
use crate::press::series::Lists;
use crate::terminal::Global;

/// Arguments of `kufe press`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; a built-in bobsled runner on flat ice where none is given
    pub case: Option<PathBuf>,
    /// Folder for result.json, pressure.exr, pressure.png, field.vtu, contact.vtp and hull.glb
    /// (runner.vtu and stress.png too where the runner deforms, groove.exr, groove.png and film.csv
    /// where it slides)
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Stress on the line under the peak too: subsurface.csv and subsurface.png, figures in
    /// result.json, maximum shear in the VTU files
    #[arg(long)]
    pub subsurface: bool,
    /// Figures, errors and maps for MATLAB too: result.mat
    #[arg(long)]
    pub mat: bool,
    #[command(flatten)]
    pub lists: Lists,
}

/// Solves the case and writes its files, all or none.
///
/// # Errors
/// [`Failure::BadInput`] for the case and for an output that cannot be written,
/// [`Failure::NotConverged`] if the solver does not reach the requested accuracy.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let loaded = match &args.case {
        Some(path) => LoadedCase::read(path)?,
        None => LoadedCase::example()?,
    };
    let options = Options {
        subsurface: args.subsurface,
        ..Options::default()
    };
    if args.lists.count() > 1 {
        return series::run(args, &loaded, global, &options);
    }
    let single = args.lists.combinations().into_iter().next();
    let loaded = single.unwrap_or_default().applied_to(&loaded)?;
    let inputs = case_inputs(args.case.as_deref(), &loaded)?;
    let output = OutputDir::begin("press", &inputs, &args.out, global.force)?;
    let bar = global.progress();
    let shown = bar.clone();
    let options = with_progress(options, &loaded.case, move |line| shown.set_message(&line));
    let watch = Watch {
        progress: Some(&|text| bar.set_message(text)),
        warn: Some(&|text| bar.warn(text)),
        ..Watch::default()
    };
    let pressed = Contact::from(loaded).options(options).best(&watch);
    if pressed.is_ok() {
        bar.set_message("writing the files");
    }
    bar.finish_and_clear();
    let pressed = pressed?;
    let started = Instant::now();
    let result = write_contact(&output, &pressed, args.mat)?;
    output.commit()?;
    let writing = started.elapsed().as_secs_f64();
    let summary = summary::text(&pressed, &result, &args.out, writing)?;
    global.print(&result, || summary)?;
    pressed.short.map_or(Ok(()), Err)
}
