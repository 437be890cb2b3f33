//! The elements and arrays of a VTU file.

use quick_xml::{Reader, events::BytesStart, events::Event};

use crate::error::MeshError;
use crate::hexahedra::vtu::data::{Encoding, decode, problem, values};

/// A DataArray as it stands in the file.
struct Array {
    name: String,
    kind: String,
    format: String,
    offset: Option<usize>,
    text: Vec<u8>,
}

/// A VTU file taken apart.
pub(crate) struct VtuFile<'a> {
    encoding: Encoding,
    arrays: Vec<Array>,
    /// Bytes after the underscore of AppendedData, and whether they are raw.
    appended: Option<(&'a [u8], bool)>,
}

impl<'a> VtuFile<'a> {
    /// Takes a file apart, its arrays as they stand in it.
    pub fn parse(bytes: &'a [u8]) -> Result<Self, MeshError> {
        let (head, appended) = split_appended(bytes)?;
        let mut file = Self {
            encoding: Encoding::default(),
            arrays: Vec::new(),
            appended,
        };
        let mut reader = Reader::from_reader(head);
        reader.config_mut().check_end_names = false;
        let (mut is_grid, mut section) = (false, Vec::new());
        loop {
            let event = reader
                .read_event()
                .map_err(|_| problem("XML", "it is not well formed"))?;
            match event {
                Event::Eof => break,
                Event::Start(tag) => {
                    file.open(&tag, &mut is_grid, &section)?;
                    section = if tag.name().as_ref() == b"DataArray" {
                        section
                    } else {
                        tag.name().as_ref().to_vec()
                    };
                    if tag.name().as_ref() == b"DataArray" && wanted(&section) {
                        let text = reader
                            .read_text(tag.name())
                            .map_err(|_| problem("XML", "it is not well formed"))?;
                        if let Some(array) = file.arrays.last_mut() {
                            // VTK adds elements of its own behind the values.
                            array.text = text.split('<').next().unwrap_or("").as_bytes().to_vec();
                        }
                    }
                }
                Event::Empty(tag) => file.open(&tag, &mut is_grid, &section)?,
                Event::End(tag) if tag.name().as_ref() != b"DataArray" => section.clear(),
                _ => {}
            }
        }
        if !is_grid {
            return Err(problem("VTKFile", "expected type UnstructuredGrid"));
        }
        Ok(file)
    }

    fn open(
        &mut self,
        tag: &BytesStart,
        is_grid: &mut bool,
        section: &[u8],
    ) -> Result<(), MeshError> {
        let attribute = |name: &str| {
            let found = tag.try_get_attribute(name).ok().flatten();
            found.map(|a| String::from_utf8_lossy(&a.value).into_owned())
        };
        match tag.name().as_ref() {
            b"VTKFile" => {
                *is_grid = attribute("type").as_deref() == Some("UnstructuredGrid");
                self.encoding.wide_header = attribute("header_type").as_deref() == Some("UInt64");
                if attribute("byte_order").as_deref() == Some("BigEndian") {
                    return Err(problem("VTKFile", "big-endian files are not supported"));
                }
                self.encoding.compressed = match attribute("compressor").as_deref() {
                    None => false,
                    Some("vtkZLibDataCompressor") => true,
                    Some(_) => {
                        return Err(problem(
                            "VTKFile",
                            "of the compressors only zlib is supported",
                        ));
                    }
                };
            }
            b"DataArray" if wanted(section) => {
                let offset = attribute("offset").and_then(|o| o.parse().ok());
                let name = if section == b"Points" {
                    Some("Points".into())
                } else {
                    attribute("Name")
                };
                self.arrays.push(Array {
                    name: name.unwrap_or_default(),
                    kind: attribute("type").unwrap_or_default(),
                    format: attribute("format").unwrap_or_else(|| "ascii".into()),
                    offset,
                    text: Vec::new(),
                });
                if self.arrays.iter().filter(|a| a.name == "Points").count() > 1 {
                    return Err(problem(
                        "Points",
                        "files of several pieces are not supported",
                    ));
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The values of the array `name`.
    pub fn array(&self, name: &'static str) -> Result<Vec<f64>, MeshError> {
        let array = self
            .arrays
            .iter()
            .find(|a| a.name == name)
            .ok_or_else(|| problem(name, "it is missing"))?;
        if array.format == "ascii" {
            let text = str::from_utf8(&array.text).map_err(|_| problem(name, "it is no text"))?;
            let values: Result<Vec<f64>, _> = text.split_whitespace().map(str::parse).collect();
            return values.map_err(|_| problem(name, "a value is no number"));
        }
        let trimmed: Vec<u8>;
        let (data, raw) = match array.format.as_str() {
            "binary" => {
                trimmed = array
                    .text
                    .iter()
                    .copied()
                    .filter(|b| !b.is_ascii_whitespace())
                    .collect();
                (trimmed.as_slice(), false)
            }
            "appended" => {
                let (data, raw) = self
                    .appended
                    .ok_or_else(|| problem(name, "the file has no appended data"))?;
                let offset = array.offset.filter(|&o| o <= data.len());
                (
                    &data[offset
                        .ok_or_else(|| problem(name, "its offset lies beyond the file"))?..],
                    raw,
                )
            }
            _ => {
                return Err(problem(
                    name,
                    "unknown format; expected ascii, binary or appended",
                ));
            }
        };
        values(&decode(self.encoding, name, data, raw)?, &array.kind)
            .ok_or_else(|| problem(name, "unknown type of number"))
    }
}

fn wanted(section: &[u8]) -> bool {
    section == b"Points" || section == b"Cells"
}

/// The file before AppendedData, the bytes after its underscore and whether they are raw.
type Split<'a> = (&'a [u8], Option<(&'a [u8], bool)>);

fn split_appended(bytes: &[u8]) -> Result<Split<'_>, MeshError> {
    let tag = b"<AppendedData";
    let Some(start) = bytes.windows(tag.len()).position(|w| w == tag) else {
        return Ok((bytes, None));
    };
    let broken = || problem("AppendedData", "expected <AppendedData encoding=...> _");
    let close = start
        + bytes[start..]
            .iter()
            .position(|&b| b == b'>')
            .ok_or_else(broken)?;
    let raw = bytes[start..close].windows(5).any(|w| w == b"\"raw\"");
    let mark = close
        + bytes[close..]
            .iter()
            .position(|&b| b == b'_')
            .ok_or_else(broken)?;
    let data = &bytes[mark + 1..];
    let data = if raw {
        data
    } else {
        &data[..data.iter().position(|&b| b == b'<').unwrap_or(data.len())]
    };
    Ok((&bytes[..start], Some((data, raw))))
}
