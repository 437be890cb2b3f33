//! Hexahedral meshes from VTU files.

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::HexMesh;
use crate::hexahedra::vtu::data::{HEXAHEDRON, problem};
use crate::hexahedra::vtu::file::VtuFile;

/// Reads the hexahedra of a VTU file: text, base64 or raw, appended or not, zlib or uncompressed.
///
/// # Errors
/// [`MeshError::VtuRead`] with what is wrong and where, [`MeshError::CellType`] for other cells than
/// hexahedra, and those of [`HexMesh::from_elsewhere`].
pub fn read_vtu(bytes: &[u8]) -> Result<HexMesh, MeshError> {
    let file = VtuFile::parse(bytes)?;
    let points = file.array("Points")?;
    let connectivity = file.array("connectivity")?;
    let offsets = file.array("offsets")?;
    let types = file.array("types")?;
    if let Some(cell) = types.iter().position(|&t| t != f64::from(HEXAHEDRON)) {
        return Err(MeshError::CellType {
            cell: cell + 1,
            found: format!("VTK type {}", types[cell]),
        });
    }
    if points.len() % 3 != 0 {
        return Err(problem("Points", "its length is no multiple of three"));
    }
    let regular = offsets
        .iter()
        .enumerate()
        .all(|(i, &o)| o == 8.0 * (i + 1) as f64);
    if offsets.len() != types.len() || !regular || connectivity.len() != 8 * types.len() {
        return Err(problem(
            "offsets",
            "expected 8, 16, 24 ... for hexahedra, as many as types",
        ));
    }
    let points: Vec<[f64; 3]> = points.chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    if connectivity.iter().any(|&n| n < 0.0) {
        return Err(problem("connectivity", "negative node numbers"));
    }
    let cells: Vec<[usize; 8]> = connectivity
        .chunks_exact(8)
        .map(|c| std::array::from_fn(|k| c[k] as usize))
        .collect();
    HexMesh::from_elsewhere(&points, &cells)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hexahedra::tensor_grid::TensorGrid;
    use crate::hexahedra::vtu::write::write_vtu;
    use base64::{Engine, engine::general_purpose::STANDARD};

    #[test]
    fn written_files_are_read_back_whether_blocks_are_whole_or_not() {
        // 16 x 16 x 16 points fill 98,304 bytes, three whole blocks; 17 x 5 x 3 do not.
        for shape in [[16, 16, 16], [17, 5, 3]] {
            let axis = |n: usize| (0..n).map(|i| 0.1 * i as f64).collect::<Vec<_>>();
            let mesh = TensorGrid {
                x: axis(shape[0]),
                y: axis(shape[1]),
                z: axis(shape[2]),
            }
            .hex_mesh();
            let mut file = Vec::new();
            write_vtu(&mesh, &[], &[], &[], &mut file).unwrap();
            let back = read_vtu(&file).unwrap();
            assert_eq!(back.quality(), mesh.quality());
            assert_eq!(back.cells.len(), mesh.cells.len());
        }
    }

    fn ascii(points: &str, connectivity: &str, offsets: &str, types: &str) -> String {
        format!(
            "<VTKFile type=\"UnstructuredGrid\"><UnstructuredGrid><Piece><Points><DataArray type=\"Float64\">{points}\
             </DataArray></Points><Cells><DataArray Name=\"connectivity\" type=\"Int64\">{connectivity}</DataArray>\
             <DataArray Name=\"offsets\" type=\"Int64\">{offsets}</DataArray><DataArray Name=\"types\" type=\"UInt8\">\
             {types}</DataArray></Cells></Piece></UnstructuredGrid></VTKFile>"
        )
    }

    const CUBE: &str = "0 0 0 1 0 0 1 1 0 0 1 0 0 0 1 1 0 1 1 1 1 0 1 1";

    #[test]
    fn text_is_read_and_other_cells_are_named() {
        let cube = read_vtu(ascii(CUBE, "0 1 2 3 4 5 6 7", "8", "12").as_bytes()).unwrap();
        assert!((cube.quality().volume - 1.0).abs() < 1e-15);
        let refused = |text: String| read_vtu(text.as_bytes()).unwrap_err().to_string();
        assert!(refused(ascii(CUBE, "0 1 2 3", "4", "10")).contains("VTK type 10"));
        assert!(refused(ascii(CUBE, "0 1 2 3 4 5 6 99", "8", "12")).contains("99"));
        assert!(refused(ascii(CUBE, "0 1 2 3 4 5 6 7", "9", "12")).contains("offsets"));
        assert!(refused(ascii("zero", "0 1 2 3 4 5 6 7", "8", "12")).contains("Points"));
        assert!(refused("<VTKFile type=\"PolyData\"/>".into()).contains("UnstructuredGrid"));
    }

    #[test]
    fn lengths_that_lie_are_refused_before_anything_is_allocated() {
        let header = |words: &[u64]| {
            STANDARD.encode(
                words
                    .iter()
                    .flat_map(|w| w.to_le_bytes())
                    .collect::<Vec<u8>>(),
            )
        };
        for (attributes, data) in [
            ("header_type=\"UInt64\"", header(&[u64::MAX])),
            ("header_type=\"UInt64\"", header(&[1 << 50])),
            (
                "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"",
                header(&[u64::MAX, 1, 1, 1]),
            ),
            (
                "header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\"",
                header(&[1, 1 << 60, 0, 1 << 60]),
            ),
            ("", String::new()),
        ] {
            let text = ascii("x", "0 1 2 3 4 5 6 7", "8", "12")
                .replacen(
                    "type=\"UnstructuredGrid\"",
                    &format!("type=\"UnstructuredGrid\" {attributes}"),
                    1,
                )
                .replace(
                    "type=\"Float64\">x",
                    &format!("type=\"Float64\" format=\"binary\">{data}"),
                );
            assert!(
                read_vtu(text.as_bytes())
                    .unwrap_err()
                    .to_string()
                    .contains("Points"),
                "{attributes}"
            );
        }
    }
}
