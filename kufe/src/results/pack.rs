//! Numbers in the form that scripts of pages read: 16 bits each, in base64.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::Serialize;

use crate::plot::extent;

/// Largest code of a finite value.
const MAX_CODE: f64 = 65534.0;
/// The code of a value that is not finite.
const NOT_FINITE: u16 = 65535;

/// Numbers packed into 16 bits each: `value = low + code * step`; code 65535 is not finite.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Packed {
    /// The smallest finite value.
    pub low: f64,
    /// 1/65534 of the range of the finite values.
    pub step: f64,
    /// The codes, little-endian, in base64.
    pub codes: String,
}

/// Packs values into 16 bits each: `value = low + code * step`; code 65535 is not finite.
///
/// Steps are 1/65534 of the range of the finite values. The codes are little-endian, in base64.
///
/// ```
/// let packed = kufe::results::pack([0.0, 65534.0, f64::INFINITY]);
/// assert_eq!((packed.low, packed.step), (0.0, 1.0));
/// assert_eq!(packed.codes, "AAD+////");
/// ```
pub fn pack(values: impl IntoIterator<Item = f64>) -> Packed {
    let values: Vec<f64> = values.into_iter().collect();
    let [low, high] = extent(values.iter().copied());
    let low = if low.is_finite() { low } else { 0.0 };
    let step = if high > low {
        (high - low) / MAX_CODE
    } else {
        0.0
    };
    let code = |value: &f64| match (value.is_finite(), step > 0.0) {
        (false, _) => NOT_FINITE,
        (true, false) => 0,
        (true, true) => ((value - low) / step).round().clamp(0.0, MAX_CODE) as u16,
    };
    let bytes = values.iter().flat_map(|value| code(value).to_le_bytes());
    let codes = STANDARD.encode(bytes.collect::<Vec<u8>>());
    Packed { low, step, codes }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_values_come_back_within_half_a_step() {
        let values: Vec<f64> = (0..1000)
            .map(|k| 1e8 * (0.01 * f64::from(k)).sin())
            .collect();
        let packed = pack(values.iter().copied());
        let bytes = STANDARD.decode(&packed.codes).expect("base64");
        let (low, step) = (packed.low, packed.step);
        assert_eq!(bytes.len(), 2000);
        for (pair, value) in bytes.chunks(2).zip(&values) {
            let back = low + step * f64::from(u16::from_le_bytes([pair[0], pair[1]]));
            assert!((back - value).abs() <= 0.501 * step, "{back} {value}");
        }
    }

    #[test]
    fn equal_values_and_none_at_all_are_packed_too() {
        assert_eq!(pack([3.0, 3.0]).codes, "AAAAAA==");
        assert_eq!(pack([3.0]).low, 3.0);
        assert_eq!(pack([f64::NAN]).codes, "//8=");
        assert_eq!(pack([]).codes, "");
    }
}
