//! How much a file can unpack to.

/// Most bytes, and so numbers, that a compressed file of this length holds: deflate packs at best 1032 of them into one.
///
/// Source: J. Gailly, M. Adler, zlib technical details.
pub fn most_unpacked(bytes: usize) -> u64 {
    1032 * bytes as u64
}

/// Numbers of an array of this shape, as many as can be counted; 1 without one.
pub fn numbers_of(shape: &[u64]) -> u64 {
    shape.iter().fold(1, |n: u64, k| n.saturating_mul(*k))
}
