//! Numbers in the unit that suits their size.

use std::borrow::Cow;

use crate::plot::number4;

use crate::report::sign::sign;

/// A unit as files have it, and the units in which it is shown, the largest first: the least size,
/// the factor, and the symbol.
type Ladder = (&'static str, &'static [(f64, f64, &'static str)]);

const LADDERS: [Ladder; 14] = [
    (
        "Pa",
        &[
            (1e9, 1e-9, "GPa"),
            (1e5, 1e-6, "MPa"),
            (1e3, 1e-3, "kPa"),
            (0.0, 1.0, "Pa"),
        ],
    ),
    (
        "m",
        &[
            (1.0, 1.0, "m"),
            (1e-3, 1e3, "mm"),
            (1e-7, 1e6, "µm"),
            (0.0, 1e9, "nm"),
        ],
    ),
    ("m2", &[(0.1, 1.0, "m²"), (0.0, 1e6, "mm²")]),
    (
        "m3",
        &[(1e-2, 1.0, "m³"), (1e-7, 1e6, "cm³"), (0.0, 1e9, "mm³")],
    ),
    (
        "rad",
        &[(1.0, 1.0, "rad"), (1e-4, 1e3, "mrad"), (0.0, 1e6, "µrad")],
    ),
    ("rad/s", &[(0.1, 1.0, "rad/s"), (0.0, 1e3, "mrad/s")]),
    ("N", &[(1e4, 1e-3, "kN"), (0.1, 1.0, "N"), (0.0, 1e3, "mN")]),
    ("N m", &[(1.0, 1.0, "N m"), (0.0, 1e3, "mN m")]),
    ("N/rad", &[(1e3, 1e-3, "kN/rad"), (0.0, 1.0, "N/rad")]),
    (
        "J",
        &[
            (1e6, 1e-6, "MJ"),
            (1e3, 1e-3, "kJ"),
            (0.1, 1.0, "J"),
            (0.0, 1e3, "mJ"),
        ],
    ),
    ("s", &[(0.5, 1.0, "s"), (1e-4, 1e3, "ms"), (0.0, 1e6, "µs")]),
    ("m/s", &[(0.1, 1.0, "m/s"), (0.0, 1e3, "mm/s")]),
    (
        "bytes",
        &[(1e6, 1e-6, "MB"), (1e3, 1e-3, "kB"), (0.0, 1.0, "bytes")],
    ),
    ("1e-3", &[(0.0, 1e3, "10⁻³")]),
];

/// What numbers are shown in.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// How many of the unit make one of the file's.
    pub times: f64,
    /// The unit's sign, empty for pure numbers.
    pub unit: Cow<'static, str>,
}

impl Scale {
    /// The one that suits numbers of which the largest has this size.
    pub fn of(unit: Cow<'static, str>, largest: f64) -> Scale {
        let steps = LADDERS.iter().find(|(known, _)| *known == unit);
        // Zero is shown in the usual unit.
        let fits = |(least, ..): &&(f64, f64, &str)| largest >= *least;
        if let Some((_, steps)) = steps {
            let usual = steps.iter().find(|(_, times, _)| *times == 1.0);
            let step = if largest > 0.0 {
                steps.iter().find(fits)
            } else {
                usual
            };
            if let Some((_, times, unit)) = step.or(steps.last()) {
                return Scale {
                    times: *times,
                    unit: Cow::Borrowed(unit),
                };
            }
        }
        Scale {
            times: 1.0,
            unit: Cow::Owned(sign(&unit)),
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
            let scale = Scale::of(unit.into(), value.abs());
            assert_eq!(format!("{} {}", scale.number(value), scale.unit), shown);
        }
        assert_eq!(Scale::of("m".into(), 1e-5).error(1.6e-7), "0.16");
        assert_eq!(Scale::of("Pa".into(), 1e8).error(1.07e6), "1.1");
    }
}
