//! Units as people write them: files have m2 and deg C.

/// A unit with powers and degrees by their signs.
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
