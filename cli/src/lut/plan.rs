//! `kufe lut plan`, `run` and `merge`: a table in shards.

use std::path::{Path, PathBuf};
use std::time::Instant;

use kufe::jobs::{
    Failure, Watch,
    table::{Solver, Wanted},
};
use kufe_lut::{Error, Manifest, Next, Origin, Store, next_batch, parallel_script, slurm_script};

use crate::lut::export::{Forms, write_table};
use crate::lut::finish::{Spent, finish};
use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::say::{say, warn};
use crate::output::watched::watched;

/// The files of a plan's folder.
const PLAN_FILES: [&str; 3] = ["plan.json", "slurm.sh", "parallel.sh"];

/// Arguments of `kufe lut plan`.
#[derive(clap::Args, Debug)]
pub struct PlanArgs {
    /// The table file
    table: PathBuf,
    /// Folder for the plan and its results
    #[arg(long, short, value_name = "FOLDER")]
    out: PathBuf,
    /// Into how many parts, called shards, the scripts cut the points
    #[arg(long, default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    shards: u32,
}

/// Arguments of `kufe lut run`.
#[derive(clap::Args, Debug)]
pub struct RunArgs {
    /// The plan's folder
    plan: PathBuf,
    /// Which shard of how many, 1/N to N/N
    #[arg(long, value_name = "I/N", value_parser = shard_word)]
    shard: (usize, usize),
}

/// Arguments of `kufe lut merge`.
#[derive(clap::Args, Debug)]
pub struct MergeArgs {
    /// The plan's folder
    plan: PathBuf,
    /// Where the table goes
    #[arg(long, short, value_name = "FILE")]
    out: PathBuf,
    #[command(flatten)]
    forms: Forms,
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
/// [`Failure::BadInput`] for files, and where the folder holds results of another version or case.
pub fn plan(args: &PlanArgs, global: &Global) -> Result<(), Failure> {
    let wanted = Wanted::read(&args.table)?;
    let solver = solver(&wanted)?;
    let origin = solver.origin();
    let file = args.out.join("plan.json");
    let is_own = file.exists();
    if is_own {
        let old = Manifest::read(&file).map_err(Failure::bad_input)?;
        same_origin(&file, &old.origin, &origin)?;
    }
    let outputs = PLAN_FILES.map(|name| args.out.join(name));
    let inputs = solver.inputs(&wanted)?;
    let files = OutputFiles::begin("lut plan", &inputs, &outputs, is_own || global.force)?;
    let table = args
        .table
        .canonicalize()
        .map_err(|error| Failure::BadInput(format!("{}: {error}", args.table.display())))?;
    let store = open_store(&args.out, origin)?;
    match next_batch(&wanted.plan, &store).map_err(Failure::bad_input)? {
        Next::Points { points, round, .. } => {
            let manifest = Manifest {
                origin: store.origin().clone(),
                table: table.display().to_string(),
                round,
                shards: args.shards as usize,
                points,
            };
            write_plan(&args.out, &manifest, files)?;
            tell_plan(&args.out, &manifest, global);
        }
        Next::Finished(_) => {
            if !global.quiet {
                say(&format!(
                    "nothing to solve: {} is complete, merge it\n",
                    args.out.display()
                ));
            }
        }
    }
    Ok(())
}

/// Solves the points of one shard that have no result.
///
/// # Errors
/// [`Failure::BadInput`] where plan, case or results do not belong together; as [`Solver::solve_missing`].
pub fn run(args: &RunArgs, global: &Global) -> Result<(), Failure> {
    let (manifest, solver, store, _) = open_plan(&args.plan)?;
    let (index, count) = args.shard;
    let points = manifest.shard(index, count).map_err(Failure::bad_input)?;
    let label = format!("round {}, shard {index}/{count}", manifest.round);
    let solved = watched(global, |watch| {
        solver.solve_missing(&store, points, &label, watch)
    })?;
    let kept = points.len() - solved;
    if global.json {
        let report =
            serde_json::json!({ "shard": index, "of": count, "solved": solved, "kept": kept });
        say(&format!("{report}\n"));
    } else if !global.quiet {
        say(&format!(
            "shard {index}/{count}: {solved} points solved, {kept} were there\n"
        ));
    }
    Ok(())
}

/// Puts the results together, or plans the next round of a table that is refined to a tolerance.
///
/// # Errors
/// [`Failure::Partial`] where points are missing or a further round is needed; [`Failure::BadInput`] naming the
/// damaged or foreign file; [`Failure::NotConverged`] as for a table made in one process.
pub fn merge(args: &MergeArgs, global: &Global) -> Result<(), Failure> {
    let started = Instant::now();
    let (manifest, solver, store, wanted) = open_plan(&args.plan)?;
    let mut inputs = solver.inputs(&wanted)?;
    inputs.extend(PLAN_FILES.map(|name| args.plan.join(name)));
    let mut outputs = args.forms.paths(&args.out);
    outputs.push(args.out.clone());
    let files = OutputFiles::begin("lut merge", &inputs, &outputs, global.force)?;
    match next_batch(&wanted.plan, &store).map_err(Failure::bad_input)? {
        Next::Finished(mut swept) => {
            swept.table.case = solver.case();
            write_table(&swept.table, &args.out, &files)?;
            let written = args.forms.write(&swept.table, &args.out, &files)?;
            files.commit()?;
            let seconds = started.elapsed().as_secs_f64();
            finish(
                &swept,
                solver.tolerance(),
                &args.out,
                &written,
                Spent { solves: 0, seconds },
                global,
            )
        }
        Next::Points {
            points,
            round,
            missing,
            first,
        } => {
            if round <= manifest.round {
                return Err(Failure::Partial(
                    Error::Incomplete {
                        folder: args.plan.display().to_string(),
                        missing,
                        planned: points.len(),
                        first: first.to_string(),
                    }
                    .to_string(),
                ));
            }
            let next = Manifest {
                round,
                points,
                ..manifest
            };
            let outputs = PLAN_FILES.map(|name| args.plan.join(name));
            let files = OutputFiles::begin("lut plan", &[], &outputs, true)?;
            write_plan(&args.plan, &next, files)?;
            Err(Failure::Partial(format!(
                "{}: round {round} is planned with {} points where the interpolation is not good enough yet; run the \
                 shards again, then merge",
                args.plan.display(),
                next.points.len()
            )))
        }
    }
}

fn open_plan(folder: &Path) -> Result<(Manifest, Solver, Store, Wanted), Failure> {
    let file = folder.join("plan.json");
    let manifest = Manifest::read(&file).map_err(Failure::bad_input)?;
    let wanted = Wanted::read(Path::new(&manifest.table))?;
    let solver = solver(&wanted)?;
    let origin = solver.origin();
    same_origin(&file, &manifest.origin, &origin)?;
    let store = open_store(folder, origin)?;
    Ok((manifest, solver, store, wanted))
}

fn solver(wanted: &Wanted) -> Result<Solver, Failure> {
    let watch = Watch {
        warn: Some(&warn),
        ..Watch::default()
    };
    Solver::new(wanted, &watch)
}

fn same_origin(file: &Path, planned: &Origin, now: &Origin) -> Result<(), Failure> {
    for (what, planned, now) in [
        ("version", &planned.version, &now.version),
        ("case_sha256", &planned.case_sha256, &now.case_sha256),
    ] {
        if planned != now {
            return Err(Failure::BadInput(format!(
                "{}: {what} is {planned}, that of this program and case is {now}: expected the same; plan into a new folder",
                file.display()
            )));
        }
    }
    Ok(())
}

fn open_store(folder: &Path, origin: Origin) -> Result<Store, Failure> {
    Store::open(&folder.join("points"), origin).map_err(Failure::bad_input)
}

fn write_plan(folder: &Path, manifest: &Manifest, files: OutputFiles) -> Result<(), Failure> {
    files.draw(&folder.join("plan.json"), |path| {
        manifest.write(path).map_err(Failure::bad_input)
    })?;
    let unusable =
        |error: std::io::Error| Failure::BadInput(format!("{}: {error}", folder.display()));
    let place = folder.canonicalize().map_err(unusable)?;
    let kufe = std::env::current_exe().map_err(unusable)?;
    let shards = manifest.shards;
    let slurm = slurm_script(&kufe, &place, shards);
    files.write(&folder.join("slurm.sh"), |writer| {
        writer.write_all(slurm.as_bytes())
    })?;
    let parallel = parallel_script(&kufe, &place, shards);
    files.write(&folder.join("parallel.sh"), |writer| {
        writer.write_all(parallel.as_bytes())
    })?;
    files.commit()
}

fn tell_plan(folder: &Path, manifest: &Manifest, global: &Global) {
    let folder = folder.display();
    if global.json {
        let report = serde_json::json!({
            "round": manifest.round, "points": manifest.points.len(), "shards": manifest.shards
        });
        say(&format!("{report}\n"));
    } else if !global.quiet {
        say(&format!(
            "{folder}: round {}, {} points in {} shards\n  \
             Slurm          sbatch --wait {folder}/slurm.sh\n  \
             GNU parallel   sh {folder}/parallel.sh\n  \
             then           kufe lut merge {folder} -o TABLE.lut\n",
            manifest.round,
            manifest.points.len(),
            manifest.shards
        ));
    }
}
