//! Shapes that pictures are composed of.

use crate::plot::colour::{Colour, Rgb};

/// A position on a picture, to the right of and below its upper left corner [pixels].
pub type Place = [f64; 2];

/// A shape with its place on the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A filled polygon.
    Polygon(Vec<Place>, Colour),
    /// A line of a width, broken at NaN points.
    Line(Vec<Place>, f64, Colour),
    /// A disc of a radius.
    Disc(Place, f64, Colour),
    /// A ring of a radius, two pixels wide.
    Ring(Place, f64, Colour),
    /// A text of one line, with its middle height at a place.
    Text(Place, String, Style),
    /// Cells stretched over a rectangle, between its upper left and its lower right corner.
    Image([Place; 2], Cells),
    /// Shapes with a tooltip on a page.
    Group(String, Vec<Shape>),
}

/// Style of a text.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Style {
    /// Height of the em square.
    pub size: f64,
    /// Fraction of the text's width before its position: 0, 0.5 or 1.
    pub anchor: f64,
    /// Whether the text is rotated to read upwards.
    pub turned: bool,
    /// Whether it is bold on a page; the embedded font has one weight.
    pub bold: bool,
    /// Its colour.
    pub colour: Colour,
}

impl Style {
    /// An upright style of a size and a colour.
    pub fn new(size: f64, anchor: f64, colour: Colour) -> Style {
        Style {
            size,
            anchor,
            turned: false,
            bold: false,
            colour,
        }
    }
}

/// Coloured cells, row by row from the upper left; a cell without a colour is transparent.
#[derive(Clone, Debug, PartialEq)]
pub struct Cells {
    /// Columns and rows.
    pub size: [usize; 2],
    /// The colours.
    pub colours: Vec<Option<Rgb>>,
}

impl Cells {
    /// Cells whose colours follow from their column and their row, counted from the lower left.
    pub fn new(size: [usize; 2], colour: impl Fn(usize, usize) -> Option<Rgb>) -> Self {
        let rows = (0..size[1]).rev();
        let places = rows.flat_map(|row| (0..size[0]).map(move |column| (column, row)));
        let colours = places.map(|(column, row)| colour(column, row)).collect();
        Cells { size, colours }
    }
}

/// Distance from the middle of the digits' height to the baseline, relative to the em square.
pub const BASELINE: f64 = 0.36;
