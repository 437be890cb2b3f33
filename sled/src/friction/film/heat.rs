//! Heat that the film loses to the ice below and the steel above it.

use std::f64::consts::PI;

use super::conditions::FilmConditions;
use super::properties::Properties;
use super::strip::Strip;

/// Heat into ice whose surface is held at the melting point from the moment the runner's leading edge reaches it.
///
/// Conduction in depth alone (the Peclet number of a bob runner is a million) into ice at `T_ice`, with `D = T_m(p(xi)) - T_ice`:
///
/// ```text
/// q_i(xi) = k_i sqrt(V/(pi kappa)) [ D(0)/sqrt(xi) + integral_0^xi D'(s)/sqrt(xi - s) ds ]
/// ```
///
/// Exact for the pressure of a [`Strip`], linear between its stations. Under an even pressure it is `k_i D/sqrt(pi kappa xi/V)`.
/// Source: H.S. Carslaw, J.C. Jaeger, Conduction of Heat in Solids, 2nd ed., Oxford 1959, section 2.5 with Duhamel's theorem.
///
/// Negative where the pressure has pushed the melting point under the temperature of the ice.
#[derive(Clone, Debug)]
pub struct HeatIntoIce {
    factor: f64,
    first: f64,
    xi: Vec<f64>,
    slopes: Vec<f64>,
}

impl HeatIntoIce {
    /// For the pressures of `strip`.
    pub fn new(strip: &Strip, conditions: &FilmConditions, properties: &Properties) -> Self {
        let kappa = properties.ice_diffusivity();
        let factor = if kappa > 0.0 {
            properties.ice_conductivity * (conditions.v / (PI * kappa)).sqrt()
        } else {
            0.0
        };
        let (xi, p) = (strip.xi(), strip.pressure());
        let melting = |k: usize| properties.melting_temperature(p[k]);
        HeatIntoIce {
            factor,
            first: melting(0) - conditions.ice_temperature,
            xi: xi.to_vec(),
            slopes: (1..xi.len())
                .map(|k| (melting(k) - melting(k - 1)) / (xi[k] - xi[k - 1]))
                .collect(),
        }
    }

    /// `q_i sqrt(xi)` at `xi` [m], which stays finite at the leading edge [W/m^1.5].
    pub fn scaled(&self, xi: f64) -> f64 {
        let mut sum = 0.0;
        for (slope, ends) in self.slopes.iter().zip(self.xi.windows(2)) {
            if ends[0] >= xi {
                break;
            }
            sum += 2.0 * slope * ((xi - ends[0]).sqrt() - (xi - ends[1]).max(0.0).sqrt());
        }
        self.factor * (self.first + xi.sqrt() * sum)
    }
}

/// Heat transfer coefficient of steel as deep as heat goes in the sliding time [W/(m2 K)].
///
/// `q_s = sqrt(k_s rho_s c_s/(pi t)) (T_m - T_s)` with the time `t` for which the runner has slid: the film stays at the same
/// place of the steel. Some 2 kW/(m2 K) after 10 s, beside megawatts of friction. Source: as [`HeatIntoIce`].
pub(crate) fn steel_transfer(conditions: &FilmConditions, properties: &Properties) -> f64 {
    let effusivity_squared = properties.steel_conductivity * properties.steel_volumetric_heat;
    (effusivity_squared / (PI * conditions.sliding_time)).sqrt()
}
