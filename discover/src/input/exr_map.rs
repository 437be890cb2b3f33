//! Pressure maps from EXR files: channel `p` [Pa] with its place in metres.

use std::path::Path;

use kufe::case::effects::Map;
use kufe_mesh::{ExrImage, MeshError};

use crate::error::{Error, Result};

/// Reads channel `p` of a map.
///
/// # Errors
/// [`Error::File`] if the file is not an EXR image with a place in metres, is too large, does not
/// have the channel, or contains values that are not pressures.
pub fn read_map(path: &Path) -> Result<Map> {
    let image = ExrImage::load(path).map_err(|error| match error {
        MeshError::Io { source, .. } => Error::file(path, source),
        MeshError::File { source, .. } => Error::file(path, source),
        other => Error::file(path, other),
    })?;
    map(&image, path)
}

/// Reads a map as [`read_map`] does; `file` names it in errors.
///
/// # Errors
/// As [`read_map`].
pub fn read_map_bytes(bytes: &[u8], file: &str) -> Result<Map> {
    let file = Path::new(file);
    let image = ExrImage::read(bytes).map_err(|error| Error::file(file, error))?;
    map(&image, file)
}

fn map(image: &ExrImage, file: &Path) -> Result<Map> {
    let pressure = image
        .channel("p")
        .map_err(|error| Error::file(file, error))?;
    if let Some(bad) = pressure.iter().position(|p| !p.is_finite()) {
        let what = format!("pixel {bad} of channel p is infinite; expected a pressure in Pa");
        return Err(Error::file(file, what));
    }
    Ok(Map {
        nx: image.size[0],
        ny: image.size[1],
        x0: image.origin_m[0],
        y0: image.origin_m[1],
        dx: image.pixel_m[0],
        dy: image.pixel_m[1],
        pressure: pressure.to_vec(),
    })
}
