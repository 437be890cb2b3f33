//! Picture files that are whole or absent.

use std::path::Path;
use std::sync::Once;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::{FontStyle, register_font};

/// What can go wrong when a picture is drawn or written.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The drawing itself failed (an empty axis range, text that does not fit).
    #[error("picture could not be drawn: {reason}")]
    Draw {
        /// The drawing library's own words.
        reason: String,
    },
    /// The file could not be written.
    #[error("{path}: picture could not be written: {source}")]
    Write {
        /// Where the picture should have gone.
        path: String,
        /// The system's answer.
        source: std::io::Error,
    },
}

impl<E: std::error::Error + Send + Sync> From<DrawingAreaErrorKind<E>> for Error {
    fn from(error: DrawingAreaErrorKind<E>) -> Self {
        Error::Draw {
            reason: error.to_string(),
        }
    }
}

/// The drawing area that [`png`] hands out.
pub type PngRoot<'a> = DrawingArea<BitMapBackend<'a>, Shift>;
/// The drawing area that [`svg`] and [`svg_string`] hand out.
pub type SvgRoot<'a> = DrawingArea<SVGBackend<'a>, Shift>;

fn embed_font() {
    static FONT: Once = Once::new();
    static SANS: &[u8] = include_bytes!("../../assets/DejaVuSans.ttf");
    FONT.call_once(|| {
        for style in [
            FontStyle::Normal,
            FontStyle::Bold,
            FontStyle::Italic,
            FontStyle::Oblique,
        ] {
            // The font is part of the program: that it parses is tested, not handled.
            assert!(
                register_font("sans-serif", style, SANS).is_ok(),
                "embedded font is broken"
            );
        }
    });
}

/// Draws a PNG of `width` x `height` pixels on white and moves it to `path` once it is whole.
///
/// # Errors
/// [`Error::Draw`] from the closure, [`Error::Write`] where the file cannot be made.
pub fn png(
    path: &Path,
    width: u32,
    height: u32,
    draw: &dyn Fn(PngRoot) -> Result<(), Error>,
) -> Result<(), Error> {
    embed_font();
    let mut pixels = vec![0; 3 * width as usize * height as usize];
    {
        let backend = BitMapBackend::with_buffer(&mut pixels, (width, height));
        let root = backend.into_drawing_area();
        root.fill(&WHITE)?;
        draw(root.clone())?;
        root.present()?;
    }
    let written = kufe_files::write_whole(path, |writer| {
        let mut encoder = ::png::Encoder::new(writer, width, height);
        encoder.set_color(::png::ColorType::Rgb);
        encoder.set_depth(::png::BitDepth::Eight);
        encoder.set_adaptive_filter(::png::AdaptiveFilterType::Adaptive);
        encoder.set_compression(::png::Compression::Fast);
        encoder.add_text_chunk(
            "Software".into(),
            concat!("kufe ", env!("CARGO_PKG_VERSION")).into(),
        )?;
        let mut image = encoder.write_header()?;
        image.write_image_data(&pixels)?;
        Ok(image.finish()?)
    });
    written.map_err(|source| write_error(path, source))
}

/// Draws an SVG of `width` x `height` units on white and moves it to `path` once it is whole.
///
/// # Errors
/// [`Error::Draw`] from the closure, [`Error::Write`] where the file cannot be made.
pub fn svg(
    path: &Path,
    width: u32,
    height: u32,
    draw: &dyn Fn(SvgRoot) -> Result<(), Error>,
) -> Result<(), Error> {
    let text = svg_string(width, height, draw)?;
    kufe_files::write_whole(path, |writer| writer.write_all(text.as_bytes()))
        .map_err(|source| write_error(path, source))
}

/// Draws an SVG and returns its text.
///
/// # Errors
/// [`Error::Draw`] from the closure.
pub fn svg_string(
    width: u32,
    height: u32,
    draw: &dyn Fn(SvgRoot) -> Result<(), Error>,
) -> Result<String, Error> {
    embed_font();
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (width, height)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(root.clone())?;
        root.present()?;
    }
    Ok(text)
}

fn write_error(path: &Path, source: std::io::Error) -> Error {
    Error::Write {
        path: path.display().to_string(),
        source,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_holds_what_was_drawn_and_may_be_read_as_any_other_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("dot.png");
        png(&path, 7, 5, &|root| {
            root.draw(&Pixel::new((2, 3), RGBColor(10, 20, 30)))?;
            Ok(())
        })
        .unwrap();
        let file = std::fs::File::open(&path).unwrap();
        let mut reader = ::png::Decoder::new(file).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height, pixels.len()), (7, 5, 105));
        for (place, pixel) in pixels.chunks(3).enumerate() {
            let drawn: [u8; 3] = if place == 3 * 7 + 2 {
                [10, 20, 30]
            } else {
                [255; 3]
            };
            assert_eq!(pixel, drawn, "{place}");
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            std::fs::write(folder.path().join("other"), "").unwrap();
            let mode = |path: &Path| std::fs::metadata(path).unwrap().permissions().mode();
            assert_eq!(mode(&path), mode(&folder.path().join("other")));
        }
    }

    #[test]
    fn a_picture_that_cannot_be_drawn_leaves_no_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("none.svg");
        let drawn = svg(&path, 7, 5, &|_| {
            Err(Error::Draw {
                reason: "no room".into(),
            })
        });
        assert!(drawn.is_err() && !path.exists());
    }
}
