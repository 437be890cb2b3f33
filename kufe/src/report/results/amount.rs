//! Numbers in the unit that suits their size.

use crate::plot::number4;
use crate::report::sign::sign;

/// A unit as files have it; the least size, the factor and the symbol of a unit in which it is
/// shown, the largest first.
type Step = (&'static str, f64, f64, &'static str);

const STEPS: [Step; 38] = [
    ("Pa", 1e9, 1e-9, "GPa"),
    ("Pa", 1e5, 1e-6, "MPa"),
    ("Pa", 1e3, 1e-3, "kPa"),
    ("Pa", 0.0, 1.0, "Pa"),
    ("m", 1.0, 1.0, "m"),
    ("m", 1e-3, 1e3, "mm"),
    ("m", 1e-7, 1e6, "µm"),
    ("m", 0.0, 1e9, "nm"),
    ("m2", 0.1, 1.0, "m²"),
    ("m2", 0.0, 1e6, "mm²"),
    ("m3", 1e-2, 1.0, "m³"),
    ("m3", 1e-7, 1e6, "cm³"),
    ("m3", 0.0, 1e9, "mm³"),
    ("rad", 1.0, 1.0, "rad"),
    ("rad", 1e-4, 1e3, "mrad"),
    ("rad", 0.0, 1e6, "µrad"),
    ("rad/s", 0.1, 1.0, "rad/s"),
    ("rad/s", 0.0, 1e3, "mrad/s"),
    ("N", 1e4, 1e-3, "kN"),
    ("N", 0.1, 1.0, "N"),
    ("N", 0.0, 1e3, "mN"),
    ("N m", 1.0, 1.0, "N m"),
    ("N m", 0.0, 1e3, "mN m"),
    ("N/rad", 1e3, 1e-3, "kN/rad"),
    ("N/rad", 0.0, 1.0, "N/rad"),
    ("J", 1e6, 1e-6, "MJ"),
    ("J", 1e3, 1e-3, "kJ"),
    ("J", 0.1, 1.0, "J"),
    ("J", 0.0, 1e3, "mJ"),
    ("s", 0.5, 1.0, "s"),
    ("s", 1e-4, 1e3, "ms"),
    ("s", 0.0, 1e6, "µs"),
    ("m/s", 0.1, 1.0, "m/s"),
    ("m/s", 0.0, 1e3, "mm/s"),
    ("bytes", 1e6, 1e-6, "MB"),
    ("bytes", 1e3, 1e-3, "kB"),
    ("bytes", 0.0, 1.0, "bytes"),
    ("1e-3", 0.0, 1e3, "10⁻³"),
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
        let known = || STEPS.iter().filter(|step| step.0 == unit);
        let usual = known().find(|step| step.2 == 1.0 && largest == 0.0);
        let fitting = || known().find(|step| largest >= step.1);
        let plain = sign(unit);
        let (.., times, symbol) = usual.or_else(fitting).unwrap_or(&("", 0.0, 1.0, ""));
        Scale {
            times: *times,
            unit: if symbol.is_empty() {
                plain
            } else {
                (*symbol).to_owned()
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
        match text.strip_prefix('-') {
            Some(zero) if !zero.contains(|c| ('1'..='9').contains(&c)) => zero.to_owned(),
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
