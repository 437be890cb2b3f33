//! VTU files, series of them as PVD files, and surfaces as VTP files.

use std::io::{BufWriter, Result, Write};

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use base64::write::EncoderWriter;
use flate2::Compression;
use flate2::write::ZlibEncoder;
use rayon::prelude::*;

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::HexMesh;
use crate::hexahedra::read_vtu::HEXAHEDRON;

/// Version of the program that writes a file, as numbers: some readers refuse strings as field
/// data.
const VERSION: [&str; 3] = [
    env!("CARGO_PKG_VERSION_MAJOR"),
    env!("CARGO_PKG_VERSION_MINOR"),
    env!("CARGO_PKG_VERSION_PATCH"),
];

/// Number of values per compressed block; each block is compressed by one thread.
const BLOCK: usize = 1 << 15;

/// Ratio of a block to its beginning that is compressed first, to decide whether compression is
/// worth its time. Stresses and displacements, whose last digits are random, would shrink by 17 %
/// at most and are stored uncompressed.
const SAMPLE: usize = 16;

/// A named array with one value, vector or tensor per point or cell. In the file its numbers have
/// seven digits (`Float32`), which halves the data.
#[derive(Clone, Copy, Debug)]
pub struct VtuField<'a> {
    /// The array's name, which should include its unit, such as `stress_pa`.
    pub name: &'a str,
    /// Number of components of each value: 1, 3 for a vector, 9 for a tensor (row by row), or any
    /// other.
    pub components: usize,
    /// The numbers, value by value.
    pub values: &'a [f64],
}

/// Writes `mesh` with `point_data` and `cell_data` as a VTU file that VTK, pyvista and meshio read;
/// `field_data` holds numbers of the whole file by name, to which `kufe_version` (such as 0, 1, 0)
/// is added.
///
/// # Errors
/// [`MeshError::Invalid`] where an array does not fit the mesh, or where it cannot be written.
pub fn write_vtu(
    mesh: &HexMesh,
    point_data: &[VtuField],
    cell_data: &[VtuField],
    field_data: &[(&str, &[f64])],
    writer: impl Write,
) -> std::result::Result<(), MeshError> {
    let (points, cells) = (mesh.points.len(), mesh.cells.len());
    fits(point_data, points)?;
    fits(cell_data, cells)?;
    let counts = format!("NumberOfPoints=\"{points}\" NumberOfCells=\"{cells}\"");
    let piece = |out: &mut BufWriter<_>| {
        write_fields(out, "PointData", point_data)?;
        write_fields(out, "CellData", cell_data)?;
        write_points(out, &mesh.points)?;
        writeln!(out, "<Cells>")?;
        write_cells(out, &mesh.cells)?;
        let types = vec![HEXAHEDRON; cells];
        write_array(out, "UInt8", ("types", 1), &types, |kind| [kind])?;
        writeln!(out, "</Cells>")
    };
    write_file("UnstructuredGrid", field_data, &counts, piece, writer)
}

/// Checks that every field has `components` numbers for each of `count` points or cells.
fn fits(fields: &[VtuField], count: usize) -> std::result::Result<(), MeshError> {
    let wrong = |f: &&VtuField| f.components == 0 || f.values.len() != f.components * count;
    match fields.iter().find(wrong) {
        None => Ok(()),
        Some(field) => Err(MeshError::Invalid(format!(
            "field {:?} has {} numbers; expected {}",
            field.name,
            field.values.len(),
            field.components * count
        ))),
    }
}

/// Writes a file of one piece of a kind of grid.
fn write_file<W: Write>(
    kind: &str,
    field_data: &[(&str, &[f64])],
    counts: &str,
    piece: impl FnOnce(&mut BufWriter<W>) -> Result<()>,
    writer: W,
) -> std::result::Result<(), MeshError> {
    let mut out = BufWriter::with_capacity(1 << 20, writer);
    let write = || {
        writeln!(
            out,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"{kind}\" version=\"1.0\" \
             byte_order=\"LittleEndian\" header_type=\"UInt64\" \
             compressor=\"vtkZLibDataCompressor\">\n<{kind}>"
        )?;
        write_field_data(&mut out, field_data)?;
        writeln!(out, "<Piece {counts}>")?;
        piece(&mut out)?;
        writeln!(out, "</Piece>\n</{kind}>\n</VTKFile>")?;
        out.flush()
    };
    let unwritten = |error: std::io::Error| format!("the file cannot be written: {error}");
    write().map_err(|error| MeshError::Invalid(unwritten(error)))
}

/// Numbers of the whole file, including the program's version.
fn write_field_data(out: &mut impl Write, field_data: &[(&str, &[f64])]) -> Result<()> {
    let version = ("kufe_version", VERSION.map(str::to_owned).to_vec());
    let texts = |values: &[f64]| values.iter().map(f64::to_string).collect();
    let others = field_data.iter().map(|&(name, list)| (name, texts(list)));
    writeln!(out, "<FieldData>")?;
    for (name, values) in std::iter::once(version).chain(others) {
        let name = quick_xml::escape::escape(name);
        let (tuples, values): (usize, String) = (values.len(), values.join(" "));
        writeln!(
            out,
            "<DataArray type=\"Float64\" Name=\"{name}\" NumberOfTuples=\"{tuples}\" format=\"ascii\"> {values}</DataArray>"
        )?;
    }
    writeln!(out, "</FieldData>")
}

/// The arrays on points or cells; the first scalar, vector and tensor are marked as a viewer's
/// defaults.
fn write_fields(out: &mut impl Write, tag: &str, fields: &[VtuField]) -> Result<()> {
    write!(out, "<{tag}")?;
    for (attribute, components) in [("Scalars", 1), ("Vectors", 3), ("Tensors", 9)] {
        if let Some(field) = fields.iter().find(|f| f.components == components) {
            let name = quick_xml::escape::escape(field.name);
            write!(out, " {attribute}=\"{name}\"")?;
        }
    }
    writeln!(out, ">")?;
    for field in fields {
        let number = |value: f64| (value as f32).to_le_bytes();
        let name = (field.name, field.components);
        write_array(out, "Float32", name, field.values, number)?;
    }
    writeln!(out, "</{tag}>")
}

/// Positions of the points, in double precision.
fn write_points(out: &mut impl Write, points: &[[f64; 3]]) -> Result<()> {
    writeln!(out, "<Points>")?;
    let coordinates = points.as_flattened();
    write_array(out, "Float64", ("Points", 3), coordinates, f64::to_le_bytes)?;
    writeln!(out, "</Points>")
}

/// The points of each cell, one after the other, and where each cell ends.
fn write_cells<const N: usize>(out: &mut impl Write, cells: &[[usize; N]]) -> Result<()> {
    let ends: Vec<usize> = (1..=cells.len()).map(|cell| N * cell).collect();
    let number = |n: usize| (n as i64).to_le_bytes();
    let points = cells.as_flattened();
    write_array(out, "Int64", ("connectivity", 1), points, number)?;
    write_array(out, "Int64", ("offsets", 1), &ends, number)
}

fn zlib(bytes: &[u8], level: Compression) -> Result<Vec<u8>> {
    let mut encoder = ZlibEncoder::new(Vec::with_capacity(bytes.len()), level);
    encoder.write_all(bytes)?;
    encoder.finish()
}

/// A header with the number of blocks, their size, the last block's size (0 if it is full) and the
/// compressed sizes, then the blocks; both in base64. `number` returns a value's bytes in the file.
fn write_array<T: Copy + Sync, const N: usize>(
    out: &mut impl Write,
    kind: &str,
    (name, components): (&str, usize),
    values: &[T],
    number: impl Fn(T) -> [u8; N] + Sync,
) -> Result<()> {
    let name = quick_xml::escape::escape(name);
    write!(out, "<DataArray type=\"{kind}\" Name=\"{name}\"")?;
    // Some readers turn an array with one stated component into a matrix of one column.
    if components != 1 {
        write!(out, " NumberOfComponents=\"{components}\"")?;
    }
    writeln!(out, " format=\"binary\">")?;
    let packed = |block: &[T]| {
        let mut bytes = vec![0; N * block.len()];
        for (place, &value) in bytes.chunks_exact_mut(N).zip(block) {
            place.copy_from_slice(&number(value));
        }
        let sample = &bytes[..bytes.len() / SAMPLE];
        let mut level = Compression::none();
        if 4 * zlib(sample, Compression::fast())?.len() <= 3 * sample.len() {
            level = Compression::fast();
        }
        zlib(&bytes, level)
    };
    let blocks: Result<Vec<Vec<u8>>> = values.par_chunks(BLOCK).map(packed).collect();
    let blocks = blocks?;
    let sizes = [blocks.len(), N * BLOCK, N * (values.len() % BLOCK)];
    let sizes = sizes.into_iter().chain(blocks.iter().map(Vec::len));
    let header: Vec<u8> = sizes.flat_map(|n| (n as u64).to_le_bytes()).collect();
    write!(out, "{}", STANDARD.encode(header))?;
    let mut encoder = EncoderWriter::new(&mut *out, &STANDARD);
    for block in &blocks {
        encoder.write_all(block)?;
    }
    encoder.finish()?;
    drop(encoder);
    writeln!(out, "\n</DataArray>")
}

/// Writes quadrilaterals over `points` [m], each with the indices of its four points in order
/// around it, and `point_data` as a VTP file (polygons) that VTK and pyvista read; `kufe_version`
/// is added as field data.
///
/// # Errors
/// [`MeshError::Invalid`] where an array does not fit the points, or where it cannot be written.
pub fn write_vtp(
    points: &[[f64; 3]],
    quadrilaterals: &[[usize; 4]],
    point_data: &[VtuField],
    writer: impl Write,
) -> std::result::Result<(), MeshError> {
    let (count, faces) = (points.len(), quadrilaterals.len());
    fits(point_data, count)?;
    let counts = format!(
        "NumberOfPoints=\"{count}\" NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\" \
         NumberOfPolys=\"{faces}\""
    );
    let piece = |out: &mut BufWriter<_>| {
        write_fields(out, "PointData", point_data)?;
        write_points(out, points)?;
        writeln!(out, "<Polys>")?;
        write_cells(out, quadrilaterals)?;
        writeln!(out, "</Polys>")
    };
    write_file("PolyData", &[], &counts, piece, writer)
}

/// Writes a PVD file, which ParaView opens as a time series, from pairs of time (or load, or
/// another parameter) and file.
///
/// # Errors
/// Those of the writer.
pub fn write_pvd(steps: &[(f64, &str)], mut writer: impl Write) -> std::io::Result<()> {
    writeln!(
        writer,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"Collection\" version=\"0.1\" \
         byte_order=\"LittleEndian\">\n  <Collection>"
    )?;
    for &(time, file) in steps {
        let file = quick_xml::escape::escape(file);
        writeln!(
            writer,
            "    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>"
        )?;
    }
    writeln!(writer, "  </Collection>\n</VTKFile>")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_that_do_not_shrink_are_stored_and_the_others_are_packed() {
        let written = |values: &[f64]| {
            let mut out = Vec::new();
            let number = |value: f64| (value as f32).to_le_bytes();
            write_array(&mut out, "Float32", ("x", 1), values, number).unwrap();
            out.len() as f64 / (4.0 * values.len() as f64)
        };
        let zeros = vec![0.0; 3 * BLOCK + 5];
        assert!(written(&zeros) < 0.02);
        let irregular = |i: usize| (0.37 * i as f64 * i as f64).sin();
        let any: Vec<f64> = (0..3 * BLOCK + 5).map(irregular).collect();
        // Base64 writes three bytes as four.
        assert!((written(&any) * 0.75 - 1.0).abs() < 0.01);
    }
}
