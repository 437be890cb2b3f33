//! Colours: the viridis map, a diverging map, and a qualitative palette.

/// Red, green and blue.
pub type Rgb = [u8; 3];

/// A colour with an opacity.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Colour {
    /// Red, green and blue.
    pub rgb: Rgb,
    /// Opacity, 0 to 1.
    pub alpha: f64,
}

impl Colour {
    /// An opaque colour.
    pub const fn new(red: u8, green: u8, blue: u8) -> Self {
        Colour {
            rgb: [red, green, blue],
            alpha: 1.0,
        }
    }

    /// The same colour with this opacity.
    pub const fn alpha(self, alpha: f64) -> Self {
        Colour {
            rgb: self.rgb,
            alpha,
        }
    }

    /// The `k`-th of `count` hues around the circle, halfway between dark and light.
    pub fn hue(k: usize, count: usize) -> Self {
        let turn = 200.0 / 30.0 + 12.0 * k as f64 / count.max(1) as f64;
        let channel = |shift: f64| {
            let place = (shift + turn) % 12.0;
            let share = 0.5 - 0.3 * (place - 3.0).min(9.0 - place).clamp(-1.0, 1.0);
            (255.0 * share).round() as u8
        };
        Colour::new(channel(0.0), channel(8.0), channel(4.0))
    }
}

/// Colour of text and axes: black in a PNG, the text colour of the page in an SVG.
pub const INK: Colour = Colour::new(0, 0, 0);

/// Colours of a quantity before and after a change, legible on white and on black.
pub const BEFORE: Colour = Colour::new(208, 112, 60);
/// See [`BEFORE`].
pub const AFTER: Colour = Colour::new(63, 143, 208);

/// Eight line colours after Okabe and Ito, "Color Universal Design" (2008), black last.
pub const PALETTE: [Colour; 8] = [
    Colour::new(0, 114, 178),
    Colour::new(213, 94, 0),
    Colour::new(0, 158, 115),
    Colour::new(204, 121, 167),
    Colour::new(230, 159, 0),
    Colour::new(86, 180, 233),
    Colour::new(90, 90, 90),
    INK,
];

/// Colour of `t` in the viridis map (S. van der Walt and N. Smith, 2015), clamped to `0..=1`.
///
/// Interpolates nine stops of the published map linearly; NaN gives mid-grey.
pub fn viridis(t: f64) -> Rgb {
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
        return [128; 3];
    }
    let position = t.clamp(0.0, 1.0) * (STOPS.len() - 1) as f64;
    let low = (position as usize).min(STOPS.len() - 2);
    let weight = position - low as f64;
    [0, 1, 2].map(|k| (STOPS[low][k] + weight * (STOPS[low + 1][k] - STOPS[low][k])).round() as u8)
}

/// Blue at -1, white at 0, red at 1; NaN gives mid-grey.
pub fn diverging(t: f64) -> Rgb {
    if t.is_nan() {
        return [128; 3];
    }
    let end: [f64; 3] = if t < 0.0 {
        [33.0, 102.0, 172.0]
    } else {
        [178.0, 24.0, 43.0]
    };
    end.map(|channel| (255.0 + (channel - 255.0) * t.abs().min(1.0)).round() as u8)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_meet_their_ends_and_grey_out_nan() {
        assert_eq!(viridis(-1.0), [68, 1, 84]);
        assert_eq!(viridis(2.0), [253, 231, 37]);
        assert_eq!(diverging(0.0), [255; 3]);
        assert_eq!(diverging(-3.0), [33, 102, 172]);
        assert_eq!([viridis(f64::NAN), diverging(f64::NAN)], [[128; 3]; 2]);
    }

    /// CSS: `hsl(200 60% 50%)` is #3399cc, `hsl(320 60% 50%)` is #cc3399.
    #[test]
    fn hues_are_those_of_css() {
        assert_eq!(Colour::hue(0, 3), Colour::new(51, 153, 204));
        assert_eq!(Colour::hue(1, 3), Colour::new(204, 51, 153));
    }
}
