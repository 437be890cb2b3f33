//! Pictures in one style.
//!
//! The other crates draw with [`plotters`] directly; this crate gives them what must be the
//! same everywhere: an embedded font (so that pictures need no system library), a colour map
//! that is even to the eye, a palette for lines, and files that are whole or absent.
//!
//! | item | purpose |
//! |---|---|
//! | [`png`] / [`svg`] | draws a picture and writes its file, whole or not at all |
//! | [`svg_string`] | the same picture as text, for an HTML page |
//! | [`viridis`] | colour map on `0..=1` |
//! | [`PALETTE`] | eight line colours that colour-blind readers can tell apart |
//! | [`curve`] | a line in a PNG, to a fraction of a pixel |
//! | [`legend`] | what swatches mean, above a panel |
//! | [`colour_bar`] | what a map's colours mean, beside it |
//! | [`axis_ticks`], [`tick_text`] | round tick positions and their text |
//! | [`number4`], [`quantity`], [`usual`], [`unit_of`] | numbers and units as people read them |
//!
//! ```
//! use plotters::prelude::*;
//! let text = kufe::plot::svg_string(320, 200, &|root| {
//!     let mut chart = ChartBuilder::on(&root)
//!         .caption("sine", ("sans-serif", 16))
//!         .margin(8)
//!         .set_all_label_area_size(40)
//!         .build_cartesian_2d(0.0..6.3, -1.0..1.0)?;
//!     chart.configure_mesh().x_desc("x [rad]").y_desc("sin x").draw()?;
//!     chart.draw_series(LineSeries::new(
//!         (0..64).map(|i| (i as f64 * 0.1, (i as f64 * 0.1).sin())),
//!         &kufe::plot::PALETTE[0],
//!     ))?;
//!     Ok(())
//! })?;
//! assert!(text.contains("<svg"));
//! # Ok::<(), kufe::plot::Error>(())
//! ```

mod bar;
mod colour;
mod curve;
mod file;
mod legend;
mod number;
mod ticks;

pub use bar::colour_bar;
pub use colour::{PALETTE, viridis};
pub use curve::{PngChart, curve};
pub use file::{Error, PngRoot, SvgRoot, png, svg, svg_string};
pub use kufe_lut::unit_of;
pub use legend::{Key, Swatch, legend};
pub use number::{number4, quantity, usual};
pub use ticks::{axis_ticks, tick_text};
