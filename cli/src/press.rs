//! `kufe press`: one contact problem, from its case to its pressure map.

mod result;
mod summary;

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use kufe_contact::case::{FittedHull, StatedProblem};
use kufe_contact::{Iterate, Options, Problem, Solution, solve};

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

/// A solved case with what there is to say about it.
pub struct Pressed {
    /// The case.
    pub loaded: LoadedCase,
    /// The problem that it stated.
    pub problem: Problem,
    /// The hull, where the case names one.
    pub hull: Option<FittedHull>,
    /// Its solution.
    pub solution: Solution,
    /// Wall time of the solve [s].
    pub seconds: f64,
    /// What the reader of the result should know.
    pub warnings: Vec<String>,
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
    let StatedProblem { problem, hull } = loaded.stated()?;
    let mut warnings = Vec::new();
    for warning in loaded.hull_warnings(hull.as_ref()) {
        warn(&mut warnings, warning);
    }
    let staging = Staging::begin(&args.out)?;
    staging.remove_on_interrupt();
    let started = Instant::now();
    let solution = solve_with_progress(&loaded, &problem, global)?;
    let seconds = started.elapsed().as_secs_f64();
    loaded.fine_enough(hull.as_ref(), &solution)?;
    if let Some(warning) = summary::beyond_ice(&problem, &solution) {
        warn(&mut warnings, warning);
    }
    let pressed = Pressed {
        loaded,
        problem,
        hull,
        solution,
        seconds,
        warnings,
    };
    let document = result::document(&pressed);
    write_files(&staging, &pressed, &document)?;
    staging.commit()?;
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&summary::text(&pressed, &args.out));
    }
    Ok(())
}

/// Says a warning at once, and keeps it for the result.
fn warn(warnings: &mut Vec<String>, warning: String) {
    eprintln!("kufe: warning: {warning}");
    warnings.push(warning);
}

fn solve_with_progress(
    loaded: &LoadedCase,
    problem: &Problem,
    global: &Global,
) -> Result<Solution, Failure> {
    let bar = global.progress();
    let shown = bar.clone();
    let options = Options {
        p_max_tolerance: loaded.case.accuracy.p_max,
        progress: Some(Arc::new(move |state: &Iterate| {
            shown.set_message(summary::progress_line(state));
        })),
        ..Options::default()
    };
    let solved = solve(problem, &options);
    bar.finish_and_clear();
    solved.map_err(|error| loaded.failure(&error))
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
