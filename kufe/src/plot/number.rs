//! Formatting of numbers and quantities for texts, pages and pictures.

use std::borrow::Cow;

use kufe_lut::unit_of;

/// A unit of files, and its display units, the largest first, with the number of display units in
/// one unit.
type Shown = (&'static str, &'static [(&'static str, f64)]);

#[rustfmt::skip]
const SHOWN: [Shown; 15] = [
    ("Pa", &[("GPa", 1e-9), ("MPa", 1e-6), ("kPa", 1e-3), ("Pa", 1.0)]),
    ("m", &[("m", 1.0), ("mm", 1e3), ("µm", 1e6), ("nm", 1e9)]),
    ("m2", &[("m²", 1.0), ("mm²", 1e6)]),
    ("m3", &[("m³", 1.0), ("cm³", 1e6), ("mm³", 1e9)]),
    ("rad", &[("rad", 1.0), ("mrad", 1e3), ("µrad", 1e6)]),
    ("rad/s", &[("rad/s", 1.0), ("mrad/s", 1e3)]),
    ("N", &[("kN", 1e-3), ("N", 1.0), ("mN", 1e3)]),
    ("N m", &[("N m", 1.0), ("mN m", 1e3)]),
    ("N/rad", &[("kN/rad", 1e-3), ("N/rad", 1.0)]),
    ("J", &[("MJ", 1e-6), ("kJ", 1e-3), ("J", 1.0), ("mJ", 1e3)]),
    ("s", &[("s", 1.0), ("ms", 1e3), ("µs", 1e6)]),
    ("m/s", &[("m/s", 1.0), ("mm/s", 1e3)]),
    ("kg/s", &[("kg/s", 1.0), ("g/s", 1e3), ("mg/s", 1e6)]),
    ("bytes", &[("MB", 1e-6), ("kB", 1e-3), ("bytes", 1.0)]),
    (THOUSANDTHS, &[("10⁻³", 1e3)]),
];

/// Display unit of coefficients of friction.
const THOUSANDTHS: &str = "1e-3";

/// Keys that are displayed in thousandths.
const IN_THOUSANDTHS: [&str; 6] = [
    "mu",
    "mu_ploughing",
    "mu_viscous",
    "mu_boundary",
    "mu_se_lines",
    "mu_se_scatter",
];

/// The display unit of a key, before a prefix is chosen by the size of the number; empty for pure
/// numbers.
pub fn shown_unit(key: &str) -> Cow<'static, str> {
    if IN_THOUSANDTHS.contains(&key) {
        return Cow::Borrowed(THOUSANDTHS);
    }
    unit_of(key)
}

/// A display unit with its factor.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Number of display units in one unit of the file.
    pub times: f64,
    /// Symbol of the display unit; empty for pure numbers.
    pub unit: String,
}

impl Scale {
    /// The largest display unit in which `largest` is at least 1; for 0 the unit itself.
    pub fn of(unit: &str, largest: f64) -> Scale {
        let known = SHOWN.iter().find(|(known, _)| *known == unit);
        let known = known.map_or(&[][..], |(_, shown)| shown);
        let fits = |times: f64| match largest.abs() {
            0.0 => times == 1.0,
            // Drag areas are in m².
            largest if unit == "m2" => times > 1.0 || largest >= 0.01,
            // 1 kN less a rounding error is displayed in kN too.
            largest => largest * times >= 1.0 - 1e-4,
        };
        let found = known.iter().find(|(_, times)| fits(*times));
        match found.or(known.last()) {
            Some((unit, times)) => Scale {
                times: *times,
                unit: (*unit).to_owned(),
            },
            None => Scale {
                times: 1.0,
                unit: sign(unit),
            },
        }
    }

    /// The display unit for the largest of these numbers.
    pub fn of_all(unit: &str, numbers: impl IntoIterator<Item = f64>) -> Scale {
        let sizes = numbers.into_iter().map(f64::abs);
        Scale::of(unit, sizes.fold(0.0, f64::max))
    }

    /// A number without its unit: integers in full, others with four digits.
    pub fn number(&self, value: f64) -> String {
        let value = self.times * value;
        if value.fract() == 0.0 && value.abs() < 1e7 {
            // Adding 0 removes the sign of -0.
            format!("{:.0}", value + 0.0)
        } else {
            number4(value)
        }
    }

    /// A number and its error without their unit: two digits of the error, and the same number of
    /// decimals of the number. An error of 0 or NaN is omitted.
    pub fn with_error(&self, value: f64, error: f64) -> String {
        let size = (self.times * error).abs();
        if size == 0.0 || !size.is_finite() {
            return self.number(value);
        }
        let decimals = decimals(size, 2);
        if decimals > 6 {
            return format!("{} ± {size:.1e}", self.number(value));
        }
        let decimals = decimals.max(0) as usize;
        let text = format!("{:.decimals$}", self.times * value);
        let text = match text.parse() {
            Ok(0.0) => text.trim_start_matches('-'),
            _ => &text,
        };
        format!("{text} ± {size:.decimals$}")
    }

    /// Appends the unit to a formatted number; a power of ten is written as a factor.
    pub fn with_unit(&self, number: &str) -> String {
        match &*self.unit {
            "" => number.to_owned(),
            power if power.starts_with("10") => match number {
                "0" => number.to_owned(),
                number if number.contains(' ') => format!("({number}) · {power}"),
                number => format!("{number} · {power}"),
            },
            unit => format!("{number} {unit}"),
        }
    }

    /// `channel [unit]`.
    pub fn label(&self, name: &str) -> String {
        match &*self.unit {
            "" => name.to_owned(),
            unit => format!("{name} [{unit}]"),
        }
    }
}

/// A value with its unit.
pub fn quantity(value: f64, unit: &str) -> String {
    let scale = Scale::of(unit, value);
    scale.with_unit(&scale.number(value))
}

/// A value and its error, with their unit.
pub fn measured(value: f64, error: f64, unit: &str) -> String {
    let error = if error.is_finite() { error } else { 0.0 };
    let scale = Scale::of_all(unit, [value, error]);
    scale.with_unit(&scale.with_error(value, error))
}

/// Number of decimals of a number with this many significant digits; negative for large numbers.
fn decimals(x: f64, digits: i32) -> i32 {
    let rounded = format!("{:.*e}", (digits - 1) as usize, x.abs());
    let exponent = rounded.rsplit_once('e').and_then(|(_, e)| e.parse().ok());
    digits - 1 - exponent.unwrap_or(0)
}

/// A number with this many significant digits, with an exponent where that is shorter.
fn significant(x: f64, digits: i32) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{}", x + 0.0);
    }
    match decimals(x, digits) {
        decimals @ -3..=8 => format!("{x:.*}", decimals.max(0) as usize),
        _ => format!("{x:.*e}", (digits - 1) as usize),
    }
}

/// Four significant digits.
pub fn number4(x: f64) -> String {
    significant(x, 4)
}

/// A fraction in per cent, with three digits.
pub fn percent(share: f64) -> String {
    significant(1e2 * share, 3) + " %"
}

/// The symbol of a unit with superscripts and degree signs; files write m2 and deg C.
pub fn sign(unit: &str) -> String {
    match unit {
        "deg C" => return "°C".to_owned(),
        "deg" => return "°".to_owned(),
        _ => {}
    }
    let powers: Vec<char> = "⁰¹²³⁴⁵⁶⁷⁸⁹".chars().collect();
    let mut before = ' ';
    let letters = unit.chars().map(|letter| {
        let power = letter.to_digit(10).filter(|_| before.is_alphabetic());
        before = letter;
        power.map_or(letter, |digit| powers[digit as usize])
    });
    letters.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_four_digits() {
        assert_eq!(number4(0.012_345_6), "0.01235");
        assert_eq!(number4(0.999_99), "1.000");
        assert_eq!(number4(123_456.0), "123456");
        assert_eq!(number4(1.5e-7), "1.500e-7");
    }

    #[test]
    fn quantities_have_the_unit_that_suits_their_size() {
        for (value, unit, shown) in [
            (1.395e8_f64, "Pa", "139.5 MPa"),
            (94_700.0, "Pa", "94.70 kPa"),
            (1.155e-5, "m", "11.55 µm"),
            (2.4e-10, "m", "0.2400 nm"),
            (0.05, "m", "50 mm"),
            (-0.0, "m", "0 m"),
            (999.99, "N", "1.000 kN"),
            (1.064e-5, "m2", "10.64 mm²"),
            (0.0822, "m2", "0.08220 m²"),
            (-6.0, "deg C", "-6 °C"),
            (0.0042, THOUSANDTHS, "4.200 · 10⁻³"),
            (0.0, THOUSANDTHS, "0"),
            (1.2, "kg/m3", "1.200 kg/m³"),
            (-0.02, "1/K", "-0.02000 1/K"),
            (1_333_227.0, "bytes", "1.333 MB"),
            (0.004, "", "0.004000"),
        ] {
            assert_eq!(quantity(value, unit), shown);
        }
    }

    #[test]
    fn a_value_has_the_decimals_of_its_error_and_that_two_digits() {
        for (value, error, unit, shown) in [
            (1.3862e8, 1.07e6, "Pa", "138.6 ± 1.1 MPa"),
            (0.05027, 0.00113, "m", "50.3 ± 1.1 mm"),
            (659_500.0, 5.6e6, "Pa", "0.7 ± 5.6 MPa"),
            (-2510.0, 6.152e6, "Pa", "0.0 ± 6.2 MPa"),
            (0.0, 0.0, "rad", "0 rad"),
            (0.0, 2e-6, "rad", "0.0 ± 2.0 µrad"),
            (1.0, f64::NAN, "N", "1 N"),
            (1.0, 1e-9, "N", "1 ± 1.0e-9 N"),
            (4.1e-3, 2e-5, THOUSANDTHS, "(4.100 ± 0.020) · 10⁻³"),
        ] {
            assert_eq!(measured(value, error, unit), shown);
        }
    }

    #[test]
    fn shares_have_three_digits_and_none_is_none() {
        for (share, shown) in [
            (0.0, "0 %"),
            (0.008_761, "0.876 %"),
            (0.25, "25.0 %"),
            (3.2e-13, "3.20e-11 %"),
        ] {
            assert_eq!(percent(share), shown);
        }
    }

    #[test]
    fn powers_and_degrees_have_their_signs() {
        for (unit, shown) in [
            ("m/s2", "m/s²"),
            ("s4/rad2", "s⁴/rad²"),
            ("kg m2", "kg m²"),
            ("1/(m N)", "1/(m N)"),
            ("1/m", "1/m"),
            ("deg C", "°C"),
            ("", ""),
        ] {
            assert_eq!(sign(unit), shown);
        }
    }
}
