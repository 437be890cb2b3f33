//! `kufe press`: one contact problem, from its case to its pressure map.

use kufe::jobs::{Failure, Watch, case_file::LoadedCase, press_with, with_progress};
use kufe_contact::Options;

use crate::output::apart::{case_inputs, folder_apart};
use crate::output::global::Global;
use crate::output::say::say;
use crate::output::staging::Staging;
use crate::press::args::Args;
use crate::press::held::no_series;
use crate::press::{files, series, summary};

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
    no_series(&args.out)?;
    let inputs = case_inputs(args.case.as_deref(), &loaded)?;
    folder_apart(&inputs, &args.out, &files::NAMES)?;
    let surely = files::surely(&loaded.case, args);
    let staging = Staging::beside(&inputs, &args.out, &surely)?;
    staging.remove_on_interrupt();
    let bar = global.progress();
    let (shown, asked) = (bar.clone(), loaded.case.accuracy.p_max);
    let watch = Watch {
        warn: Some(&|warning| eprintln!("kufe: warning: {warning}")),
        ..Watch::default()
    };
    let options = with_progress(options, asked, move |line| shown.set_message(line));
    let pressed = press_with(loaded, &watch, options);
    bar.finish_and_clear();
    let pressed = pressed?;
    let (result, json) = files::write(&staging, &pressed, args.mat)?;
    staging.commit()?;
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
