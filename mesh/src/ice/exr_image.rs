//! EXR images whose pixels have a place in metres: height maps, pressure maps.

use std::io::Cursor;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{ReadChannels, ReadLayers, read};

use kufe_files::read_regular;

use crate::error::MeshError;

/// Most values that an image may hold, over all of its channels: 64 million, 256 MB as single precision.
const MOST_VALUES: u64 = 1 << 26;
/// Most bytes of an image's file.
const MOST_BYTES: u64 = 1 << 30;

/// An image with the attributes `origin_x_m, origin_y_m, pixel_x_m, pixel_y_m`: column i, row j is centred at
/// (origin_x_m + i pixel_x_m, origin_y_m + j pixel_y_m).
#[derive(Clone, Debug, PartialEq)]
pub struct ExrImage {
    /// Numbers of columns and rows.
    pub size: [usize; 2],
    /// Centre of the first pixel [m].
    pub origin_m: [f64; 2],
    /// Width and height of a pixel [m], positive.
    pub pixel_m: [f64; 2],
    channels: Vec<(String, Vec<f64>)>,
}

impl ExrImage {
    /// Reads a file.
    ///
    /// # Errors
    /// [`MeshError::Io`] where it cannot be read, [`MeshError::File`] with what is wrong in it.
    pub fn load(path: &Path) -> Result<Self, MeshError> {
        let name = path.display().to_string();
        let io = |source| MeshError::Io {
            path: name.clone(),
            source,
        };
        let bytes = read_regular(path, MOST_BYTES).map_err(io)?;
        Self::read(&bytes).map_err(|source| MeshError::File {
            path: name.clone(),
            source: Box::new(source),
        })
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// [`MeshError::Exr`] where they are no EXR image, where a header asks for more values than are read, or where an
    /// attribute is missing or no place.
    pub fn read(bytes: &[u8]) -> Result<Self, MeshError> {
        let told = |problem: String| MeshError::Exr { problem };
        if bytes.len() as u64 > MOST_BYTES {
            return Err(told(format!("more than {MOST_BYTES} bytes")));
        }
        // The reader takes the memory that the headers ask for, so all headers are looked at first.
        let meta = MetaData::read_from_buffered(Cursor::new(bytes), false)
            .map_err(|error| told(error.to_string()))?;
        for header in &meta.headers {
            let (width, height) = (header.layer_size.width(), header.layer_size.height());
            let count = header.channels.list.len();
            let values = [width as u64, height as u64, count as u64]
                .into_iter()
                .try_fold(1u64, u64::checked_mul);
            if values.is_none_or(|values| values > MOST_VALUES) {
                return Err(told(format!(
                    "{width} x {height} pixels in {count} channels; expected at most {MOST_VALUES} values in all"
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
        let number = |name: &str, positive: bool| {
            let value = match layer.attributes.other.get(&Text::from(name)) {
                Some(AttributeValue::F64(value)) => *value,
                Some(AttributeValue::F32(value)) => f64::from(*value),
                _ => {
                    return Err(told(format!(
                        "attribute {name} is missing; expected a number of metres"
                    )));
                }
            };
            if !value.is_finite() || positive && value <= 0.0 {
                let wanted = if positive { "positive" } else { "finite" };
                return Err(told(format!(
                    "attribute {name} = {value}; expected a {wanted} number of metres"
                )));
            }
            Ok(value)
        };
        Ok(Self {
            size: [layer.size.x(), layer.size.y()],
            origin_m: [number("origin_x_m", false)?, number("origin_y_m", false)?],
            pixel_m: [number("pixel_x_m", true)?, number("pixel_y_m", true)?],
            channels: layer
                .channel_data
                .list
                .iter()
                .map(|channel| {
                    let values = channel.sample_data.values_as_f32().map(f64::from);
                    (channel.name.to_string(), values.collect())
                })
                .collect(),
        })
    }

    /// A channel's values, row by row.
    ///
    /// # Errors
    /// [`MeshError::Exr`] where there is no such channel, or a value of it is not a number.
    pub fn channel(&self, name: &str) -> Result<&[f64], MeshError> {
        let told = |problem: String| MeshError::Exr { problem };
        let Some((_, values)) = self.channels.iter().find(|(known, _)| known == name) else {
            let found: Vec<&str> = self
                .channels
                .iter()
                .map(|(name, _)| name.as_str())
                .collect();
            return Err(told(format!(
                "channels {}; expected a channel {name}",
                found.join(", ")
            )));
        };
        match values.iter().position(|value| value.is_nan()) {
            Some(at) => Err(told(format!(
                "channel {name}, column {}, row {}: NaN; expected a number",
                at % self.size[0],
                at / self.size[0]
            ))),
            None => Ok(values),
        }
    }
}
