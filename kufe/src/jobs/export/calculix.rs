//! A case as an input deck of CalculiX, on the mesh that it is solved on.

use std::io::Write;
use std::path::Path;

use kufe_contact::{
    Foundation, Load, Mount, Options, Problem, Solution, Tilt, runner_loads, solve,
};
use serde::Serialize;

use crate::jobs::case_file::LoadedCase;
use crate::jobs::export::deck::{Deck, write_deck};
use crate::jobs::failure::Failure;
use crate::results::RunnerResult;

/// A solved case that a deck can state.
pub struct CalculixDeck<'a> {
    loaded: &'a LoadedCase,
    problem: Problem,
    solution: Solution,
}

/// The contents of a deck, and the contact on its mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeckResult {
    /// The deck's file.
    pub deck: String,
    /// Peak pressure [Pa].
    pub p_max_pa: f64,
    /// Its error [Pa].
    pub p_max_error_pa: f64,
    /// Integrated normal force [N].
    pub fz_n: f64,
    /// Approach [m].
    pub approach_m: f64,
    /// Mirror planes: y = 0 and x = 0.
    pub symmetry: [bool; 2],
    /// Unknowns.
    pub dofs: usize,
    /// Iterations.
    pub iterations: usize,
    /// Stress of the runner and the loads on its mount.
    #[serde(flatten)]
    pub runner: Option<RunnerResult>,
}

impl<'a> CalculixDeck<'a> {
    /// Solves a case with an elastic runner, mounted at its top or at places, level, on ice on a
    /// rigid bed; with `cells` across half the patch, else to the accuracy that the case requests.
    ///
    /// # Errors
    /// Those of the solver, and [`Failure::BadInput`] for a problem that the deck cannot state.
    pub fn solve(loaded: &'a LoadedCase, cells: Option<usize>) -> Result<Self, Failure> {
        let problem = loaded.stated()?.problem;
        let refuse = |reason: &str| Failure::BadInput(format!("{}: {reason}", loaded.name));
        check_statable(&problem).map_err(refuse)?;
        let options = Options {
            cells,
            ..loaded.case.options()
        };
        let solution = solve(&problem, &options).map_err(|error| loaded.failure(&error))?;
        Ok(CalculixDeck {
            loaded,
            problem,
            solution,
        })
    }

    /// Writes the deck.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, writer: impl Write) -> std::io::Result<()> {
        let (problem, solution) = (&self.problem, &self.solution);
        let bodies = (
            &solution.volume,
            &solution.runner_volume,
            &problem.runner.elastic,
        );
        let (Some(ice), Some(runner), Some(elastic)) = bodies else {
            unreachable!("the runner of a problem that a deck can state is elastic");
        };
        let deck = Deck {
            title: format!(
                "{}, by kufe {}",
                self.loaded.name.replace(char::is_control, " "),
                env!("CARGO_PKG_VERSION")
            ),
            grid: &ice.grid,
            ice: [problem.ice.youngs_modulus, problem.ice.poissons_ratio],
            runner: &runner.mesh,
            steel: [elastic.youngs_modulus, elastic.poissons_ratio],
            mount: &elastic.mount,
            symmetry: solution.symmetry,
            approach: solution.approach,
            half_width: 0.5 * solution.width,
            surface: &solution.surface,
        };
        write_deck(&deck, writer)
    }

    /// The contact on the deck's mesh; `path` is the deck's file.
    ///
    /// # Errors
    /// Those of the loads on the mount.
    pub fn result(&self, path: &Path) -> Result<DeckResult, Failure> {
        let solution = &self.solution;
        let loads = runner_loads(&self.problem, solution);
        let loads = loads.map_err(|error| self.loaded.failure(&error))?;
        Ok(DeckResult {
            deck: path.display().to_string(),
            p_max_pa: solution.p_max,
            p_max_error_pa: solution.p_max_error,
            fz_n: solution.fz,
            approach_m: solution.approach,
            symmetry: solution.symmetry,
            dofs: solution.dofs,
            iterations: solution.iterations,
            runner: loads.as_ref().map(RunnerResult::from),
        })
    }
}

/// Why a deck cannot state a problem.
fn check_statable(problem: &Problem) -> Result<(), &'static str> {
    let Some(elastic) = &problem.runner.elastic else {
        return Err("runner.elastic: expected true: the deck has two bodies");
    };
    if elastic.solid.is_some() {
        return Err(
            "runner.mesh: expected a shape or a hull: the deck takes the hexahedra on the ice's columns",
        );
    }
    let extent = problem.runner.underside.extent();
    if extent.iter().any(|end| end.is_infinite()) {
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
        Load::Force { tilt, .. } if tilt == Tilt::LEVEL => Ok(()),
        _ => Err("load.tilt: expected \"fixed\" with no pitch and no roll"),
    }
}
