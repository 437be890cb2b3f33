//! Colours: the viridis map and a qualitative palette.

use plotters::style::RGBColor;

/// Eight line colours after Okabe and Ito, "Color Universal Design" (2008), black last.
pub const PALETTE: [RGBColor; 8] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(90, 90, 90),
    RGBColor(0, 0, 0),
];

/// Colour of `t` in the viridis map (S. van der Walt and N. Smith, 2015), clamped to `0..=1`.
///
/// Interpolates nine stops of the published map linearly; NaN gives mid-grey.
pub fn viridis(t: f64) -> RGBColor {
    const STOPS: [[f64; 3]; 9] = [
        [68.0, 1.0, 84.0],
        [71.0, 44.0, 122.0],
        [59.0, 81.0, 139.0],
        [44.0, 113.0, 142.0],
        [33.0, 144.0, 141.0],
        [39.0, 173.0, 129.0],
        [92.0, 200.0, 99.0],
        [170.0, 220.0, 50.0],
        [253.0, 231.0, 37.0],
    ];
    if t.is_nan() {
        return RGBColor(128, 128, 128);
    }
    let position = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let low = (position as usize).min(STOPS.len() - 2);
    let weight = position - low as f64;
    let mix =
        |k: usize| (STOPS[low][k] + weight * (STOPS[low + 1][k] - STOPS[low][k])).round() as u8;
    RGBColor(mix(0), mix(1), mix(2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viridis_meets_its_ends_and_greys_out_nan() {
        assert_eq!(viridis(-1.0), RGBColor(68, 1, 84));
        assert_eq!(viridis(2.0), RGBColor(253, 231, 37));
        assert_eq!(viridis(f64::NAN), RGBColor(128, 128, 128));
    }
}
