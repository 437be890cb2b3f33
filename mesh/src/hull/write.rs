//! Hulls to OBJ, GLB and STL files, in metres.

use std::borrow::Cow;
use std::io::{BufWriter, Error, Result, Write};

use nalgebra::Vector3;

use crate::hull::triangles::Hull;

/// The mark of this program in a file that it writes.
const MARK: &str = concat!("kufe ", env!("CARGO_PKG_VERSION"));

/// Writes `hull` as OBJ, z up, coordinates in full precision.
///
/// # Errors
/// Those of the writer.
pub(crate) fn write_obj(hull: &Hull, writer: impl Write) -> Result<()> {
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
        let normal = Vector3::from(hull.normal(t));
        let normal = (normal / normal.norm().max(f64::MIN_POSITIVE)).into();
        let corners = t.map(|i| hull.positions[i as usize]);
        for value in [normal].iter().chain(&corners).flatten() {
            out.write_all(&(*value as f32).to_le_bytes())?;
        }
        out.write_all(&[0; 2])?;
    }
    out.flush()
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
            (low[axis], high[axis]) = (low[axis].min(value), high[axis].max(value));
        }
    }
    let first_index = data.len();
    let indices = hull.triangles.iter().flatten();
    data.extend(indices.flat_map(|i| i.to_le_bytes()));
    let [low, high] = [serde_json::to_string(&low)?, serde_json::to_string(&high)?];
    // Component types 5126 and 5125 are 32-bit floats and 32-bit unsigned integers; targets 34962
    // and 34963 are vertices and indices.
    let json = format!(
        concat!(
            r#"{{"asset":{{"version":"2.0","generator":"{mark}"}},"scene":0,"scenes":[{{"nodes":[0]}}],"#,
            r#""nodes":[{{"mesh":0,"name":"runner"}}],"#,
            r#""meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],"#,
            r#""buffers":[{{"byteLength":{bytes}}}],"#,
            r#""bufferViews":[{{"buffer":0,"byteOffset":0,"byteLength":{first},"target":34962}},"#,
            r#"{{"buffer":0,"byteOffset":{first},"byteLength":{rest},"target":34963}}],"#,
            r#""accessors":[{{"bufferView":0,"componentType":5126,"count":{points},"type":"VEC3","#,
            r#""min":{low},"max":{high}}},"#,
            r#"{{"bufferView":1,"componentType":5125,"count":{corners},"type":"SCALAR"}}]}}"#
        ),
        mark = MARK,
        bytes = data.len(),
        first = first_index,
        rest = data.len() - first_index,
        points = points,
        low = low,
        high = high,
        corners = 3 * triangles,
    );
    let glb = gltf::binary::Glb {
        header: gltf::binary::Header {
            magic: *b"glTF",
            version: 2,
            length: 0,
        },
        json: Cow::Owned(json.into_bytes()),
        bin: Some(Cow::Owned(data)),
    };
    let mut out = BufWriter::new(writer);
    glb.to_writer(&mut out).map_err(Error::other)?;
    out.flush()
}
