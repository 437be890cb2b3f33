//! Several solves in one command: lists of loads, radii and tilts.

use std::path::{Path, PathBuf};
use std::time::SystemTime;

use kufe_case::TiltWord;
use kufe_contact::Options;
use kufe_jobs::case_file::LoadedCase;
use kufe_jobs::{Pressed, Watch, case_json, press_with};
use kufe_mesh::write_pvd;
use serde_json::Value;

use super::series_table::{Row, write_table};
use super::{Args, solved_document, summary};
use crate::failure::Failure;
use crate::output::{Global, say, write_whole};
use crate::staging::Staging;
use crate::watched::watched;

/// The lists of a series; every combination is solved, the load running fastest.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Lists {
    /// Normal forces [N], as 500,1000,2000: a series in folders of its own, with series.pvd and table.csv
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fz_n: Vec<f64>,
    /// Track radii in the vertical plane [m], inf for a straight
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    radius_m: Vec<f64>,
    /// Rocker radii of a shape [m]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    rocker_radius_m: Vec<f64>,
    /// Fixed pitch angles [rad], positive lowers the nose
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pitch_rad: Vec<f64>,
    /// Fixed roll angles [rad]
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    roll_rad: Vec<f64>,
    /// Solve steps again that the output folder already holds
    #[arg(long)]
    fresh: bool,
}

impl Lists {
    /// Whether there is any list.
    pub fn is_series(&self) -> bool {
        self.named().iter().any(|(_, values)| !values.is_empty())
    }

    /// The lists, the one that runs slowest first.
    fn named(&self) -> [(&'static str, &[f64]); 5] {
        [
            ("rocker_radius_m", &self.rocker_radius_m),
            ("radius_m", &self.radius_m),
            ("pitch_rad", &self.pitch_rad),
            ("roll_rad", &self.roll_rad),
            ("fz_n", &self.fz_n),
        ]
    }

    /// Every combination, as pairs of key and value.
    fn steps(&self) -> Vec<Vec<(&'static str, f64)>> {
        let mut steps: Vec<Vec<(&'static str, f64)>> = vec![Vec::new()];
        for (key, values) in self.named().into_iter().filter(|(_, v)| !v.is_empty()) {
            steps = steps
                .iter()
                .flat_map(|step| {
                    values.iter().map(move |&value| {
                        let mut longer = step.clone();
                        longer.push((key, value));
                        longer
                    })
                })
                .collect();
        }
        steps
    }

    /// Times for ParaView: the values themselves where one list rises, else 1, 2, 3 ...
    fn times(&self, count: usize) -> Vec<f64> {
        let lists: Vec<&[f64]> = self
            .named()
            .into_iter()
            .map(|(_, values)| values)
            .filter(|values| values.len() > 1)
            .collect();
        match lists[..] {
            [only]
                if only.windows(2).all(|w| w[0] < w[1]) && only.iter().all(|v| v.is_finite()) =>
            {
                only.to_vec()
            }
            _ => (1..=count).map(|k| k as f64).collect(),
        }
    }
}

/// One step of a series.
struct Step {
    values: Vec<(&'static str, f64)>,
    folder: String,
    loaded: LoadedCase,
}

/// Largest number of steps, so that a slip of the hand does not fill the disk.
const MOST: usize = 10_000;

/// Solves every combination into a folder of its own; what the output folder holds already stays.
///
/// A step that stops short of its accuracy is told in the table and the others go on.
///
/// # Errors
/// [`Failure::BadInput`] for a combination that is no case, before anything is solved; [`Failure::Partial`] where steps are
/// missing at the end, by an interrupt or short of their accuracy; [`Failure::NotConverged`] where all are.
pub fn run(
    args: &Args,
    loaded: &LoadedCase,
    global: &Global,
    options: &Options,
) -> Result<(), Failure> {
    let steps = steps(&args.lists, loaded)?;
    let mut rows = Vec::new();
    let solved = watched(global, |watch| {
        solve_steps(args, &steps, watch, options, &mut rows)
    });
    write_overview(&args.out, &rows, &args.lists, steps.len())?;
    let (kept, short) = solved?;
    let document = super::series_table::document(&rows);
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&summary::series(&rows, kept, &args.out));
    }
    let done = rows.iter().filter(|row| row.result.is_some()).count();
    match short {
        Some(text) if done == 0 => Err(Failure::NotConverged(text)),
        _ if done == steps.len() => Ok(()),
        _ => Err(Failure::Partial(format!(
            "{}: {done} of {} steps are solved and kept; the same command resumes",
            args.out.display(),
            steps.len()
        ))),
    }
}

/// Solves what the output folder does not hold; returns how many steps it held, and what fell short last.
fn solve_steps(
    args: &Args,
    steps: &[Step],
    watch: &Watch,
    options: &Options,
    rows: &mut Vec<Row>,
) -> Result<(usize, Option<String>), Failure> {
    let (mut kept, mut short) = (0, None);
    for (k, step) in steps.iter().enumerate() {
        let row = |result: Option<Value>, error: Option<String>| Row {
            step: k + 1,
            folder: step.folder.clone(),
            values: step.values.clone(),
            result,
            error,
        };
        let folder = args.out.join(&step.folder);
        if let Some(result) = finished(&folder, step, args) {
            kept += 1;
            rows.push(row(Some(result), None));
            continue;
        }
        if watch.stopped() {
            // Later steps may be there from an earlier run.
            continue;
        }
        watch.progress(&format!("step {} of {}", k + 1, steps.len()));
        match press_with(step.loaded.clone(), watch, options.clone()) {
            Ok(pressed) => rows.push(row(Some(write_step(&folder, &pressed, args)?), None)),
            Err(Failure::NotConverged(text)) => {
                let text = format!("{}: {text}", step.folder);
                watch.warn(&text);
                rows.push(row(None, Some(text.clone())));
                short = Some(text);
            }
            Err(other) => return Err(prefixed(other, &step.folder)),
        }
    }
    Ok((kept, short))
}

fn prefixed(failure: Failure, folder: &str) -> Failure {
    match failure {
        Failure::BadInput(text) => Failure::BadInput(format!("{folder}: {text}")),
        other => other,
    }
}

/// The cases of all combinations, each checked before anything is solved.
fn steps(lists: &Lists, loaded: &LoadedCase) -> Result<Vec<Step>, Failure> {
    let combinations = lists.steps();
    if combinations.len() > MOST {
        return Err(Failure::Usage(format!(
            "{} combinations: expected at most {MOST}",
            combinations.len()
        )));
    }
    let digits = combinations.len().to_string().len().max(3);
    combinations
        .into_iter()
        .enumerate()
        .map(|(k, values)| {
            let mut loaded = loaded.clone();
            for &(key, value) in &values {
                set(&mut loaded, key, value)?;
            }
            loaded
                .case
                .check()
                .map_err(|error| Failure::BadInput(format!("{}: {error}", loaded.name)))?;
            Ok(Step {
                values,
                folder: format!("step-{:0digits$}", k + 1),
                loaded,
            })
        })
        .collect()
}

fn set(loaded: &mut LoadedCase, key: &str, value: f64) -> Result<(), Failure> {
    let case = &mut loaded.case;
    match key {
        "fz_n" => case.load.fz_n = value,
        "radius_m" => {
            case.track.curvature_1pm = None;
            case.track.radius_m = Some(value);
        }
        "pitch_rad" => {
            case.load.tilt = TiltWord::Fixed;
            case.load.pitch_rad = Some(value);
        }
        "roll_rad" => {
            case.load.tilt = TiltWord::Fixed;
            case.load.roll_rad = Some(value);
        }
        _ => match &mut case.runner.shape {
            Some(shape) => *shape.rocker_radius_m() = value,
            None => {
                return Err(Failure::BadInput(format!(
                    "{}: --rocker-radius-m: the runner is a hull, expected a shape with a rocker radius",
                    loaded.name
                )));
            }
        },
    }
    Ok(())
}

/// The result in a step's folder, where it is this step's: of this version and case, with what is asked, and younger than
/// the files that the case names.
fn finished(folder: &Path, step: &Step, args: &Args) -> Option<Value> {
    if args.lists.fresh {
        return None;
    }
    let path = folder.join("result.json");
    let age = |path: PathBuf| -> Option<SystemTime> { path.metadata().ok()?.modified().ok() };
    let written = age(path.clone())?;
    let result: Value = serde_json::from_slice(&std::fs::read(path).ok()?).ok()?;
    let current = step
        .loaded
        .case
        .files()
        .iter()
        .all(|file| age(step.loaded.base.join(file)).is_some_and(|changed| changed < written));
    (current
        && result["version"] == env!("CARGO_PKG_VERSION")
        && result["case"] == case_json(&step.loaded.case)
        && result.get("subsurface").is_some() == args.subsurface)
        .then_some(result)
}

/// Writes one step's files, all or none.
fn write_step(folder: &Path, pressed: &Pressed, args: &Args) -> Result<Value, Failure> {
    let staging = Staging::begin(folder)?;
    let (document, line) = solved_document(pressed, args.subsurface)?;
    super::files::write(&staging, pressed, &document, line.as_ref())?;
    staging.commit()?;
    Ok(document)
}

/// Writes table.csv, table.json and series.pvd (runner.pvd where runners deform) over the steps that are solved.
fn write_overview(out: &Path, rows: &[Row], lists: &Lists, count: usize) -> Result<(), Failure> {
    write_table(out, rows)?;
    let times = lists.times(count);
    for (name, file) in [("series.pvd", "field.vtu"), ("runner.pvd", "runner.vtu")] {
        let entries: Vec<(f64, String)> = rows
            .iter()
            .filter(|row| row.result.is_some() && out.join(&row.folder).join(file).exists())
            .map(|row| (times[row.step - 1], format!("{}/{file}", row.folder)))
            .collect();
        if !entries.is_empty() {
            let entries: Vec<(f64, &str)> = entries.iter().map(|(t, f)| (*t, f.as_str())).collect();
            write_whole(&out.join(name), |writer| write_pvd(&entries, writer))?;
        }
    }
    Ok(())
}
