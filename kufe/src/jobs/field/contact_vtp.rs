//! `contact.vtp`: the patch as a surface of its own.

use std::io::Write;

use kufe_contact::SurfaceField;
use kufe_mesh::{VtuField, write_vtp};

use crate::jobs::Failure;

/// Writes the whole patch, both sides of a mirror plane: the cells of the contact plane with a node that touches, on the deformed ice, with
/// `contact_pressure_pa`, `gap_m` (NaN where there is no hull) and `uz_m` at the nodes. The pressure integrates to the load `fz` [N].
///
/// # Errors
/// [`Failure::BadInput`] with the writer's words.
pub fn write(writer: &mut dyn Write, surface: &SurfaceField, fz: f64) -> Result<(), Failure> {
    let (nx, ny) = (surface.x.len(), surface.y.len());
    let mut number = vec![usize::MAX; nx * ny];
    let mut nodes = Vec::new();
    let mut cells = Vec::new();
    for j in 0..ny - 1 {
        for i in 0..nx - 1 {
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(|(i, j)| j * nx + i);
            if corners.iter().all(|&n| surface.pressure[n] <= 0.0) {
                continue;
            }
            cells.push(corners.map(|n| {
                if number[n] == usize::MAX {
                    number[n] = nodes.len();
                    nodes.push(n);
                }
                number[n]
            }));
        }
    }
    let points: Vec<[f64; 3]> = nodes
        .iter()
        .map(|&n| [surface.x[n % nx], surface.y[n / nx], surface.uz[n]])
        .collect();
    let at = |values: &[f64]| -> Vec<f64> { nodes.iter().map(|&n| values[n]).collect() };
    let (pressure, uz) = (at(&surface.balanced_pressure(fz)), at(&surface.uz));
    let gap: Vec<f64> = at(&surface.gap).into_iter().map(finite).collect();
    let field = |name, values| VtuField {
        name,
        components: 1,
        values,
    };
    let fields = [
        field("contact_pressure_pa", &pressure[..]),
        field("gap_m", &gap[..]),
        field("uz_m", &uz[..]),
    ];
    write_vtp(&points, &cells, &fields, writer).map_err(Failure::bad_input)
}

/// A gap, NaN where there is none.
pub(super) fn finite(gap: f64) -> f64 {
    match gap.is_finite() {
        true => gap,
        false => f64::NAN,
    }
}
