//! Pressure maps from EXR files: channel `p` [Pa] with its place in metres.

use std::path::Path;

use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{ReadChannels, ReadLayers, read};
use kufe_contact::effects::Map;

use crate::Error;

/// Reads channel `p` and the attributes `origin_x_m, origin_y_m, pixel_x_m, pixel_y_m`.
///
/// # Errors
/// [`Error::File`] where the file is no EXR image, lacks the channel or an attribute, or holds values that are no pressures.
pub fn read_map(path: &Path) -> Result<Map, Error> {
    let told = |reason: String| Error::File {
        file: path.display().to_string(),
        reason,
    };
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_file(path)
        .map_err(|error| told(error.to_string()))?;
    let layer = &image.layer_data;
    let number = |name: &str| -> Result<f64, Error> {
        match layer.attributes.other.get(&Text::from(name)) {
            Some(AttributeValue::F64(value)) => Ok(*value),
            Some(AttributeValue::F32(value)) => Ok(f64::from(*value)),
            _ => Err(told(format!(
                "attribute `{name}` is missing; expected a number of metres"
            ))),
        }
    };
    let channel = layer
        .channel_data
        .list
        .iter()
        .find(|channel| channel.name == *"p")
        .ok_or_else(|| told("channel `p` is missing".to_owned()))?;
    let pressure: Vec<f64> = channel.sample_data.values_as_f32().map(f64::from).collect();
    if let Some(bad) = pressure.iter().position(|p| !p.is_finite()) {
        return Err(told(format!("pixel {bad} of channel `p` is not a number")));
    }
    let map = Map {
        nx: layer.size.x(),
        ny: layer.size.y(),
        x0: number("origin_x_m")?,
        y0: number("origin_y_m")?,
        dx: number("pixel_x_m")?,
        dy: number("pixel_y_m")?,
        pressure,
    };
    if !(map.dx > 0.0 && map.dy > 0.0) {
        return Err(told(format!(
            "pixel {} by {} m; expected positive numbers",
            map.dx, map.dy
        )));
    }
    Ok(map)
}
