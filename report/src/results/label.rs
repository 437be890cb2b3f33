//! What the keys of documents are called, and what their numbers are counted in.

/// What friction is counted in; nobody reads four zeros.
const THOUSANDTHS: &str = "1e-3";

/// Keys that say most, with their proper names, and the unit where the key's ending is not it.
const NAMES: [(&str, &str, Option<&str>); 64] = [
    ("p_max_pa", "peak pressure", None),
    ("p_mean_pa", "mean pressure", None),
    ("fz_n", "normal force", None),
    ("v_mps", "speed", None),
    ("v_mean_mps", "mean speed", None),
    ("start_speed_mps", "speed at the start", None),
    ("mu", "friction", Some(THOUSANDTHS)),
    ("mu_ploughing", "friction of ploughing", Some(THOUSANDTHS)),
    ("mu_viscous", "friction of the melt film", Some(THOUSANDTHS)),
    (
        "mu_se_lines",
        "friction, standard error of the lines",
        Some(THOUSANDTHS),
    ),
    (
        "mu_se_scatter",
        "friction, standard error by scatter",
        Some(THOUSANDTHS),
    ),
    ("groove_depth_m", "depth of the groove", None),
    ("film_mean_m", "melt film, mean", None),
    ("hardness_pa", "hardness", None),
    ("ice_c", "temperature of the ice", None),
    ("air_c", "temperature of the air", None),
    ("air_pa", "air pressure", None),
    ("mu_zeta", "largest grip, mu zeta", None),
    ("c", "shape factor C", None),
    ("e", "curvature factor E", None),
    ("k_n_per_rad", "stiffness over slip, K", Some("N/rad")),
    ("mu_zeta_c", "mu zeta C", Some("")),
    ("slip_sd_rad", "noise of the slip angle", None),
    ("residual_rms_n", "left of the lateral force, r.m.s.", None),
    ("rmse_n", "error of the lateral force, r.m.s.", None),
    ("rmse_braghin_n", "the same of Braghin's law", None),
    ("along_n", "along", None),
    ("side_n", "sideways", None),
    ("yaw_nm", "yaw", None),
    (
        "balances_left_rms",
        "what is left of the balances, r.m.s.",
        None,
    ),
    ("left_rms", "left, r.m.s.", None),
    ("times_rmse", "times the r.m.s.", None),
    ("times_rms", "times the usual", None),
    ("t_s", "time", None),
    ("s_m", "distance", None),
    ("alpha_rad", "slip angle", None),
    ("delta_rad", "steering", None),
    ("gamma_rad", "roll split", None),
    ("run", "run", None),
    ("track", "track", None),
    ("driver", "driver", None),
    ("driver_class", "class", None),
    ("class", "class", None),
    ("session", "session", None),
    ("measured", "measured run", None),
    ("time_s", "run time", None),
    ("seconds", "length", Some("s")),
    ("finished", "came to the finish", None),
    ("stopped", "stopped", None),
    ("gravity_j", "gained from gravity", None),
    ("ice_j", "lost to the ice", None),
    ("air_j", "lost to the air", None),
    ("mean_force_n", "force that the model lacks, mean", None),
    ("slope_rad", "slope", None),
    ("specimen", "specimen", None),
    ("index", "index of the runs", None),
    ("replay", "replay", None),
    ("from_m", "from", None),
    ("to_m", "to", None),
    ("column", "what", None),
    ("key", "what", None),
    ("file", "file", None),
    ("air_density_kgpm3", "density of the air", Some("kg/m³")),
    ("line_gain_rad_per_m", "gain on the line", Some("rad/m")),
];

/// Words of keys that are no words.
const WORDS: [(&str, &str); 5] = [
    ("sd", "standard deviation"),
    ("se", "standard error"),
    ("rms", "r.m.s."),
    ("rmse", "r.m.s. error"),
    ("max", "largest"),
];

fn named(key: &str) -> Option<&'static (&'static str, &'static str, Option<&'static str>)> {
    NAMES.iter().find(|(known, ..)| *known == key)
}

/// Whether a key is one of those that say most.
pub fn is_named(key: &str) -> bool {
    named(key).is_some()
}

/// The unit of a key's numbers, as its ending says; empty for pure numbers.
pub fn unit_of(key: &str) -> &'static str {
    match named(key) {
        Some((_, _, Some(unit))) => unit,
        _ => kufe_plot::unit_of(key),
    }
}

/// A key as people call it: its proper name, or its words without the unit.
pub fn name_of(key: &str) -> String {
    if let Some((_, name, _)) = named(key) {
        return (*name).to_owned();
    }
    let words = stem(key).0.split('_').map(|word| {
        let known = WORDS.iter().find(|(short, _)| *short == word);
        known.map_or(word, |(_, long)| long)
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A key without the ending that is its unit, and that ending.
fn stem(key: &str) -> (&str, &str) {
    match key.rfind('_') {
        Some(at) if !unit_of(key).is_empty() && unit_of(key) != THOUSANDTHS => key.split_at(at),
        _ => (key, ""),
    }
}

/// Keys under which the error of a key's number may stand.
pub fn error_keys(key: &str) -> [String; 3] {
    let (stem, ending) = stem(key);
    ["error", "se", "sd"].map(|word| format!("{stem}_{word}{ending}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_key_is_called_by_its_words_and_its_ending_is_its_unit() {
        for (key, name, unit) in [
            ("p_max_pa", "peak pressure", "Pa"),
            ("mu_zeta_c", "mu zeta C", ""),
            ("largest_at_m", "largest at", "m"),
            ("slope_sd_rad", "slope standard deviation", "rad"),
            ("left_out", "left out", ""),
        ] {
            assert_eq!((name_of(key).as_str(), unit_of(key)), (name, unit), "{key}");
        }
        assert!(error_keys("groove_depth_m").contains(&"groove_depth_error_m".to_owned()));
        assert!(error_keys("mu").contains(&"mu_se".to_owned()));
    }

    #[test]
    fn no_key_has_two_names() {
        for (k, (key, ..)) in NAMES.iter().enumerate() {
            assert!(NAMES[..k].iter().all(|(other, ..)| other != key), "{key}");
        }
    }
}
