//! Normal forces at the axles, and the front runner's own frame.

use crate::model::sled::Sled;

/// Normal forces at the axles in the body frame (front, rear) [N] from the vertical specific force at the centre of
/// gravity [m/s2] and the pitch acceleration [rad/s2].
///
/// ```text
/// F_z,f0 = (l_r m a_z - J_yy dpitch/dt) / L      F_z,r = (l_f m a_z + J_yy dpitch/dt) / L
/// ```
#[inline]
pub fn normal_forces(sled: &Sled, az: f64, pitch_accel: f64) -> (f64, f64) {
    let wheelbase = sled.wheelbase_m();
    let total = sled.mass_kg * az;
    let moment = sled.j_yy_kgm2 * pitch_accel;
    (
        (sled.l_r_m * total - moment) / wheelbase,
        (sled.l_f_m * total + moment) / wheelbase,
    )
}

/// `F_f0 = R_x(gamma) R_z(delta) F_f`: a force on the front runner, brought to the body frame.
pub fn front_to_body(force: [f64; 3], delta: f64, gamma: f64) -> [f64; 3] {
    turned(force, delta.sin_cos(), gamma.sin_cos())
}

/// [`front_to_body`] with sine and cosine of both angles known.
#[inline]
pub(crate) fn turned(force: [f64; 3], (sd, cd): (f64, f64), (sg, cg): (f64, f64)) -> [f64; 3] {
    let (x, y) = (cd * force[0] - sd * force[1], sd * force[0] + cd * force[1]);
    [x, cg * y - sg * force[2], sg * y + cg * force[2]]
}

/// `F_f = R^T F_f0`: the inverse of [`front_to_body`].
pub fn body_to_front(force: [f64; 3], delta: f64, gamma: f64) -> [f64; 3] {
    let ((sd, cd), (sg, cg)) = (delta.sin_cos(), gamma.sin_cos());
    let (y, z) = (
        cg * force[1] + sg * force[2],
        -sg * force[1] + cg * force[2],
    );
    [cd * force[0] + sd * y, -sd * force[0] + cd * y, z]
}
