//! Surfaces of quadrilaterals and their fields as VTP files.

use std::io::{BufWriter, Result, Write};

use crate::error::MeshError;
use crate::hexahedra::vtu::write::{
    VtuField, fits, write_cells, write_field_data, write_fields, write_points,
};

/// Writes quadrilaterals over `points` [m], each a round of four numbers of points, with `point_data` as a VTP file (polygons) that VTK
/// and pyvista read; `kufe_version` is among the file's data.
///
/// # Errors
/// [`MeshError::FieldLength`] where an array does not fit the points, [`MeshError::Vtu`] where it cannot be written.
pub fn write_vtp(
    points: &[[f64; 3]],
    quadrilaterals: &[[usize; 4]],
    point_data: &[VtuField],
    writer: impl Write,
) -> std::result::Result<(), MeshError> {
    fits(point_data, points.len())?;
    let mut out = BufWriter::new(writer);
    write_file(points, quadrilaterals, point_data, &mut out)
        .and_then(|()| out.flush())
        .map_err(|error| MeshError::Vtu(error.to_string()))
}

fn write_file(
    points: &[[f64; 3]],
    quadrilaterals: &[[usize; 4]],
    point_data: &[VtuField],
    out: &mut impl Write,
) -> Result<()> {
    let (count, faces) = (points.len(), quadrilaterals.len());
    writeln!(
        out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">\n<PolyData>"
    )?;
    write_field_data(out, &[])?;
    writeln!(
        out,
        "<Piece NumberOfPoints=\"{count}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" NumberOfPolys=\"{faces}\">"
    )?;
    write_fields(out, "PointData", point_data)?;
    write_points(out, points)?;
    writeln!(out, "<Polys>")?;
    write_cells(out, quadrilaterals)?;
    writeln!(out, "</Polys>\n</Piece>\n</PolyData>\n</VTKFile>")
}
