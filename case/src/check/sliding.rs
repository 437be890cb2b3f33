//! The ranges of `[sliding]`, and what it does not go with.

use crate::case::Case;
use crate::check::range::{Checked, combination, positive, require};

/// Checks the table where there is one.
pub(crate) fn check_sliding(case: &Case) -> Checked {
    let Some(sliding) = &case.sliding else {
        return Ok(());
    };
    require(
        sliding.v_mps > 0.0 && sliding.v_mps <= 100.0,
        "sliding.v_mps",
        sliding.v_mps,
        "a speed above 0 and up to 100 m/s",
    )?;
    require(
        (-50.0..=-0.1).contains(&sliding.ice_c),
        "sliding.ice_c",
        sliding.ice_c,
        "a temperature from -50 to -0.1 C: ice at its melting point bears nothing",
    )?;
    if let Some(factor) = sliding.viscosity_factor {
        positive("sliding.viscosity_factor", factor)?;
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
