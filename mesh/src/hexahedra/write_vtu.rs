//! Hexahedral meshes and their fields as VTU files, and series of them as PVD files.

use std::io::Write;

use vtkio::{
    model::{
        Attribute, Attributes, ByteOrder, CellType, Cells, DataSet, UnstructuredGridPiece, Version,
        VertexNumbers, Vtk,
    },
    xml::Compressor,
};

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::HexMesh;

/// Block size of vtkio's compressor; it writes arrays of whole blocks in a way that VTK cannot read.
const BLOCK: usize = 32_768;

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
) -> Result<(), MeshError> {
    let sizes = [
        24 * mesh.points.len(),
        64 * mesh.cells.len(),
        8 * mesh.cells.len(),
        mesh.cells.len(),
    ];
    let fields = point_data
        .iter()
        .chain(cell_data)
        .map(|f| 8 * f.values.len());
    let compressible = sizes
        .into_iter()
        .chain(fields)
        .all(|bytes| bytes % BLOCK != 0);
    let piece = UnstructuredGridPiece {
        points: mesh
            .points
            .iter()
            .flatten()
            .copied()
            .collect::<Vec<f64>>()
            .into(),
        cells: Cells {
            cell_verts: VertexNumbers::XML {
                connectivity: mesh.cells.iter().flatten().map(|&n| n as u64).collect(),
                offsets: (1..=mesh.cells.len() as u64).map(|n| 8 * n).collect(),
            },
            types: vec![CellType::Hexahedron; mesh.cells.len()],
        },
        data: Attributes {
            point: attributes(point_data, mesh.points.len())?,
            cell: attributes(cell_data, mesh.cells.len())?,
        },
    };
    let file = Vtk {
        version: Version::new_xml(1, 0),
        title: String::new(),
        byte_order: ByteOrder::LittleEndian,
        data: DataSet::inline(piece),
        file_path: None,
    };
    let compressor = if compressible {
        Compressor::ZLib
    } else {
        Compressor::None
    };
    let xml = file
        .try_into_xml_format(compressor, 1)
        .map_err(|e| MeshError::Vtu(e.to_string()))?;
    let mut out = std::io::BufWriter::new(writer);
    xml.write(&mut out)
        .map_err(|e| MeshError::Vtu(e.to_string()))?;
    out.flush().map_err(|e| MeshError::Vtu(e.to_string()))
}

fn attributes(fields: &[VtuField], count: usize) -> Result<Vec<Attribute>, MeshError> {
    let attribute = |field: &VtuField| {
        if field.components == 0 || field.values.len() != field.components * count {
            return Err(MeshError::FieldLength {
                name: field.name.to_string(),
                found: field.values.len(),
                expected: field.components * count,
            });
        }
        let attribute = match field.components {
            1 => Attribute::scalars(field.name, 1),
            3 => Attribute::vectors(field.name),
            9 => Attribute::tensors(field.name),
            n => Attribute::generic(field.name, n as u32),
        };
        Ok(attribute.with_data(field.values.to_vec()))
    };
    fields.iter().map(attribute).collect()
}

/// Writes a PVD file, which ParaView opens as time: pairs of time (or load, or whatever is stepped) and file.
///
/// # Errors
/// Those of the writer.
pub fn write_pvd(steps: &[(f64, &str)], mut writer: impl Write) -> std::io::Result<()> {
    writeln!(writer, "<?xml version=\"1.0\"?>")?;
    writeln!(
        writer,
        "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">"
    )?;
    writeln!(writer, "  <Collection>")?;
    for &(time, file) in steps {
        let file = quick_xml::escape::escape(file);
        writeln!(
            writer,
            "    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>"
        )?;
    }
    writeln!(writer, "  </Collection>")?;
    writeln!(writer, "</VTKFile>")
}
