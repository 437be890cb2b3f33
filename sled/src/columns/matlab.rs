//! Columns of numbers in MATLAB v5 files (`save` with `-v6` or `-v7`): each is a vector variable with
//! the name of the column.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::columns::{Columns, MOST_NUMBERS, collect};
use crate::error::Error;

/// Largest MATLAB file [bytes]. It is read into memory as a whole: a damaged HDF5 file (v7.3) needs
/// less memory so than when it is streamed.
pub const LONGEST_MATLAB: u64 = 1 << 28;

/// Largest depth of nested structs.
const MAX_DEPTH: usize = 6;

/// Bytes before the first variable.
const HEADER: usize = 128;

// Types of elements and classes of arrays (MathWorks, MAT-File Format).
const MATRIX: u32 = 14;
const COMPRESSED: u32 = 15;
const CELL: u32 = 1;
const STRUCT: u32 = 2;
const CHAR: u32 = 4;
const SPARSE: u32 = 5;
const FIRST_NUMERIC: u32 = 6;
const LAST_NUMERIC: u32 = 15;
const OPAQUE: u32 = 17;

/// The variables of a MATLAB file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MatlabVariables {
    /// Real vectors (1 x n or n x 1) of more than one element, those in structs as `struct.field`,
    /// and the columns of matrices with more rows than columns ([`matlab_column`]).
    pub vectors: Vec<(String, Vec<f64>)>,
    /// Remarks on variables that are no numeric arrays: their class, and how to save them as vectors.
    pub remarks: Vec<String>,
}

/// Reads the vectors of a file as columns.
///
/// # Errors
/// [`Error::File`] as [`read_matlab`], and if no variable is a vector of numbers; [`Error::Column`].
pub(crate) fn read_matlab_columns(bytes: &[u8], file: &str) -> Result<Columns, Error> {
    let MatlabVariables { vectors, remarks } = read_matlab(bytes, file)?;
    if vectors.is_empty() {
        let mut reason = "no variable is a vector of numbers".to_string();
        for remark in remarks {
            reason += &format!("; {remark}");
        }
        return Err(Error::file(file, reason));
    }
    let own = vectors
        .into_iter()
        .filter(|(name, _)| !name.contains(['.', '(']));
    collect(own, file)
}

/// Reads every vector of numbers and the columns of matrices with more rows than columns. Scalars and
/// other arrays are ignored; other variables get a remark.
///
/// # Errors
/// [`Error::File`] if the file is no MATLAB v5 file (v7.3 is HDF5), is cut short, or contains more
/// than [`MOST_NUMBERS`] numbers.
pub fn read_matlab(bytes: &[u8], file: &str) -> Result<MatlabVariables, Error> {
    let failure = |reason: &str| {
        Error::file(
            file,
            format!("{reason} (expected MATLAB v5; save with -v6 or -v7)"),
        )
    };
    let big = match bytes.get(HEADER - 2..HEADER) {
        Some(b"IM") => false,
        Some(b"MI") => true,
        _ => return Err(failure("no MATLAB v5 header")),
    };
    if bytes.starts_with(b"MATLAB 7.3") {
        return Err(failure("this is MATLAB v7.3"));
    }
    let mut file = Variables {
        found: MatlabVariables::default(),
        room: MOST_NUMBERS as usize,
    };
    let mut elements = Elements {
        rest: &bytes[HEADER..],
        big,
    };
    while !elements.rest.is_empty() {
        let read = elements.next().and_then(|variable| file.variable(variable));
        read.map_err(|reason| failure(&reason))?;
    }
    Ok(file.found)
}

/// Error of an element that cannot be read.
const CUT_SHORT: &str = "a variable is cut short";

/// Type and bytes of an element.
type Element<'a> = (u32, Elements<'a>);

/// Elements of a file, each with a tag of its type and length.
#[derive(Clone, Copy)]
struct Elements<'a> {
    rest: &'a [u8],
    big: bool,
}

impl<'a> Elements<'a> {
    /// The 32-bit number at the byte `at`.
    fn word(&self, at: usize) -> Option<u32> {
        let bytes = *self.rest.get(at..)?.first_chunk()?;
        Some(if self.big {
            u32::from_be_bytes(bytes)
        } else {
            u32::from_le_bytes(bytes)
        })
    }

    /// The first number.
    fn first(&self) -> Result<u32, String> {
        self.word(0).ok_or_else(|| CUT_SHORT.to_string())
    }

    /// The next element.
    fn next(&mut self) -> Result<Element<'a>, String> {
        let (kind, rest) = self.split().ok_or_else(|| CUT_SHORT.to_string())?;
        let big = self.big;
        Ok((kind, Elements { rest, big }))
    }

    fn split(&mut self) -> Option<(u32, &'a [u8])> {
        let first = self.word(0)?;
        // A short element: up to four bytes of data within the tag.
        if first >> 16 != 0 {
            let data = self.rest.get(4..4 + (first >> 16) as usize)?;
            self.rest = self.rest.get(8..)?;
            return Some((first & 0xffff, data));
        }
        let length = self.word(4)? as usize;
        let data = self.rest.get(8..8usize.checked_add(length)?)?;
        let padded = match first {
            COMPRESSED => length,
            _ => length.next_multiple_of(8),
        };
        self.rest = self.rest.get(8 + padded..).unwrap_or_default();
        Some((first, data))
    }

    fn text(&mut self) -> Result<String, String> {
        let (_, data) = self.next()?;
        Ok(String::from_utf8_lossy(data.rest).into_owned())
    }
}

/// The variables read so far.
struct Variables {
    found: MatlabVariables,
    /// Number of further numbers that may be read.
    room: usize,
}

impl Variables {
    /// Reads an array, compressed or not; elements of other types are ignored.
    fn variable(&mut self, (kind, data): Element) -> Result<(), String> {
        match kind {
            MATRIX => self.matrix(data, None, MAX_DEPTH),
            COMPRESSED => {
                let unpacked = self.inflate(&data)?;
                let mut inner = Elements {
                    rest: &unpacked,
                    ..data
                };
                match inner.next()? {
                    (MATRIX, data) => self.matrix(data, None, MAX_DEPTH),
                    _ => Err(CUT_SHORT.to_string()),
                }
            }
            _ => Ok(()),
        }
    }

    fn inflate(&self, packed: &Elements) -> Result<Vec<u8>, String> {
        let mut decoder = ZlibDecoder::new(packed.rest);
        let mut unpacked = vec![0; 8];
        let failure = |error: std::io::Error| format!("a variable cannot be unpacked: {error}");
        decoder.read_exact(&mut unpacked).map_err(failure)?;
        let tag = Elements {
            rest: &unpacked,
            ..*packed
        };
        let length = tag.word(4).unwrap_or(0) as usize;
        if length / 8 > self.room {
            return Err(Self::too_much());
        }
        unpacked.reserve_exact(length);
        let mut rest = decoder.take(length as u64);
        rest.read_to_end(&mut unpacked).map_err(failure)?;
        Ok(unpacked)
    }

    fn too_much() -> String {
        format!("it holds more than {MOST_NUMBERS} numbers; save fewer variables")
    }

    /// Reads an array. `field` is its name if it is a field of a struct.
    fn matrix(
        &mut self,
        mut elements: Elements,
        field: Option<&str>,
        depth: usize,
    ) -> Result<(), String> {
        if elements.rest.is_empty() {
            return Ok(());
        }
        let flags = elements.next()?.1.first()?;
        let (class, complex) = (flags & 0xff, flags & 0x800 != 0);
        if class == OPAQUE {
            let (name, _, kind) = (elements.text()?, elements.text()?, elements.text()?);
            self.remark(field.unwrap_or(&name), &kind);
            return Ok(());
        }
        let (_, sizes) = elements.next()?;
        let sizes = (0..sizes.rest.len() / 4).filter_map(|k| sizes.word(4 * k));
        let dimensions: Vec<usize> = sizes.map(|size| size as usize).collect();
        let own = elements.text()?;
        let name = field.unwrap_or(&own);
        let length = dimensions
            .iter()
            .try_fold(1usize, |product, n| product.checked_mul(*n))
            .ok_or_else(Self::too_much)?;
        // Internal data of MATLAB objects have no name.
        if name.is_empty() {
            return Ok(());
        }
        match class {
            FIRST_NUMERIC..=LAST_NUMERIC => {
                let is_vector = dimensions.iter().filter(|n| **n != 1).count() == 1;
                let columns = match dimensions[..] {
                    _ if is_vector => 1,
                    [rows, columns] if rows > columns => columns,
                    _ => 0,
                };
                if columns == 0 || length < 2 || complex {
                    return Ok(());
                }
                if length > self.room {
                    return Err(Self::too_much());
                }
                let (kind, data) = elements.next()?;
                let values = numbers(kind, &data).filter(|values| values.len() == length);
                let values = values.ok_or_else(|| CUT_SHORT.to_string())?;
                self.room -= length;
                if is_vector {
                    self.found.vectors.push((name.to_string(), values));
                } else {
                    let columns = values.chunks(length / columns).enumerate();
                    let named = columns.map(|(k, own)| (matlab_column(name, k), own.to_vec()));
                    self.found.vectors.extend(named);
                }
            }
            STRUCT if length == 1 && depth > 0 => {
                let longest = elements.next()?.1.first()? as usize;
                let (_, names) = elements.next()?;
                for field in names.rest.chunks_exact(longest.max(1)) {
                    let end = field.iter().position(|byte| *byte == 0);
                    let field = String::from_utf8_lossy(&field[..end.unwrap_or(field.len())]);
                    let (_, data) = elements.next()?;
                    self.matrix(data, Some(&format!("{name}.{field}")), depth - 1)?;
                }
            }
            STRUCT => self.remark(name, "struct array"),
            CELL => self.remark(name, "cell array"),
            CHAR => self.remark(name, "char array"),
            SPARSE => self.remark(name, "sparse matrix"),
            _ => self.remark(name, "object"),
        }
        Ok(())
    }

    fn remark(&mut self, name: &str, kind: &str) {
        self.found.remarks.push(matlab_remark(name, kind));
    }
}

/// The name of a column of a matrix, as MATLAB writes it: `acc(:,1)` for the first.
pub fn matlab_column(matrix: &str, column: usize) -> String {
    format!("{matrix}(:,{})", column + 1)
}

/// The remark on a variable of another class: how to save its numbers as vectors.
pub fn matlab_remark(name: &str, kind: &str) -> String {
    let remedy = match kind {
        "table" | "timetable" => {
            format!(
                "; S = table2struct({name}, 'ToScalar', true); save('out.mat', '-struct', 'S', '-v7') saves its columns"
            )
        }
        "string" | "cell array" => format!("; double({name}) is a vector where it holds numbers"),
        "datetime" => format!("; posixtime({name}) is a vector"),
        "duration" => format!("; seconds({name}) is a vector"),
        _ => String::new(),
    };
    format!("variable {name} is a {kind} and not read{remedy}")
}

fn numbers(kind: u32, data: &Elements) -> Option<Vec<f64>> {
    macro_rules! read {
        ($number:ty) => {{
            let (all, rest) = data.rest.as_chunks::<{ size_of::<$number>() }>();
            let read = |bytes: &[u8; size_of::<$number>()]| {
                if data.big {
                    <$number>::from_be_bytes(*bytes) as f64
                } else {
                    <$number>::from_le_bytes(*bytes) as f64
                }
            };
            rest.is_empty().then(|| all.iter().map(read).collect())
        }};
    }
    match kind {
        1 => read!(i8),
        2 => read!(u8),
        3 => read!(i16),
        4 => read!(u16),
        5 => read!(i32),
        6 => read!(u32),
        7 => read!(f32),
        9 => read!(f64),
        12 => read!(i64),
        13 => read!(u64),
        _ => None,
    }
}
