//! The ranges of `[sliding]`, and what it does not go with.

use crate::case::check::range::{Checked, combination, in_range};
use crate::case::document::Case;

/// Checks the table where there is one.
pub(crate) fn check_sliding(case: &Case) -> Checked {
    let Some(sliding) = &case.sliding else {
        return Ok(());
    };
    in_range("sliding.v_mps", sliding.v_mps)?;
    in_range("sliding.ice_c", sliding.ice_c)?;
    if let Some(factor) = sliding.viscosity_factor {
        in_range("sliding.viscosity_factor", factor)?;
    }
    for (key, value) in [
        ("sliding.roughness_m", sliding.roughness_m),
        ("sliding.boundary_shear_pa", sliding.boundary_shear_pa),
    ] {
        if let Some(value) = value {
            in_range(key, value)?;
        }
    }
    if let Some(anchor) = &sliding.hardness {
        in_range("sliding.hardness.pressure_pa", anchor.pressure_pa)?;
        in_range("sliding.hardness.ice_c", anchor.ice_c)?;
        in_range("sliding.hardness.contact_time_s", anchor.contact_time_s)?;
        if case.ice.hardness_pa.is_some() {
            return Err(combination(
                "sliding.hardness",
                "either ice.hardness_pa or sliding.hardness, not both",
            ));
        }
        if case.effects.contains_key("hardness") {
            return Err(combination(
                "sliding.hardness",
                "either sliding.hardness or the effect hardness, not both",
            ));
        }
    }
    if case.ice.temperature_c.is_some_and(|t| t != sliding.ice_c) {
        return Err(combination(
            "sliding.ice_c",
            "the same temperature as ice.temperature_c",
        ));
    }
    if case.ice.waviness.is_some() || case.ice.surface.is_some() {
        return Err(combination(
            "sliding",
            "even ice: on ice of varying height no sliding is steady, expected no ice.waviness and no ice.surface",
        ));
    }
    Ok(())
}
