//! The ranges of the ice's values.

use super::range::{Checked, combination, in_range};
use crate::case::table::{Hardness, IceTable, Thickness};

pub(crate) fn check_ice(ice: &IceTable) -> Checked {
    match (ice.temperature_c, ice.youngs_modulus_pa) {
        (Some(temperature), _) => in_range("ice.temperature_c", temperature)?,
        (None, None) => {
            return Err(combination(
                "ice",
                "expected youngs_modulus_pa, or temperature_c to take it from",
            ));
        }
        (None, Some(_)) => {}
    }
    if let Some(stated) = ice.youngs_modulus_pa {
        in_range("ice.youngs_modulus_pa", stated)?;
    }
    match ice.poissons_ratio {
        Some(stated) => in_range("ice.poissons_ratio", stated)?,
        None if ice.temperature_c.is_none() => {
            return Err(combination(
                "ice",
                "expected poissons_ratio, or temperature_c to take it from",
            ));
        }
        None => {}
    }
    if let Thickness::Layer(thickness) = ice.thickness_m {
        in_range("ice.thickness_m", thickness)?;
    }
    if let Some(bed) = &ice.bed {
        if ice.thickness_m == Thickness::HalfSpace {
            return Err(combination("ice.bed", "a half-space of ice has no bed"));
        }
        in_range("ice.bed.youngs_modulus_pa", bed.youngs_modulus_pa)?;
        in_range("ice.bed.poissons_ratio", bed.poissons_ratio)?;
        in_range("ice.bed.thickness_m", bed.thickness_m)?;
    }
    match ice.hardness_pa {
        Some(Hardness::Stated(hardness)) => in_range("ice.hardness_pa", hardness)?,
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
        in_range("ice.waviness.amplitude_m", waves.amplitude_m)?;
        in_range("ice.waviness.wavelength_m", waves.wavelength_m)?;
        in_range("ice.waviness.direction_rad", waves.direction_rad)?;
        in_range("ice.waviness.phase_rad", waves.phase_rad)?;
    }
    Ok(())
}
