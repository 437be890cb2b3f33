//! Hulls to OBJ, GLB and STL files, in metres.

use std::borrow::Cow;
use std::io::{BufWriter, Error, Result, Write};

use serde::Serialize;

use crate::hull::triangles::Hull;

/// The mark of this program in a file that it writes.
const MARK: &str = concat!("kufe ", env!("CARGO_PKG_VERSION"));

/// Writes `hull` as OBJ, z up, coordinates in full precision.
///
/// # Errors
/// Those of the writer.
pub fn write_obj(hull: &Hull, writer: impl Write) -> Result<()> {
    let mut out = BufWriter::new(writer);
    writeln!(out, "# {MARK}")?;
    writeln!(out, "# metres, x forward, y left, z up")?;
    for [x, y, z] in &hull.positions {
        writeln!(out, "v {x} {y} {z}")?;
    }
    for [a, b, c] in &hull.triangles {
        writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1)?;
    }
    out.flush()
}

/// Writes `hull` as binary STL, z up, in single precision.
///
/// # Errors
/// Those of the writer.
pub(crate) fn write_stl(hull: &Hull, writer: impl Write) -> Result<()> {
    let mut out = BufWriter::new(writer);
    let mut header = [0; 80];
    header[..MARK.len()].copy_from_slice(MARK.as_bytes());
    out.write_all(&header)?;
    let count = u32::try_from(hull.triangles.len()).map_err(Error::other)?;
    out.write_all(&count.to_le_bytes())?;
    for t in &hull.triangles {
        let normal = hull.normal(t);
        let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
        let normal = normal.map(|v| v / length.max(f64::MIN_POSITIVE));
        let corners = t.map(|i| hull.positions[i as usize]);
        for value in [normal].iter().chain(&corners).flatten() {
            out.write_all(&(*value as f32).to_le_bytes())?;
        }
        out.write_all(&[0; 2])?;
    }
    out.flush()
}

/// The JSON of a glTF file with one mesh of one primitive.
#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Document {
    asset: Asset,
    scene: u32,
    scenes: [Scene; 1],
    nodes: [Node; 1],
    meshes: [Mesh; 1],
    buffers: [Buffer; 1],
    buffer_views: [BufferView; 2],
    accessors: [Accessor; 2],
}

#[derive(Serialize)]
struct Asset {
    version: &'static str,
    generator: &'static str,
}

#[derive(Serialize)]
struct Scene {
    nodes: [u32; 1],
}

#[derive(Serialize)]
struct Node {
    mesh: u32,
    name: &'static str,
}

#[derive(Serialize)]
struct Mesh {
    primitives: [Primitive; 1],
}

#[derive(Serialize)]
struct Primitive {
    attributes: Attributes,
    indices: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "UPPERCASE")]
struct Attributes {
    position: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    byte_length: usize,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct BufferView {
    buffer: u32,
    byte_offset: usize,
    byte_length: usize,
    /// 34962 for vertices, 34963 for indices.
    target: u32,
}

#[derive(Serialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: u32,
    /// 5126 for 32-bit floats, 5125 for 32-bit unsigned integers.
    component_type: u32,
    count: usize,
    #[serde(rename = "type")]
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    min: Option<[f32; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    max: Option<[f32; 3]>,
}

/// Writes `hull` as GLB with one node, y up as glTF requires, in single precision.
///
/// # Errors
/// Those of the writer.
pub(crate) fn write_glb(hull: &Hull, writer: impl Write) -> Result<()> {
    let (points, triangles) = (hull.positions.len(), hull.triangles.len());
    let mut data = Vec::with_capacity(12 * (points + triangles));
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &[x, y, z] in &hull.positions {
        for (axis, value) in [x, z, -y].map(|v| v as f32).into_iter().enumerate() {
            data.extend(value.to_le_bytes());
            low[axis] = low[axis].min(value);
            high[axis] = high[axis].max(value);
        }
    }
    let first_index = data.len();
    let indices = hull.triangles.iter().flatten();
    data.extend(indices.flat_map(|i| i.to_le_bytes()));
    let view = |byte_offset, byte_length, target| BufferView {
        buffer: 0,
        byte_offset,
        byte_length,
        target,
    };
    let document = Document {
        asset: Asset {
            version: "2.0",
            generator: MARK,
        },
        scene: 0,
        scenes: [Scene { nodes: [0] }],
        nodes: [Node {
            mesh: 0,
            name: "runner",
        }],
        meshes: [Mesh {
            primitives: [Primitive {
                attributes: Attributes { position: 0 },
                indices: 1,
            }],
        }],
        buffers: [Buffer {
            byte_length: data.len(),
        }],
        buffer_views: [
            view(0, first_index, 34962),
            view(first_index, data.len() - first_index, 34963),
        ],
        accessors: [
            Accessor {
                buffer_view: 0,
                component_type: 5126,
                count: points,
                kind: "VEC3",
                min: Some(low),
                max: Some(high),
            },
            Accessor {
                buffer_view: 1,
                component_type: 5125,
                count: 3 * triangles,
                kind: "SCALAR",
                min: None,
                max: None,
            },
        ],
    };
    let glb = gltf::binary::Glb {
        header: gltf::binary::Header {
            magic: *b"glTF",
            version: 2,
            length: 0,
        },
        json: Cow::Owned(serde_json::to_vec(&document)?),
        bin: Some(Cow::Owned(data)),
    };
    let mut out = BufWriter::new(writer);
    glb.to_writer(&mut out).map_err(Error::other)?;
    out.flush()
}
