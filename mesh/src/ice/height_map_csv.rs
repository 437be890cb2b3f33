//! Height maps from CSV tables.

use std::io::Read;

use crate::error::MeshError;
use crate::ice::height_map::{HeightMap, Interpolation};

impl HeightMap {
    /// Reads columns `x_m`, `y_m`, `z_m` of a CSV table whose points, in any order, fill a regular grid.
    ///
    /// # Errors
    /// [`MeshError::MapRow`] with the row and column, [`MeshError::MapGrid`] where the points fill no regular grid.
    pub fn from_csv(reader: impl Read, interpolation: Interpolation) -> Result<Self, MeshError> {
        let mut table = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .from_reader(reader);
        let row_problem = |row: usize, column: &'static str, found: String| MeshError::MapRow {
            row,
            column,
            found,
        };
        let headers = table
            .headers()
            .map_err(|e| row_problem(1, "header", e.to_string()))?
            .clone();
        let mut columns = [0; 3];
        for (place, name) in columns.iter_mut().zip(["x_m", "y_m", "z_m"]) {
            let found = headers.iter().position(|h| h == name);
            *place = found.ok_or_else(|| row_problem(1, name, "no such column".into()))?;
        }
        let mut points: Vec<[f64; 3]> = Vec::new();
        for (i, record) in table.records().enumerate() {
            let record = record.map_err(|e| row_problem(i + 2, "row", e.to_string()))?;
            let mut point = [0.0; 3];
            for ((value, column), name) in point.iter_mut().zip(columns).zip(["x_m", "y_m", "z_m"])
            {
                let text = record.get(column).unwrap_or("");
                let number = text.parse::<f64>().ok().filter(|v| v.is_finite());
                *value = number.ok_or_else(|| row_problem(i + 2, name, format!("{text:?}")))?;
            }
            points.push(point);
        }
        let [xs, ys] = [0, 1].map(|axis| {
            let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
            values.sort_by(f64::total_cmp);
            let span = values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0);
            values.dedup_by(|b, a| *b - *a <= 1e-9 * span);
            values
        });
        let shape = [xs.len(), ys.len()];
        if shape.iter().any(|&n| n < 2) || shape[0].checked_mul(shape[1]) != Some(points.len()) {
            return Err(MeshError::MapGrid {
                shape,
                points: points.len(),
                problem: "expected one row a grid point",
            });
        }
        let spacing = [&xs, &ys].map(|v| (v[v.len() - 1] - v[0]) / (v.len() - 1) as f64);
        let even = |v: &[f64], step: f64| {
            v.windows(2)
                .all(|p| (p[1] - p[0] - step).abs() <= 1e-3 * step)
        };
        if !even(&xs, spacing[0]) || !even(&ys, spacing[1]) {
            return Err(MeshError::MapGrid {
                shape,
                points: points.len(),
                problem: "the points are not evenly spaced",
            });
        }
        let mut heights = vec![f64::NAN; points.len()];
        for [x, y, z] in &points {
            let i = ((x - xs[0]) / spacing[0]).round() as usize;
            let j = ((y - ys[0]) / spacing[1]).round() as usize;
            let place = &mut heights[j.min(shape[1] - 1) * shape[0] + i.min(shape[0] - 1)];
            if !place.is_nan() {
                return Err(MeshError::MapGrid {
                    shape,
                    points: points.len(),
                    problem: "a point occurs twice",
                });
            }
            *place = *z;
        }
        Self::new([xs[0], ys[0]], spacing, shape, heights, interpolation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ice::surface::IceSurface;

    #[test]
    fn csv_in_any_order_gives_the_map() {
        let table =
            "y_m,x_m,note,z_m\n0,0,a,1\n0.5,2,b,6\n0,2,c,3\n0.5,0,d,4\n0,1,e,2\n0.5,1,f,5\n";
        let map = HeightMap::from_csv(table.as_bytes(), Interpolation::Bilinear).unwrap();
        assert!(
            (map.height(1.0, 0.0) - 2.0).abs() < 1e-15
                && (map.height(2.0, 0.25) - 4.5).abs() < 1e-15
        );
    }

    #[test]
    fn broken_tables_are_refused_with_row_and_column() {
        let refused = |table: &str| {
            HeightMap::from_csv(table.as_bytes(), Interpolation::Bicubic)
                .unwrap_err()
                .to_string()
        };
        assert!(refused("x_m,y_m\n0,0\n").contains("z_m"));
        let message = refused("x_m,y_m,z_m\n0,0,1\n1,0,high\n");
        assert!(
            message.contains("row 3") && message.contains("high"),
            "{message}"
        );
        assert!(refused("x_m,y_m,z_m\n0,0,1\n1,0,nan\n").contains("row 3"));
        assert!(refused("x_m,y_m,z_m\n0,0,1\n1,0,1\n0,1,1\n").contains("one row a grid point"));
        assert!(
            refused("x_m,y_m,z_m\n0,0,1\n1,0,1\n3,0,1\n0,1,1\n1,1,1\n3,1,1\n").contains("evenly")
        );
        assert!(refused("").contains("x_m"));
        assert!(
            HeightMap::new(
                [0.0; 2],
                [1.0; 2],
                [usize::MAX, 2],
                vec![0.0; 4],
                Interpolation::Bicubic
            )
            .is_err()
        );
    }
}
