//! Numbers that sum up a stress tensor given as (xx, yy, zz, yz, zx, xy).

use nalgebra::Matrix3;

/// Von Mises stress: sqrt(3/2 s : s) with the deviator s, in the unit of the stress.
///
/// ```
/// assert_eq!(kufe_fem::von_mises([7.0, 0.0, 0.0, 0.0, 0.0, 0.0]), 7.0);
/// ```
pub fn von_mises(stress: [f64; 6]) -> f64 {
    let [xx, yy, zz, yz, zx, xy] = stress;
    let normal = (xx - yy).powi(2) + (yy - zz).powi(2) + (zz - xx).powi(2);
    (0.5 * normal + 3.0 * (yz * yz + zx * zx + xy * xy)).sqrt()
}

/// Principal stresses, largest (most tensile) first, in the unit of the stress.
///
/// All NaN where a component is not finite.
pub fn principal_stresses(stress: [f64; 6]) -> [f64; 3] {
    let [xx, yy, zz, yz, zx, xy] = stress;
    if stress.iter().any(|s| !s.is_finite()) {
        return [f64::NAN; 3];
    }
    let values = Matrix3::new(xx, xy, zx, xy, yy, yz, zx, yz, zz).symmetric_eigenvalues();
    let mut values = [values[0], values[1], values[2]];
    values.sort_by(|a, b| b.total_cmp(a));
    values
}

/// Largest shear stress on any plane: half the difference of the largest and smallest principal stress.
pub fn maximum_shear(stress: [f64; 6]) -> f64 {
    let [first, _, third] = principal_stresses(stress);
    (first - third) / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pure_shear_has_its_textbook_measures() {
        let tau = 3.0;
        for component in 3..6 {
            let mut stress = [0.0; 6];
            stress[component] = tau;
            assert!((von_mises(stress) - 3.0f64.sqrt() * tau).abs() < 1e-14);
            assert!((maximum_shear(stress) - tau).abs() < 1e-14);
        }
        assert!(principal_stresses([f64::NAN; 6])[0].is_nan());
    }

    #[test]
    fn principal_stresses_keep_the_invariants_and_order() {
        let stress = [3.0, -1.0, 2.0, 0.7, -0.4, 1.5];
        let [xx, yy, zz, yz, zx, xy] = stress;
        let [a, b, c] = principal_stresses(stress);
        assert!(a >= b && b >= c);
        let second = xx * yy + yy * zz + zz * xx - yz * yz - zx * zx - xy * xy;
        let third = xx * (yy * zz - yz * yz) - xy * (xy * zz - yz * zx) + zx * (xy * yz - yy * zx);
        assert!((a + b + c - (xx + yy + zz)).abs() < 1e-13);
        assert!((a * b + b * c + c * a - second).abs() < 1e-13);
        assert!((a * b * c - third).abs() < 1e-12);
        let by_principal = 0.5 * ((a - b).powi(2) + (b - c).powi(2) + (c - a).powi(2));
        assert!((von_mises(stress).powi(2) - by_principal).abs() < 1e-12);
    }
}
