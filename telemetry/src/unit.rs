//! Conversion of units as loggers write them to the units of kufe's columns.

/// Exponents of metre, kilogram, second and radian.
type Dimension = [i32; 4];

const NONE: Dimension = [0, 0, 0, 0];
const LENGTH: Dimension = [1, 0, 0, 0];
const MASS: Dimension = [0, 1, 0, 0];
const TIME: Dimension = [0, 0, 1, 0];
const ANGLE: Dimension = [0, 0, 0, 1];
const SPEED: Dimension = [1, 0, -1, 0];
const ACCELERATION: Dimension = [1, 0, -2, 0];
const TURN_RATE: Dimension = [0, 0, -1, 1];
const FREQUENCY: Dimension = [0, 0, -1, 0];
const FORCE: Dimension = [1, 1, -2, 0];
const PRESSURE: Dimension = [-1, 1, -2, 0];
const TORQUE: Dimension = [2, 1, -2, 0];
const POWER: Dimension = [2, 1, -3, 0];

/// Standard gravity [m/s^2].
const GRAVITY: f64 = 9.806_65;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Spellings, value in SI units and dimension of each unit. Capitals only matter if they
/// distinguish two units (mPa, MPa).
///
/// Values of the SI brochure, ISO 80000 and the international yard and pound.
const UNITS: &[(&str, f64, Dimension)] = &[
    ("m meter meters metre metres", 1.0, LENGTH),
    ("mm", 1e-3, LENGTH),
    ("cm", 1e-2, LENGTH),
    ("km kilometers kilometres", 1e3, LENGTH),
    ("um µm μm", 1e-6, LENGTH),
    ("in inch inches", 0.0254, LENGTH),
    ("ft feet foot", 0.3048, LENGTH),
    ("mi mile miles", 1609.344, LENGTH),
    ("kg", 1.0, MASS),
    ("gram grams", 1e-3, MASS),
    ("lb lbs", 0.453_592_37, MASS),
    ("s sec secs second seconds sekunden", 1.0, TIME),
    ("ms msec msecs millisecond milliseconds", 1e-3, TIME),
    ("us µs μs usec usecs microsecond microseconds", 1e-6, TIME),
    ("ns nsec nanosecond nanoseconds", 1e-9, TIME),
    ("min minute minutes", 60.0, TIME),
    ("h hr hrs hour hours", 3600.0, TIME),
    ("rad rads radian radians", 1.0, ANGLE),
    ("mrad", 1e-3, ANGLE),
    ("deg degree degrees ° º grad", DEGREE, ANGLE),
    ("mdeg", 1e-3 * DEGREE, ANGLE),
    ("rev revs turn turns", std::f64::consts::TAU, ANGLE),
    ("mps", 1.0, SPEED),
    ("kmh kph kmph", 1.0 / 3.6, SPEED),
    ("mph", 1609.344 / 3600.0, SPEED),
    ("kn knot knots kt kts", 1852.0 / 3600.0, SPEED),
    ("mps2", 1.0, ACCELERATION),
    ("g gs gn", GRAVITY, ACCELERATION),
    ("mg milli-g", 1e-3 * GRAVITY, ACCELERATION),
    ("radps", 1.0, TURN_RATE),
    ("dps degps", DEGREE, TURN_RATE),
    ("mdps", 1e-3 * DEGREE, TURN_RATE),
    ("rpm", std::f64::consts::TAU / 60.0, TURN_RATE),
    ("Hz hertz", 1.0, FREQUENCY),
    ("kHz", 1e3, FREQUENCY),
    ("N newton newtons", 1.0, FORCE),
    ("kN", 1e3, FORCE),
    ("lbf", 0.453_592_37 * GRAVITY, FORCE),
    ("Pa pascal", 1.0, PRESSURE),
    ("hPa mbar millibar", 100.0, PRESSURE),
    ("kPa", 1e3, PRESSURE),
    ("MPa", 1e6, PRESSURE),
    ("bar", 1e5, PRESSURE),
    ("psi", 0.453_592_37 * GRAVITY / (0.0254 * 0.0254), PRESSURE),
    ("Nm", 1.0, TORQUE),
    ("W", 1.0, POWER),
    ("kW", 1e3, POWER),
    ("% percent prozent pct", 1e-2, NONE),
];

/// Units of temperature: spellings, size of a degree, and its zero in degrees Celsius.
const TEMPERATURES: [(&str, f64, f64); 3] = [
    ("°c c degc celsius", 1.0, 0.0),
    ("°f f degf fahrenheit", 5.0 / 9.0, -160.0 / 9.0),
    ("k kelvin", 1.0, -273.15),
];

/// Other words in rows of units, without a conversion.
const OTHERS: &str = "- # v mv a ma ohm db l ml bit bits count counts raw ratio lambda unitless none enum no no. flag \
    date text string bool boolean hex sats";

/// Suffixes of kufe's columns and their units.
const SUFFIXES: [(&str, &str); 14] = [
    ("_mps2", "m/s^2"),
    ("_radps2", "rad/s^2"),
    ("_radps", "rad/s"),
    ("_mps", "m/s"),
    ("_rad", "rad"),
    ("_kgm2", "kg*m^2"),
    ("_1pm", "m^-1"),
    ("_pct", "%"),
    ("_pa", "Pa"),
    ("_kg", "kg"),
    ("_m", "m"),
    ("_n", "N"),
    ("_s", "s"),
    ("_c", "°C"),
];

/// The unit of a column by its name's suffix; `"1"` for a column without one.
///
/// ```
/// use kufe_telemetry::column_unit;
/// assert_eq!(column_unit("yaw_rate_radps"), "rad/s");
/// assert_eq!(column_unit("gear"), "1");
/// ```
pub fn column_unit(column: &str) -> &'static str {
    let suffix = SUFFIXES.iter().find(|(suffix, _)| column.ends_with(suffix));
    suffix.map_or("1", |(_, unit)| unit)
}

/// The unit at the end of another program's channel name: `acc_x_gs`, `yaw_rate_deg_per_s`,
/// `speed_kmh`.
pub(crate) fn name_unit(name: &str) -> Option<String> {
    let words: Vec<&str> = name.trim().split(['_', ' ']).collect();
    let words: Vec<&str> = words.into_iter().filter(|word| !word.is_empty()).collect();
    let last = |count: usize| {
        words.len() > count && product(&words[words.len() - count..].join(" ")).is_some()
    };
    if words.len() > 3 && words[words.len() - 2].eq_ignore_ascii_case("per") && last(3) {
        return Some(words[words.len() - 3..].join(" "));
    }
    let own = column_unit(name);
    if own != "1" {
        return Some(own.to_string());
    }
    let unit = words.last()?;
    let spelled = unit.len() > 1 || unit.eq_ignore_ascii_case("g");
    (name.contains('_') && spelled && last(1)).then(|| unit.to_string())
}

/// Number of words at the end of a name with a unit that form the unit.
pub(crate) fn unit_words(name: &str) -> usize {
    let words: Vec<&str> = name.split(['_', ' ']).collect();
    let per = words.len() > 3 && words[words.len() - 2].eq_ignore_ascii_case("per");
    if per { 3 } else { 1 }
}

/// `target = factor * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    /// The factor.
    pub factor: f64,
    /// The value in the target unit of 0 in the source unit; other than 0 only for temperatures.
    pub offset: f64,
}

impl Conversion {
    /// Converts a value.
    pub fn apply(&self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

/// Converts values of `unit`, as a logger writes it, to `target`.
///
/// # Errors
/// The reason why the conversion is not possible.
///
/// ```
/// use kufe_telemetry::conversion;
/// assert_eq!(conversion("G", "m/s^2")?.apply(2.0), 19.6133);
/// assert!((conversion("km/h", "m/s")?.apply(90.0) - 25.0).abs() < 1e-14);
/// assert!((conversion("degF", "°C")?.apply(68.0) - 20.0).abs() < 1e-12);
/// assert!(conversion("kg", "m/s").is_err());
/// # Ok::<(), String>(())
/// ```
pub fn conversion(unit: &str, target: &str) -> Result<Conversion, String> {
    let unit = bare(unit);
    let none = ["", "-", "1"].contains(&unit);
    if none && target != "1" {
        return Err(format!("a unit of {target} is expected"));
    }
    let by_size = || {
        let (one, dimension) = if target == "1" {
            (1.0, NONE)
        } else {
            product(target)?
        };
        let (size, _) = product(unit).filter(|(_, own)| *own == dimension)?;
        Some((size / one, 0.0))
    };
    let found = match target {
        _ if none || unit == target => Some((1.0, 0.0)),
        "°C" => temperature(unit),
        _ => by_size(),
    };
    let (factor, offset) =
        found.ok_or_else(|| format!("{unit:?} is no unit that converts to {target}"))?;
    Ok(Conversion { factor, offset })
}

/// Whether a text is a unit or another word of rows of units.
pub(crate) fn is_unit(text: &str) -> bool {
    let unit = bare(text);
    let mut others = OTHERS.split_whitespace();
    unit.is_empty() || others.any(|word| unit.eq_ignore_ascii_case(word)) || has_dimension(unit)
}

/// Whether a text is a unit of a physical quantity.
pub(crate) fn has_dimension(unit: &str) -> bool {
    let unit = bare(unit);
    temperature(unit).is_some() || product(unit).is_some()
}

fn bare(unit: &str) -> &str {
    unit.trim().trim_matches(['[', ']', '(', ')', ' '])
}

fn temperature(unit: &str) -> Option<(f64, f64)> {
    let small = unit.to_lowercase().replace('º', "°");
    let unit = small.replace([' ', '.'], "");
    let known = |words: &str| words.split(' ').any(|word| word == unit);
    let found = TEMPERATURES.iter().find(|(words, ..)| known(words))?;
    Some((found.1, found.2))
}

/// Size and dimension of a product of powers: `km/h`, `m/s2`, `m·s^-2`, `deg per s`, `kg*m^2`. What
/// follows a stroke divides.
fn product(unit: &str) -> Option<(f64, Dimension)> {
    if unit.eq_ignore_ascii_case("unix time") {
        return Some((1.0, TIME));
    }
    let mut text = unit.replace('/', " per ");
    for (exponent, plain) in [("¹", "1"), ("²", "2"), ("³", "3"), ("⁻", "-")] {
        text = text.replace(exponent, plain);
    }
    let (mut size, mut dimension) = (1.0, NONE);
    let (mut sign, mut count) = (1, 0);
    for factor in text.split([' ', '*', '·', '×', '_', '(', ')']) {
        if factor.eq_ignore_ascii_case("per") {
            sign = -1;
        } else if !(factor.is_empty() || factor == "1" && count == 0) {
            let ((one, of), exponent) = power(factor)?;
            size *= one.powi(sign * exponent);
            for (sum, own) in dimension.iter_mut().zip(of) {
                *sum += sign * exponent * own;
            }
            count += 1;
        }
    }
    (1..=6).contains(&count).then_some((size, dimension))
}

/// A unit and its exponent: `s`, `s2`, `s^-2`.
fn power(factor: &str) -> Option<((f64, Dimension), i32)> {
    // mps2 is one word.
    if let Some(unit) = find(factor) {
        return Some((unit, 1));
    }
    let (word, exponent) = factor.split_at(factor.find(|c: char| !is_letter(c))?);
    let exponent = exponent.trim_start_matches('^').parse().ok();
    let exponent = exponent.filter(|e: &i32| (1..=4).contains(&e.abs()))?;
    Some((find(word)?, exponent))
}

fn is_letter(c: char) -> bool {
    c.is_alphabetic() || "°º%".contains(c)
}

/// A unit by its spelling, then by its spelling in small letters: loggers write KM/H, DEG/S, BAR.
fn find(word: &str) -> Option<(f64, Dimension)> {
    let same = |known: &str| known == word;
    let small = |known: &str| known.to_lowercase() == word.to_lowercase();
    let by = |fits: &dyn Fn(&str) -> bool| {
        let found = UNITS.iter().find(|unit| unit.0.split(' ').any(fits))?;
        Some((found.1, found.2))
    };
    by(&same).or_else(|| by(&small))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors by their definitions.
    #[test]
    fn units_as_loggers_write_them_have_their_defined_factors() {
        let mile = 1609.344;
        for (units, target, factor) in [
            ("g,G,[g],gs", "m/s^2", 9.80665),
            ("mg", "m/s^2", 9.80665e-3),
            (
                "m/s2,m/s²,m/s/s,m/s^2,m s^-2,m·s⁻²,m/(s^2),M/S2,mps2",
                "m/s^2",
                1.0,
            ),
            ("ft/s^2", "m/s^2", 0.3048),
            ("km/h,KM/H,kmh,kph,kmph,km per h", "m/s", 1.0 / 3.6),
            ("mph,MPH", "m/s", mile / 3600.0),
            ("knots,kn,KN,kts", "m/s", 1852.0 / 3600.0),
            ("mm/s", "m/s", 1e-3),
            ("meters per s,m_per_s", "m/s", 1.0),
            ("deg,°,º,Grad", "rad", DEGREE),
            ("mrad", "rad", 1e-3),
            ("deg/s,°/s,deg/sec,deg per s,DEG/S,dps", "rad/s", DEGREE),
            ("mdeg/s", "rad/s", 1e-3 * DEGREE),
            ("rpm,rev/min", "rad/s", std::f64::consts::TAU / 60.0),
            ("ms", "s", 1e-3),
            ("us,µs", "s", 1e-6),
            ("min", "s", 60.0),
            ("h", "s", 3600.0),
            ("unix time", "s", 1.0),
            ("bar,BAR", "Pa", 1e5),
            ("mbar,hPa", "Pa", 100.0),
            ("psi", "Pa", 4.448_221_615_260_5 / (0.0254 * 0.0254)),
            ("mm", "m", 1e-3),
            ("km", "m", 1e3),
            ("1/m,m^-1", "m^-1", 1.0),
            ("kN", "N", 1e3),
            ("%,percent", "%", 1.0),
            ("%", "1", 0.01),
            (",-,1", "1", 1.0),
        ] {
            for unit in units.split(',') {
                let found = conversion(unit, target).unwrap_or_else(|e| panic!("{unit}: {e}"));
                let error = (found.factor / factor - 1.0).abs();
                assert!(error < 1e-13, "{unit}: {} for {factor}", found.factor);
                assert_eq!(found.offset, 0.0, "{unit}");
            }
        }
    }

    #[test]
    fn temperatures_have_their_zero() {
        for (unit, value, celsius) in [
            ("degC", -8.0, -8.0),
            ("C", 21.5, 21.5),
            ("°F", 32.0, 0.0),
            ("degF", 212.0, 100.0),
            ("K", 273.15, 0.0),
        ] {
            let found = conversion(unit, "°C").unwrap().apply(value);
            assert!((found - celsius).abs() < 1e-11, "{unit}: {found}");
        }
    }

    #[test]
    fn other_text_is_no_unit() {
        let long = "m".repeat(500);
        for (unit, target) in [
            ("kg", "m/s"),
            ("furlongish", "m"),
            ("10^10^10", "1"),
            ("s^9^9", "s"),
            ("(9^9)^9 s", "s"),
            ("m); exec(", "m"),
            ("", "m/s"),
            ("1", "rad/s"),
            ("1/s", "rad/s"),
            ("g", "m/s"),
            ("V", "1"),
            (&long, "m"),
        ] {
            assert!(conversion(unit, target).is_err(), "{unit:?} to {target}");
        }
    }

    #[test]
    fn names_end_in_units() {
        for (name, unit) in [
            ("acc_x_gs", Some("gs")),
            ("yaw_rate_deg_per_s", Some("deg per s")),
            ("speed_meters_per_s", Some("meters per s")),
            ("v_mps", Some("m/s")),
            ("speed_kmh", Some("kmh")),
            ("lateral_g", Some("g")),
            ("gyro_x", None),
            ("Speed", None),
            ("Lap", None),
        ] {
            assert_eq!(name_unit(name).as_deref(), unit, "{name}");
        }
    }
}
