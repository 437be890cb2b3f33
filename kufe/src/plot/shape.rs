//! Shapes that pictures are composed of.

use crate::plot::colour::{Colour, Rgb};

/// A place on a picture, right of and below its upper left corner [pixels].
pub type Place = [f64; 2];

/// A shape with its place on the picture.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// A filled polygon.
    Polygon {
        /// Its corners.
        corners: Vec<Place>,
        /// Its colour.
        colour: Colour,
    },
    /// A line, broken at points that are no numbers.
    Line {
        /// Its points.
        points: Vec<Place>,
        /// Its colour.
        colour: Colour,
        /// Its width.
        width: f64,
        /// Whether it is dashed.
        dashed: bool,
    },
    /// A disc, or a ring of width 2.
    Circle {
        /// Its centre.
        centre: Place,
        /// Its radius.
        radius: f64,
        /// Its colour.
        colour: Colour,
        /// Whether it is a ring.
        ring: bool,
    },
    /// A text of one line.
    Text {
        /// Where its middle height is.
        at: Place,
        /// The text.
        text: String,
        /// Height of the em square.
        size: f64,
        /// The share of it that is before `at`: 0, 0.5 or 1.
        anchor: f64,
        /// Whether it reads upwards.
        turned: bool,
        /// Whether it is bold on a page; the embedded font has one weight.
        bold: bool,
        /// Its colour.
        colour: Colour,
    },
    /// Pixels, row by row from the upper left, stretched over a rectangle.
    Image {
        /// Upper left and lower right corner.
        corners: [Place; 2],
        /// Columns and rows.
        size: [usize; 2],
        /// The colours; nothing is transparent.
        pixels: Vec<Option<Rgb>>,
    },
    /// Shapes with a text that a page shows when the pointer is over them.
    Group {
        /// The text.
        hint: String,
        /// The shapes.
        shapes: Vec<Shape>,
    },
}

/// From the middle height of a text, which is that of its figures, to its baseline, as a share of
/// the em square.
pub const BASELINE: f64 = 0.36;

/// Lengths of a dash and of the gap behind it.
pub const DASH: [f64; 2] = [7.0, 5.0];
