//! The pressure that ice bears before it yields, over temperature and contact time.

use super::properties::Properties;
use crate::friction::error::{Error, in_range};

/// Molar gas constant [J/(mol K)], exact in the SI of 2019.
const GAS_CONSTANT: f64 = 8.314_462_618;

/// 0 C [K].
const ZERO_CELSIUS: f64 = 273.15;

/// Temperature at which the activation energy of ice's creep changes [C].
const KNEE: f64 = -8.0;

/// Activation energy above the knee, where water between the grains helps [J/mol].
const ENERGY_ABOVE: f64 = 120.0e3;

/// Activation energy below the knee [J/mol].
const ENERGY_BELOW: f64 = 78.0e3;

/// Stress exponent of ice's creep.
pub const HARDNESS_EXPONENT: f64 = 3.0;

/// Indentation hardness of ice from one known point, by the law of its creep.
///
/// Creep at the rate `A H^n exp(-Q/(R T))` that has to make an indentation within the contact time `t` gives
///
/// ```text
/// H(T, t) = H_0 (t/t_0)^(-1/n) exp( integral from T_0 to T of Q/(n R) d(1/T) ),   n = 3
/// Q = 120 kJ/mol above -8 C, 78 kJ/mol below,   H <= T/(dT_m/dp)
/// ```
///
/// The energies and the law: P. Barnes, D. Tabor, J.C.F. Walker, Proc. R. Soc. Lond. A 324 (1971) 127-155. Over -8 C the
/// integral is taken piece by piece, so that the hardness is continuous. The bound is pressure melting, [`pressure_melting_bound`].
///
/// ```
/// use kufe_sled::friction::film::{IceHardness, Properties};
/// let hardness = IceHardness::new(17.7e6, -5.0, 2.0e-3)?; // 17.7 MPa at -5 C within 2 ms
/// let colder = hardness.at(-15.0, 2.0e-3, &Properties::WATER_AND_ICE)?;
/// let slower = hardness.at(-5.0, 16.0e-3, &Properties::WATER_AND_ICE)?;
/// assert!(colder > 17.7e6);
/// assert!((slower / 17.7e6 - 0.5).abs() < 1e-12);
/// # Ok::<(), kufe_sled::friction::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IceHardness {
    pressure: f64,
    temperature: f64,
    contact_time: f64,
}

impl IceHardness {
    /// From the hardness `pressure` [Pa] that was measured at `temperature` [C] within `contact_time` [s].
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a pressure or time that is not positive, or a temperature outside -100 to 0 C.
    pub fn new(pressure: f64, temperature: f64, contact_time: f64) -> Result<Self, Error> {
        in_range("pressure", pressure, pressure > 0.0, "a positive number")?;
        check(temperature, contact_time)?;
        Ok(IceHardness {
            pressure,
            temperature,
            contact_time,
        })
    }

    /// Hardness at `temperature` [C] within `contact_time` [s], at most the pressure that melts the ice [Pa].
    ///
    /// A runner of contact length `l` at the speed `V` leaves the ice `l/V`. 0 at 0 C, where ice bears nothing without melting.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] for a time that is not positive, or a temperature outside -100 to 0 C.
    pub fn at(
        &self,
        temperature: f64,
        contact_time: f64,
        properties: &Properties,
    ) -> Result<f64, Error> {
        check(temperature, contact_time)?;
        let warmth = exponent(temperature) - exponent(self.temperature);
        let time = (contact_time / self.contact_time).powf(-1.0 / HARDNESS_EXPONENT);
        let creep = self.pressure * time * warmth.exp();
        Ok(creep.min(pressure_melting_bound(temperature, properties)))
    }
}

/// Pressure that melts ice of this temperature [C], which no contact exceeds for long [Pa].
///
/// `p = T/(dT_m/dp)`: 13.5 MPa a kelvin below 0 C. Without bound where the melting point does not fall with pressure.
pub fn pressure_melting_bound(temperature: f64, properties: &Properties) -> f64 {
    if properties.melting_slope < 0.0 {
        (temperature.min(0.0) / properties.melting_slope).abs()
    } else {
        f64::INFINITY
    }
}

/// `Q/(n R T)`, with the jump at the knee taken out.
fn exponent(temperature: f64) -> f64 {
    let inverse = 1.0 / (temperature + ZERO_CELSIUS);
    let knee = 1.0 / (KNEE + ZERO_CELSIUS);
    let energy = if temperature > KNEE {
        ENERGY_ABOVE
    } else {
        ENERGY_BELOW
    };
    energy / (HARDNESS_EXPONENT * GAS_CONSTANT) * (inverse - knee)
}

fn check(temperature: f64, contact_time: f64) -> Result<(), Error> {
    let cold = (-100.0..=0.0).contains(&temperature);
    in_range("temperature", temperature, cold, "-100 to 0 C")?;
    let holds = contact_time > 0.0;
    in_range("contact_time", contact_time, holds, "a positive number")
}
