//! What swatches and colours mean, in a row of its own.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use crate::plot::file::{Error, PngRoot};

/// How something is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Swatch {
    /// A line.
    Line,
    /// A line of dashes.
    Dashes,
    /// A dot of this radius in pixels.
    Dot(i32),
    /// A filled part of the plane.
    Fill,
}

/// One swatch and its meaning.
#[derive(Clone, Debug)]
pub struct Key {
    /// How it is drawn.
    pub swatch: Swatch,
    /// In which colour.
    pub colour: RGBAColor,
    /// What it is.
    pub name: String,
}

impl Key {
    /// A swatch, its colour and what it is.
    pub fn new(swatch: Swatch, colour: impl Into<RGBAColor>, name: impl Into<String>) -> Key {
        Key {
            swatch,
            colour: colour.into(),
            name: name.into(),
        }
    }
}

/// Width of a swatch, from there to its text, and between two keys [pixels].
const SWATCH: i32 = 26;
const GAP: i32 = 7;
const APART: i32 = 24;
/// Height of a row [pixels].
const ROW: i32 = 25;
const FONT: (&str, i32) = ("sans-serif", 16);

/// Draws keys in rows at the top of an area and returns what is left of it: so no legend covers what it explains.
///
/// # Errors
/// [`Error::Draw`] from the drawing library.
pub fn legend<'a>(area: &PngRoot<'a>, keys: &[Key]) -> Result<PngRoot<'a>, Error> {
    let style = FONT.into_text_style(area);
    let style = style.pos(Pos::new(HPos::Left, VPos::Center));
    let width = |key: &Key| -> Result<i32, Error> {
        Ok(SWATCH + GAP + area.estimate_text_size(&key.name, &style)?.0 as i32)
    };
    let room = area.dim_in_pixel().0 as i32 - 2 * APART;
    let mut rows: Vec<(i32, Vec<(i32, &Key)>)> = Vec::new();
    for key in keys {
        let own = width(key)?;
        match rows.last_mut() {
            Some((end, row)) if *end + APART + own <= room => {
                row.push((*end + APART, key));
                *end += APART + own;
            }
            _ => rows.push((own, vec![(0, key)])),
        }
    }
    let (head, rest) = area.split_vertically(ROW * rows.len() as i32);
    for (number, (end, row)) in rows.iter().enumerate() {
        let left = APART + (room - end).max(0) / 2;
        let middle = ROW * number as i32 + ROW / 2;
        for (from, key) in row {
            draw_swatch(&head, key, left + from, middle)?;
            let at = (left + from + SWATCH + GAP, middle);
            head.draw(&Text::new(key.name.as_str(), at, style.clone()))?;
        }
    }
    Ok(rest)
}

fn draw_swatch(area: &PngRoot, key: &Key, x: i32, y: i32) -> Result<(), Error> {
    let fill = key.colour.filled();
    let bar = |from: i32, to: i32, half: i32| {
        Rectangle::new([(x + from, y - half), (x + to, y + half)], fill)
    };
    match key.swatch {
        Swatch::Line => area.draw(&bar(0, SWATCH, 1))?,
        Swatch::Dashes => {
            area.draw(&bar(0, 7, 1))?;
            area.draw(&bar(10, 16, 1))?;
            area.draw(&bar(19, SWATCH, 1))?;
        }
        Swatch::Dot(radius) => area.draw(&Circle::new((x + SWATCH / 2, y), radius, fill))?,
        Swatch::Fill => area.draw(&bar(0, SWATCH, 7))?,
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::file::png;

    #[test]
    fn keys_take_as_many_rows_as_they_need_and_leave_the_rest() {
        let folder = tempfile::tempdir().unwrap();
        let left = |width: u32, count: usize| {
            let left = std::cell::Cell::new(0);
            png(&folder.path().join("keys.png"), width, 300, &|root| {
                let key = Key::new(Swatch::Line, BLACK, "a name of some length");
                let rest = legend(&root, &vec![key; count])?;
                left.set(rest.dim_in_pixel().1);
                Ok(())
            })
            .unwrap();
            left.get()
        };
        assert_eq!([left(900, 0), left(900, 3), left(300, 3)], [300, 275, 225]);
    }
}
