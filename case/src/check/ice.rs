//! The ranges of the ice's values.

use kufe_contact::ICE_TEMPERATURES;

use super::range::{Checked, combination, finite, modulus, poisson, positive, require};
use crate::table::{Hardness, IceTable, Thickness};

pub(crate) fn check_ice(ice: &IceTable) -> Checked {
    match (ice.temperature_c, ice.youngs_modulus_pa) {
        (Some(temperature), _) => require(
            ICE_TEMPERATURES.contains(&temperature),
            "ice.temperature_c",
            temperature,
            "a temperature from -50 to 0 degrees Celsius",
        )?,
        (None, None) => {
            return Err(combination(
                "ice",
                "expected youngs_modulus_pa, or temperature_c to take it from",
            ));
        }
        (None, Some(_)) => {}
    }
    if let Some(stated) = ice.youngs_modulus_pa {
        modulus("ice.youngs_modulus_pa", stated)?;
    }
    match ice.poissons_ratio {
        Some(stated) => poisson("ice.poissons_ratio", stated)?,
        None if ice.temperature_c.is_none() => {
            return Err(combination(
                "ice",
                "expected poissons_ratio, or temperature_c to take it from",
            ));
        }
        None => {}
    }
    if let Thickness::Layer(thickness) = ice.thickness_m {
        require(
            thickness.is_finite() && thickness > 0.0,
            "ice.thickness_m",
            thickness,
            "a positive thickness in metres or \"half-space\"",
        )?;
    }
    if let Some(bed) = &ice.bed {
        if ice.thickness_m == Thickness::HalfSpace {
            return Err(combination("ice.bed", "a half-space of ice has no bed"));
        }
        modulus("ice.bed.youngs_modulus_pa", bed.youngs_modulus_pa)?;
        poisson("ice.bed.poissons_ratio", bed.poissons_ratio)?;
        positive("ice.bed.thickness_m", bed.thickness_m)?;
    }
    match ice.hardness_pa {
        Some(Hardness::Stated(hardness)) => positive("ice.hardness_pa", hardness)?,
        Some(Hardness::FromTemperature) if ice.temperature_c.is_none() => {
            return Err(combination(
                "ice.hardness_pa",
                "\"from-temperature\" needs temperature_c",
            ));
        }
        _ => {}
    }
    if let Some(waves) = &ice.waviness {
        if ice.surface.is_some() {
            return Err(combination(
                "ice.surface",
                "either waviness or surface, not both",
            ));
        }
        finite("ice.waviness.amplitude_m", waves.amplitude_m)?;
        positive("ice.waviness.wavelength_m", waves.wavelength_m)?;
        finite("ice.waviness.direction_rad", waves.direction_rad)?;
        finite("ice.waviness.phase_rad", waves.phase_rad)?;
    }
    Ok(())
}
