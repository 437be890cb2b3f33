//! What no file can state, since its reader refuses it: a program that calls the library can.

mod parts;
mod problems;

/// Numbers that no contact has.
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
