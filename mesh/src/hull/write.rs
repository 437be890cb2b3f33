//! Hulls to OBJ, GLB and STL files, in metres.

use std::{
    borrow::Cow,
    io::{Error, Result, Write},
};

use serde_json::json;

use crate::hull::triangles::Hull;

/// Writes `hull` as OBJ, z up, coordinates in full precision.
///
/// # Errors
/// Those of the writer.
pub fn write_obj(hull: &Hull, writer: impl Write) -> Result<()> {
    let mut out = std::io::BufWriter::new(writer);
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
pub fn write_stl(hull: &Hull, writer: impl Write) -> Result<()> {
    let facets: Vec<stl_io::Triangle> = hull
        .triangles
        .iter()
        .map(|t| {
            let normal = hull.normal(t);
            let length = normal
                .iter()
                .map(|v| v * v)
                .sum::<f64>()
                .sqrt()
                .max(f64::MIN_POSITIVE);
            stl_io::Triangle {
                normal: stl_io::Normal::new(normal.map(|v| (v / length) as f32)),
                vertices: t
                    .map(|i| stl_io::Vertex::new(hull.positions[i as usize].map(|v| v as f32))),
            }
        })
        .collect();
    let mut out = std::io::BufWriter::new(writer);
    stl_io::write_stl(&mut out, facets.iter())?;
    out.flush()
}

/// Writes `hull` as GLB with one node, y up as glTF has it, in single precision.
///
/// # Errors
/// Those of the writer.
pub fn write_glb(hull: &Hull, writer: impl Write) -> Result<()> {
    let points: Vec<[f32; 3]> = hull
        .positions
        .iter()
        .map(|&[x, y, z]| [x, z, -y].map(|v| v as f32))
        .collect();
    let mut data = Vec::with_capacity(12 * (points.len() + hull.triangles.len()));
    let (mut low, mut high) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for point in &points {
        for (axis, value) in point.iter().enumerate() {
            data.extend(value.to_le_bytes());
            low[axis] = low[axis].min(*value);
            high[axis] = high[axis].max(*value);
        }
    }
    let first_index = data.len();
    data.extend(
        hull.triangles
            .iter()
            .flatten()
            .flat_map(|i| i.to_le_bytes()),
    );
    let root = json!({
        "asset": { "version": "2.0", "generator": "kufe" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "name": "runner" }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": data.len() }],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": first_index, "target": 34962 },
            { "buffer": 0, "byteOffset": first_index, "byteLength": data.len() - first_index, "target": 34963 },
        ],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": points.len(), "type": "VEC3", "min": low, "max": high },
            { "bufferView": 1, "componentType": 5125, "count": 3 * hull.triangles.len(), "type": "SCALAR" },
        ],
    });
    let glb = gltf::binary::Glb {
        header: gltf::binary::Header {
            magic: *b"glTF",
            version: 2,
            length: 0,
        },
        json: Cow::Owned(root.to_string().into_bytes()),
        bin: Some(Cow::Owned(data)),
    };
    let mut out = std::io::BufWriter::new(writer);
    glb.to_writer(&mut out).map_err(Error::other)?;
    out.flush()
}
