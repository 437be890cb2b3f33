//! A series: lists of loads, radii and tilts, each combination solved in a folder of its own, and one
//! table of all.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Instant;

use kufe::case::TiltWord;
use kufe::jobs::field::{pretty, write_contact};
use kufe::jobs::{
    Failure, Prepared, SolvedContact, Watch, case_file::LoadedCase, press_prepared, time_left,
};
use kufe::results::{CaseRecord, ContactResult, SeriesRow, VariedKeys, write_csv};
use kufe_contact::{Options, check_problem};
use kufe_mesh::write_pvd;

use crate::output::folder::{OutputDir, remove_outputs};
use crate::output::global::Global;
use crate::output::paths::case_inputs;
use crate::output::say::say;
use crate::output::watched::watched;
use crate::press::command::Args;
use crate::press::summary;
use crate::report::read_json;

/// One step of a series.
struct Step {
    varied: VariedKeys,
    folder: String,
    loaded: LoadedCase,
    runner: Arc<Prepared>,
}

/// What a series is asked for, and what it is made from.
struct Asked<'a> {
    args: &'a Args,
    /// Of the case's files.
    content: String,
    /// The case and its files.
    inputs: Vec<PathBuf>,
    /// Whether files that kufe did not write may be replaced.
    force: bool,
}

/// Most bytes of a result.json.
const LONGEST: u64 = 1 << 22;

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
    let steps = steps(&args.lists, loaded, options)?;
    let asked = Asked {
        args,
        content: loaded.content()?,
        inputs: case_inputs(args.case.as_deref(), loaded)?,
        force: global.force,
    };
    let output = OutputDir::prepare("press (series)", &asked.inputs, &args.out, global.force)?;
    output.claim()?;
    for step in &steps {
        // Refused before the first step is solved.
        asked.output_of(step)?;
    }
    remove_other_steps(&args.out, &steps);
    let mut rows = Vec::new();
    let solved = watched(global, |watch| {
        solve_steps(&asked, &steps, watch, options, &mut rows)
    });
    write_overview(&output, &args.out, &rows, &args.lists, steps.len())?;
    output.commit()?;
    let (kept, short) = solved?;
    if global.json {
        say(&pretty(&rows)?);
    } else if !global.quiet {
        say(&summary::series(&rows, kept, &args.out));
    }
    let done = rows.iter().filter(|row| row.error.is_none()).count();
    ending([done, rows.len(), steps.len()], short, &args.out)
}

impl Asked<'_> {
    /// The output folder of a step.
    fn output_of(&self, step: &Step) -> Result<OutputDir, Failure> {
        let folder = self.args.out.join(&step.folder);
        OutputDir::prepare("press", &self.inputs, &folder, self.force)
    }
}

/// Removes the steps of an earlier series that this one does not have.
fn remove_other_steps(out: &Path, steps: &[Step]) {
    let entries = std::fs::read_dir(out).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let is_step = name.to_string_lossy().starts_with("step-");
        if is_step && !steps.iter().any(|step| name == step.folder.as_str()) {
            remove_outputs(&entry.path());
        }
    }
}

/// How a series ends of whose `steps` so many are `tried` and `done`; `short` says what fell short last.
fn ending(
    [done, tried, steps]: [usize; 3],
    short: Option<String>,
    out: &Path,
) -> Result<(), Failure> {
    match short {
        Some(text) if done == 0 && tried == steps => Err(Failure::NotConverged(text)),
        _ if done == steps => Ok(()),
        _ => Err(Failure::Partial(format!(
            "{}: {done} of {steps} steps are solved and kept; the same command resumes",
            out.display()
        ))),
    }
}

/// What is said while the `number`-th of the steps is solved and `left` are to be, that one among them, where those solved took so long each [s].
fn progress(number: usize, steps: usize, left: usize, took: &[f64]) -> String {
    // One step says nothing of how others differ from it.
    let known = took.iter().copied().filter(|_| took.len() > 1);
    let range = [f64::min, f64::max].map(|pick| known.clone().reduce(pick));
    let range = range.map(|each| each.map_or(f64::NAN, |each| left as f64 * each));
    let rest = time_left(range).map_or(String::new(), |time| format!(", {time}"));
    format!("step {number} of {steps}{rest}")
}

/// Solves what the output folder does not hold; returns how many steps it held, and what fell short last.
fn solve_steps(
    asked: &Asked,
    steps: &[Step],
    watch: &Watch,
    options: &Options,
    rows: &mut Vec<SeriesRow>,
) -> Result<(usize, Option<String>), Failure> {
    let (mut kept, mut short) = (0, None);
    let said = Mutex::new(BTreeMap::new());
    let once = |text: &str| {
        let mut said = said.lock().unwrap_or_else(PoisonError::into_inner);
        let times: &mut usize = said.entry(without_numbers(text)).or_default();
        *times += 1;
        if *times == 1 {
            watch.warn(text);
        }
    };
    let quieter = Watch {
        warn: Some(&once),
        ..*watch
    };
    let held = steps.iter().map(|step| {
        let folder = asked.args.out.join(&step.folder);
        finished(&folder, step, asked)
    });
    let held: Vec<Option<ContactResult>> = held.collect();
    let mut took = Vec::new();
    for (k, step) in steps.iter().enumerate() {
        let row = |result: Option<&ContactResult>, error: Option<String>| {
            let mut row = SeriesRow::new(k + 1, step.folder.clone(), step.varied.clone());
            row.result = result.map(Into::into);
            row.error = error;
            row
        };
        if let Some(result) = &held[k] {
            kept += 1;
            rows.push(row(Some(result), None));
            continue;
        }
        if watch.stopped() {
            // Later steps may be there from an earlier run.
            continue;
        }
        let left = held[k..].iter().filter(|held| held.is_none()).count();
        watch.progress(&progress(k + 1, steps.len(), left, &took));
        let begun = Instant::now();
        let loaded = step.loaded.clone();
        match press_prepared(loaded, &step.runner, &quieter, options.clone()) {
            Ok(pressed) => {
                let written = write_step(asked.output_of(step)?, &pressed, asked.args.mat)?;
                let told = pressed.short.map(|why| format!("{}: {why}", step.folder));
                if let Some(text) = &told {
                    watch.warn(text);
                    short.clone_from(&told);
                }
                rows.push(row(Some(&written), told));
            }
            Err(Failure::NotConverged(text)) => {
                let text = format!("{}: {text}", step.folder);
                watch.warn(&text);
                rows.push(row(None, Some(text.clone())));
                short = Some(text);
            }
            Err(other) => return Err(other.within(&step.folder)),
        }
        took.push(begun.elapsed().as_secs_f64());
    }
    let said = said.lock().unwrap_or_else(PoisonError::into_inner);
    for (_, times) in said.iter().filter(|(_, times)| **times > 1) {
        let more = match times - 1 {
            1 => "one more step warns".to_owned(),
            more => format!("{more} more steps warn"),
        };
        watch.warn(&format!("{more} alike (`warnings` in result.json)"));
    }
    Ok((kept, short))
}

/// A warning as the same one of another step has it.
fn without_numbers(text: &str) -> String {
    text.chars().filter(|c| !c.is_ascii_digit()).collect()
}

/// The cases of all combinations, each checked before anything is solved.
fn steps(lists: &Lists, loaded: &LoadedCase, options: &Options) -> Result<Vec<Step>, Failure> {
    let count = lists.count();
    if count > MOST {
        return Err(Failure::Usage(format!(
            "{count} combinations: expected at most {MOST}"
        )));
    }
    let combinations = lists.steps();
    let mut first = FirstStep::default();
    let digits = combinations.len().to_string().len().max(3);
    combinations
        .into_iter()
        .enumerate()
        .map(|(k, values)| {
            let mut loaded = loaded.clone();
            for &(key, value) in &values {
                set(&mut loaded, key, value)?;
            }
            let folder = format!("step-{:0digits$}", k + 1);
            let runner = first
                .check(&loaded, options)
                .map_err(|failure| failure.within(&folder))?;
            let mut varied = VariedKeys::default();
            values
                .iter()
                .for_each(|&(key, value)| record(&mut varied, key, value));
            Ok(Step {
                varied,
                folder,
                loaded,
                runner,
            })
        })
        .collect()
}

/// Notes the value of a varied key.
fn record(varied: &mut VariedKeys, key: &str, value: f64) {
    match key {
        "fz_n" => varied.fz_n = Some(value),
        "radius_m" => varied.radius_m = Some(value.into()),
        "pitch_rad" => varied.pitch_rad = Some(value),
        "roll_rad" => varied.roll_rad = Some(value),
        _ => varied.rocker_radius_m = Some(value),
    }
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

/// The result in a step's folder, where it is this step's: of this version and case, with the same content of the files that the
/// case names, and with what is asked.
fn finished(folder: &Path, step: &Step, asked: &Asked) -> Option<ContactResult> {
    if asked.args.lists.fresh {
        return None;
    }
    let result: ContactResult = read_json(&folder.join("result.json"), LONGEST).ok()?;
    (result.version == env!("CARGO_PKG_VERSION")
        && result.content_sha256 == asked.content
        && result.case == CaseRecord::of(&step.loaded.case)
        && result.accuracy_reached
        && (!asked.args.mat || folder.join("result.mat").is_file())
        && result.subsurface.is_some() == asked.args.subsurface)
        .then_some(result)
}

/// Writes one step's files, all or none.
fn write_step(
    output: OutputDir,
    pressed: &SolvedContact,
    mat: bool,
) -> Result<ContactResult, Failure> {
    let (result, _) = write_contact(output.files(), pressed, mat)?;
    output.commit()?;
    Ok(result)
}

/// Writes table.csv, table.json and series.pvd (runner.pvd where runners deform) over the steps that are solved.
fn write_overview(
    output: &OutputDir,
    out: &Path,
    rows: &[SeriesRow],
    lists: &Lists,
    count: usize,
) -> Result<(), Failure> {
    output.json("table.json", &rows)?;
    output.write("table.csv", |mut file| write_csv(&mut file, rows))?;
    let times = lists.times(count);
    for (name, file) in [("series.pvd", "field.vtu"), ("runner.pvd", "runner.vtu")] {
        let entries: Vec<(f64, String)> = rows
            .iter()
            .filter(|row| row.result.is_some() && out.join(&row.folder).join(file).exists())
            .map(|row| (times[row.step - 1], format!("{}/{file}", row.folder)))
            .collect();
        if !entries.is_empty() {
            let entries: Vec<(f64, &str)> = entries.iter().map(|(t, f)| (*t, f.as_str())).collect();
            output.write(name, |mut file| write_pvd(&entries, &mut file))?;
        }
    }
    Ok(())
}

/// What is kept between steps: a hull is read and fitted once.
#[derive(Default)]
pub struct FirstStep {
    hull: Option<Arc<Prepared>>,
}

impl FirstStep {
    /// Checks that a step's case states a problem that can be begun; its runner.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with what is wrong.
    pub fn check(
        &mut self,
        loaded: &LoadedCase,
        options: &Options,
    ) -> Result<Arc<Prepared>, Failure> {
        let prepared = match &self.hull {
            Some(hull) => hull.clone(),
            None => Arc::new(Prepared::of(loaded, &Watch::default())?),
        };
        let problem = prepared.problem(loaded)?;
        check_problem(&problem, options).map_err(|error| loaded.failure(&error))?;
        if loaded.case.runner.shape.is_none() {
            self.hull = Some(prepared.clone());
        }
        Ok(prepared)
    }
}

/// The lists of a series; every combination is solved, the load running fastest.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Lists {
    /// Normal force [N], or several as 500,1000,2000: a series in folders of its own, with series.pvd and table.csv
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub fz_n: Vec<f64>,
    /// Track radius in the vertical plane [m], positive in a valley, inf on a straight; one or several
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub radius_m: Vec<f64>,
    /// Radius of the rocker [m], of a shape; one or several
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub rocker_radius_m: Vec<f64>,
    /// Fixed pitch angle [rad], positive lowers the nose; one or several
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub pitch_rad: Vec<f64>,
    /// Fixed roll angle [rad], positive lifts the left side; one or several
    #[arg(
        long,
        value_name = "LIST",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    pub roll_rad: Vec<f64>,
    /// Solve steps again that the output folder already holds
    #[arg(long)]
    pub fresh: bool,
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

    /// How many combinations there are.
    pub fn count(&self) -> usize {
        let lengths = self.named().map(|(_, values)| values.len().max(1));
        lengths.iter().fold(1, |n: usize, &k| n.saturating_mul(k))
    }

    /// Every combination, as pairs of key and value.
    pub fn steps(&self) -> Vec<Vec<(&'static str, f64)>> {
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
    pub fn times(&self, count: usize) -> Vec<f64> {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_ends_with_4_only_where_all_of_it_was_tried() {
        let ends = |counts, short: Option<&str>| {
            ending(counts, short.map(str::to_owned), Path::new("out"))
        };
        assert!(ends([3, 3, 3], None).is_ok());
        let short = Some("step-001: 3 % of 1 %");
        assert!(matches!(
            ends([0, 3, 3], short),
            Err(Failure::NotConverged(_))
        ));
        for counts in [[0, 1, 3], [1, 3, 3], [2, 2, 3]] {
            assert!(matches!(ends(counts, short), Err(Failure::Partial(_))));
        }
    }

    #[test]
    fn a_long_series_says_about_when_it_ends() {
        assert_eq!(progress(2, 9, 8, &[5.0]), "step 2 of 9");
        assert_eq!(
            progress(3, 9, 7, &[5.0, 6.0]),
            "step 3 of 9, 35 to 42 s remaining"
        );
        assert_eq!(progress(3, 9, 7, &[0.01, 0.02]), "step 3 of 9");
    }
}
