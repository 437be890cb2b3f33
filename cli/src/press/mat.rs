//! `result.mat`: figures, errors and the map for MATLAB.

use std::io::Write;

use kufe::jobs::Failure;
use kufe::results::ContactResult;
use kufe_contact::{PressureMap, Solution};
use kufe_lut::MatValue;

use crate::output::mat;

/// Writes every key of result.json as a variable and the map of pressure.exr: `x_m` and `y_m`, the pixels' centres, and `pressure_pa`, `map_gap_m` and
/// `map_uz_m`, rows along y and columns along x as `surf(x_m, y_m, pressure_pa)` takes them.
///
/// # Errors
/// Those of the writer.
pub fn write(
    writer: &mut dyn Write,
    result: &ContactResult,
    solution: &Solution,
) -> Result<(), Failure> {
    let map = PressureMap::of(solution);
    let centres = |start: f64, step: f64, count: usize| {
        MatValue::row((0..count).map(|i| start + i as f64 * step).collect())
    };
    let over_plane = |values: &[f64]| {
        let by_column = (0..map.nx).flat_map(|i| (0..map.ny).map(move |j| (i, j)));
        let values = by_column.map(|(i, j)| values[j * map.nx + i]).collect();
        MatValue::Numbers(vec![map.ny, map.nx], values)
    };
    let fields = [
        ("x_m", centres(map.x0, map.dx, map.nx)),
        ("y_m", centres(map.y0, map.dy, map.ny)),
        ("pressure_pa", over_plane(&map.pressure)),
        ("map_gap_m", over_plane(&map.gap)),
        ("map_uz_m", over_plane(&map.uz)),
    ];
    let fields = fields.map(|(name, value)| (name.to_owned(), value));
    mat::write(writer, result, fields.into())
}
