//! Sparse matrices as text that other programs read.

use std::io::{self, Write};

use crate::sparse::stiffness::SparseStiffness;

/// Writes the stiffness of some bodies, one after the other along the diagonal, in Matrix Market form.
///
/// `coordinate real symmetric`: the lower triangle, one-based (row, column, value [N/m]), column by column; values have as many
/// digits as bring the same number back. `comments` stand above as lines of their own. Source: R. F. Boisvert, R. Pozo and
/// K. A. Remington, The Matrix Market exchange formats, NISTIR 5935 (1996).
///
/// # Errors
/// Those of `out`.
///
/// ```
/// use kufe_fem::{Body, ElementKind, Material, SparseStiffness, write_matrix_market};
/// use kufe_mesh::TensorGrid;
/// let grid = TensorGrid { x: vec![0.0, 1.0], y: vec![0.0, 1.0], z: vec![0.0, 1.0] };
/// let body = Body::uniform(grid.hex_mesh(), Material::new(1.0, 0.3)?, ElementKind::Hex8)?;
/// let stiffness = SparseStiffness::assemble(&body, 1 << 20)?;
/// let mut text = Vec::new();
/// write_matrix_market(&[&stiffness], &["one cell".into()], &mut text)?;
/// let text = String::from_utf8(text)?;
/// assert!(text.starts_with("%%MatrixMarket matrix coordinate real symmetric\n% one cell\n24 24 300\n1 1 "));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_matrix_market(
    bodies: &[&SparseStiffness],
    comments: &[String],
    out: &mut dyn Write,
) -> io::Result<()> {
    writeln!(out, "%%MatrixMarket matrix coordinate real symmetric")?;
    for comment in comments {
        writeln!(out, "% {comment}")?;
    }
    let dofs: usize = bodies.iter().map(|body| body.dofs()).sum();
    // Every row has its diagonal, and every other entry its mirror.
    let entries: usize = bodies.iter().map(|body| body.entries()).sum();
    writeln!(out, "{dofs} {dofs} {}", (entries + dofs) / 2)?;
    let mut first = 1;
    for body in bodies {
        for (row, column, value) in body.lower() {
            writeln!(out, "{} {} {value:e}", first + row, first + column)?;
        }
        first += body.dofs();
    }
    Ok(())
}
