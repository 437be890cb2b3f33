//! What water, ice and steel are at 0 C.

use crate::friction::error::{Error, in_range};

/// Material constants of the film and of its two walls, all at 0 C.
///
/// They do not follow the temperature: between 0 and -10 C the conductivity of ice rises by 5 %, its heat capacity falls by 4 %,
/// and the viscosity of water below 0 C rises by 4 % a kelvin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Properties {
    /// Dynamic viscosity of water [Pa s].
    pub water_viscosity: f64,
    /// Density of water [kg/m3].
    pub water_density: f64,
    /// Density of ice [kg/m3].
    pub ice_density: f64,
    /// Specific heat capacity of ice [J/(kg K)].
    pub ice_heat_capacity: f64,
    /// Thermal conductivity of ice [W/(m K)].
    pub ice_conductivity: f64,
    /// Latent heat of melting [J/kg].
    pub latent_heat: f64,
    /// Change of the melting point with pressure, negative for ice [K/Pa].
    pub melting_slope: f64,
    /// Thermal conductivity of the runner's steel [W/(m K)].
    pub steel_conductivity: f64,
    /// Density times specific heat capacity of the steel [J/(m3 K)].
    pub steel_volumetric_heat: f64,
}

impl Properties {
    /// Water, ice Ih and a carbon steel at 0 C.
    ///
    /// | constant | source |
    /// |---|---|
    /// | viscosity 1.79e-3 Pa s, density 999.8 kg/m3 of water | CRC Handbook of Chemistry and Physics, properties of water and steam |
    /// | density 917 kg/m3, latent heat 3.34e5 J/kg, melting slope -7.4e-8 K/Pa | V.F. Petrenko, R.W. Whitworth, Physics of Ice, Oxford 1999 |
    /// | conductivity 2.2 W/(m K), heat capacity 2050 J/(kg K) of ice | the same, rounded to what 0 to -5 C have in common |
    /// | conductivity 45 W/(m K), volumetric heat 3.6e6 J/(m3 K) of steel | CRC Handbook, plain carbon steel |
    pub const WATER_AND_ICE: Properties = Properties {
        water_viscosity: 1.79e-3,
        water_density: 999.8,
        ice_density: 917.0,
        ice_heat_capacity: 2050.0,
        ice_conductivity: 2.2,
        latent_heat: 3.34e5,
        melting_slope: -7.4e-8,
        steel_conductivity: 45.0,
        steel_volumetric_heat: 3.6e6,
    };

    /// Melting point of ice at the pressure `p` [Pa] over the atmosphere's [C].
    ///
    /// `T_m = p dT_m/dp`: linear, 0.4 K too warm at 50 MPa.
    pub fn melting_temperature(&self, p: f64) -> f64 {
        self.melting_slope * p
    }

    /// Thermal diffusivity of ice [m2/s].
    pub fn ice_diffusivity(&self) -> f64 {
        self.ice_conductivity / (self.ice_density * self.ice_heat_capacity)
    }

    /// Heat that melts one cubic metre of water out of ice at its melting point [J/m3 of water].
    pub fn heat_of_water(&self) -> f64 {
        self.water_density * self.latent_heat
    }

    /// Checks that every constant is finite, that conductivities are 0 or more and the others positive.
    ///
    /// # Errors
    /// [`Error::OutOfRange`] with the constant's name.
    pub fn check(&self) -> Result<(), Error> {
        let positive = [
            ("water_viscosity", self.water_viscosity),
            ("water_density", self.water_density),
            ("ice_density", self.ice_density),
            ("ice_heat_capacity", self.ice_heat_capacity),
            ("latent_heat", self.latent_heat),
            ("steel_volumetric_heat", self.steel_volumetric_heat),
        ];
        for (name, value) in positive {
            in_range(name, value, value > 0.0, "a positive number")?;
        }
        for (name, value) in [
            ("ice_conductivity", self.ice_conductivity),
            ("steel_conductivity", self.steel_conductivity),
        ] {
            in_range(name, value, value >= 0.0, "0 or more")?;
        }
        in_range("melting_slope", self.melting_slope, true, "a finite number")
    }
}
