//! The embedded font: widths of texts, and their pixels.

use std::sync::LazyLock;

use ab_glyph::{Font, FontRef, PxScaleFont, ScaleFont, point};

static FONT: LazyLock<FontRef<'static>> = LazyLock::new(|| {
    let file = include_bytes!("../../assets/DejaVuSans.ttf");
    FontRef::try_from_slice(file).expect("the embedded font is a font")
});

/// The font at a size: the height of its em square [pixels].
fn scaled(size: f64) -> PxScaleFont<&'static FontRef<'static>> {
    let em = FONT.units_per_em().unwrap_or(2048.0);
    FONT.as_scaled(size as f32 * FONT.height_unscaled() / em)
}

/// Width of a text of this size [pixels].
pub fn width(text: &str, size: f64) -> f64 {
    let font = scaled(size);
    let advance = |letter| f64::from(font.h_advance(font.glyph_id(letter)));
    text.chars().map(advance).sum()
}

/// Calls `pixel` for each pixel of a text with its column and row relative to the start of the
/// baseline, and the fraction of the pixel that the text covers.
pub fn rasterise(text: &str, size: f64, mut pixel: impl FnMut(i64, i64, f64)) {
    let font = scaled(size);
    let mut x = 0.0;
    for letter in text.chars() {
        let mut glyph = font.scaled_glyph(letter);
        glyph.position = point(x, 0.0);
        x += font.h_advance(glyph.id);
        if let Some(outline) = font.outline_glyph(glyph) {
            let corner = outline.px_bounds().min;
            outline.draw(|column, row, share| {
                let at = [
                    corner.x as i64 + i64::from(column),
                    corner.y as i64 + i64::from(row),
                ];
                pixel(at[0], at[1], f64::from(share));
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// DejaVu Sans: figures are 1303 of 2048 units wide, and 1493 high without overshoot.
    #[test]
    fn figures_have_the_size_of_their_font() {
        assert!((width("00", 2048.0) - 2606.0).abs() < 1.0);
        let mut top = 0;
        rasterise("1", 204.8, |_, row, _| top = top.min(row));
        assert!((-151..=-148).contains(&top), "{top}");
    }
}
