//! Round tick positions and the text beside them.

/// Ticks at 1, 2 or 5 times a power of ten inside `low..=high`, about `count` of them.
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

/// A tick's number with as many digits as an axis of this span needs to tell its ticks apart.
///
/// ```
/// assert_eq!(kufe::plot::tick_text(20.0, 60.0), "20");
/// assert_eq!(kufe::plot::tick_text(0.05, 0.4), "0.05");
/// assert_eq!(kufe::plot::tick_text(1.5, 4.0), "1.5");
/// assert_eq!(kufe::plot::tick_text(-0.0, 0.4), "0");
/// ```
pub fn tick_text(value: f64, span: f64) -> String {
    let digits = (2.0 - span.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    let digits = digits.saturating_sub(1);
    let text = format!("{value:.digits$}");
    if text
        .trim_start_matches('-')
        .chars()
        .all(|c| c == '0' || c == '.')
    {
        return "0".to_string();
    }
    text
}
