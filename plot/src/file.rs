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
    static SANS: &[u8] = include_bytes!("../assets/DejaVuSans.ttf");
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
    write_whole(path, ".png", &|temporary| {
        let root = BitMapBackend::new(temporary, (width, height)).into_drawing_area();
        root.fill(&WHITE)?;
        draw(root.clone())?;
        root.present()?;
        Ok(())
    })
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
    write_whole(path, ".svg", &|temporary| {
        std::fs::write(temporary, &text).map_err(|source| write_error(path, source))
    })
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

fn write_whole(
    path: &Path,
    suffix: &str,
    write: &dyn Fn(&Path) -> Result<(), Error>,
) -> Result<(), Error> {
    let folder = match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    };
    let temporary = tempfile::Builder::new()
        .prefix(".kufe-")
        .suffix(suffix)
        .tempfile_in(folder)
        .map_err(|source| write_error(path, source))?;
    write(temporary.path())?;
    temporary
        .persist(path)
        .map_err(|error| write_error(path, error.error))?;
    Ok(())
}
