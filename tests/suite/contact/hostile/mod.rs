//! Invalid numbers, passed directly to the library: file readers reject them.

mod parts;
mod problems;

/// Numbers that are invalid or extreme for most parameters.
const NUMBERS: [f64; 10] = [
    f64::NAN,
    f64::INFINITY,
    f64::NEG_INFINITY,
    0.0,
    -1.0,
    f64::MIN_POSITIVE,
    1e-30,
    1e30,
    -1e30,
    f64::MAX,
];
