//! Measured curves in files: a CSV table of points.

use std::path::Path;

use kufe_files::read_regular;

use crate::error::MeshError;

/// Most bytes of a curve's file.
const MOST_BYTES: u64 = 1 << 26;

/// Reads a CSV file with exactly two columns of this name, a point a row [m].
///
/// # Errors
/// [`MeshError::File`] with the row, the column and what stands there.
pub fn load_points(path: &Path, columns: [&'static str; 2]) -> Result<Vec<[f64; 2]>, MeshError> {
    let name = path.display().to_string();
    let bytes = read_regular(path, MOST_BYTES).map_err(|source| MeshError::Io {
        path: name.clone(),
        source,
    })?;
    read_points(&bytes, columns).map_err(|source| MeshError::File {
        path: name,
        source: Box::new(source),
    })
}

fn read_points(bytes: &[u8], columns: [&'static str; 2]) -> Result<Vec<[f64; 2]>, MeshError> {
    let told = |row: usize, column: &'static str, found: String| MeshError::PointRow {
        row,
        column,
        found,
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(bytes);
    let header = reader
        .headers()
        .map_err(|error| told(0, columns[0], error.to_string()))?;
    if header != columns.to_vec() {
        let found = header.iter().collect::<Vec<&str>>().join(",");
        return Err(MeshError::PointColumns { found, columns });
    }
    let mut points = Vec::new();
    for (i, record) in reader.records().enumerate() {
        let record = record.map_err(|error| told(i + 1, columns[0], error.to_string()))?;
        let mut point = [0.0; 2];
        for (k, value) in point.iter_mut().enumerate() {
            let text = record.get(k).unwrap_or_default();
            let number = text.parse::<f64>().ok().filter(|v| v.is_finite());
            *value = number.ok_or_else(|| told(i + 1, columns[k], format!("{text:?}")))?;
        }
        points.push(point);
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_read_and_what_is_none_is_refused_with_its_place() {
        let read = |text: &str| read_points(text.as_bytes(), ["y_m", "z_m"]);
        assert_eq!(
            read("y_m,z_m\n-0.1, 2e-3\n0,0\n").unwrap(),
            [[-0.1, 2e-3], [0.0, 0.0]]
        );
        let refused = |text: &str| read(text).unwrap_err().to_string();
        let message = refused("y_m,z_m\n0,0\n0.1,wide\n");
        assert!(
            message.contains("row 2") && message.contains("z_m") && message.contains("wide"),
            "{message}"
        );
        assert!(refused("x_m,z_m\n0,0\n").contains("x_m,z_m"));
        assert!(refused("y_m,z_m\n0,inf\n").contains("inf"));
        assert!(refused("y_m,z_m\n0\n").contains("row 1"));
    }
}
