//! The film's equation along a strip, in variables in which its start is regular.

use super::conditions::FilmConditions;
use super::heat::{HeatIntoIce, steel_transfer};
use super::properties::Properties;
use super::radau::Rate;
use super::solution::{FilmStation, FilmTotals};
use super::strip::{Strip, between};

/// Share of the largest width below which squeeze-out no longer grows as the strip narrows to a point.
const NARROWEST: f64 = 1e-3;

/// What the film's equation says along a strip.
///
/// With `s = sqrt(xi)` instead of `xi` the thickness starts as `h = a s` and every term stays finite:
///
/// ```text
/// dh/ds = (4/V) [ mu V^2 s/(rho_w L h) - (q_i + q_s) s/(rho_w L) - s p h^3/(mu w^2) ]
/// ```
pub(crate) struct Track<'a> {
    strip: &'a Strip,
    /// At the stations, the pressure that a long strip would have to have for the squeeze-out that there is [Pa].
    outflow_pressure: Vec<f64>,
    width_squared: Vec<f64>,
    narrowest_squared: f64,
    heat_into_ice: HeatIntoIce,
    steel_transfer: f64,
    steel_temperature: f64,
    viscosity: f64,
    v: f64,
    properties: &'a Properties,
}

impl<'a> Track<'a> {
    pub(crate) fn new(
        strip: &'a Strip,
        conditions: &FilmConditions,
        properties: &'a Properties,
        outflow_pressure: Vec<f64>,
    ) -> Self {
        Track {
            strip,
            outflow_pressure,
            width_squared: strip.width().iter().map(|w| w * w).collect(),
            narrowest_squared: (NARROWEST * strip.largest_width()).powi(2),
            heat_into_ice: HeatIntoIce::new(strip, conditions, properties),
            steel_transfer: steel_transfer(conditions, properties),
            steel_temperature: conditions.steel_temperature,
            viscosity: conditions.viscosity(properties),
            v: conditions.v,
            properties,
        }
    }

    /// Heat that melts a kilogram of ice [J/kg], and that makes a cubic metre of water [J/m3].
    pub(crate) fn heats(&self) -> [f64; 2] {
        [self.properties.latent_heat, self.properties.heat_of_water()]
    }

    /// Segments between stations.
    pub(crate) fn segments(&self) -> usize {
        self.strip.xi().len() - 1
    }

    /// Ends of segment `k` in `s = sqrt(xi)`.
    pub(crate) fn segment(&self, k: usize) -> [f64; 2] {
        [self.strip.xi()[k].sqrt(), self.strip.xi()[k + 1].sqrt()]
    }

    fn pressure(&self, k: usize, xi: f64) -> f64 {
        between(self.strip.xi(), self.strip.pressure(), k, xi)
    }

    fn width_squared(&self, k: usize, xi: f64) -> f64 {
        between(self.strip.xi(), &self.width_squared, k, xi).max(0.0)
    }

    /// Squeeze-out over `h^3` [1/(m2 s)].
    fn squeeze(&self, k: usize, xi: f64) -> f64 {
        let p = between(self.strip.xi(), &self.outflow_pressure, k, xi);
        p / (self.viscosity * self.width_squared(k, xi).max(self.narrowest_squared))
    }

    fn heat_into_steel(&self, k: usize, xi: f64) -> f64 {
        let melting = self.properties.melting_temperature(self.pressure(k, xi));
        self.steel_transfer * (melting - self.steel_temperature)
    }

    /// The equation at `s` in segment `k`.
    pub(crate) fn rate(&self, k: usize, s: f64) -> Rate {
        let xi = s * s;
        let heat = self.properties.heat_of_water();
        let lost = self.heat_into_ice.scaled(xi) + s * self.heat_into_steel(k, xi);
        Rate {
            alpha: 4.0 * self.viscosity * self.v * s / heat,
            beta: 4.0 / self.v * lost / heat,
            gamma: 4.0 / self.v * s * self.squeeze(k, xi),
        }
    }

    /// What one metre of `s` adds to the totals, where the film is `h` thick; `mean_thickness` is the volume.
    pub(crate) fn totals_rate(&self, k: usize, s: f64, h: f64) -> FilmTotals {
        let xi = s * s;
        let width = self.width_squared(k, xi).sqrt();
        let area = 2.0 * s * width;
        let drag = self.viscosity * self.v / h * area;
        let into_ice = 2.0 * width * self.heat_into_ice.scaled(xi);
        let into_steel = self.heat_into_steel(k, xi) * area;
        let melting = (drag * self.v - into_ice - into_steel) / self.properties.latent_heat;
        FilmTotals {
            load: self.pressure(k, xi) * area,
            area,
            viscous_drag: drag,
            friction: 0.0,
            dissipated: drag * self.v,
            into_ice,
            into_steel,
            melted: melting.max(0.0),
            refrozen: (-melting).max(0.0),
            squeezed_out: self.squeeze(k, xi) * h.powi(3) * area,
            mean_thickness: h * area,
        }
    }

    /// The film at station `k`, not the first, where it is `h` thick.
    pub(crate) fn station(&self, k: usize, h: f64, thickness_error: f64) -> FilmStation {
        let xi = self.strip.xi()[k];
        let heat_into_ice = self.heat_into_ice.scaled(xi) / xi.sqrt();
        let heat_into_steel = self.heat_into_steel(k - 1, xi);
        let shear = self.viscosity * self.v / h;
        let melting = shear * self.v - heat_into_ice - heat_into_steel;
        FilmStation {
            xi,
            width: self.strip.width()[k],
            pressure: self.strip.pressure()[k],
            thickness: h,
            thickness_error,
            temperature: self
                .properties
                .melting_temperature(self.strip.pressure()[k]),
            melt_rate: melting / (self.properties.ice_density * self.properties.latent_heat),
            shear,
            heat_into_ice,
            heat_into_steel,
        }
    }
}
