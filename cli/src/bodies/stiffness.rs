//! The assembled stiffness of a case's bodies as a file.

use std::path::Path;

use kufe::case::StatedProblem;
use kufe::jobs::{Failure, case_file::LoadedCase};
use kufe_contact::{Options, Solution, StiffnessForm, solve};
use kufe_fem::write_matrix_market;
use serde_json::json;

use crate::output::file::OutputFiles;
use crate::output::global::Global;
use crate::output::paths::case_inputs;
use crate::output::say::say;

/// Numbers in a line of comments.
const A_LINE: usize = 12;

/// Solves the case with an assembled stiffness and writes that of the finest mesh.
///
/// # Errors
/// Those of `kufe press`, and [`Failure::BadInput`] where the matrix is too large or cannot be written.
pub fn write_stiffness(
    case: &Path,
    matrix: &Path,
    cells: Option<usize>,
    global: &Global,
) -> Result<(), Failure> {
    let loaded = LoadedCase::read(case)?;
    let StatedProblem { problem, .. } = loaded.stated()?;
    let inputs = case_inputs(Some(case), &loaded)?;
    let outputs = [matrix.to_path_buf()];
    let files = OutputFiles::begin("export", &inputs, &outputs, global.force)?;
    let bar = global.progress();
    bar.set_message("solving, for the mesh");
    let options = Options {
        cells,
        stiffness: StiffnessForm::Assembled,
        ..loaded.case.options()
    };
    let solved = solve(&problem, &options);
    bar.finish_and_clear();
    let solution = solved.map_err(|error| loaded.failure(&error))?;
    let title = format!("{}, by kufe {}", loaded.name, env!("CARGO_PKG_VERSION"));
    let comments = comments(title, &solution);
    let bodies: Vec<_> = solution.assembled.iter().map(|b| &*b.stiffness).collect();
    files.write(matrix, |mut out| {
        write_matrix_market(&bodies, &comments, &mut out)
    })?;
    files.commit()?;
    let displacements: usize = bodies.iter().map(|body| body.dofs()).sum();
    let entries: usize = bodies.iter().map(|body| body.entries()).sum();
    let held: usize = solution.assembled.iter().map(|body| body.fixed.len()).sum();
    if global.json {
        let facts = json!({
            "stiffness": matrix.display().to_string(),
            "displacements": displacements,
            "held": held,
            "entries": entries,
            "p_max_pa": solution.p_max,
            "symmetry": solution.symmetry,
        });
        say(&format!("{facts:#}\n"));
    } else if !global.quiet {
        say(&format!(
            "{}: {displacements} displacements, {held} of them held; {entries} entries, of which one triangle is written\n",
            matrix.display()
        ));
    }
    Ok(())
}

/// What the rows and columns are, and which of them are held.
fn comments(title: String, solution: &Solution) -> Vec<String> {
    let mut lines = vec![
        format!("Stiffness of {title} [N/m]"),
        "Displacements count from 1, body after body; in a body component after component (x, y, z), node by node.".into(),
        "Nothing is taken out: every body is free here and has its six rigid motions. Without the rows and columns".into(),
        "that are listed as held (by outer faces, mirror planes or a mount) the matrix is positive definite.".into(),
    ];
    let mut first = 1;
    for body in &solution.assembled {
        let dofs = body.stiffness.dofs();
        lines.push(format!("{}: {first} to {}", body.name, first + dofs - 1));
        if body.name == "ice" {
            let grid = &solution.volume.grid;
            lines.push("ice nodes: x fastest, then y, then z, on a tensor grid [m]".into());
            for (axis, nodes) in [("x", &grid.x), ("y", &grid.y), ("z", &grid.z)] {
                listed(&format!("ice {axis}"), nodes.iter(), &mut lines);
            }
        }
        let held = body.fixed.iter().map(|dof| first + dof);
        listed(&format!("{} held", body.name), held, &mut lines);
        first += dofs;
    }
    lines
}

/// Adds numbers as lines that begin with what they are.
fn listed<T: ToString>(what: &str, numbers: impl Iterator<Item = T>, lines: &mut Vec<String>) {
    let words: Vec<String> = numbers.map(|number| number.to_string()).collect();
    let chunks = words.chunks(A_LINE);
    lines.extend(chunks.map(|words| format!("{what}: {}", words.join(" "))));
}
