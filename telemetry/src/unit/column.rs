//! The unit that a column's name ends in.

/// Suffixes of columns and the units that they stand for, as the unit library writes them.
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
    SUFFIXES
        .iter()
        .find(|(suffix, _)| column.ends_with(suffix))
        .map_or("1", |(_, unit)| unit)
}
