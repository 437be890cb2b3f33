//! The numbers of a VTU file, from their bytes.
//!
//! Every length is checked against the bytes that are there before anything is allocated.

use std::io::Read;

use base64::{Engine, engine::general_purpose::STANDARD};

use crate::error::MeshError;

/// VTK's number for an eight-node hexahedron.
pub(crate) const HEXAHEDRON: u8 = 12;
/// Most values in one array.
const MOST_VALUES: usize = 400_000_000;

/// How a file keeps its arrays.
#[derive(Clone, Copy, Default)]
pub(crate) struct Encoding {
    /// Sizes are words of 8 bytes, not 4.
    pub wide_header: bool,
    /// Arrays are cut into blocks, each compressed with zlib.
    pub compressed: bool,
}

/// What is wrong with an array.
pub(crate) fn problem(array: &str, problem: &'static str) -> MeshError {
    MeshError::VtuRead {
        array: array.into(),
        problem,
    }
}

/// The bytes of the array `name` that begins at the start of `data`, raw or base64.
pub(crate) fn decode(
    encoding: Encoding,
    name: &'static str,
    data: &[u8],
    raw: bool,
) -> Result<Vec<u8>, MeshError> {
    let short = || problem(name, "it announces more bytes than the file has");
    let word = if encoding.wide_header { 8 } else { 4 };
    // The first `count` bytes of a stream that begins at `from`, and where the stream ends.
    let take = |from: usize, count: usize| -> Result<(Vec<u8>, usize), MeshError> {
        let length = if raw {
            Some(count)
        } else {
            count.div_ceil(3).checked_mul(4)
        };
        let end = length
            .and_then(|l| from.checked_add(l))
            .filter(|&e| e <= data.len())
            .ok_or_else(short)?;
        let bytes = if raw {
            data[from..end].to_vec()
        } else {
            STANDARD.decode(&data[from..end]).map_err(|_| short())?
        };
        if bytes.len() < count {
            Err(short())
        } else {
            Ok((bytes, end))
        }
    };
    let number = |bytes: &[u8], i: usize| {
        let bytes = bytes[i * word..(i + 1) * word].iter().rev();
        bytes.fold(0u64, |sum, &b| (sum << 8) | u64::from(b)) as usize
    };
    let (first, _) = take(0, word)?;
    if !encoding.compressed {
        let count = number(&first, 0).checked_add(word).ok_or_else(short)?;
        let (mut bytes, _) = take(0, count)?;
        bytes.truncate(count);
        bytes.drain(..word);
        return Ok(bytes);
    }
    let blocks = number(&first, 0);
    let header = blocks
        .checked_add(3)
        .and_then(|n| n.checked_mul(word))
        .ok_or_else(short)?;
    let (sizes, begin) = take(0, header)?;
    let total = (0..blocks)
        .try_fold(0usize, |sum, i| sum.checked_add(number(&sizes, 3 + i)))
        .ok_or_else(short)?;
    let (packed, _) = take(begin, total)?;
    let largest = number(&sizes, 1);
    let (mut bytes, mut from) = (Vec::new(), 0);
    for i in 0..blocks {
        let to = from + number(&sizes, 3 + i);
        let before = bytes.len();
        let mut block = flate2::read::ZlibDecoder::new(&packed[from..to]).take(largest as u64 + 1);
        block
            .read_to_end(&mut bytes)
            .map_err(|_| problem(name, "a block does not decompress"))?;
        if bytes.len() - before > largest || bytes.len() > 8 * MOST_VALUES {
            return Err(problem(name, "a block is larger than announced"));
        }
        from = to;
    }
    Ok(bytes)
}

/// Little-endian numbers of VTK's type `kind` as doubles.
pub(crate) fn values(bytes: &[u8], kind: &str) -> Option<Vec<f64>> {
    macro_rules! read {
        ($number:ty) => {
            bytes
                .chunks_exact(size_of::<$number>())
                .map(|b| {
                    <$number>::from_le_bytes(b.try_into().expect("a chunk of its size")) as f64
                })
                .collect()
        };
    }
    Some(match kind {
        "Float64" => read!(f64),
        "Float32" => read!(f32),
        "Int8" => read!(i8),
        "UInt8" => read!(u8),
        "Int16" => read!(i16),
        "UInt16" => read!(u16),
        "Int32" => read!(i32),
        "UInt32" => read!(u32),
        "Int64" => read!(i64),
        "UInt64" => read!(u64),
        _ => return None,
    })
}
