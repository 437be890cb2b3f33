//! Hulls from glTF and GLB files.

use std::borrow::Cow;
use std::collections::HashSet;

use base64::{Engine, engine::general_purpose::STANDARD};
use gltf::{
    Accessor, Document, Gltf, Node,
    accessor::{DataType, Dimensions},
    buffer::Source,
    mesh::Mode,
};
use nalgebra::Matrix4;
use percent_encoding::percent_decode_str;

use crate::error::MeshError;
use crate::hull::triangles::{Axis, Hull, HullOptions, PlacedMeshes};

/// Bytes of a triangle with indices of 32 bits, and of a vertex in single precision.
const BYTES_PER_TRIANGLE: usize = 12;
/// Extensions that a file may require although they do not change its triangles, by their
/// beginning.
const WITHOUT_EFFECT: &str = "KHR_materials_ KHR_texture_ EXT_texture_ KHR_lights_";
/// Extensions that compress triangles, the names of their methods, and the tools that decompress
/// them: Blender reads Draco, but up to version 5.1 not meshopt.
const COMPRESSIONS: [[&str; 3]; 3] = [
    ["KHR_draco_mesh_compression", "Draco", BLENDER],
    ["EXT_meshopt_compression", "meshopt", GLTFPACK],
    ["KHR_meshopt_compression", "meshopt", GLTFPACK],
];
const BLENDER: &str = "in Blender: import it, export glTF with Compression off";
const GLTFPACK: &str = "`npx gltfpack -i in.glb -o out.glb -noq`";

/// Reads the triangles of a glTF file's scene, text or binary, with node transforms applied.
///
/// Lists, strips and fans of triangles are read, and positions that are quantized
/// (`KHR_mesh_quantization`). `open` returns the bytes of an external buffer, given its URI in the
/// glTF file. The up axis of the file is y unless `options` state another one.
///
/// # Errors
/// [`MeshError::Invalid`] if the triangles are compressed, if the file cannot be parsed or refers
/// to data that do not exist, if its meshes, each used many times, make more than a million
/// triangles and more than the file can hold; and those of a hull without triangles or with
/// positions that are not finite.
pub fn read_gltf(
    bytes: &[u8],
    options: &HullOptions,
    open: impl Fn(&str) -> std::io::Result<Vec<u8>>,
) -> Result<Hull, MeshError> {
    let rows = options.rows(Axis::Y)?;
    check_length(bytes)?;
    let (document, mut blob) = parse(bytes)?;
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let data = match buffer.source() {
            Source::Bin => blob.take().unwrap_or_default(),
            Source::Uri(uri) => match embedded_text(uri) {
                Some(text) => STANDARD.decode(text).unwrap_or_default(),
                None => open(&file_name(uri)).map_err(|error| {
                    MeshError::Invalid(format!("glTF buffer file {uri:?}: {error}"))
                })?,
            },
        };
        if data.len() < buffer.length() {
            return Err(MeshError::Invalid(format!(
                "glTF buffer {} announces {} bytes; it has {}",
                buffer.index(),
                buffer.length(),
                data.len()
            )));
        }
        buffers.push(data);
    }
    let length = bytes.len() + buffers.iter().map(Vec::len).sum::<usize>();
    let mut reader = Reader {
        buffers,
        placed: PlacedMeshes {
            capacity: length / BYTES_PER_TRIANGLE,
            ..PlacedMeshes::default()
        },
        seen: HashSet::new(),
    };
    let mut scenes = document.scenes();
    match document.default_scene().or_else(|| scenes.next()) {
        Some(scene) => scene.nodes().try_for_each(|node| reader.node(node))?,
        None => {
            let mut meshes = document.meshes();
            meshes.try_for_each(|mesh| reader.mesh(&mesh, &Matrix4::identity()))?;
        }
    }
    reader.placed.welded(rows)
}

/// The URIs of the external buffers of a glTF file.
///
/// # Errors
/// As [`read_gltf`] where the file cannot be parsed.
pub(crate) fn outer_buffers(bytes: &[u8]) -> Result<Vec<String>, MeshError> {
    check_length(bytes)?;
    let (document, _) = parse(bytes)?;
    let buffers = document.buffers();
    let uris = buffers.filter_map(|buffer| match buffer.source() {
        Source::Uri(uri) if embedded_text(uri).is_none() => Some(file_name(uri).into_owned()),
        _ => None,
    });
    Ok(uris.collect())
}

/// The text of a buffer embedded in the glTF file.
fn embedded_text(uri: &str) -> Option<&str> {
    let (_, text) = uri.strip_prefix("data:")?.split_once(";base64,")?;
    Some(text)
}

/// The name of a buffer's file: a URI has a blank as `%20`.
fn file_name(uri: &str) -> Cow<'_, str> {
    percent_decode_str(uri).decode_utf8_lossy()
}

/// Checks the length in the header of a binary file, which includes the header; the library would
/// wrap around if it were smaller.
fn check_length(bytes: &[u8]) -> Result<(), MeshError> {
    let length = bytes
        .get(8..12)
        .map_or(0, |b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
    if bytes.starts_with(b"glTF") && !(20..=bytes.len()).contains(&length) {
        return Err(MeshError::Invalid(format!(
            "the GLB header announces {length} bytes; the file has {}",
            bytes.len()
        )));
    }
    Ok(())
}

/// The validated document and the binary chunk.
///
/// The library's validation indexes accessors before it has checked them, so that they are checked
/// here first.
fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), MeshError> {
    let unparsed = |error| MeshError::Invalid(format!("not a readable glTF file: {error}"));
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes).map_err(unparsed)?;
    let mut root = document.into_json();
    for [extension, method, remedy] in COMPRESSIONS {
        if root
            .extensions_required
            .iter()
            .any(|name| name == extension)
        {
            return Err(MeshError::Invalid(format!(
                "the glTF file is compressed by {method}, which is not read; export it without \
                 compression ({remedy})"
            )));
        }
    }
    root.extensions_required.retain(|name| {
        name != "KHR_mesh_quantization"
            && !WITHOUT_EFFECT
                .split(' ')
                .any(|start| name.starts_with(start))
    });
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let named = primitives.flat_map(|primitive| primitive.attributes.values());
    let mut named = named.map(|index| index.value());
    if let Some(missing) = named.find(|&index| index >= root.accessors.len()) {
        let problem = "a mesh refers to it; there is none of that number";
        return Err(accessor_error(missing, problem));
    }
    Ok((Document::from_json(root).map_err(unparsed)?, blob))
}

fn accessor_error(index: usize, problem: &str) -> MeshError {
    MeshError::Invalid(format!("glTF accessor {index}: {problem}"))
}

struct Reader {
    buffers: Vec<Vec<u8>>,
    placed: PlacedMeshes,
    seen: HashSet<usize>,
}

impl Reader {
    /// Adds a node and its descendants, without recursion, as files may nest to any depth.
    fn node(&mut self, root: Node) -> Result<(), MeshError> {
        let mut waiting = vec![(root, Matrix4::identity())];
        while let Some((node, above)) = waiting.pop() {
            if !self.seen.insert(node.index()) {
                return Err(MeshError::Invalid(format!(
                    "glTF node {} is reached twice; expected a tree",
                    node.index()
                )));
            }
            let own = node.transform().matrix();
            let transform = above * Matrix4::from_fn(|row, column| f64::from(own[column][row]));
            if let Some(mesh) = node.mesh() {
                self.mesh(&mesh, &transform)?;
            }
            waiting.extend(node.children().map(|child| (child, transform)));
        }
        Ok(())
    }

    fn mesh(&mut self, mesh: &gltf::Mesh, transform: &Matrix4<f64>) -> Result<(), MeshError> {
        for primitive in mesh.primitives() {
            let corners_of: fn(usize) -> [usize; 3] = match primitive.mode() {
                Mode::Triangles => |t| [3 * t, 3 * t + 1, 3 * t + 2],
                Mode::TriangleStrip => |t| [t, t + 1 + t % 2, t + 2 - t % 2],
                Mode::TriangleFan => |t| [t + 1, t + 2, 0],
                Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => continue,
            };
            let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else {
                continue;
            };
            let vertices = self.positions_of(&accessor)?;
            let indices = match primitive.indices() {
                Some(indices) => self.indices_of(&indices)?,
                None => (0..vertices.len()).collect(),
            };
            let count = match primitive.mode() {
                Mode::Triangles => indices.len() / 3,
                _ => indices.len().saturating_sub(2),
            };
            let triangles = (0..count).map(|t| corners_of(t).map(|i| indices[i]));
            self.placed.add(&vertices, triangles, transform)?;
        }
        Ok(())
    }

    fn positions_of(&self, accessor: &Accessor) -> Result<Vec<[f64; 3]>, MeshError> {
        if accessor.dimensions() != Dimensions::Vec3 {
            let problem = "positions must have three components";
            return Err(accessor_error(accessor.index(), problem));
        }
        let data_type = accessor.data_type();
        let size = data_type.size();
        let four = |b: &[u8]| [b[0], b[1], b[2], b[3]];
        // A component, and the largest value of its type, to which normalized integers are
        // relative.
        let component = |b: &[u8]| match data_type {
            DataType::I8 => (f64::from(b[0] as i8), f64::from(i8::MAX)),
            DataType::U8 => (f64::from(b[0]), f64::from(u8::MAX)),
            DataType::I16 => (i16::from_le_bytes([b[0], b[1]]).into(), f64::from(i16::MAX)),
            DataType::U16 => (u16::from_le_bytes([b[0], b[1]]).into(), f64::from(u16::MAX)),
            DataType::U32 => (u32::from_le_bytes(four(b)).into(), f64::from(u32::MAX)),
            DataType::F32 => (f32::from_le_bytes(four(b)).into(), 1.0),
        };
        let value = |b: &[u8]| match component(b) {
            (value, largest) if accessor.normalized() && largest > 1.0 => {
                (value / largest).max(-1.0)
            }
            (value, _) => value,
        };
        let three = |b: &[u8]| [0, 1, 2].map(|k| value(&b[k * size..]));
        Ok(self.elements(accessor)?.map(three).collect())
    }

    fn indices_of(&self, accessor: &Accessor) -> Result<Vec<usize>, MeshError> {
        let data_type = accessor.data_type();
        let unsigned = matches!(data_type, DataType::U8 | DataType::U16 | DataType::U32);
        if !unsigned || accessor.dimensions() != Dimensions::Scalar {
            let problem = "indices must be unsigned integers";
            return Err(accessor_error(accessor.index(), problem));
        }
        let index = |b: &[u8]| {
            let bytes = b.iter().rev();
            bytes.fold(0, |sum, &byte| (sum << 8) | usize::from(byte))
        };
        Ok(self.elements(accessor)?.map(index).collect())
    }

    /// The bytes of each element of an accessor, with every offset checked against view and buffer.
    fn elements<'a>(
        &'a self,
        accessor: &Accessor,
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, MeshError> {
        let fail = |problem| accessor_error(accessor.index(), problem);
        if accessor.sparse().is_some() {
            return Err(fail("sparse accessors are not supported"));
        }
        let view = accessor.view();
        let view = view.ok_or_else(|| fail("it has no buffer view"))?;
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return Err(fail("its stride is shorter than an element"));
        }
        let buffer = self.buffers.get(view.buffer().index());
        let buffer = buffer.ok_or_else(|| fail("its buffer does not exist"))?;
        let view_end = view.offset().checked_add(view.length());
        let in_view = view_end.and_then(|end| buffer.get(view.offset()..end));
        let in_view = in_view.ok_or_else(|| fail("its buffer view ends after the buffer"))?;
        let last = accessor.count().checked_sub(1);
        let span = last.and_then(|n| n.checked_mul(stride)?.checked_add(size));
        let end = span.and_then(|span| span.checked_add(accessor.offset()));
        let bytes = end.and_then(|end| in_view.get(accessor.offset()..end));
        let bytes = bytes.ok_or_else(|| fail("its elements end after the buffer view"))?;
        Ok(bytes.chunks(stride).map(move |chunk| &chunk[..size]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One triangle (0,0,0) (1,0,0) (0,1,0) with 16-bit indices, its node moved, turned or scaled
    /// by `node`.
    fn file(node: &str, announced: usize, count: usize, index: u16) -> String {
        let mut data = Vec::new();
        for value in [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
            data.extend(value.to_le_bytes());
        }
        for value in [0u16, 1, index] {
            data.extend(value.to_le_bytes());
        }
        let uri = STANDARD.encode(&data);
        format!(
            r#"{{"asset":{{"version":"2.0"}},"scene":0,"scenes":[{{"nodes":[0]}}],
            "nodes":[{{"children":[1]{node}}},{{"mesh":0}}],
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}],
            "buffers":[{{"byteLength":{announced},"uri":"data:application/octet-stream;base64,{uri}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":36}},{{"buffer":0,"byteOffset":36,"byteLength":6}}],
            "accessors":[{{"bufferView":0,"componentType":5126,"count":{count},"type":"VEC3","min":[0,0,0],"max":[1,1,0]}},
            {{"bufferView":1,"componentType":5123,"count":3,"type":"SCALAR"}}]}}"#
        )
    }

    fn read(text: &str) -> Result<Hull, MeshError> {
        read_gltf(text.as_bytes(), &HullOptions::default(), |_| {
            Err(std::io::ErrorKind::NotFound.into())
        })
    }

    #[test]
    fn node_transforms_are_applied_and_y_is_up() {
        let hull = read(&file(r#","translation":[0,5,0],"scale":[2,2,2]"#, 42, 3, 2)).unwrap();
        assert_eq!(
            hull.positions,
            [[0.0, 0.0, 5.0], [2.0, 0.0, 5.0], [0.0, 0.0, 7.0]]
        );
        let mirrored = read(&file(r#","scale":[1,1,-1]"#, 42, 3, 2)).unwrap();
        let plain = read(&file("", 42, 3, 2)).unwrap();
        let normal = |hull: &Hull| hull.normal(&hull.triangles[0]);
        assert_eq!(normal(&plain)[1], -1.0);
        assert_eq!(normal(&mirrored)[1], 1.0);
    }

    /// A file of one primitive whose positions are `data` of this component type.
    fn one_primitive(
        data: &[u8],
        component: u32,
        normalized: bool,
        mode: u32,
        nodes: &str,
    ) -> String {
        let size = match component {
            5120 | 5121 => 4,
            5122 | 5123 => 8,
            _ => 12,
        };
        format!(
            r#"{{"asset":{{"version":"2.0"}},"extensionsRequired":["KHR_mesh_quantization"],"extensionsUsed":["KHR_mesh_quantization"],
            "scenes":[{{"nodes":[0]}}],"nodes":{nodes},
            "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"mode":{mode}}}]}}],
            "buffers":[{{"byteLength":{0},"uri":"data:application/octet-stream;base64,{1}"}}],
            "bufferViews":[{{"buffer":0,"byteLength":{0},"byteStride":{size}}}],
            "accessors":[{{"bufferView":0,"componentType":{component},"normalized":{normalized},"count":{2},"type":"VEC3",
            "min":[-1,-1,-1],"max":[1,1,1]}}]}}"#,
            data.len(),
            STANDARD.encode(data),
            data.len() / size
        )
    }

    const ONE_NODE: &str = r#"[{"mesh":0}]"#;

    #[test]
    fn quantized_positions_are_scaled_by_their_type_and_node() {
        // Three corners with a byte or a word to spare each.
        let bytes: [[i8; 4]; 3] = [[-128, 0, 0, 0], [127, 0, 0, 0], [0, 0, 127, 0]];
        let bytes: Vec<u8> = bytes.concat().iter().map(|&b| b as u8).collect();
        let words: Vec<u8> = [0u16, 0, 0, 0, 65535, 0, 0, 0, 0, 0, 13107, 0]
            .iter()
            .flat_map(|w| w.to_le_bytes())
            .collect();
        // File y is up: (x, y, z) becomes (x, -z, y).
        let read_positions = |text: &str| read(text).unwrap().positions;
        assert_eq!(
            read_positions(&one_primitive(&bytes, 5120, true, 4, ONE_NODE)),
            [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -1.0, 0.0]]
        );
        assert_eq!(
            read_positions(&one_primitive(&words, 5123, true, 4, ONE_NODE)),
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, -0.2, 0.0]]
        );
        let scaled = r#"[{"mesh":0,"scale":[0.5,0.5,0.5],"translation":[1,0,0]}]"#;
        assert_eq!(
            read_positions(&one_primitive(&words, 5123, false, 4, scaled)),
            [[1.0, 0.0, 0.0], [32768.5, 0.0, 0.0], [1.0, -6553.5, 0.0]]
        );
    }

    #[test]
    fn strips_and_fans_face_the_same_way_as_lists() {
        let floats = |points: &[[f32; 3]]| -> Vec<u8> {
            points
                .concat()
                .iter()
                .flat_map(|v| v.to_le_bytes())
                .collect()
        };
        let [a, b, c, d] = [
            [0.0, 0.0, 0.0],
            [1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0],
            [1.0, 0.0, 1.0],
        ];
        for (points, mode) in [(vec![a, b, c, d], 5), (vec![a, b, d, c], 6)] {
            let hull = read(&one_primitive(
                &floats(&points),
                5126,
                false,
                mode,
                ONE_NODE,
            ))
            .unwrap();
            assert_eq!(hull.triangles.len(), 2);
            for t in &hull.triangles {
                assert_eq!(hull.normal(t), [0.0, 0.0, -1.0], "{mode}");
            }
        }
        // Lines and points have no triangles.
        assert!(read(&one_primitive(&floats(&[a, b]), 5126, false, 1, ONE_NODE)).is_err());
    }

    #[test]
    fn nested_transforms_multiply_and_mirrors_keep_the_outside() {
        let floats: Vec<u8> = [0.0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]
            .iter()
            .flat_map(|v| v.to_le_bytes())
            .collect();
        for child in ["-1,1,1", "-1,1,-1"] {
            let nodes = format!(
                r#"[{{"children":[1],"matrix":[-2,0,0,0, 0,2,0,0, 0,0,2,0, 0,3,0,1]}},
                {{"children":[2],"scale":[{child}]}},{{"mesh":0,"translation":[1,0,0]}}]"#
            );
            let hull = read(&one_primitive(&floats, 5126, false, 4, &nodes)).unwrap();
            assert_eq!(hull.positions[0], [2.0, 0.0, 3.0]);
            assert_eq!(hull.normal(&hull.triangles[0])[2], -4.0, "{child}");
        }
    }

    #[test]
    fn a_mesh_used_too_often_is_refused() {
        let uses: Vec<String> = (1..=1100).map(|k| k.to_string()).collect();
        let nodes = r#",{"mesh":0}"#.repeat(uses.len());
        let nodes = format!(r#"[{{"children":[{}]}}{nodes}]"#, uses.join(","));
        let fan = one_primitive(&[0; 4000], 5120, true, 6, &nodes);
        let message = read(&fan).unwrap_err().to_string();
        assert!(message.contains("more than 1000000"), "{message}");
    }

    #[test]
    fn compressed_files_are_refused_with_the_remedy() {
        let data = [0; 36];
        for (extension, method) in [
            ("KHR_draco_mesh_compression", "Draco"),
            ("EXT_meshopt_compression", "meshopt"),
        ] {
            let text = one_primitive(&data, 5126, false, 4, ONE_NODE);
            let message = read(&text.replace("KHR_mesh_quantization", extension))
                .unwrap_err()
                .to_string();
            assert!(
                message.contains(method) && message.contains("without compression"),
                "{message}"
            );
        }
        let text = one_primitive(&data, 5126, false, 4, ONE_NODE);
        let message = read(&text.replace("KHR_mesh_quantization", "EXT_of_tomorrow"));
        assert!(message.unwrap_err().to_string().contains("EXT_of_tomorrow"));
        let textured = read(&text.replace("KHR_mesh_quantization", "KHR_texture_basisu"));
        assert!(textured.unwrap_err().to_string().contains("no triangles"));
    }

    #[test]
    fn files_with_wrong_lengths_or_references_are_refused() {
        for (text, part) in [
            (file("", 1_000_000_000_000, 3, 2), "1000000000000 bytes"),
            (file("", 42, 4_000_000_000, 2), "after the buffer view"),
            (file("", 42, 3, 77), "77"),
            (
                file("", 42, 3, 2).replace("\"byteOffset\":36", "\"byteOffset\":4000"),
                "after the buffer",
            ),
            (
                file(r#","children":[0]"#, 42, 3, 2).replacen(r#""children":[1],"#, "", 1),
                "node 0",
            ),
            (
                file("", 42, 3, 2).replace(r#""mesh":0"#, r#""mesh":7"#),
                "glTF",
            ),
            (
                file("", 42, 3, 2).replace("data:application/octet-stream;base64,", "hull.bin?"),
                "hull.bin",
            ),
            ("{}".into(), "glTF"),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn glb_with_a_wrong_length_is_refused() {
        let glb = |length: u32| {
            let mut bytes = b"glTF".to_vec();
            bytes.extend(2u32.to_le_bytes());
            bytes.extend(length.to_le_bytes());
            bytes.extend([0; 12]);
            read_gltf(&bytes, &HullOptions::default(), |_| Ok(Vec::new()))
                .unwrap_err()
                .to_string()
        };
        assert!(glb(3).contains("3 bytes"));
        assert!(glb(u32::MAX).contains("4294967295 bytes"));
    }
}
