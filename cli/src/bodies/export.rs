//! `kufe export`: a contact problem for another solver.

use std::path::{Path, PathBuf};

use kufe::case::StatedProblem;
use kufe::jobs::field::pretty;
use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe::results::RunnerResult;
use kufe_contact::{Foundation, Load, Mount, Options, Problem, Tilt, runner_loads, solve};
use serde::Serialize;

use crate::bodies::calculix::{Deck, write_deck};
use crate::bodies::stiffness::write_stiffness;
use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::paths::case_inputs;
use crate::output::say::say;

/// What a deck holds, and the contact on its mesh.
#[derive(Serialize)]
struct DeckFacts {
    deck: String,
    p_max_pa: f64,
    p_max_error_pa: f64,
    fz_n: f64,
    approach_m: f64,
    symmetry: [bool; 2],
    dofs: usize,
    iterations: usize,
    #[serde(flatten)]
    runner: Option<RunnerResult>,
}

/// Arguments of `kufe export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case
    pub case: PathBuf,
    /// Write an input deck of CalculiX, of an elastic runner held by its top or at places, level, on ice on a rigid bed
    #[arg(long, value_name = "FILE", conflicts_with = "stiffness")]
    pub calculix: Option<PathBuf>,
    /// Write the assembled stiffness of its bodies on the mesh that it is solved on, in Matrix Market form
    #[arg(long, value_name = "FILE")]
    pub stiffness: Option<PathBuf>,
    /// Cells across half the contact patch, instead of the accuracy that the case asks
    #[arg(long, value_name = "N")]
    pub cells: Option<usize>,
}

/// Solves the case, whose mesh the deck or the matrix is of, and writes it.
///
/// # Errors
/// Those of `kufe press`, and [`Failure::BadInput`] for a problem that the deck cannot state.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if args.cells.is_some_and(|cells| !(2..=64).contains(&cells)) {
        let found = args.cells.unwrap_or_default();
        return Err(Failure::Usage(format!("--cells {found}: expected 2 to 64")));
    }
    match (&args.calculix, &args.stiffness) {
        (Some(deck), _) => write_calculix(&args.case, deck, args.cells, global),
        (_, Some(matrix)) => write_stiffness(&args.case, matrix, args.cells, global),
        _ => Err(Failure::Usage(
            "expected --calculix or --stiffness with the file to write".into(),
        )),
    }
}

fn write_calculix(
    case: &Path,
    out: &Path,
    cells: Option<usize>,
    global: &Global,
) -> Result<(), Failure> {
    let loaded = LoadedCase::read(case)?;
    let StatedProblem { problem, .. } = loaded.stated()?;
    let refuse = |reason: &str| Failure::BadInput(format!("{}: {reason}", loaded.name));
    let inputs = case_inputs(Some(case), &loaded)?;
    let outputs = [out.to_path_buf()];
    let files = OutputFiles::begin("export", &inputs, &outputs, global.force)?;
    let mount = statable(&problem).map_err(&refuse)?;
    let bar = global.progress();
    bar.set_message("solving, for the mesh and the approach");
    let options = Options {
        cells,
        ..loaded.case.options()
    };
    let solved = solve(&problem, &options);
    bar.finish_and_clear();
    let solution = solved.map_err(|error| loaded.failure(&error))?;
    let (Some(runner), Some(elastic)) = (&solution.runner_volume, &problem.runner.elastic) else {
        return Err(refuse("expected elastic = true"));
    };
    let deck = Deck {
        title: format!("{}, by kufe {}", loaded.name, env!("CARGO_PKG_VERSION")),
        grid: &solution.volume.grid,
        ice: [problem.ice.youngs_modulus, problem.ice.poissons_ratio],
        runner: &runner.mesh,
        steel: [elastic.youngs_modulus, elastic.poissons_ratio],
        mount,
        symmetry: solution.symmetry,
        approach: solution.approach,
        half_width: 0.5 * solution.width,
        surface: &solution.surface,
    };
    files.write(out, |file| write_deck(&deck, file))?;
    files.commit()?;
    let loads = runner_loads(&problem, &solution).map_err(|error| loaded.failure(&error))?;
    let facts = DeckFacts {
        deck: out.display().to_string(),
        p_max_pa: solution.p_max,
        p_max_error_pa: solution.p_max_error,
        fz_n: solution.fz,
        approach_m: solution.approach,
        symmetry: solution.symmetry,
        dofs: solution.dofs,
        iterations: solution.iterations,
        runner: loads.as_ref().map(RunnerResult::from),
    };
    if global.json {
        say(&pretty(&facts)?);
    } else if !global.quiet {
        say(&format!(
            "{}: {} unknowns; pressed in by {:.4} µm they bear {:.3} N at a peak of {:.4} MPa here\n",
            out.display(),
            solution.dofs,
            1e6 * solution.approach,
            solution.fz,
            1e-6 * solution.p_max
        ));
    }
    Ok(())
}

/// The mount of a problem that a deck can state, or why it cannot.
fn statable(problem: &Problem) -> Result<&Mount, &'static str> {
    let Some(elastic) = &problem.runner.elastic else {
        return Err("runner.elastic: expected true: the deck has two bodies");
    };
    if elastic.solid.is_some() {
        return Err(
            "runner.mesh: expected a shape or a hull: the deck takes the hexahedra on the ice's columns",
        );
    }
    if problem
        .runner
        .underside
        .extent()
        .iter()
        .any(|end| end.is_infinite())
    {
        return Err("runner.shape: expected a runner with ends");
    }
    if matches!(elastic.mount, Mount::Loads(_)) {
        return Err("runner.mount: expected held places, or the whole top");
    }
    if !matches!(problem.ice.foundation, Foundation::RigidBed { .. }) {
        return Err("ice.thickness_m: expected a layer on a rigid bed");
    }
    if problem.ice.hardness.is_some() {
        return Err("ice.hardness_pa: expected elastic ice");
    }
    if problem.track_curvature != 0.0 {
        return Err("track: expected a flat one");
    }
    match problem.load {
        Load::Force { tilt, .. } if tilt == Tilt::LEVEL => Ok(&elastic.mount),
        _ => Err("load.tilt: expected \"fixed\" with no pitch and no roll"),
    }
}
