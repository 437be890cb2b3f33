//! Ranges, round tick positions and their texts.

/// Minimum and maximum of the finite values; `[inf, -inf]` without finite values.
pub fn extent(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let finite = values.into_iter().filter(|value| value.is_finite());
    finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
        [low.min(value), high.max(value)]
    })
}

/// Ticks at 1, 2 or 5 times a power of ten between two values, about `count` of them.
///
/// Returns an empty list where the range is empty or not finite.
///
/// ```
/// assert_eq!(kufe::plot::axis_ticks(0.0, 10.0, 5), vec![0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
/// ```
pub fn axis_ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let span = high - low;
    if !span.is_finite() || span <= 0.0 || count == 0 {
        return Vec::new();
    }
    let raw = span / count as f64;
    let decade = 10f64.powf(raw.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|m| m * decade)
        .find(|step| *step >= raw * 0.999)
        .unwrap_or(10.0 * decade);
    let first = (low / step - 1e-9).ceil() as i64;
    let last = (high / step + 1e-9).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

/// The text of a tick, with the digits that distinguish the ticks of an axis of this span.
///
/// ```
/// assert_eq!(kufe::plot::tick_text(20.0, 60.0), "20");
/// assert_eq!(kufe::plot::tick_text(0.05, 0.4), "0.05");
/// assert_eq!(kufe::plot::tick_text(1.5, 4.0), "1.5");
/// assert_eq!(kufe::plot::tick_text(-0.0, 0.4), "0");
/// assert_eq!(kufe::plot::tick_text(2e-6, 1e-5), "2.0e-6");
/// ```
pub fn tick_text(value: f64, span: f64) -> String {
    let digits = (2.0 - span.abs().log10().floor()).max(0.0) as usize;
    let digits = digits.saturating_sub(1);
    let text = match digits {
        0..=5 => format!("{value:.digits$}"),
        _ => format!("{value:.1e}"),
    };
    let mantissa = text.trim_start_matches('-').split('e').next();
    if mantissa.is_some_and(|m| m.chars().all(|c| c == '0' || c == '.')) {
        "0".to_owned()
    } else {
        text
    }
}

/// 1, 2 and 5 times the powers of ten between two positive numbers; over more than three decades
/// only the powers. The ends where fewer than two values lie between them.
pub fn decades([low, high]: [f64; 2]) -> Vec<f64> {
    let powers = low.log10().floor() as i32..=high.log10().ceil() as i32;
    let times: &[f64] = if high / low > 1e3 {
        &[1.0]
    } else {
        &[1.0, 2.0, 5.0]
    };
    let all = powers.flat_map(|power| times.iter().map(move |times| times * 10f64.powi(power)));
    let between: Vec<f64> = all.filter(|at| (low..=high).contains(at)).collect();
    match between.len() {
        0 | 1 => vec![low, high],
        _ => between,
    }
}

/// Four significant digits without trailing zeros; scientific notation for very large or small
/// numbers.
///
/// ```
/// assert_eq!(kufe::plot::short(0.025), "0.025");
/// assert_eq!(kufe::plot::short(5000.0), "5000");
/// assert_eq!(kufe::plot::short(1e-6), "1e-6");
/// ```
pub fn short(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    let trimmed = |text: &str| {
        if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text.to_owned()
        }
    };
    if value == 0.0 {
        "0".to_owned()
    } else if (-4.0..6.0).contains(&exponent) {
        let digits = (3.0 - exponent).max(0.0) as usize;
        trimmed(&format!("{value:.digits$}"))
    } else {
        let text = format!("{value:.3e}");
        let (mantissa, power) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{power}", trimmed(mantissa))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_decade_of_forces_has_ticks() {
        let near = |range, expected: &[f64]| {
            let found = decades(range);
            assert_eq!(found.len(), expected.len(), "{found:?}");
            let close = |(a, b): (&f64, &f64)| (a / b - 1.0).abs() < 1e-12;
            assert!(found.iter().zip(expected).all(close), "{found:?}");
        };
        near([500.0, 2000.0], &[500.0, 1000.0, 2000.0]);
        near(
            [90.0, 8000.0],
            &[100.0, 200.0, 500.0, 1000.0, 2000.0, 5000.0],
        );
        near([600.0, 900.0], &[600.0, 900.0]);
        near([0.9, 2e4], &[1.0, 10.0, 100.0, 1e3, 1e4]);
    }

    /// A scale about 0 has three numbers wherever it ends.
    #[test]
    fn scales_have_three_numbers() {
        for largest in [1.0, 2.3, 3.9, 4.1, 7.7, 9.9] {
            assert!(axis_ticks(-largest, largest, 5).len() >= 3, "{largest}");
        }
    }
}
