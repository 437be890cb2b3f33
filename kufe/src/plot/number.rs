//! Numbers as people read them.

/// Four significant digits.
pub fn number4(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{x}");
    }
    let digits = 3 - x.abs().log10().floor() as i32;
    if (0..=8).contains(&digits) {
        format!("{x:.*}", digits as usize)
    } else if (-3..0).contains(&digits) {
        format!("{x:.0}")
    } else {
        format!("{x:.3e}")
    }
}

/// A value and its unit in the size that is usual to read: pressures of contacts in MPa.
pub fn usual(value: f64, unit: &str) -> (f64, &str) {
    match unit {
        "Pa" => (1e-6 * value, "MPa"),
        _ => (value, unit),
    }
}

/// A value with its unit.
pub fn quantity(value: f64, unit: &str) -> String {
    let (value, unit) = usual(value, unit);
    format!("{} {unit}", number4(value)).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits() {
        assert_eq!(number4(0.012_345_6), "0.01235");
        assert_eq!(number4(123_456.0), "123456");
        assert_eq!(number4(1.5e-7), "1.500e-7");
    }

    #[test]
    fn quantities_carry_their_unit() {
        assert_eq!(quantity(8.4e7, "Pa"), "84.00 MPa");
        assert_eq!(quantity(0.004, ""), "0.004000");
    }
}
