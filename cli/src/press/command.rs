//! `kufe press`: one contact problem, from its case to its pressure map.

use std::path::PathBuf;

use kufe::jobs::field::write_contact;
use kufe::jobs::{Contact, Failure, Watch, case_file::LoadedCase, with_progress};
use kufe_contact::Options;

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::paths::case_inputs;
use crate::output::say::{say, warn};
use crate::press::series::Lists;
use crate::press::{series, summary};

/// Arguments of `kufe press`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; a built-in bobsled runner on flat ice where none is given
    pub case: Option<PathBuf>,
    /// Folder for result.json, pressure.exr, pressure.png, field.vtu, contact.vtp and hull.glb (runner.vtu and stress.png too where the runner deforms, groove.exr, groove.png and
    /// film.csv where it slides)
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Stress on the line under the peak too: subsurface.csv and subsurface.png, figures in result.json, maximum shear in
    /// the VTU files
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
/// [`Failure::BadInput`] for the case and for an output that cannot be written, [`Failure::NotConverged`] where the solver stops short of the accuracy asked.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let loaded = match &args.case {
        Some(path) => LoadedCase::read(path)?,
        None => LoadedCase::example()?,
    };
    let options = Options {
        subsurface: args.subsurface,
        ..Options::default()
    };
    if args.lists.is_series() {
        return series::run(args, &loaded, global, &options);
    }
    let inputs = case_inputs(args.case.as_deref(), &loaded)?;
    let output = OutputDir::begin("press", &inputs, &args.out, global.force)?;
    let bar = global.progress();
    let (shown, asked) = (bar.clone(), loaded.case.accuracy.p_max);
    let watch = Watch {
        warn: Some(&warn),
        ..Watch::default()
    };
    let options = with_progress(options, asked, move |line| shown.set_message(line));
    let pressed = Contact::from(loaded).options(options).best(&watch);
    bar.finish_and_clear();
    let pressed = pressed?;
    let (result, json) = write_contact(output.files(), &pressed, args.mat)?;
    output.commit()?;
    if global.json {
        say(&json);
    } else if !global.quiet {
        say(&summary::text(&pressed, &result, &args.out));
    }
    match &pressed.short {
        Some(short) => Err(short.clone()),
        None => Ok(()),
    }
}
