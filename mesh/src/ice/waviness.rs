//! Wavy ice.

use crate::error::MeshError;
use crate::ice::surface::IceSurface;
use crate::parameter::positive_finite;

/// Sinusoidal waves `z = amplitude cos(2 pi (x cos a + y sin a) / wavelength + phase)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Waviness {
    /// Half the height from trough to crest [m].
    pub amplitude: f64,
    /// Distance from crest to crest [m].
    pub wavelength: f64,
    /// Angle a between the waves' direction and x [rad].
    pub direction: f64,
    /// Phase at the origin [rad]; 0 puts a crest there.
    pub phase: f64,
}

impl Waviness {
    /// Waves along x with a crest at the origin.
    ///
    /// # Errors
    /// [`MeshError::Parameter`] where the amplitude is not finite or the wavelength not positive.
    pub fn new(amplitude: f64, wavelength: f64) -> Result<Self, MeshError> {
        positive_finite("wavelength [m]", wavelength)?;
        if !amplitude.is_finite() {
            return Err(MeshError::Parameter {
                name: "amplitude [m]",
                value: amplitude,
                expected: "a finite number",
            });
        }
        Ok(Self {
            amplitude,
            wavelength,
            direction: 0.0,
            phase: 0.0,
        })
    }
}

impl IceSurface for Waviness {
    fn height(&self, x: f64, y: f64) -> f64 {
        let along = x * self.direction.cos() + y * self.direction.sin();
        self.amplitude * (std::f64::consts::TAU * along / self.wavelength + self.phase).cos()
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        let crest_or_trough = self.phase.sin().abs() < 1e-12;
        let (along, across) = (self.direction.cos().abs(), self.direction.sin().abs());
        [
            along < 1e-12 || (across < 1e-12 && crest_or_trough),
            across < 1e-12 || (along < 1e-12 && crest_or_trough),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn waves_along_an_axis_are_symmetric_and_oblique_ones_are_not() {
        assert_eq!(
            Waviness::new(1e-6, 0.1).unwrap().mirror_symmetric(),
            [true, true]
        );
        let oblique = Waviness {
            direction: 0.3,
            ..Waviness::new(1e-6, 0.1).unwrap()
        };
        assert_eq!(oblique.mirror_symmetric(), [false, false]);
        assert!((oblique.height(0.0, 0.0) - 1e-6).abs() < 1e-20);
    }
}
