//! The bar that says what colours mean.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::plot::file::{Error, PngRoot};
use crate::plot::ticks::{axis_ticks, tick_text};

/// Width of the bar, of a tick, and from there to its text [pixels].
const WIDE: i32 = 36;
const TICK: i32 = 7;
const GAP: i32 = 5;

/// Draws a bar as high as the area, its ticks right of it and its title right of these.
///
/// # Errors
/// [`Error::Draw`] from the drawing library.
pub fn colour_bar(
    area: &PngRoot,
    [low, high]: [f64; 2],
    colour: impl Fn(f64) -> RGBColor,
    title: &str,
) -> Result<(), Error> {
    let last = (area.dim_in_pixel().1 as i32 - 1).max(1);
    for row in 0..=last {
        let value = high - (high - low) * f64::from(row) / f64::from(last);
        let ends = [(0, row), (WIDE, row + 1)];
        area.draw(&Rectangle::new(ends, colour(value).filled()))?;
    }
    let style = ("sans-serif", 17).into_text_style(area);
    let style = style.pos(Pos::new(HPos::Left, VPos::Center));
    let mut widest = 0;
    for tick in axis_ticks(low, high, 8) {
        let row = (f64::from(last) * (high - tick) / (high - low)).round() as i32;
        let text = tick_text(tick, high - low);
        widest = widest.max(area.estimate_text_size(&text, &style)?.0 as i32);
        let line = [(WIDE, row), (WIDE + TICK, row)];
        area.draw(&PathElement::new(line, BLACK))?;
        area.draw(&Text::new(text, (WIDE + TICK + GAP, row), style.clone()))?;
    }
    let style = ("sans-serif", 18).into_text_style(area);
    let style = style
        .transform(FontTransform::Rotate90)
        .pos(Pos::new(HPos::Center, VPos::Bottom));
    let at = (WIDE + TICK + 2 * GAP + widest, last / 2);
    area.draw(&Text::new(title, at, style))?;
    Ok(())
}
