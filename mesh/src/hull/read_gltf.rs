//! Hulls from glTF and GLB files.

use std::collections::HashSet;

use base64::{Engine, engine::general_purpose::STANDARD};
use gltf::{
    Accessor, Document, Gltf, Node,
    accessor::{DataType, Dimensions},
    buffer::Source,
    mesh::Mode,
};
use nalgebra::{Matrix4, Point3};

use crate::error::MeshError;
use crate::hull::axes::{Axis, HullOptions};
use crate::hull::triangles::Hull;

/// Most triangles, and most vertices, read from one file; nodes may use one mesh many times.
const MOST_TRIANGLES: usize = 50_000_000;

/// Reads the triangles of a glTF file's scene, text or binary, node transforms applied.
///
/// `open` finds a buffer kept in a file of its own by its address in the glTF file; embedded
/// buffers do not need it. The file's up is y unless `options` say otherwise.
///
/// # Errors
/// [`MeshError::Gltf`] where the file cannot be parsed; [`MeshError::GltfBuffer`],
/// [`MeshError::GltfAccessor`] and [`MeshError::GltfNode`] where it refers to what is not there;
/// and those of a hull without triangles or with positions that are no numbers.
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
                None => open(uri).map_err(|source| MeshError::GltfFile {
                    uri: uri.into(),
                    source,
                })?,
            },
        };
        if data.len() < buffer.length() {
            let (index, announced, found) = (buffer.index(), buffer.length(), data.len());
            return Err(MeshError::GltfBuffer {
                index,
                announced,
                found,
            });
        }
        buffers.push(data);
    }
    let mut reader = Reader {
        buffers,
        positions: Vec::new(),
        triangles: Vec::new(),
        seen: HashSet::new(),
    };
    let scene = document
        .default_scene()
        .or_else(|| document.scenes().next());
    match scene {
        Some(scene) => scene
            .nodes()
            .try_for_each(|node| reader.node(&node, &Matrix4::identity()))?,
        None => {
            for mesh in document.meshes() {
                reader.mesh(&mesh, &Matrix4::identity())?;
            }
        }
    }
    Hull::welded(&reader.positions, reader.triangles.into_iter(), rows)
}

/// The addresses of the buffers that a glTF file keeps in files of their own.
///
/// # Errors
/// As [`read_gltf`] where the file cannot be parsed.
pub(crate) fn outer_buffers(bytes: &[u8]) -> Result<Vec<String>, MeshError> {
    check_length(bytes)?;
    let (document, _) = parse(bytes)?;
    let uris = document
        .buffers()
        .filter_map(|buffer| match buffer.source() {
            Source::Uri(uri) if embedded_text(uri).is_none() => Some(uri.to_owned()),
            _ => None,
        });
    Ok(uris.collect())
}

/// The text of a buffer that stands in the glTF file itself.
fn embedded_text(uri: &str) -> Option<&str> {
    let (_, text) = uri.strip_prefix("data:")?.split_once(";base64,")?;
    Some(text)
}

/// The header's length of a binary file counts itself; less than that would wrap around.
fn check_length(bytes: &[u8]) -> Result<(), MeshError> {
    if bytes.starts_with(b"glTF") {
        let length = bytes
            .get(8..12)
            .map(|b| u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize);
        if length.is_none_or(|length| length < 20 || length > bytes.len()) {
            return Err(MeshError::GlbLength {
                announced: length.unwrap_or(0),
                found: bytes.len(),
            });
        }
    }
    Ok(())
}

/// The validated document and the binary chunk.
///
/// The library's own validation indexes accessors before it has checked them, so that comes first here.
fn parse(bytes: &[u8]) -> Result<(Document, Option<Vec<u8>>), MeshError> {
    let Gltf { document, blob } = Gltf::from_slice_without_validation(bytes)?;
    let root = document.into_json();
    let primitives = root.meshes.iter().flat_map(|mesh| &mesh.primitives);
    let named = primitives.flat_map(|primitive| primitive.attributes.values());
    if let Some(missing) = named
        .map(|index| index.value())
        .find(|&index| index >= root.accessors.len())
    {
        return Err(MeshError::GltfAccessor {
            index: missing,
            problem: "a mesh refers to it; there is none of that number",
        });
    }
    Ok((Document::from_json(root)?, blob))
}

struct Reader {
    buffers: Vec<Vec<u8>>,
    positions: Vec<[f64; 3]>,
    triangles: Vec<[usize; 3]>,
    seen: HashSet<usize>,
}

impl Reader {
    /// Adds a node and those below it, without recursion: files may nest as deep as they like.
    fn node(&mut self, root: &Node, transform: &Matrix4<f64>) -> Result<(), MeshError> {
        let mut waiting = vec![(root.clone(), *transform)];
        while let Some((node, above)) = waiting.pop() {
            if !self.seen.insert(node.index()) {
                return Err(MeshError::GltfNode {
                    index: node.index(),
                });
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
        // A transform that mirrors turns outside in.
        let mirrored = transform.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        for primitive in mesh.primitives().filter(|p| p.mode() == Mode::Triangles) {
            let Some(accessor) = primitive.get(&gltf::Semantic::Positions) else {
                continue;
            };
            let first = self.positions.len();
            let local = self.positions_of(&accessor)?;
            let indices = match primitive.indices() {
                Some(indices) => self.indices_of(&indices)?,
                None => (0..local.len()).collect(),
            };
            if self.triangles.len() + indices.len() / 3 > MOST_TRIANGLES
                || first + local.len() > MOST_TRIANGLES
            {
                return Err(MeshError::TooMany {
                    what: "triangles",
                    limit: MOST_TRIANGLES,
                });
            }
            for triangle in indices.chunks_exact(3) {
                let mut corners = [triangle[0], triangle[1], triangle[2]];
                if let Some(&index) = corners.iter().find(|&&i| i >= local.len()) {
                    let (triangle, vertices) = (self.triangles.len() + 1, local.len());
                    return Err(MeshError::VertexIndex {
                        triangle,
                        index,
                        vertices,
                    });
                }
                if mirrored {
                    corners.swap(1, 2);
                }
                self.triangles.push(corners.map(|i| first + i));
            }
            let place =
                |p: &[f64; 3]| -> [f64; 3] { transform.transform_point(&Point3::from(*p)).into() };
            self.positions.extend(local.iter().map(place));
        }
        Ok(())
    }

    fn positions_of(&self, accessor: &Accessor) -> Result<Vec<[f64; 3]>, MeshError> {
        let right =
            accessor.data_type() == DataType::F32 && accessor.dimensions() == Dimensions::Vec3;
        if !right {
            return Err(MeshError::GltfAccessor {
                index: accessor.index(),
                problem: "positions must be three 32-bit floats each",
            });
        }
        let single = |b: &[u8]| f64::from(f32::from_le_bytes([b[0], b[1], b[2], b[3]]));
        Ok(self
            .elements(accessor)?
            .map(|b| [single(b), single(&b[4..]), single(&b[8..])])
            .collect())
    }

    fn indices_of(&self, accessor: &Accessor) -> Result<Vec<usize>, MeshError> {
        let data_type = accessor.data_type();
        let unsigned = matches!(data_type, DataType::U8 | DataType::U16 | DataType::U32);
        if !unsigned || accessor.dimensions() != Dimensions::Scalar {
            return Err(MeshError::GltfAccessor {
                index: accessor.index(),
                problem: "indices must be unsigned integers",
            });
        }
        let index = |b: &[u8]| {
            b.iter()
                .rev()
                .fold(0, |sum, &byte| (sum << 8) | usize::from(byte))
        };
        Ok(self.elements(accessor)?.map(index).collect())
    }

    /// The bytes of each element of an accessor, every place checked against its view and buffer.
    fn elements<'a>(
        &'a self,
        accessor: &Accessor,
    ) -> Result<impl Iterator<Item = &'a [u8]> + use<'a>, MeshError> {
        let fail = |problem| MeshError::GltfAccessor {
            index: accessor.index(),
            problem,
        };
        if accessor.sparse().is_some() {
            return Err(fail("sparse accessors are not supported"));
        }
        let view = accessor
            .view()
            .ok_or_else(|| fail("it has no buffer view"))?;
        let size = accessor.size();
        let stride = view.stride().unwrap_or(size);
        if stride < size {
            return Err(fail("its stride is shorter than an element"));
        }
        let buffer = self
            .buffers
            .get(view.buffer().index())
            .ok_or_else(|| fail("its buffer does not exist"))?;
        let view_end = view
            .offset()
            .checked_add(view.length())
            .filter(|&end| end <= buffer.len());
        let view_end = view_end.ok_or_else(|| fail("its buffer view reaches beyond the buffer"))?;
        let begin = view.offset().checked_add(accessor.offset());
        let span = accessor
            .count()
            .checked_sub(1)
            .and_then(|n| n.checked_mul(stride)?.checked_add(size));
        let end = begin
            .zip(span)
            .and_then(|(begin, span)| begin.checked_add(span))
            .filter(|&end| end <= view_end);
        let (begin, end) = begin
            .zip(end)
            .ok_or_else(|| fail("its elements reach beyond the buffer view"))?;
        Ok(buffer[begin..end]
            .chunks(stride)
            .map(move |chunk| &chunk[..size]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One triangle (0,0,0) (1,0,0) (0,1,0) with 16-bit indices, its node moved, turned or scaled by `node`.
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

    #[test]
    fn files_that_lie_are_refused() {
        for (text, part) in [
            (file("", 1_000_000_000_000, 3, 2), "1000000000000 bytes"),
            (file("", 42, 4_000_000_000, 2), "beyond the buffer view"),
            (file("", 42, 3, 77), "77"),
            (
                file("", 42, 3, 2).replace("\"byteOffset\":36", "\"byteOffset\":4000"),
                "beyond the buffer",
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
    fn glb_with_a_length_that_lies_is_refused() {
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
