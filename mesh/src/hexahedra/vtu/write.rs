//! Hexahedral meshes and their fields as VTU files.

use std::io::{Result, Write};

use base64::{Engine, engine::general_purpose::STANDARD};
use flate2::{Compression, write::ZlibEncoder};
use rayon::prelude::*;

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::HexMesh;
use crate::hexahedra::vtu::data::HEXAHEDRON;

/// Bytes that are compressed at a time, one thread a block.
const BLOCK: usize = 1 << 18;

/// A named array with one value, vector or tensor a point or cell.
#[derive(Clone, Copy, Debug)]
pub struct VtuField<'a> {
    /// The array's name; its unit belongs in it, as `stress_pa`.
    pub name: &'a str,
    /// Numbers in each value: 1, 3 for a vector, 9 for a tensor (row by row), or any other.
    pub components: usize,
    /// The numbers, value by value.
    pub values: &'a [f64],
}

/// Writes `mesh` with `point_data` and `cell_data` as a VTU file that VTK, pyvista and meshio read.
///
/// # Errors
/// [`MeshError::FieldLength`] where an array does not fit the mesh, [`MeshError::Vtu`] where it cannot be written.
pub fn write_vtu(
    mesh: &HexMesh,
    point_data: &[VtuField],
    cell_data: &[VtuField],
    writer: impl Write,
) -> std::result::Result<(), MeshError> {
    for (fields, count) in [
        (point_data, mesh.points.len()),
        (cell_data, mesh.cells.len()),
    ] {
        fits(fields, count)?;
    }
    let mut out = std::io::BufWriter::new(writer);
    write_file(mesh, point_data, cell_data, &mut out)
        .and_then(|()| out.flush())
        .map_err(|e| MeshError::Vtu(e.to_string()))
}

/// Checks that every field has its numbers for each of `count` points or cells.
pub(super) fn fits(fields: &[VtuField], count: usize) -> std::result::Result<(), MeshError> {
    let wrong = |f: &&VtuField| f.components == 0 || f.values.len() != f.components * count;
    match fields.iter().find(wrong) {
        None => Ok(()),
        Some(field) => Err(MeshError::FieldLength {
            name: field.name.to_string(),
            found: field.values.len(),
            expected: field.components * count,
        }),
    }
}

fn write_file(
    mesh: &HexMesh,
    point_data: &[VtuField],
    cell_data: &[VtuField],
    out: &mut impl Write,
) -> Result<()> {
    let (points, cells) = (mesh.points.len(), mesh.cells.len());
    writeln!(out, "<?xml version=\"1.0\"?>")?;
    writeln!(
        out,
        "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" \
         header_type=\"UInt64\" compressor=\"vtkZLibDataCompressor\">"
    )?;
    writeln!(out, "<UnstructuredGrid>")?;
    writeln!(
        out,
        "<Piece NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\">"
    )?;
    write_fields(out, "PointData", point_data)?;
    write_fields(out, "CellData", cell_data)?;
    let coordinates = bytes(mesh.points.iter().flatten().map(|v| v.to_le_bytes()));
    writeln!(out, "<Points>")?;
    write_array(out, "Float64", ("Points", 3), &coordinates)?;
    writeln!(out, "</Points>")?;
    let nodes = mesh.cells.iter().flatten();
    let connectivity = bytes(nodes.map(|&n| (n as i64).to_le_bytes()));
    let offsets = bytes((1..=cells as i64).map(|n| (8 * n).to_le_bytes()));
    writeln!(out, "<Cells>")?;
    write_array(out, "Int64", ("connectivity", 1), &connectivity)?;
    write_array(out, "Int64", ("offsets", 1), &offsets)?;
    write_array(out, "UInt8", ("types", 1), &vec![HEXAHEDRON; cells])?;
    writeln!(out, "</Cells>")?;
    writeln!(out, "</Piece>")?;
    writeln!(out, "</UnstructuredGrid>")?;
    writeln!(out, "</VTKFile>")
}

/// The arrays on points or cells; the first scalar, vector and tensor are those that a viewer shows first.
pub(super) fn write_fields(out: &mut impl Write, tag: &str, fields: &[VtuField]) -> Result<()> {
    write!(out, "<{tag}")?;
    for (attribute, components) in [("Scalars", 1), ("Vectors", 3), ("Tensors", 9)] {
        if let Some(field) = fields.iter().find(|f| f.components == components) {
            let name = quick_xml::escape::escape(field.name);
            write!(out, " {attribute}=\"{name}\"")?;
        }
    }
    writeln!(out, ">")?;
    for field in fields {
        let values = bytes(field.values.iter().map(|v| v.to_le_bytes()));
        write_array(out, "Float64", (field.name, field.components), &values)?;
    }
    writeln!(out, "</{tag}>")
}

pub(super) fn bytes<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(N * numbers.size_hint().0);
    numbers.for_each(|number| bytes.extend_from_slice(&number));
    bytes
}

/// A header of the blocks' number, size, last size (0 where it is whole) and compressed sizes, then the blocks; both in
/// base64.
pub(super) fn write_array(
    out: &mut impl Write,
    kind: &str,
    (name, components): (&str, usize),
    data: &[u8],
) -> Result<()> {
    let name = quick_xml::escape::escape(name);
    write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\"")?;
    // Some readers make a column of an array that says that it has one component.
    if components != 1 {
        write!(out, " NumberOfComponents=\"{components}\"")?;
    }
    writeln!(out, " format=\"binary\">")?;
    let blocks: Vec<Vec<u8>> = data.par_chunks(BLOCK).map(packed).collect::<Result<_>>()?;
    let mut header = vec![blocks.len(), BLOCK, data.len() % BLOCK];
    header.extend(blocks.iter().map(Vec::len));
    let header = bytes(header.iter().map(|&n| (n as u64).to_le_bytes()));
    write!(out, "{}", STANDARD.encode(header))?;
    writeln!(out, "{}", STANDARD.encode(blocks.concat()))?;
    writeln!(out, "</DataArray>")
}

fn packed(block: &[u8]) -> Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(block.len()), Compression::fast());
    encoder.write_all(block)?;
    encoder.finish()
}
