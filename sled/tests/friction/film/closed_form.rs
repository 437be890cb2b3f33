//! Closed forms: squeeze-out of a long strip, and the limits of the film.

use std::f64::consts::PI;

use kufe_sled::friction::film::{FilmConditions, Properties};

/// Thickness at which melting and squeeze-out are in balance if all friction heat melts ice [m].
///
/// For a strip of width `w` [m] under the pressure `p` [Pa], far from its leading edge:
///
/// ```text
/// mu V^2/(rho_w L h) = p h^3/(mu w^2)   =>   h = [ mu^2 V^2 w^2/(rho_w L p) ]^(1/4)
/// ```
///
/// The density is that of water: the squeezed-out volume is a volume of water, not of ice.
pub fn melt_and_squeeze_thickness(
    w: f64,
    p: f64,
    conditions: &FilmConditions,
    properties: &Properties,
) -> f64 {
    let mu = conditions.viscosity(properties);
    ((mu * conditions.v * w).powi(2) / (properties.heat_of_water() * p)).powf(0.25)
}

/// Friction coefficient of the film of [`melt_and_squeeze_thickness`].
///
/// ```text
/// mu_v = mu V/(h p) = (mu V)^(1/2) (rho_w L)^(1/4) p^(-3/4) w^(-1/2)
/// ```
pub fn melt_and_squeeze_friction(
    w: f64,
    p: f64,
    conditions: &FilmConditions,
    properties: &Properties,
) -> f64 {
    let h = melt_and_squeeze_thickness(w, p, conditions, properties);
    conditions.viscosity(properties) * conditions.v / (h * p)
}

/// Friction coefficient of a slow runner on cold ice: all friction heat flows into the ice.
///
/// For the length `l` [m] under the uniform pressure `p` [Pa], with `dT = T_m(p) - T_ice`:
///
/// ```text
/// mu V^2/h = q_i = k_i dT/sqrt(pi kappa xi/V)   =>   mu_v = 2 k_i dT/(p sqrt(pi kappa l V))
/// ```
///
/// The viscosity cancels. 0 if the ice is at its melting point.
pub fn cold_friction(l: f64, p: f64, conditions: &FilmConditions, properties: &Properties) -> f64 {
    let warmed = properties.melting_temperature(p) - conditions.ice_c;
    let spread = PI * properties.ice_diffusivity() * l * conditions.v;
    if warmed > 0.0 && properties.ice_conductivity > 0.0 {
        2.0 * properties.ice_conductivity * warmed / (p * spread.sqrt())
    } else {
        0.0
    }
}

/// The factor `a` of the start of the film `h = a sqrt(xi)` [m^0.5].
///
/// Near the leading edge squeeze-out is negligible and the heat flux into the ice decreases as
/// `1/sqrt(xi)`. The film equation `(V/2) dh/dxi = (mu V^2/h - q_i)/(rho_w L)` then has the
/// solution
///
/// ```text
/// a = (2/V) ( -c + sqrt(c^2 + mu V^3/(rho_w L)) ),   c = k_i dT sqrt(V/(pi kappa))/(rho_w L)
/// ```
///
/// `pressure` [Pa] is the pressure at the leading edge, `dT = T_m(pressure) - T_ice`. Heat into the
/// steel is neglected.
pub fn self_similar_start(
    pressure: f64,
    conditions: &FilmConditions,
    properties: &Properties,
) -> f64 {
    let v = conditions.v;
    let warmed = properties.melting_temperature(pressure) - conditions.ice_c;
    let heat = properties.heat_of_water();
    let mut c = 0.0;
    if properties.ice_conductivity > 0.0 {
        let depth = (PI * properties.ice_diffusivity() / v).sqrt();
        c = properties.ice_conductivity * warmed / depth / heat;
    }
    let friction = conditions.viscosity(properties) * v.powi(3) / heat;
    let root = c.hypot(friction.sqrt());
    // The two forms are equal. The second avoids cancellation where friction is a small part of the
    // root.
    if c <= 0.0 {
        2.0 / v * (root - c)
    } else {
        2.0 / v * friction / (root + c)
    }
}

/// Volume per unit area and time that a long strip loses sideways [m/s].
///
/// With the thickness `h` [m] uniform across the width `w` [m], the Reynolds equation across a
/// strip with open sides is
///
/// ```text
/// d/dy( h^3/(12 mu) dp/dy ) = -s,   p(-w/2) = p(w/2) = 0
/// p = 6 mu s/h^3 (w^2/4 - y^2),   mean p = mu s w^2/h^3   =>   s = p_mean h^3/(mu w^2)
/// ```
///
/// The factor is exactly 1 if `p` [Pa] is the mean pressure over the width. The peak is 3/2 of the
/// mean, so the factor for the peak is 8/12. Source: squeeze film between parallel plates, O.
/// Reynolds, Phil. Trans. R. Soc. 177 (1886).
pub fn squeeze_out_rate(p: f64, h: f64, w: f64, viscosity: f64) -> f64 {
    p * h.powi(3) / (viscosity * w * w)
}

/// Film pressure at `y` [m] from the middle of a long strip that loses `s` [m/s]: the parabola of
/// [`squeeze_out_rate`] [Pa]. 0 at the sides `y = +-w/2`.
pub fn film_pressure(y: f64, s: f64, h: f64, w: f64, viscosity: f64) -> f64 {
    6.0 * viscosity * s / h.powi(3) * (0.25 * w * w - y * y)
}

#[test]
fn the_parabola_has_the_mean_pressure_of_the_squeeze_out() {
    let s = squeeze_out_rate(10.0e6, 0.5e-6, 1.0e-3, 1.79e-3);
    let at = |i: i32| (f64::from(i) + 0.5) / 1000.0 * 1.0e-3 - 0.5e-3;
    let pressures = (0..1000).map(|i| film_pressure(at(i), s, 0.5e-6, 1.0e-3, 1.79e-3));
    let mean = pressures.sum::<f64>() / 1000.0;
    assert!((mean / 10.0e6 - 1.0).abs() < 1e-6, "{mean}");
}
