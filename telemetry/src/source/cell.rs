//! A number in a cell.

/// What people write where there is no value.
const MISSING: [&str; 6] = ["nan", "-", "n/a", "na", "null", "#n/a"];

/// The number of a cell: NaN where it is empty, seconds where it is a time of the day (`13:05:59.125`); `None` for text.
pub(crate) fn number(cell: &str, decimal_comma: bool) -> Option<f64> {
    let cell = cell.trim();
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    if let Ok(value) = cell.parse::<f64>() {
        return Some(value);
    }
    if decimal_comma && cell.contains(',') {
        return number(&cell.replacen(',', ".", 1), false);
    }
    if cell.contains(':') {
        return time_of_day(cell);
    }
    MISSING
        .contains(&cell.to_lowercase().as_str())
        .then_some(f64::NAN)
}

/// Seconds of `h:m:s` or `m:s`.
fn time_of_day(cell: &str) -> Option<f64> {
    let mut seconds = 0.0;
    let parts: Vec<&str> = cell.split(':').collect();
    if parts.len() > 3 {
        return None;
    }
    for (place, part) in parts.iter().enumerate() {
        let last = place + 1 == parts.len();
        if !part
            .bytes()
            .all(|b| b.is_ascii_digit() || last && b == b'.')
        {
            return None;
        }
        seconds = seconds * 60.0 + part.parse::<f64>().ok()?;
    }
    Some(seconds)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_numbers_times_of_the_day_nothing_or_text() {
        assert_eq!(number(" -1.5e-3", false), Some(-1.5e-3));
        assert_eq!(number("-0,75", true), Some(-0.75));
        assert_eq!(number("-0,75", false), None);
        assert_eq!(number("1,2,3", true), None);
        assert_eq!(number("13:05:59.125", false), Some(13.0 * 3600.0 + 359.125));
        assert_eq!(number("01:02,5", true), Some(62.5));
        for text in ["12:x", "1:2:3:4", "fast", "1.2.3", "--"] {
            assert_eq!(number(text, false), None, "{text}");
        }
        for nothing in ["", "  ", "NaN", "-", "n/a", "#N/A"] {
            assert!(number(nothing, false).unwrap().is_nan(), "{nothing:?}");
        }
    }
}
