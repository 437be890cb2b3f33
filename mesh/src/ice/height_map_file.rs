//! Height maps from CSV tables and EXR images.

use std::fmt::Display;
use std::io::Cursor;
use std::path::Path;

use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{AnyChannel, FlatSamples, ReadChannels, ReadLayers, read};

use crate::error::MeshError;
use crate::ice::surface::HeightMap;
use crate::input::{ending, read_columns, read_file};

impl HeightMap {
    /// Reads columns `x_m`, `y_m`, `z_m` of a CSV table whose points, in any order, fill a regular
    /// grid.
    ///
    /// # Errors
    /// [`MeshError::Value`] with the row and column, or if the points do not fill a regular grid.
    pub fn from_csv(text: &[u8]) -> Result<Self, MeshError> {
        let points = read_columns(text, ["x_m", "y_m", "z_m"])?;
        let [xs, ys] = [0, 1].map(|axis| {
            let mut values: Vec<f64> = points.iter().map(|p| p[axis]).collect();
            values.sort_by(f64::total_cmp);
            let span = values.last().unwrap_or(&0.0) - values.first().unwrap_or(&0.0);
            values.dedup_by(|b, a| *b - *a <= 1e-9 * span);
            values
        });
        let shape = [xs.len(), ys.len()];
        let grid_problem = |problem: &str| {
            MeshError::Invalid(format!(
                "height map: {} points at {} different x and {} different y: {problem}",
                points.len(),
                shape[0],
                shape[1]
            ))
        };
        if shape.iter().any(|&n| n < 2) || shape[0].checked_mul(shape[1]) != Some(points.len()) {
            return Err(grid_problem("expected one row a grid point"));
        }
        let spacing = [&xs, &ys].map(|v| (v[v.len() - 1] - v[0]) / (v.len() - 1) as f64);
        let even = |v: &[f64], step: f64| {
            let mut steps = v.windows(2).map(|p| p[1] - p[0]);
            steps.all(|own| (own - step).abs() <= 1e-3 * step)
        };
        if !even(&xs, spacing[0]) || !even(&ys, spacing[1]) {
            return Err(grid_problem("the points are not evenly spaced"));
        }
        let mut heights = vec![f64::NAN; points.len()];
        for [x, y, z] in &points {
            let i = ((x - xs[0]) / spacing[0]).round() as usize;
            let j = ((y - ys[0]) / spacing[1]).round() as usize;
            let place = &mut heights[j.min(shape[1] - 1) * shape[0] + i.min(shape[0] - 1)];
            if !place.is_nan() {
                return Err(grid_problem("a point occurs twice"));
            }
            *place = *z;
        }
        Self::new([xs[0], ys[0]], spacing, shape, heights)
    }

    /// Reads channel `z` [m] of an [`ExrImage`].
    ///
    /// # Errors
    /// As [`ExrImage::read`] and [`HeightMap::new`].
    pub fn from_exr(bytes: &[u8]) -> Result<Self, MeshError> {
        let image = ExrImage::read(bytes)?;
        let heights = image.channel("z")?.to_vec();
        let (origin, pixel) = (image.origin_m, image.pixel_m);
        Self::new(origin, pixel, image.size, heights)
    }
}

/// Largest number of values of an image, over all channels: 64 million, 256 MB in single precision.
const MAX_VALUES: u64 = 1 << 26;
/// Largest size of an image's file [bytes].
const MAX_BYTES: u64 = 1 << 30;

/// An image with the attributes `origin_x_m, origin_y_m, pixel_x_m, pixel_y_m`: column i, row j is
/// centred at (origin_x_m + i pixel_x_m, origin_y_m + j pixel_y_m).
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

fn exr_error(problem: impl Display) -> MeshError {
    MeshError::Invalid(format!("EXR image: {problem}"))
}

impl ExrImage {
    /// Reads a file.
    ///
    /// # Errors
    /// [`MeshError::Io`] if it cannot be read, [`MeshError::File`] if its content is invalid.
    pub fn load(path: &Path) -> Result<Self, MeshError> {
        let bytes = read_file(path, MAX_BYTES)?;
        Self::read(&bytes).map_err(|error| error.in_file(path))
    }

    /// Reads the bytes of a file.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] if the bytes are not an EXR image, if a header announces more than 64
    /// million values, or if an attribute is missing or invalid.
    pub fn read(bytes: &[u8]) -> Result<Self, MeshError> {
        if bytes.len() as u64 > MAX_BYTES {
            return Err(exr_error(format!("more than {MAX_BYTES} bytes")));
        }
        // The reader allocates the announced sizes, so all headers are checked first.
        let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(exr_error)?;
        for header in &meta.headers {
            let (width, height) = (header.layer_size.width(), header.layer_size.height());
            let count = header.channels.list.len();
            let sizes = [width, height, count].map(|size| size as u64);
            let values = sizes.into_iter().try_fold(1, u64::checked_mul);
            if values.is_none_or(|values| values > MAX_VALUES) {
                return Err(exr_error(format!(
                    "{width} x {height} pixels in {count} channels; expected at most {MAX_VALUES} values in all"
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
            .map_err(exr_error)?;
        let layer = &image.layer_data;
        let number = |name: &str, positive: bool| {
            let wanted = if positive { "positive" } else { "finite" };
            let expected = format!("expected a {wanted} number of metres");
            let value = match layer.attributes.other.get(&Text::from(name)) {
                Some(AttributeValue::F64(value)) => *value,
                Some(AttributeValue::F32(value)) => f64::from(*value),
                _ => {
                    return Err(exr_error(format!(
                        "attribute {name} is missing; {expected}"
                    )));
                }
            };
            if !value.is_finite() || positive && value <= 0.0 {
                return Err(exr_error(format!("attribute {name} = {value}; {expected}")));
            }
            Ok(value)
        };
        let channel = |channel: &AnyChannel<FlatSamples>| {
            let values = channel.sample_data.values_as_f32().map(f64::from);
            (channel.name.to_string(), values.collect())
        };
        Ok(Self {
            size: [layer.size.x(), layer.size.y()],
            origin_m: [number("origin_x_m", false)?, number("origin_y_m", false)?],
            pixel_m: [number("pixel_x_m", true)?, number("pixel_y_m", true)?],
            channels: layer.channel_data.list.iter().map(channel).collect(),
        })
    }

    /// A channel's values, row by row.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] if there is no such channel, or a value of it is not finite.
    pub fn channel(&self, name: &str) -> Result<&[f64], MeshError> {
        let Some((_, values)) = self.channels.iter().find(|(known, _)| known == name) else {
            let found: Vec<&str> = self.channels.iter().map(|(known, _)| &**known).collect();
            return Err(exr_error(format!(
                "channels {}; expected a channel {name}",
                found.join(", ")
            )));
        };
        let Some(at) = values.iter().position(|value| value.is_nan()) else {
            return Ok(values);
        };
        let (column, row) = (at % self.size[0], at / self.size[0]);
        Err(exr_error(format!(
            "channel {name}, column {column}, row {row}: NaN; expected a number"
        )))
    }
}

/// Reads the height map `path`: CSV with columns `x_m, y_m, z_m` ([`HeightMap::from_csv`]), or EXR
/// ([`HeightMap::from_exr`]).
///
/// Between the points it is interpolated by cubic convolution.
///
/// # Errors
/// [`MeshError::Io`] if the file cannot be read, [`MeshError::File`] if its content is invalid.
pub fn load_height_map(path: &Path) -> Result<HeightMap, MeshError> {
    let ending = ending(path);
    if !["csv", "exr"].contains(&&*ending) {
        let found = format!("the ending {ending:?}");
        return Err(MeshError::value("height map", found, "csv or exr").in_file(path));
    }
    let bytes = read_file(path, MAX_BYTES)?;
    let map = match ending.as_str() {
        "csv" => HeightMap::from_csv(&bytes[..]),
        _ => HeightMap::from_exr(&bytes),
    };
    map.map_err(|error| error.in_file(path))
}

#[cfg(test)]
mod tests {
    use exr::prelude::{
        AnyChannels, Encoding, Image, Layer, LayerAttributes, SmallVec, WritableImage,
    };

    use super::*;
    use crate::ice::surface::IceSurface;

    #[test]
    fn csv_in_any_order_gives_the_map() {
        let table =
            "y_m,x_m,note,z_m\n0,0,a,1\n0.5,2,b,6\n0,2,c,3\n0.5,0,d,4\n0,1,e,2\n0.5,1,f,5\n";
        let map = HeightMap::from_csv(table.as_bytes()).unwrap();
        assert!(
            (map.height(1.0, 0.0) - 2.0).abs() < 1e-15
                && (map.height(2.0, 0.25) - 4.5).abs() < 1e-15
        );
    }

    #[test]
    fn broken_tables_are_refused_with_row_and_column() {
        let refused = |table: &str| {
            HeightMap::from_csv(table.as_bytes())
                .unwrap_err()
                .to_string()
        };
        assert!(refused("x_m,y_m\n0,0\n").contains("z_m"));
        let message = refused("x_m,y_m,z_m\n0,0,1\n1,0,high\n");
        assert!(
            message.contains("row 3") && message.contains("high"),
            "{message}"
        );
        assert!(refused("x_m,y_m,z_m\n0,0,1\n1,0,nan\n").contains("row 3"));
        assert!(refused("x_m,y_m,z_m\n0,0,1\n1,0,1\n0,1,1\n").contains("one row a grid point"));
        assert!(
            refused("x_m,y_m,z_m\n0,0,1\n1,0,1\n3,0,1\n0,1,1\n1,1,1\n3,1,1\n").contains("evenly")
        );
        assert!(refused("").contains("x_m"));
        assert!(HeightMap::new([0.0; 2], [1.0; 2], [usize::MAX, 2], vec![0.0; 4]).is_err());
    }

    fn exr(channel: &str, attributes: &[&str]) -> Vec<u8> {
        let mut given = LayerAttributes::default();
        for (name, value) in [
            ("origin_x_m", -0.1),
            ("origin_y_m", 0.0),
            ("pixel_x_m", 0.1),
            ("pixel_y_m", 0.01),
        ] {
            if attributes.contains(&name) {
                given
                    .other
                    .insert(Text::from(name), AttributeValue::F64(value));
            }
        }
        let heights = vec![1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
        let channel = AnyChannel::new(channel, FlatSamples::F32(heights));
        let channels = AnyChannels::sort(SmallVec::from_vec(vec![channel]));
        let layer = Layer::new((3, 2), given, Encoding::SMALL_LOSSLESS, channels);
        let mut file = Cursor::new(Vec::new());
        Image::from_layer(layer)
            .write()
            .to_buffered(&mut file)
            .unwrap();
        file.into_inner()
    }

    const PLACE: [&str; 4] = ["origin_x_m", "origin_y_m", "pixel_x_m", "pixel_y_m"];

    #[test]
    fn an_exr_image_gives_its_heights_where_its_attributes_put_them() {
        let map = HeightMap::from_exr(&exr("z", &PLACE)).unwrap();
        assert!((map.height(0.0, 0.0) - 2.0).abs() < 1e-12);
        assert!((map.height(0.1, 0.005) - 4.5).abs() < 1e-9);
    }

    #[test]
    fn files_that_are_no_height_maps_are_refused_with_what_was_expected() {
        let refused = |bytes: &[u8]| HeightMap::from_exr(bytes).unwrap_err().to_string();
        let message = refused(&exr("p", &PLACE));
        assert!(
            message.contains("channels p; expected a channel z"),
            "{message}"
        );
        let message = refused(&exr("z", &PLACE[..3]));
        assert!(message.contains("pixel_y_m"), "{message}");
        assert!(refused(b"no image").contains("EXR"));
        // A header with more pixels than any map has is refused before they are allocated.
        let mut huge = exr("z", &PLACE);
        let window = b"dataWindow\0box2i\0";
        let at = huge
            .windows(window.len())
            .position(|w| w == window)
            .unwrap();
        let corner = at + window.len() + 4 + 8;
        huge[corner..corner + 8].copy_from_slice(&[0xff, 0xff, 0xff, 0x3f, 0xff, 0xff, 0xff, 0x3f]);
        let message = refused(&huge);
        assert!(
            message.contains("at most") || message.contains("invalid"),
            "{message}"
        );
        let named = load_height_map(Path::new("ice.png"))
            .unwrap_err()
            .to_string();
        assert!(
            named.contains("ice.png") && named.contains("png"),
            "{named}"
        );
        let missing = load_height_map(Path::new("nowhere.csv"))
            .unwrap_err()
            .to_string();
        assert!(missing.contains("nowhere.csv"), "{missing}");
    }
}
