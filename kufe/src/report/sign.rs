//! Units as people write them: files have m2 and deg C.

use serde_json::Value;

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

/// A document whose units are so written, wherever a key calls them that.
pub fn signed(document: &Value) -> Value {
    match document {
        Value::Object(fields) => {
            let each = fields.iter().map(|(key, value)| match value {
                Value::String(unit) if key == "unit" => (key.clone(), sign(unit).into()),
                other => (key.clone(), signed(other)),
            });
            Value::Object(each.collect())
        }
        Value::Array(values) => values.iter().map(signed).collect(),
        other => other.clone(),
    }
}

#[cfg(test)]
mod tests {
    use serde_json::json;

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
        let document =
            json!({ "unit": "m2", "steps": [{ "unit": "m/s2", "name": "m2", "size": 2 }] });
        assert_eq!(
            signed(&document),
            json!({ "unit": "m²", "steps": [{ "unit": "m/s²", "name": "m2", "size": 2 }] })
        );
    }
}
