//! The assembled stiffness of a case's bodies, on the mesh that the case is solved on.

use std::io::Write;
use std::path::Path;

use kufe_contact::{Options, Solution, StiffnessForm, VolumeField, solve};
use kufe_fem::write_matrix_market;
use serde::Serialize;

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;

/// Numbers per comment line.
const NUMBERS_PER_LINE: usize = 12;

/// A case that was solved with an assembled stiffness.
pub struct AssembledStiffness {
    title: String,
    solution: Solution,
}

/// The size of a matrix, and the contact on its mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StiffnessResult {
    /// The matrix's file.
    pub stiffness: String,
    /// Number of rows: displacement components of all nodes.
    pub displacements: usize,
    /// Number of rows whose displacements are fixed by outer faces, mirror planes or a mount.
    #[serde(rename = "held")]
    pub fixed: usize,
    /// Stored entries of both triangles of the matrix.
    pub entries: usize,
    /// Peak pressure [Pa].
    pub p_max_pa: f64,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub symmetry: [bool; 2],
}

impl AssembledStiffness {
    /// Solves a case with `cells` cells across half the patch; `None` refines to the case's
    /// accuracy.
    ///
    /// # Errors
    /// Those of the solver; [`Failure::BadInput`] if the matrix is too large.
    pub fn solve(loaded: &LoadedCase, cells: Option<usize>) -> Result<Self, Failure> {
        let options = Options {
            cells,
            stiffness: StiffnessForm::Assembled,
            ..loaded.case.options()
        };
        Ok(AssembledStiffness {
            title: format!("{}, by kufe {}", loaded.name, env!("CARGO_PKG_VERSION")),
            solution: loaded.solved(solve(&loaded.stated()?.0, &options))?,
        })
    }

    /// Writes the matrix of the finest mesh in Matrix Market form.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, writer: &mut dyn Write) -> std::io::Result<()> {
        let bodies = self.solution.assembled.iter();
        let bodies: Vec<_> = bodies.map(|body| &*body.stiffness).collect();
        write_matrix_market(&bodies, &self.comments(), writer)
    }

    /// The size of the matrix; `path` is its file.
    pub fn result(&self, path: &Path) -> StiffnessResult {
        let bodies = || self.solution.assembled.iter();
        StiffnessResult {
            stiffness: path.display().to_string(),
            displacements: bodies().map(|body| body.stiffness.dofs()).sum(),
            fixed: bodies().map(|body| body.fixed.len()).sum(),
            entries: bodies().map(|body| body.stiffness.entries()).sum(),
            p_max_pa: self.solution.p_max,
            symmetry: self.solution.symmetry,
        }
    }

    /// The meaning of rows and columns, and which of them are fixed.
    fn comments(&self) -> Vec<String> {
        let mut lines = vec![
            format!("Stiffness of {} [N/m]", self.title),
            "Displacements count from 1, body after body; in a body component after component (x, y, z), node by node.".into(),
            "No boundary conditions are applied: the block of each body is singular, with six rigid-body modes. Without the rows and".into(),
            "columns listed as fixed (by outer faces, mirror planes or a mount) the matrix is positive definite.".into(),
        ];
        let mut first = 1;
        for body in &self.solution.assembled {
            let dofs = body.stiffness.dofs();
            lines.push(format!("{}: {first} to {}", body.name, first + dofs - 1));
            if let Some(VolumeField { grid, .. }) = &self.solution.volume
                && body.name == "ice"
            {
                lines.push("ice nodes: x fastest, then y, then z, on a tensor grid [m]".into());
                for (axis, nodes) in [("x", &grid.x), ("y", &grid.y), ("z", &grid.z)] {
                    list(&format!("ice {axis}"), nodes.iter(), &mut lines);
                }
            }
            let fixed = body.fixed.iter().map(|dof| first + dof);
            list(&format!("{} fixed", body.name), fixed, &mut lines);
            first += dofs;
        }
        lines
    }
}

/// Appends `numbers` as lines that begin with `label`.
fn list<T: ToString>(label: &str, numbers: impl Iterator<Item = T>, lines: &mut Vec<String>) {
    let words: Vec<String> = numbers.map(|number| number.to_string()).collect();
    let chunks = words.chunks(NUMBERS_PER_LINE);
    lines.extend(chunks.map(|words| format!("{label}: {}", words.join(" "))));
}
