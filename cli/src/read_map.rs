//! Pressure maps read back from `pressure.exr`.

use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{ReadChannels, ReadLayers, read};

use crate::failure::Failure;
use crate::pressure_map::PressureMap;

/// Most pixels of a map that is read; `kufe press` writes at most 3072 x 3072.
const MOST_PIXELS: usize = 1 << 24;

/// Reads the channels `p`, `gap` and `uz` with their place in metres.
///
/// # Errors
/// [`Failure::BadInput`] where the file is no EXR image of the size that `kufe press` writes, lacks a channel or an
/// attribute, or holds values that are no pressures.
pub fn read_map(path: &Path) -> Result<PressureMap, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let broken = |error: exr::error::Error| told(error.to_string());
    let meta = MetaData::read_from_file(path, false).map_err(broken)?;
    let size = meta.headers.first().map(|header| header.layer_size);
    let [nx, ny] = size.map_or([0, 0], |size| [size.width(), size.height()]);
    if nx < 2 || ny < 2 || nx.saturating_mul(ny) > MOST_PIXELS {
        return Err(told(format!(
            "{nx} x {ny} pixels: expected 2 x 2 to {MOST_PIXELS} in all"
        )));
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(broken)?;
    let layer = &image.layer_data;
    let number = |name: &str| match layer.attributes.other.get(&Text::from(name)) {
        Some(AttributeValue::F64(value)) if value.is_finite() => Ok(*value),
        _ => Err(told(format!(
            "attribute {name}: expected a finite double, in metres"
        ))),
    };
    let channel = |name: &str| -> Result<Vec<f64>, Failure> {
        let list = &layer.channel_data.list;
        let found = list.iter().find(|channel| channel.name == *name);
        let values: Vec<f64> = found
            .ok_or_else(|| told(format!("channel {name} is missing")))?
            .sample_data
            .values_as_f32()
            .map(f64::from)
            .collect();
        match values.iter().position(|value| value.is_nan()) {
            Some(k) => Err(told(format!(
                "channel {name}, column {}, row {}: NaN: expected a number",
                k % nx,
                k / nx
            ))),
            None => Ok(values),
        }
    };
    let map = PressureMap {
        x0: number("origin_x_m")?,
        y0: number("origin_y_m")?,
        dx: number("pixel_x_m")?,
        dy: number("pixel_y_m")?,
        nx,
        ny,
        pressure: channel("p")?,
        gap: channel("gap")?,
        uz: channel("uz")?,
    };
    if !(map.dx > 0.0 && map.dy > 0.0) {
        return Err(told(format!(
            "pixel_x_m, pixel_y_m = {}, {}: expected positive sizes",
            map.dx, map.dy
        )));
    }
    Ok(map)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pressure_exr;
    use crate::pressure_map::tests::ellipse;

    #[test]
    fn a_map_comes_back_as_it_was_written() -> Result<(), Box<dyn std::error::Error>> {
        let map = PressureMap::new(&ellipse(0.025, 0.14e-3, 138.5e6), 1000.0, 138.5e6);
        let file = tempfile::Builder::new().suffix(".exr").tempfile()?;
        pressure_exr::write(file.as_file(), &map, 1000.0, 0.0)?;
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
