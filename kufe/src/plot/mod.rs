//! Pictures in one style, as PNG files and as SVG for pages.
//!
//! A picture states its data as a [`Figure`]: rows of panels, each with two axes and layers of
//! lines, points, areas, maps and texts. Layout, ticks, legends, fonts and files are the same for
//! all. A PNG is drawn with anti-aliasing and an embedded font. An SVG uses the text colour of its
//! page, and its texts are escaped.
//!
//! | item | purpose |
//! |---|---|
//! | [`Figure`], [`Panel`], [`Axis`], [`Layer`], [`ColourBar`] | a picture as data |
//! | [`PALETTE`], [`viridis`], [`diverging`] | colours that colour-blind readers can distinguish |
//! | [`contour`] | contour lines of values on a grid |
//! | [`axis_ticks`], [`tick_text`], [`short`] | round tick positions and their texts |
//! | [`quantity`], [`measured`], [`Scale`], [`shown_unit`] | quantities with display units and digits |
//! | [`number4`], [`percent`], [`sign`], [`unit_of`] | plain numbers, percentages and units |
//! | [`escape`] | escaping of text for HTML and SVG |
//!
//! ```
//! use kufe::plot::{Axis, Figure, Layer, PALETTE, Panel};
//! let sine = (0..64).map(|i| 0.1 * f64::from(i)).map(|x| (x, x.sin()));
//! let line = Layer::line(2.0, sine, PALETTE[0]);
//! let panel = Panel::new(Axis::new("x [rad]"), Axis::new("sin x"), vec![line]);
//! let figure = Figure::new(320.0, "sine & <line>").row(200.0, [panel]);
//! assert!(figure.svg().contains("sine &amp; &lt;line&gt;"));
//! assert_eq!(&figure.png()[1..4], b"PNG");
//! ```

mod colour;
mod contour;
mod figure;
mod font;
mod layout;
mod number;
mod png;
mod shape;
mod svg;
mod ticks;

pub use colour::{AFTER, BEFORE, Colour, INK, PALETTE, Rgb, diverging, viridis};
pub use contour::contour;
pub use figure::{
    Axis, ColourBar, Figure, Layer, Mark, Panel, Point, Row, Scales, Symbol, Ticks, broken,
};
pub use kufe_lut::unit_of;
pub use number::{Scale, measured, number4, percent, quantity, shown_unit, sign};
pub use shape::Cells;
pub use svg::escape;
pub use ticks::{axis_ticks, extent, short, tick_text};
