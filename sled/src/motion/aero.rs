//! Air density, and the drag of a sled with chassis slip.

pub use crate::friction::air_density;

use crate::sled::Sled;

/// Drag area [m2] at the chassis slip angle `beta` [rad]: `c_d A (1 + k |beta in degrees|)`.
///
/// k is the sled's `yaw_drag_per_deg`, 0.0694 in the paper.
#[inline]
pub fn drag_area(sled: &Sled, beta: f64) -> f64 {
    sled.cda_m2 * (1.0 + sled.yaw_drag_per_deg * beta.to_degrees().abs())
}

/// Drag [N] against the driving direction: `F = -1/2 rho (c_d A)(beta) v^2`, never positive.
///
/// Speed in m/s, density in kg/m3, `beta` in rad. Without a drag area the density may be NaN.
/// `beta = 0` is the paper's ideal case.
#[inline]
pub fn drag(sled: &Sled, speed: f64, density: f64, beta: f64) -> f64 {
    match drag_area(sled, beta) {
        0.0 => 0.0,
        area => -0.5 * density * area * speed * speed,
    }
}

/// Component of a body-frame force along the driving direction [N].
///
/// ```text
/// F_x~ = F_x cos(alpha) - F_y sin(alpha),   driving direction = (cos(alpha), -sin(alpha))
/// ```
///
/// `alpha = -beta` is the slip angle at the centre of gravity [rad]; the paper's rotation with the
/// sign convention of this crate.
pub fn along_driving_direction(fx: f64, fy: f64, alpha: f64) -> f64 {
    let (sine, cosine) = alpha.sin_cos();
    fx * cosine - fy * sine
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::model_toml::Model;

    #[test]
    fn drag_grows_by_the_published_share_a_degree_on_either_side() {
        let sled = Model::published().sled;
        let straight = drag(&sled, 30.0, 1.2, 0.0);
        assert!((straight + 0.5 * 1.2 * 0.28 * 900.0).abs() < 1e-9);
        for beta in [2.0_f64, -2.0] {
            let ratio = drag(&sled, 30.0, 1.2, beta.to_radians()) / straight;
            assert!((ratio - 1.1388).abs() < 1e-12);
        }
    }

    #[test]
    fn lateral_force_at_slip_takes_energy_on_either_side() {
        for alpha in [0.05, -0.05] {
            // Positive slip has positive lateral force: it must brake.
            assert!(along_driving_direction(0.0, 100.0 * alpha, alpha) < 0.0);
        }
    }
}
