//! Pressure maps from EXR files: channel `p` [Pa] with its place in metres.

use std::io::{Cursor, Read};
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{ReadChannels, ReadLayers, read};
use kufe_contact::effects::Map;

use crate::Error;

/// Most values that a map may hold, over all of its channels: 64 million, 256 MB as single precision.
const MOST_VALUES: u64 = 1 << 26;
/// Most bytes of a map's file.
const MOST_BYTES: u64 = 1 << 30;

/// Reads channel `p` and the attributes `origin_x_m, origin_y_m, pixel_x_m, pixel_y_m`.
///
/// # Errors
/// [`Error::File`] where the file is no EXR image, is too large or says so in its header, lacks the channel or an
/// attribute, or holds values that are no pressures.
pub fn read_map(path: &Path) -> Result<Map, Error> {
    let name = path.display().to_string();
    let told = |reason: String| Error::File {
        file: name.clone(),
        reason,
    };
    let file = std::fs::File::open(path).map_err(|error| told(error.to_string()))?;
    let mut bytes = Vec::new();
    file.take(MOST_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|error| told(error.to_string()))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(told(format!(
            "expected a map of at most {MOST_BYTES} bytes"
        )));
    }
    read_map_bytes(&bytes, &name)
}

/// Reads a map as [`read_map`] does; `file` names it in errors.
///
/// # Errors
/// As [`read_map`].
pub fn read_map_bytes(bytes: &[u8], file: &str) -> Result<Map, Error> {
    let told = |reason: String| Error::File {
        file: file.to_owned(),
        reason,
    };
    // The reader takes the memory that the header asks for, so the header is looked at first.
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
        .map_err(|error| told(error.to_string()))?;
    for header in &meta.headers {
        let values = [
            header.layer_size.width() as u64,
            header.layer_size.height() as u64,
            header.channels.list.len() as u64,
        ]
        .into_iter()
        .try_fold(1u64, u64::checked_mul);
        if values.is_none_or(|values| values > MOST_VALUES) {
            return Err(told(format!(
                "{} x {} pixels in {} channels; expected at most {MOST_VALUES} values in all",
                header.layer_size.width(),
                header.layer_size.height(),
                header.channels.list.len()
            )));
        }
    }
    let image = read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(Cursor::new(bytes))
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
