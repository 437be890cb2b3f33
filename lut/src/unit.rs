//! Units of quantities, from the suffixes of their keys.

use std::borrow::Cow;

/// The unit in the suffix of a column's or key's name, also of the form `k_n_per_rad` or
/// `slope_per_k`; empty for a dimensionless quantity.
pub fn unit_of(name: &str) -> Cow<'static, str> {
    let Some((above, below)) = name.rsplit_once("_per_") else {
        return Cow::Borrowed(suffix_unit(name));
    };
    let above = match suffix_unit(above) {
        "" => "1",
        unit => unit,
    };
    let below = match (below, suffix_unit(&format!("_{below}"))) {
        // A difference of temperatures.
        ("c", _) => "K",
        (other, "") => other,
        (_, unit) => unit,
    };
    Cow::Owned(match above.split_once('/') {
        Some((of, over)) => format!("{of}/({over} {below})"),
        None => format!("{above}/{below}"),
    })
}

/// The unit in the suffix of a name; empty without one.
fn suffix_unit(name: &str) -> &'static str {
    const UNITS: [(&str, &str); 28] = [
        ("_1pm", "1/m"),
        ("_pa", "Pa"),
        ("_kgm2", "kg m2"),
        ("_kgpm3", "kg/m3"),
        ("_kgps", "kg/s"),
        ("_kg", "kg"),
        ("_radps2", "rad/s2"),
        ("_radps", "rad/s"),
        ("_rad", "rad"),
        ("_mps2", "m/s2"),
        ("_mps", "m/s"),
        ("_m3", "m3"),
        ("_m2", "m2"),
        ("_m", "m"),
        ("_nm", "N m"),
        ("_n", "N"),
        ("_j", "J"),
        ("_bytes", "bytes"),
        ("_ms", "ms"),
        ("_s", "s"),
        ("_seconds", "s"),
        ("_c", "deg C"),
        ("_k", "K"),
        ("_km", "km"),
        ("_pct", "%"),
        ("_w", "W"),
        ("_hz", "Hz"),
        ("_deg", "deg"),
    ];
    let name = match name {
        // A coefficient, whatever its suffix: mu_zeta_c is not a temperature.
        coefficient if coefficient.starts_with("mu_") => return "",
        // Derivative with respect to the temperature of the ice.
        "dlnmu_dice_c" => return "1/K",
        "seconds" => "_seconds",
        "bytes" => "_bytes",
        other => other,
    };
    UNITS
        .iter()
        .find(|(suffix, _)| name.ends_with(suffix))
        .map_or("", |(_, unit)| unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_follow_the_columns_suffix() {
        for (column, unit) in [
            ("v_mps", "m/s"),
            ("ax_mps2", "m/s2"),
            ("s_m", "m"),
            ("zeta", ""),
            ("seconds", "s"),
            ("melt_rate_kgps", "kg/s"),
            ("ice_c", "deg C"),
            ("c", ""),
            ("mu_zeta_c", ""),
            ("k_n_per_rad", "N/rad"),
            ("line_gain_rad_per_m", "rad/m"),
            ("slope_per_k", "1/K"),
            ("force_n_per_k", "N/K"),
            ("slope_per_c", "1/K"),
            ("slope_per_km", "1/km"),
            ("scale_1pm_per_n", "1/(m N)"),
        ] {
            assert_eq!(unit_of(column), unit, "{column}");
        }
    }
}
