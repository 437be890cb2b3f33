//! Labels and units of the keys of documents.

use std::borrow::Cow;

use kufe_sled::Column;

use crate::plot::{shown_unit, unit_of};
use crate::results::datum::Data;
use crate::results::quantity::QUANTITIES;

/// Labels of important keys, in addition to those of [`QUANTITIES`] and [`Column`].
const NAMES: [(&str, &str); 34] = [
    ("v_mean_mps", "mean speed"),
    ("start_speed_mps", "speed at the start"),
    ("mu_se_lines", "friction, standard error of the lines"),
    ("mu_se_scatter", "friction, standard error by scatter"),
    ("mu_zeta", "largest grip, mu zeta"),
    ("c", "shape factor C"),
    ("e", "curvature factor E"),
    ("k_n_per_rad", "stiffness over slip, K"),
    ("mu_zeta_c", "mu zeta C"),
    ("slip_sd_rad", "noise of the slip angle"),
    ("residual_rms_n", "residual of the lateral force, r.m.s."),
    ("rmse_n", "error of the lateral force, r.m.s."),
    ("rmse_braghin_n", "the same of Braghin's law"),
    ("side_n", "sideways"),
    ("balances_left_rms", "residuals of the balances, r.m.s."),
    ("left_rms", "residual, r.m.s."),
    ("times_rmse", "times the r.m.s."),
    ("times_rms", "times the usual"),
    ("driver_class", "class"),
    ("measured", "measured run"),
    ("time_s", "run time"),
    ("seconds", "length"),
    ("finished", "came to the finish"),
    ("gravity_j", "gained from gravity"),
    ("ice_j", "lost to the ice"),
    ("air_j", "lost to the air"),
    ("mean_force_n", "missing force, mean"),
    ("index", "index of the runs"),
    ("from_m", "from"),
    ("to_m", "to"),
    ("column", "what"),
    ("key", "what"),
    ("air_density_kgpm3", "density of the air"),
    ("line_gain_rad_per_m", "gain on the line"),
];

/// Further important keys, whose words are their labels.
const PLAIN: &str =
    "hardness_pa along_n yaw_nm run track driver class session stopped specimen replay file";

/// Words for abbreviations in keys.
const WORDS: [(&str, &str); 5] = [
    ("sd", "standard deviation"),
    ("se", "standard error"),
    ("rms", "r.m.s."),
    ("rmse", "r.m.s. error"),
    ("max", "largest"),
];

fn named(key: &str) -> Option<&'static str> {
    let quantities = QUANTITIES.iter().map(|one| (one.key, one.label));
    let mut known = quantities.chain(NAMES);
    let name = known.find(|(known, _)| *known == key).map(|(_, name)| name);
    name.or(Column::named(key).map(Column::label))
}

/// Whether a key is important enough for a short table.
pub fn is_named(key: &str) -> bool {
    named(key).is_some() || PLAIN.split(' ').any(|plain| plain == key)
}

/// The unit of a number in a row. A number without a unit in its key has that of the column or key
/// that the row names.
///
/// For a difference of the speeds `v_mps` of two runs, `size` is the missing force [N].
pub fn unit_in(row: &Data, key: &str) -> Cow<'static, str> {
    let mut named = ["column", "key"].iter();
    let column = named.find_map(|key| row.get(*key)?.text());
    let unit = shown_unit(key);
    match (&*unit, column) {
        ("", Some("v_mps")) if key == "size" => Cow::Borrowed("N"),
        ("", Some(column)) if !key.starts_with("times") => shown_unit(column),
        _ => unit,
    }
}

/// The label of a key, or its words without the unit.
pub fn name_of(key: &str) -> String {
    if let Some(name) = named(key) {
        return name.to_owned();
    }
    let words = stem(key).0.split('_').map(|word| {
        let known = WORDS.iter().find(|(short, _)| *short == word);
        known.map_or(word, |(_, long)| long)
    });
    words.collect::<Vec<_>>().join(" ")
}

/// A key without the ending that is its unit.
pub fn without_unit(key: &str) -> &str {
    stem(key).0
}

/// A key without the ending that is its unit, and that ending.
fn stem(key: &str) -> (&str, &str) {
    let above = key.rfind("_per_").map_or(key, |at| &key[..at]);
    let at = if unit_of(above).is_empty() {
        above.len()
    } else {
        above.rfind('_').unwrap_or(key.len())
    };
    key.split_at(at)
}

/// Possible keys of the error of a key's number.
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
            ("mu_viscous", "friction of the melt film", "1e-3"),
            ("k_n_per_rad", "stiffness over slip, K", "N/rad"),
            ("slope_per_k", "slope", "1/K"),
            ("side_n_per_rad", "side", "N/rad"),
        ] {
            assert_eq!(
                (name_of(key).as_str(), &*shown_unit(key)),
                (name, unit),
                "{key}"
            );
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
