//! `kufe lut plan`, `run` and `merge`: fill a table in shards, for example on a cluster.

use std::path::{Path, PathBuf};
use std::time::Instant;

use kufe::jobs::{
    Failure, Located, Watch,
    case_file::LoadedCase,
    table::{PlanFile, PointStore, Solver, TableSpec},
};
use kufe_lut::{Origin, Progress, replay, shell_word};
use serde::Serialize;

use crate::lut::export::Forms;
use crate::lut::fill::finish;
use crate::output::OutputFiles;
use crate::terminal::{Global, say, warn};

/// Arguments of `kufe lut plan`.
#[derive(clap::Args, Debug)]
pub struct PlanArgs {
    /// The table file
    table: PathBuf,
    /// Folder for the plan and its results
    #[arg(long, short, value_name = "FOLDER")]
    out: PathBuf,
    /// Number of shards, parts into which the points are divided
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
}

/// Arguments of `kufe lut run`.
#[derive(clap::Args, Debug)]
pub struct RunArgs {
    /// The plan's folder
    plan: PathBuf,
    /// The shard to solve, from 1/N to N/N
    #[arg(long, value_name = "I/N", value_parser = shard_word)]
    shard: (usize, usize),
}

/// Arguments of `kufe lut merge`.
#[derive(clap::Args, Debug)]
pub struct MergeArgs {
    /// The plan's folder
    plan: PathBuf,
    /// File of the table
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    forms: Forms,
}

/// A plan that was written.
#[derive(Clone, Copy, Serialize)]
struct Planned {
    round: usize,
    points: usize,
    shards: usize,
}

/// A shard of which every point has a result.
#[derive(Clone, Copy, Serialize)]
struct ShardSolved {
    shard: usize,
    of: usize,
    /// Points that were solved now.
    solved: usize,
    /// Points that had a result before.
    #[serde(rename = "kept")]
    retained: usize,
}

fn shard_word(word: &str) -> Result<(usize, usize), String> {
    let parts = word.split_once('/');
    let numbers = parts.and_then(|(i, n)| Some((i.parse().ok()?, n.parse().ok()?)));
    match numbers {
        Some((index, count)) if 1 <= index && index <= count && count <= 1 << 20 => {
            Ok((index, count))
        }
        _ => Err("expected I/N with I from 1 to N, as in 3/16".into()),
    }
}

/// Writes plan.json and the scripts that run its shards.
///
/// # Errors
/// [`Failure::BadInput`] for files, and if the folder contains results of another version or case.
pub fn plan(args: &PlanArgs, global: &Global) -> Result<(), Failure> {
    let spec = TableSpec::read(&args.table)?;
    let solver = solver(&spec)?;
    let origin = solver.origin()?;
    let outputs = plan_files(&args.out);
    if outputs[0].exists() {
        same_origin(&outputs[0], &PlanFile::read(&args.out)?.origin, &origin)?;
    }
    let inputs = solver.inputs(&spec)?;
    let files = OutputFiles::begin("lut plan", &inputs, &outputs, global.force)?;
    let table = args.table.canonicalize().in_file(&args.table)?;
    let store = open_store(&args.out, "none", origin.clone())?;
    let progress = replay(&spec.plan, |point| store.get(point));
    let Progress::Batch { points, round, .. } = progress? else {
        let out = args.out.display();
        if !global.quiet {
            say(&format!("nothing to solve: {out} is complete, merge it\n"));
        }
        return Ok(());
    };
    let (table, shards) = (table.display().to_string(), args.shards as usize);
    let plan = PlanFile::new(origin, table, round, shards, points);
    write_plan(&args.out, &plan, files)?;
    let planned = Planned {
        round,
        points: plan.points.len(),
        shards,
    };
    let [_, slurm, parallel] = PlanFile::NAMES.map(|name| shell_word(&args.out.join(name)));
    let (slurm, parallel, word) = (slurm?, parallel?, shell_word(&args.out)?);
    global.print(&planned, || {
        let (folder, points) = (args.out.display(), planned.points);
        format!(
            "{folder}: round {round}, {points} points in {shards} shards\n  \
             Slurm          sbatch --wait {slurm}\n  \
             GNU parallel   sh {parallel}\n  \
             then           kufe lut merge {word} -o TABLE.lut\n"
        )
    })
}

/// Solves the points of one shard that have no result.
///
/// # Errors
/// [`Failure::BadInput`] if plan, case or results do not belong together; otherwise as
/// [`Solver::solve_missing`].
pub fn run(args: &RunArgs, global: &Global) -> Result<(), Failure> {
    let (plan, solver, _) = open_plan(&args.plan)?;
    let (shard, of) = args.shard;
    let points = plan.shard(shard, of)?;
    let name = format!("shard-{shard}-of-{of}");
    let store = open_store(&args.plan, &name, plan.origin.clone())?;
    for damage in store.damaged() {
        warn(&format!("{damage}; its point is solved again"));
    }
    let label = format!("round {}, shard {shard}/{of}", plan.round);
    let solved = global.watched(|watch| solver.solve_missing(&store, points, &label, watch))?;
    let retained = points.len() - solved;
    let result = ShardSolved {
        shard,
        of,
        solved,
        retained,
    };
    global.print(&result, || {
        format!("shard {shard}/{of}: {solved} points solved, {retained} were there\n")
    })
}

/// Puts the results together, or plans the next round of a table that is refined to a tolerance.
///
/// # Errors
/// [`Failure::Partial`] if points are missing or a further round is needed;
/// [`Failure::BadInput`] with the damaged or foreign file; [`Failure::NotConverged`] as for a table
/// made in one process.
pub fn merge(args: &MergeArgs, global: &Global) -> Result<(), Failure> {
    let started = Instant::now();
    let (plan, solver, spec) = open_plan(&args.plan)?;
    let store = open_store(&args.plan, "none", plan.origin.clone())?;
    let mut inputs = solver.inputs(&spec)?;
    inputs.extend(plan_files(&args.plan));
    let mut outputs = args.forms.paths(&args.out);
    outputs.push(args.out.clone());
    let files = OutputFiles::begin("lut", &inputs, &outputs, global.force)?;
    let folder = args.plan.display();
    match replay(&spec.plan, |point| store.get(point))? {
        Progress::Finished(swept) => {
            let swept = solver.finished(*swept)?;
            let written = args.forms.commit(&swept.table, &args.out, files)?;
            let spent = (0, started.elapsed());
            finish(&swept, &solver, &args.out, &written, spent, global)
        }
        Progress::Batch {
            points,
            missing,
            first,
            round,
        } if round <= plan.round => {
            let count = points.len();
            let text = format!(
                "{missing} of {count} points of {folder} have no result yet, the first at {first}"
            );
            if store.damaged().is_empty() {
                return Err(Failure::Partial(text));
            }
            let damaged = store.damaged().join("; ");
            let text = format!("{damaged}; {text}: run the shards again");
            Err(Failure::BadInput(text))
        }
        Progress::Batch { points, round, .. } => {
            let next = PlanFile::new(plan.origin, plan.table, round, plan.shards, points);
            let outputs = plan_files(&args.plan);
            let files = OutputFiles::begin("lut plan", &[], &outputs, global.force)?;
            write_plan(&args.plan, &next, files)?;
            let count = next.points.len();
            Err(Failure::Partial(format!(
                "{folder}: round {round} is planned with {count} points where the interpolation is not accurate \
                 enough yet; run the shards again, then merge"
            )))
        }
    }
}

/// The files of a plan; the first is `plan.json`.
fn plan_files(folder: &Path) -> [PathBuf; 3] {
    PlanFile::NAMES.map(|name| folder.join(name))
}

fn open_plan(folder: &Path) -> Result<(PlanFile, Solver, TableSpec), Failure> {
    let plan = PlanFile::read(folder)?;
    let spec = TableSpec::read(Path::new(&plan.table))?;
    let solver = solver(&spec)?;
    same_origin(&plan_files(folder)[0], &plan.origin, &solver.origin()?)?;
    Ok((plan, solver, spec))
}

fn solver(spec: &TableSpec) -> Result<Solver, Failure> {
    let watch = Watch {
        warn: Some(&warn),
        ..Watch::default()
    };
    Solver::new(spec, LoadedCase::read(&spec.case)?, &watch)
}

fn same_origin(file: &Path, planned: &Origin, now: &Origin) -> Result<(), Failure> {
    kufe::jobs::table::same_origin(&file.display().to_string(), planned, now)
}

/// Reads the results of all shards. New results are appended to the file `name`.
fn open_store(folder: &Path, name: &str, origin: Origin) -> Result<PointStore, Failure> {
    PointStore::of_folder(&folder.join("points"), name, origin)
}

fn write_plan(folder: &Path, plan: &PlanFile, files: OutputFiles) -> Result<(), Failure> {
    for (name, text) in plan.files(folder)? {
        files.bytes(&folder.join(name), text.as_bytes())?;
    }
    files.commit()
}
