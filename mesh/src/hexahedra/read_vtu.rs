//! Hexahedral meshes from VTU files.
//!
//! Every length is checked against the bytes present before anything is allocated.

use std::collections::BTreeMap;
use std::io::Read;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use quick_xml::Reader;
use quick_xml::events::{BytesStart, Event};

use crate::error::MeshError;
use crate::hexahedra::hex_mesh::{HexMesh, cell_type};

/// Reads the hexahedra of a VTU file: text, base64 or raw, appended or not, zlib or uncompressed.
///
/// # Errors
/// [`MeshError::Invalid`] with what is wrong and where, also for other cells than hexahedra, and
/// those of [`HexMesh::checked`].
pub fn read_vtu(bytes: &[u8]) -> Result<HexMesh, MeshError> {
    let file = VtuFile::parse(bytes)?;
    let points = file.array("Points")?;
    let connectivity = file.array("connectivity")?;
    let offsets = file.array("offsets")?;
    let types = file.array("types")?;
    if let Some(cell) = types.iter().position(|&t| t != f64::from(HEXAHEDRON)) {
        return Err(cell_type(cell, "VTK", types[cell]));
    }
    if points.len() % 3 != 0 {
        return Err(problem("Points", "its length is no multiple of three"));
    }
    let mut numbered = offsets.iter().zip(1..);
    let regular = numbered.all(|(&offset, cell)| offset == 8.0 * f64::from(cell));
    if offsets.len() != types.len() || !regular || connectivity.len() != 8 * types.len() {
        let expected = "expected 8, 16, 24 ... for hexahedra, as many as types";
        return Err(problem("offsets", expected));
    }
    if connectivity.iter().any(|&n| n < 0.0) {
        return Err(problem("connectivity", "negative node numbers"));
    }
    let cells = connectivity.as_chunks::<8>().0.iter();
    let cells: Vec<[usize; 8]> = cells.map(|cell| cell.map(|node| node as usize)).collect();
    HexMesh::checked(points.as_chunks().0, &cells)
}

/// The attributes of an element by their names.
type Attributes = BTreeMap<String, String>;

/// A DataArray with its encoded values.
struct Array {
    name: String,
    attributes: Attributes,
    text: String,
}

/// A VTU file taken apart.
struct VtuFile<'a> {
    /// Whether sizes are stored in 8 bytes instead of 4.
    wide_header: bool,
    /// Whether arrays are cut into blocks, each compressed with zlib.
    compressed: bool,
    arrays: Vec<Array>,
    /// Bytes after the underscore of AppendedData, and whether they are raw.
    appended: Option<(&'a [u8], bool)>,
}

impl<'a> VtuFile<'a> {
    /// Parses a file without decoding its arrays.
    fn parse(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let (head, appended) = split_appended(bytes)?;
        let mut reader = Reader::from_reader(head);
        reader.config_mut().check_end_names = false;
        reader.config_mut().expand_empty_elements = true;
        let malformed = |_| problem("XML", "it is not well formed");
        let (mut header, mut arrays) = (Attributes::new(), Vec::new());
        let mut section = Vec::new();
        loop {
            match reader.read_event().map_err(malformed)? {
                Event::Eof => break,
                Event::Start(tag) => match tag.name().as_ref() {
                    b"VTKFile" => header = attributes(&tag),
                    b"DataArray" if section == b"Points" || section == b"Cells" => {
                        let mut attributes = attributes(&tag);
                        let mut name = attributes.remove("Name").unwrap_or_default();
                        if section == b"Points" {
                            name = "Points".into();
                        }
                        let text = reader.read_text(tag.name()).map_err(malformed)?;
                        arrays.push(Array {
                            name,
                            attributes,
                            // VTK adds further elements after the values.
                            text: text.split('<').next().unwrap_or("").to_owned(),
                        });
                    }
                    b"DataArray" => {}
                    name => section = name.to_vec(),
                },
                Event::End(tag) if tag.name().as_ref() != b"DataArray" => section.clear(),
                _ => {}
            }
        }
        let stated = |name: &str| header.get(name).map(String::as_str);
        if stated("type") != Some("UnstructuredGrid") {
            return Err(problem("VTKFile", "expected type UnstructuredGrid"));
        }
        if stated("byte_order") == Some("BigEndian") {
            return Err(problem("VTKFile", "big-endian files are not supported"));
        }
        let compressor = stated("compressor");
        if compressor.is_some_and(|name| name != "vtkZLibDataCompressor") {
            let only = "of the compressors only zlib is supported";
            return Err(problem("VTKFile", only));
        }
        if arrays.iter().filter(|a| a.name == "Points").count() > 1 {
            let several = "files of several pieces are not supported";
            return Err(problem("Points", several));
        }
        Ok(Self {
            wide_header: stated("header_type") == Some("UInt64"),
            compressed: compressor.is_some(),
            arrays,
            appended,
        })
    }

    /// The values of the array `name`.
    fn array(&self, name: &'static str) -> Result<Vec<f64>, MeshError> {
        let fail = |reason| problem(name, reason);
        let array = self.arrays.iter().find(|array| array.name == name);
        let array = array.ok_or_else(|| fail("it is missing"))?;
        let stated = |name: &str| array.attributes.get(name).map(String::as_str);
        let bytes = match stated("format").unwrap_or("ascii") {
            "ascii" => {
                let words = array.text.split_whitespace();
                let values: Result<Vec<f64>, _> = words.map(str::parse).collect();
                return values.map_err(|_| fail("a value is no number"));
            }
            "binary" => {
                let text: String = array.text.split_ascii_whitespace().collect();
                self.decode(name, text.as_bytes(), false)?
            }
            "appended" => {
                let appended = self.appended;
                let (data, raw) = appended.ok_or_else(|| fail("the file has no appended data"))?;
                let offset = stated("offset").and_then(|offset| offset.parse::<usize>().ok());
                let data = offset.and_then(|offset| data.get(offset..));
                let data = data.ok_or_else(|| fail("its offset lies after the end of the file"))?;
                self.decode(name, data, raw)?
            }
            _ => return Err(fail("unknown format; expected ascii, binary or appended")),
        };
        let kind = stated("type").unwrap_or_default();
        values(&bytes, kind).ok_or_else(|| fail("unknown type of number"))
    }

    /// The bytes of the array `name` that begins at the start of `data`, raw or base64.
    fn decode(&self, name: &str, data: &[u8], raw: bool) -> Result<Vec<u8>, MeshError> {
        let short = || problem(name, "it announces more bytes than the file has");
        let word = if self.wide_header { 8 } else { 4 };
        // The first `count` bytes of a stream that begins at `from`, and where the stream ends.
        let take = |from: usize, count: usize| -> Result<(Vec<u8>, usize), MeshError> {
            let base64 = count.div_ceil(3).checked_mul(4);
            let length = if raw { Some(count) } else { base64 };
            let end = length.and_then(|length| from.checked_add(length));
            let end = end.filter(|&end| end <= data.len()).ok_or_else(short)?;
            let mut bytes = data[from..end].to_vec();
            if !raw {
                bytes = STANDARD.decode(bytes).map_err(|_| short())?;
            }
            if bytes.len() < count {
                return Err(short());
            }
            Ok((bytes, end))
        };
        let number = |bytes: &[u8], i: usize| {
            let bytes = bytes[i * word..(i + 1) * word].iter().rev();
            bytes.fold(0u64, |sum, &b| (sum << 8) | u64::from(b)) as usize
        };
        let (first, _) = take(0, word)?;
        if !self.compressed {
            let count = number(&first, 0).checked_add(word).ok_or_else(short)?;
            let (mut bytes, _) = take(0, count)?;
            bytes.truncate(count);
            bytes.drain(..word);
            return Ok(bytes);
        }
        let blocks = number(&first, 0);
        let header = blocks.checked_add(3).and_then(|n| n.checked_mul(word));
        let (sizes, begin) = take(0, header.ok_or_else(short)?)?;
        let total = (0..blocks)
            .try_fold(0usize, |sum, i| sum.checked_add(number(&sizes, 3 + i)))
            .ok_or_else(short)?;
        let (packed, _) = take(begin, total)?;
        let largest = number(&sizes, 1);
        let (mut bytes, mut from) = (Vec::new(), 0);
        for i in 0..blocks {
            let to = from + number(&sizes, 3 + i);
            let before = bytes.len();
            let mut block =
                flate2::read::ZlibDecoder::new(&packed[from..to]).take(largest as u64 + 1);
            let read = block.read_to_end(&mut bytes);
            read.map_err(|_| problem(name, "a block does not decompress"))?;
            if bytes.len() - before > largest || bytes.len() > 8 * MAX_VALUES {
                return Err(problem(name, "a block is larger than announced"));
            }
            from = to;
        }
        Ok(bytes)
    }
}

fn attributes(tag: &BytesStart) -> Attributes {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let found = tag.attributes().flatten();
    found
        .map(|a| (text(a.key.as_ref()), text(&a.value)))
        .collect()
}

/// The file before AppendedData, the bytes after its underscore and whether they are raw.
type Split<'a> = (&'a [u8], Option<(&'a [u8], bool)>);

fn split_appended(bytes: &[u8]) -> Result<Split<'_>, MeshError> {
    let tag = b"<AppendedData";
    let Some(start) = bytes.windows(tag.len()).position(|w| w == tag) else {
        return Ok((bytes, None));
    };
    let find = |from: usize, byte: u8| {
        let place = bytes[from..].iter().position(|&b| b == byte);
        place.map(|place| from + place)
    };
    let marks = find(start, b'>').and_then(|close| Some((close, find(close, b'_')? + 1)));
    let expected = "expected <AppendedData encoding=...> _";
    let (close, from) = marks.ok_or_else(|| problem("AppendedData", expected))?;
    let raw = bytes[start..close].windows(5).any(|w| w == b"\"raw\"");
    let end = find(from, b'<').filter(|_| !raw).unwrap_or(bytes.len());
    Ok((&bytes[..start], Some((&bytes[from..end], raw))))
}

/// VTK's number for an eight-node hexahedron.
pub(crate) const HEXAHEDRON: u8 = 12;
/// Largest number of values in one array.
const MAX_VALUES: usize = 400_000_000;

/// The error of an array.
fn problem(array: &str, problem: &str) -> MeshError {
    MeshError::Invalid(format!("not a readable VTU file: {array}: {problem}"))
}

/// Little-endian numbers of VTK's type `kind` as doubles.
fn values(bytes: &[u8], kind: &str) -> Option<Vec<f64>> {
    fn read<const N: usize>(bytes: &[u8], number: fn([u8; N]) -> f64) -> Option<Vec<f64>> {
        Some(bytes.as_chunks().0.iter().map(|b| number(*b)).collect())
    }
    match kind {
        "Float64" => read(bytes, f64::from_le_bytes),
        "Float32" => read(bytes, |b| f32::from_le_bytes(b).into()),
        "Int8" => read(bytes, |b| i8::from_le_bytes(b).into()),
        "UInt8" => read(bytes, |b| u8::from_le_bytes(b).into()),
        "Int16" => read(bytes, |b| i16::from_le_bytes(b).into()),
        "UInt16" => read(bytes, |b| u16::from_le_bytes(b).into()),
        "Int32" => read(bytes, |b| i32::from_le_bytes(b).into()),
        "UInt32" => read(bytes, |b| u32::from_le_bytes(b).into()),
        "Int64" => read(bytes, |b| i64::from_le_bytes(b) as f64),
        "UInt64" => read(bytes, |b| u64::from_le_bytes(b) as f64),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hexahedra::hex_mesh::TensorGrid;
    use crate::hexahedra::write_vtk::write_vtu;

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
