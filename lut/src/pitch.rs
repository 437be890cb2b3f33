//! Track curvature from speed and pitch rate.

/// Speed below which [`curvature_from_pitch`] fades to a straight [m/s].
pub const MIN_SPEED: f64 = 1.0;

/// Track curvature in the vertical plane from speed and pitch rate, positive in a valley.
///
/// `1/r = -pitch_rate / v`, the inverse of `r = -v / pitch_rate` (von Schleinitz et al., Modeling
/// ice friction for vehicle dynamics of a bobsled). A pitch rate of 0 gives 0, a straight. Below
/// [`MIN_SPEED`] the quotient would amplify noise. It is replaced by `-pitch_rate v / MIN_SPEED^2`,
/// which is continuous at that speed and 0 at a standstill.
///
/// Speed [m/s], forward positive; pitch rate [rad/s], nose down positive; result [1/m]. NaN gives
/// NaN.
///
/// ```
/// use kufe_lut::curvature_from_pitch;
/// assert_eq!(curvature_from_pitch(30.0, -0.75), 0.025);
/// assert_eq!(curvature_from_pitch(30.0, 0.0), 0.0);
/// assert_eq!(curvature_from_pitch(0.0, -0.75), 0.0);
/// ```
pub fn curvature_from_pitch(speed: f64, pitch_rate: f64) -> f64 {
    // 0 - x rather than -x, so that no pitch rate gives +0.
    if speed.abs() >= MIN_SPEED {
        0.0 - pitch_rate / speed
    } else {
        0.0 - pitch_rate * speed / (MIN_SPEED * MIN_SPEED)
    }
}
