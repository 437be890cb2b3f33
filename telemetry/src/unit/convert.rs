//! What a value in one unit is in another.
//!
//! The arithmetic of units is the crate fend-core's, which knows some thousands of them. Here are only the names that it
//! does not know or takes for something else: loggers write `g` for the acceleration, `degC` for °C, `m/s2` for m/s^2.

use std::time::{Duration, Instant};

use fend_core::{Context, Interrupt, evaluate_with_interrupt};

/// Longest unit that is looked at [characters]; no unit that people write comes near.
const LONGEST: usize = 40;

/// `target = factor * value + offset`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conversion {
    /// The factor.
    pub factor: f64,
    /// What 0 of the source's unit is; not 0 for temperatures alone.
    pub offset: f64,
}

impl Conversion {
    /// A value of the source's unit in the target's.
    pub fn apply(&self, value: f64) -> f64 {
        self.factor * value + self.offset
    }
}

/// How values of `unit`, as a logger writes it, become values of `target`.
///
/// # Errors
/// Why there is no such conversion, in words.
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
    let plain = unit.trim().trim_matches(['[', ']', '(', ')', ' ']);
    let none = ["", "-", "1"].contains(&plain);
    if none && target != "1" {
        return Err(format!("a unit of {target} is expected"));
    }
    if none || plain == target {
        return Ok(Conversion {
            factor: 1.0,
            offset: 0.0,
        });
    }
    if plain.chars().count() > LONGEST || plain.matches('^').count() > 3 {
        return Err(format!(
            "a unit of at most {LONGEST} characters is expected"
        ));
    }
    let known = spelled(plain, target)?;
    let ask = |value: &str| -> Result<f64, String> {
        number(&evaluate(&format!("{value} {known} to {target} to 20 dp"))?)
    };
    if target == "°C" {
        let (zero, hundred) = (ask("0")?, ask("100")?);
        return Ok(Conversion {
            factor: (hundred - zero) / 100.0,
            offset: zero,
        });
    }
    let factor = ask("1")?;
    if !(factor.is_finite() && factor > 0.0) {
        return Err(format!("{factor} of {target} is no unit"));
    }
    Ok(Conversion {
        factor,
        offset: 0.0,
    })
}

/// Whether the unit library knows this, as a unit of whatever quantity.
pub(crate) fn is_unit(text: &str) -> bool {
    let plain = text.trim().trim_matches(['[', ']', '(', ')', ' ']);
    let short = plain.chars().count() <= LONGEST;
    // Of temperatures any word would do; the others are asked for by what they are.
    ["", "m/s^2", "°C"].iter().any(|target| {
        short && spelled(plain, target).is_ok_and(|known| evaluate(&format!("1 {known}")).is_ok())
    })
}

/// The unit in the library's words.
fn spelled(unit: &str, target: &str) -> Result<String, String> {
    let mut known = String::new();
    let mut word = String::new();
    for c in unit.chars().chain([' ']) {
        if c.is_alphabetic() || c == '°' || c == 'º' || c == '%' || c == '_' {
            word.push(if c == 'º' { '°' } else { c });
            continue;
        }
        if !word.is_empty() {
            known.push_str(&word_of(&word, target));
            // A digit after a unit is its power: m/s2.
            if c.is_ascii_digit() {
                known.push('^');
            }
            word.clear();
        }
        match c {
            '²' => known.push_str("^2"),
            '³' => known.push_str("^3"),
            '·' | '×' => known.push('*'),
            ' ' | '/' | '*' | '^' | '-' | '(' | ')' => known.push(c),
            '0'..='9' => known.push(c),
            _ => return Err(format!("{c:?} stands in no unit")),
        }
    }
    let known = known.trim();
    if known.chars().filter(char::is_ascii_digit).count() > 4 {
        return Err("at most four digits stand in a unit".to_string());
    }
    // No powers of powers, which take for ever: a power is one digit of a word or number.
    let chars: Vec<char> = known.chars().filter(|c| *c != ' ').collect();
    for (at, _) in chars.iter().enumerate().filter(|(_, c)| **c == '^') {
        let mut exponent = chars[at + 1..].iter().skip_while(|c| **c == '-');
        let digit = exponent.next().is_some_and(char::is_ascii_digit);
        let ends = exponent
            .next()
            .is_none_or(|c| *c != '^' && !c.is_ascii_digit());
        if !digit || !ends || at == 0 || chars[at - 1] == ')' {
            return Err("a power is one digit".to_string());
        }
    }
    Ok(known.to_string())
}

/// A word of a unit in the library's words.
fn word_of(word: &str, target: &str) -> String {
    let lower = word.to_lowercase();
    let acceleration = target == "m/s^2";
    let temperature = target == "°C";
    let known = match lower.as_str() {
        "g" | "gn" if acceleration => "gravity",
        "mg" if acceleration => "(gravity/1000)",
        "c" | "degc" | "celsius" | "°c" if temperature => "°C",
        "f" | "degf" | "fahrenheit" | "°f" if temperature => "°F",
        "k" | "kelvin" if temperature => "K",
        "degree" | "degrees" | "grad" | "°" => "deg",
        "mdeg" => "millidegree",
        "mrad" => "milliradian",
        "rads" => "rad",
        "kts" | "kt" => "knot",
        "kmph" => "kph",
        "mbar" => "millibar",
        "sec" | "secs" | "seconds" | "sekunden" => "second",
        "msec" | "msecs" => "millisecond",
        "usec" | "µs" | "μs" => "microsecond",
        "percent" | "prozent" => "%",
        "m" | "mm" | "ms" | "pa" | "kpa" | "mpa" | "n" | "kn" | "nm" => match (word, target) {
            ("Nm", _) => "newton*meter",
            ("KN", "m/s") => "knot",
            _ => word,
        },
        // Loggers shout: KM/H, DEG/S, BAR.
        _ if word.len() > 1 && word == word.to_uppercase() => &lower,
        "s" | "h" | "deg" | "bar" | "rad" => &lower,
        _ => word,
    };
    known.to_string()
}

/// Ends what takes longer than any unit does.
struct Deadline(Instant);

impl Interrupt for Deadline {
    fn should_interrupt(&self) -> bool {
        self.0.elapsed() > Duration::from_secs(2)
    }
}

fn evaluate(question: &str) -> Result<String, String> {
    let mut context = Context::new();
    evaluate_with_interrupt(question, &mut context, &Deadline(Instant::now()))
        .map(|answer| answer.get_main_result().to_string())
}

/// The number that an answer begins with.
fn number(answer: &str) -> Result<f64, String> {
    let plain = answer.trim_start_matches("approx. ");
    let digits = plain.split([' ', '°', '%']).next().unwrap_or("");
    digits
        .parse()
        .map_err(|_| format!("{answer} is no plain number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Factors by their definitions (SI brochure, ISO 80000, the international nautical mile and foot).
    #[test]
    fn units_as_loggers_write_them_have_their_defined_factors() {
        let degree = std::f64::consts::PI / 180.0;
        let mile = 1609.344;
        for (unit, target, factor) in [
            ("g", "m/s^2", 9.80665),
            ("G", "m/s^2", 9.80665),
            ("[g]", "m/s^2", 9.80665),
            ("mg", "m/s^2", 9.80665e-3),
            ("m/s2", "m/s^2", 1.0),
            ("m/s²", "m/s^2", 1.0),
            ("m/s/s", "m/s^2", 1.0),
            ("m/s^2", "m/s^2", 1.0),
            ("ft/s^2", "m/s^2", 0.3048),
            ("km/h", "m/s", 1.0 / 3.6),
            ("KM/H", "m/s", 1.0 / 3.6),
            ("kmh", "m/s", 1.0 / 3.6),
            ("kph", "m/s", 1.0 / 3.6),
            ("mph", "m/s", mile / 3600.0),
            ("MPH", "m/s", mile / 3600.0),
            ("knots", "m/s", 1852.0 / 3600.0),
            ("kn", "m/s", 1852.0 / 3600.0),
            ("kts", "m/s", 1852.0 / 3600.0),
            ("mm/s", "m/s", 1e-3),
            ("deg", "rad", degree),
            ("°", "rad", degree),
            ("Grad", "rad", degree),
            ("mrad", "rad", 1e-3),
            ("deg/s", "rad/s", degree),
            ("°/s", "rad/s", degree),
            ("deg/sec", "rad/s", degree),
            ("mdeg/s", "rad/s", 1e-3 * degree),
            ("rpm", "rad/s", std::f64::consts::TAU / 60.0),
            ("ms", "s", 1e-3),
            ("us", "s", 1e-6),
            ("µs", "s", 1e-6),
            ("min", "s", 60.0),
            ("h", "s", 3600.0),
            ("bar", "Pa", 1e5),
            ("mbar", "Pa", 100.0),
            ("hPa", "Pa", 100.0),
            ("psi", "Pa", 4.448_221_615_260_5 / (0.0254 * 0.0254)),
            ("mm", "m", 1e-3),
            ("km", "m", 1e3),
            ("kN", "N", 1e3),
            ("%", "%", 1.0),
            ("", "1", 1.0),
        ] {
            let found = conversion(unit, target).unwrap_or_else(|e| panic!("{unit}: {e}"));
            // The library answers with twenty decimals.
            let error = (found.factor / factor - 1.0).abs();
            assert!(error < 1e-13, "{unit}: {} for {factor}", found.factor);
            assert_eq!(found.offset, 0.0, "{unit}");
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
    fn what_is_no_unit_of_the_quantity_is_refused_at_once() {
        let begun = Instant::now();
        for (unit, target) in [
            ("kg", "m/s"),
            ("furlongish", "m"),
            ("10^10^10", "1"),
            ("9^9^9^9 s", "s"),
            ("(9^9)^9 s", "s"),
            ("m); exec(", "m"),
            ("", "m/s"),
            ("1", "rad/s"),
            ("g", "m/s"),
        ] {
            assert!(conversion(unit, target).is_err(), "{unit:?} to {target}");
        }
        assert!(conversion(&"m".repeat(500), "m").is_err());
        assert!(begun.elapsed() < Duration::from_secs(5));
    }
}
