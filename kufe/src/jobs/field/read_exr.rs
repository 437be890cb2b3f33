//! Pressure maps read back from `pressure.exr`.

use std::path::Path;

use crate::jobs::Failure;
use kufe_contact::PressureMap;
use kufe_mesh::ExrImage;

/// Reads the channels `p`, `gap` and `uz` with their place in metres.
///
/// # Errors
/// [`Failure::BadInput`] where the file is no EXR image with a place, has fewer than 2 x 2 pixels, lacks a channel or an
/// attribute, or holds values that are no numbers.
pub fn read_map(path: &Path) -> Result<PressureMap, Failure> {
    let image = ExrImage::load(path).map_err(|error| Failure::BadInput(error.to_string()))?;
    let refusal = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let [nx, ny] = image.size;
    if nx < 2 || ny < 2 {
        return Err(refusal(format!(
            "{nx} x {ny} pixels: expected at least 2 x 2"
        )));
    }
    let channel = |name: &str| match image.channel(name) {
        Ok(values) => Ok(values.to_vec()),
        Err(error) => Err(refusal(error.to_string())),
    };
    Ok(PressureMap {
        x0: image.origin_m[0],
        y0: image.origin_m[1],
        dx: image.pixel_m[0],
        dy: image.pixel_m[1],
        nx,
        ny,
        pressure: channel("p")?,
        gap: channel("gap")?,
        uz: channel("uz")?,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::hertz_map::hertz_map;
    use crate::jobs::field::write_exr;

    #[test]
    fn a_map_comes_back_as_it_was_written() -> Result<(), Box<dyn std::error::Error>> {
        let map = hertz_map();
        let file = tempfile::Builder::new().suffix(".exr").tempfile()?;
        write_exr::write(&mut file.as_file(), &map, 0.0, &[])?;
        let back = read_map(file.path()).map_err(|failure| failure.to_string())?;
        assert_eq!(
            (back.nx, back.ny, back.x0, back.y0, back.dx, back.dy),
            (map.nx, map.ny, map.x0, map.y0, map.dx, map.dy)
        );
        for (a, b) in [
            (&back.pressure, &map.pressure),
            (&back.gap, &map.gap),
            (&back.uz, &map.uz),
        ] {
            assert!(a.iter().zip(b).all(|(a, b)| *a == f64::from(*b as f32)));
        }
        Ok(())
    }
}
