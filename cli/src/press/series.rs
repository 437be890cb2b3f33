//! A series: lists of loads, radii and tilts; each combination is solved in its own folder, and
//! listed in one table.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

use kufe::jobs::field::write_contact;
use kufe::jobs::{Failure, Step, Watch, case_file::LoadedCase, time_left};
use kufe::report::{MAX_CONTACTS, read_json};
use kufe::results::{ContactResult, SeriesRow, VariedKeys, write_csv};
use kufe_contact::Options;
use kufe_mesh::write_pvd;

use crate::output::{OutputDir, case_inputs, listed, remove_outputs};
use crate::press::Args;
use crate::terminal::Global;
use crate::text::table_text;

/// Largest size of a result.json: 3 kB, and the points that its case lists [bytes].
const MAX_BYTES: u64 = 1 << 22;

/// The columns that are printed.
const COLUMNS: [&str; 10] = [
    "folder",
    "rocker_radius_m",
    "radius_m",
    "pitch_rad",
    "roll_rad",
    "fz_n",
    "p_max_pa",
    "length_m",
    "width_m",
    "error",
];

/// A series to solve.
struct Series<'a> {
    args: &'a Args,
    /// Digest of the case's files: [`LoadedCase::content`].
    content: String,
    /// The case and its files.
    inputs: Vec<PathBuf>,
    /// Whether files that kufe did not write may be replaced.
    force: bool,
    options: &'a Options,
}

/// Solves every combination into its own folder; valid results in the output folder are reused.
///
/// A step that does not reach its accuracy is reported in the table, and the others are solved.
///
/// # Errors
/// [`Failure::BadInput`] for an invalid combination, before anything is solved;
/// [`Failure::Partial`] if some steps are missing, after an interrupt or without the requested
/// accuracy; [`Failure::NotConverged`] if no step reaches the accuracy.
pub fn run(
    args: &Args,
    loaded: &LoadedCase,
    global: &Global,
    options: &Options,
) -> Result<(), Failure> {
    let count = args.lists.count();
    if count > MAX_CONTACTS {
        return Err(Failure::Usage(format!(
            "{count} combinations: expected at most {MAX_CONTACTS}"
        )));
    }
    let steps = Step::of(args.lists.combinations(), loaded, options)?;
    let series = Series {
        args,
        content: loaded.content()?,
        inputs: case_inputs(args.case.as_deref(), loaded)?,
        force: global.force,
        options,
    };
    let output = OutputDir::prepare("press (series)", &series.inputs, &args.out, global.force)?;
    output.record()?;
    let finished: Vec<_> = steps.iter().map(|step| series.finished(step)).collect();
    // Refused before the first step is solved.
    let missing = steps.iter().zip(&finished);
    let mut missing = missing.filter(|(_, found)| found.is_none());
    missing.try_for_each(|(step, _)| series.output_of(step).map(|_| ()))?;
    remove_other_steps(&args.out, &steps);
    let mut rows = Vec::new();
    let solved = global.watched(|watch| series.solve(&steps, &finished, watch, &mut rows));
    write_overview(&output, &args.out, &rows, &args.lists, steps.len())?;
    let written = output.commit()?;
    solved?;
    let text = table_text(&rows, &COLUMNS)?;
    let steps_text = match finished.iter().flatten().count() {
        0 => format!("{} steps\n", rows.len()),
        retained => format!("{} steps, {retained} of them there already\n", rows.len()),
    };
    global.print(&rows, || text + &steps_text + &listed(&args.out, &written))?;
    let mut short = rows.iter().filter_map(|row| row.error.as_deref());
    let done = rows.len() - short.clone().count();
    ending(
        [done, rows.len(), steps.len()],
        short.next_back(),
        &args.out,
    )
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

/// Outcome of a series of `steps` steps, of which `tried` were attempted and `done` were solved
/// accurately; `short` is the last reason for insufficient accuracy.
fn ending(
    [done, tried, steps]: [usize; 3],
    short: Option<&str>,
    out: &Path,
) -> Result<(), Failure> {
    match short {
        Some(text) if done == 0 && tried == steps => Err(Failure::NotConverged(text.to_owned())),
        _ if done == steps => Ok(()),
        _ => Err(Failure::Partial(format!(
            "{}: {done} of {steps} steps are solved and written; the same command resumes",
            out.display()
        ))),
    }
}

/// Progress message while the step `number` is solved. `remaining` steps including this one are not
/// yet solved; `took` are the times of the solved steps [s].
fn progress(number: usize, steps: usize, remaining: usize, took: &[f64]) -> String {
    // A single step gives no range.
    let known = took.iter().copied().filter(|_| took.len() > 1);
    let range = [f64::min, f64::max].map(|pick| known.clone().reduce(pick));
    let range = range.map(|each| each.map_or(f64::NAN, |each| remaining as f64 * each));
    let rest = time_left(range).map_or(String::new(), |time| format!(", {time}"));
    format!("step {number} of {steps}{rest}")
}

impl Series<'_> {
    /// The output folder of a step.
    fn output_of(&self, step: &Step) -> Result<OutputDir, Failure> {
        let folder = self.args.out.join(&step.folder);
        if folder.is_symlink() {
            let reason = "it is a link; expected a folder of the series";
            return Err(Failure::in_file(&folder, reason));
        }
        OutputDir::prepare("press", &self.inputs, &folder, self.force)
    }

    /// The valid result of a step that is in its folder already, with all requested files.
    fn finished(&self, step: &Step) -> Option<ContactResult> {
        let folder = self.args.out.join(&step.folder);
        if self.args.lists.fresh || folder.is_symlink() {
            return None;
        }
        let result: ContactResult = read_json(&folder.join("result.json"), MAX_BYTES).ok()?;
        (step.is_solved_by(&result, &self.content)
            && (!self.args.mat || folder.join("result.mat").is_file())
            && result.subsurface.is_some() == self.args.subsurface)
            .then_some(result)
    }

    /// Solves the steps without a `finished` result. Of warnings that differ only in their numbers,
    /// the first is printed.
    fn solve(
        &self,
        steps: &[Step],
        finished: &[Option<ContactResult>],
        watch: &Watch,
        rows: &mut Vec<SeriesRow>,
    ) -> Result<(), Failure> {
        let warned = Mutex::new(BTreeMap::new());
        let warn_once = |text: &str| {
            let without_digits: String = text.chars().filter(|c| !c.is_ascii_digit()).collect();
            let mut warned = warned.lock().unwrap_or_else(PoisonError::into_inner);
            let times: &mut usize = warned.entry(without_digits).or_default();
            *times += 1;
            if *times == 1 {
                watch.warn(text);
            }
        };
        let quieter = Watch {
            warn: Some(&warn_once),
            ..*watch
        };
        let mut took = Vec::new();
        for (k, (step, finished_step)) in steps.iter().zip(finished).enumerate() {
            if finished_step.is_some() {
                rows.push(step.row(finished_step.as_ref(), None));
                continue;
            }
            if watch.stopped() {
                // Later steps may have results of an earlier run.
                continue;
            }
            let remaining = finished[k..].iter().filter(|step| step.is_none()).count();
            watch.progress(&progress(step.number, steps.len(), remaining, &took));
            let begun = Instant::now();
            let (result, short) = match step.solve(&quieter, self.options) {
                Ok(pressed) => {
                    let output = self.output_of(step)?;
                    let result = write_contact(&output, &pressed, self.args.mat)?;
                    output.commit()?;
                    (Some(result), pressed.short.map(|why| why.to_string()))
                }
                Err(Failure::NotConverged(text)) => (None, Some(text)),
                Err(other) => return Err(other.within(&step.folder)),
            };
            let short = short.map(|text| format!("{}: {text}", step.folder));
            short.iter().for_each(|text| watch.warn(text));
            rows.push(step.row(result.as_ref(), short));
            took.push(begun.elapsed().as_secs_f64());
        }
        let warned = warned.lock().unwrap_or_else(PoisonError::into_inner);
        for times in warned.values().filter(|times| **times > 1) {
            let more = match times - 1 {
                1 => "one more step warns".to_owned(),
                more => format!("{more} more steps warn"),
            };
            watch.warn(&format!("{more} alike (`warnings` in result.json)"));
        }
        Ok(())
    }
}

/// Writes table.csv, table.json and series.pvd (runner.pvd for elastic runners) of the solved
/// steps.
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
        let rows = rows.iter().filter(|row| row.result.is_some());
        let rows = rows.filter(|row| out.join(&row.folder).join(file).exists());
        let entries = rows.map(|row| (times[row.step - 1], format!("{}/{file}", row.folder)));
        let entries: Vec<(f64, String)> = entries.collect();
        if !entries.is_empty() {
            let entries: Vec<(f64, &str)> = entries.iter().map(|(t, f)| (*t, f.as_str())).collect();
            output.write(name, |mut file| write_pvd(&entries, &mut file))?;
        }
    }
    Ok(())
}

/// Sets one of the keys that a series varies.
type SetKey = fn(&mut VariedKeys, f64);

/// The lists of a series; every combination is solved, and the load varies fastest.
#[derive(clap::Args, Clone, Debug, Default)]
pub struct Lists {
    /// Normal force [N], or several as 500,1000,2000: a series in folders of its own, with
    /// series.pvd and table.csv
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub fz_n: Vec<f64>,
    /// Track radius in the vertical plane [m], positive in a valley, inf on a straight; one or
    /// several
    #[arg(long, value_name = "LIST")]
    #[arg(value_delimiter = ',', allow_hyphen_values = true)]
    pub radius_m: Vec<f64>,
    /// Radius of the rocker [m], of a shape; one or several
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    pub rocker_radius_m: Vec<f64>,
    /// Fixed pitch angle [rad], positive lowers the nose; one or several
    #[arg(long, value_name = "LIST")]
    #[arg(value_delimiter = ',', allow_hyphen_values = true)]
    pub pitch_rad: Vec<f64>,
    /// Fixed roll angle [rad], positive lifts the left side; one or several
    #[arg(long, value_name = "LIST")]
    #[arg(value_delimiter = ',', allow_hyphen_values = true)]
    pub roll_rad: Vec<f64>,
    /// Solve steps again that have results in the output folder
    #[arg(long)]
    pub fresh: bool,
}

impl Lists {
    /// The lists with the keys that they set, the slowest varying first.
    fn all(&self) -> [(&[f64], SetKey); 5] {
        [
            (&self.rocker_radius_m, |keys, value| {
                keys.rocker_radius_m = Some(value)
            }),
            (&self.radius_m, |keys, value| {
                keys.radius_m = Some(value.into())
            }),
            (&self.pitch_rad, |keys, value| keys.pitch_rad = Some(value)),
            (&self.roll_rad, |keys, value| keys.roll_rad = Some(value)),
            (&self.fz_n, |keys, value| keys.fz_n = Some(value)),
        ]
    }

    /// Number of combinations; 1 without lists.
    pub fn count(&self) -> usize {
        let lengths = self.all().map(|(values, _)| values.len().max(1));
        lengths.iter().fold(1, |n: usize, &k| n.saturating_mul(k))
    }

    /// All combinations; the load varies fastest.
    pub fn combinations(&self) -> Vec<VariedKeys> {
        let mut combinations = vec![VariedKeys::default()];
        let lists = self.all().into_iter();
        for (values, set) in lists.filter(|(list, _)| !list.is_empty()) {
            let longer = combinations.iter().flat_map(|keys| {
                values.iter().map(|value| {
                    let mut keys = keys.clone();
                    set(&mut keys, *value);
                    keys
                })
            });
            combinations = longer.collect();
        }
        combinations
    }

    /// Times for ParaView: the values of a single increasing list, else 1, 2, 3 ...
    fn times(&self, count: usize) -> Vec<f64> {
        let lists = self.all().into_iter().map(|(list, _)| list);
        let several = lists.filter(|list| list.len() > 1);
        let several: Vec<&[f64]> = several.collect();
        let rises = |list: &[f64]| list.is_sorted_by(|a, b| a < b && b.is_finite());
        match several[..] {
            [only] if rises(only) && only[0].is_finite() => only.to_vec(),
            _ => (1..=count).map(|k| k as f64).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_series_ends_with_4_only_where_all_of_it_was_tried() {
        let ends = |counts, short: Option<&str>| ending(counts, short, Path::new("out"));
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
    fn a_long_series_shows_its_remaining_time() {
        assert_eq!(progress(2, 9, 8, &[5.0]), "step 2 of 9");
        assert_eq!(
            progress(3, 9, 7, &[5.0, 6.0]),
            "step 3 of 9, 35 to 42 s remaining"
        );
        assert_eq!(progress(3, 9, 7, &[0.01, 0.02]), "step 3 of 9");
    }
}
