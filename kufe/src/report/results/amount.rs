//! Numbers in the unit that suits their size.

use crate::plot::number4;
use crate::report::sign::sign;

/// A unit as files have it, and those that its numbers are shown in, the largest first, with their
/// number in one of it.
type Shown = (&'static str, &'static [(&'static str, f64)]);

#[rustfmt::skip]
const SHOWN: [Shown; 14] = [
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
    ("bytes", &[("MB", 1e-6), ("kB", 1e-3), ("bytes", 1.0)]),
    ("1e-3", &[("10⁻³", 1e3)]),
];

/// What numbers are shown in.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// How many of the unit make one of the file's.
    pub times: f64,
    /// The unit's sign, empty for pure numbers.
    pub unit: String,
}

impl Scale {
    /// The one that suits numbers of which the largest has this size; zero has the usual unit.
    pub fn of(unit: &str, largest: f64) -> Scale {
        let known = SHOWN.iter().find(|(known, _)| *known == unit);
        let known = known.map_or(&[][..], |(_, shown)| shown);
        let usual = known
            .iter()
            .find(|(_, times)| *times == 1.0 && largest == 0.0);
        let mut fitting = known.iter().filter(|(_, times)| largest * times >= 1.0);
        match usual.or(fitting.next()).or(known.last()) {
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

    /// A number without its unit: whole ones as they are, others with four digits.
    pub fn number(&self, value: f64) -> String {
        let value = self.times * value;
        if value.fract() == 0.0 && value.abs() < 1e7 {
            format!("{value:.0}")
        } else {
            number4(value)
        }
    }

    /// A number that its error exceeds, without its unit, with as many decimals as the error.
    pub fn uncertain(&self, value: f64, error: f64) -> String {
        let error = self.error(error);
        if error.contains('e') {
            return self.number(value);
        }
        let decimals = error.split_once('.').map_or(0, |(_, after)| after.len());
        let text = format!("{:.decimals$}", self.times * value);
        // No sign of a zero.
        match text.parse() {
            Ok(0.0) => text.trim_start_matches('-').to_owned(),
            _ => text,
        }
    }

    /// An error without its unit, with two digits.
    pub fn error(&self, value: f64) -> String {
        let value = self.times * value;
        if value == 0.0 || !value.is_finite() {
            return format!("{value}");
        }
        let digits = 1 - value.abs().log10().floor() as i32;
        match digits {
            ..=0 => format!("{value:.0}"),
            1..=6 => format!("{value:.*}", digits as usize),
            _ => format!("{value:.1e}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_the_unit_that_suits_their_size() {
        for (value, unit, shown) in [
            (1.395e8_f64, "Pa", "139.5 MPa"),
            (94_700.0, "Pa", "94.70 kPa"),
            (1.155e-5, "m", "11.55 µm"),
            (2.4e-10, "m", "0.2400 nm"),
            (0.05, "m", "50 mm"),
            (0.0, "m", "0 m"),
            (1.064e-5, "m2", "10.64 mm²"),
            (-6.0, "deg C", "-6 °C"),
            (0.0042, "1e-3", "4.200 10⁻³"),
            (1.2, "kg/m3", "1.200 kg/m³"),
            (-0.02, "1/K", "-0.02000 1/K"),
        ] {
            let scale = Scale::of(unit, value.abs());
            assert_eq!(format!("{} {}", scale.number(value), scale.unit), shown);
        }
        assert_eq!(Scale::of("m", 1e-5).error(1.6e-7), "0.16");
        assert_eq!(Scale::of("Pa", 1e8).error(1.07e6), "1.1");
        assert_eq!(Scale::of("Pa", 1e8).uncertain(659_500.0, 5.6e6), "0.7");
        assert_eq!(Scale::of("Pa", 1e8).uncertain(-2510.0, 6.152e6), "0.0");
        assert_eq!(Scale::of("m", 1e-5).uncertain(7.4e-8, 3.3e-7), "0.07");
    }
}
