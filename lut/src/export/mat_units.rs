//! The unit of a MAT-file's variable, by its name's ending, in MATLAB's spelling.

/// The unit of a name that has one.
pub(super) fn unit(name: &str) -> Option<String> {
    let unit = crate::unit::unit_of(name);
    let unit = match &*unit {
        "" => return None,
        "deg C" => "degC",
        "bytes" => "B",
        other => other,
    };
    // A figure after a letter is a power: m2 is m^2.
    let mut spelled = String::new();
    for letter in unit.chars() {
        if letter.is_ascii_digit() && spelled.ends_with(|c: char| c.is_ascii_alphabetic()) {
            spelled.push('^');
        }
        spelled.push(letter);
    }
    Some(spelled)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_spelled_as_matlab_has_them() {
        for (name, spelled) in [
            ("area_m2", "m^2"),
            ("j_zz_kgm2", "kg m^2"),
            ("ax_mps2", "m/s^2"),
            ("curvature_1pm", "1/m"),
            ("ice_c", "degC"),
            ("melt_rate_kgps", "kg/s"),
            ("k_n_per_rad", "N/rad"),
            ("peak_memory_bytes", "B"),
        ] {
            assert_eq!(unit(name).as_deref(), Some(spelled), "{name}");
        }
        assert_eq!(unit("dofs"), None);
    }
}
