//! Measured ice surfaces in files, by the file's ending.

use std::path::Path;

use kufe_files::read_regular;

use crate::error::MeshError;
use crate::ice::exr_image::ExrImage;
use crate::ice::height_map::{HeightMap, Interpolation};

/// Most bytes of a height map's file.
const MOST_BYTES: u64 = 1 << 30;

/// Reads the height map `path`: CSV with columns `x_m, y_m, z_m` ([`HeightMap::from_csv`]), or EXR ([`HeightMap::from_exr`]).
///
/// Between the points it is interpolated by cubic convolution.
///
/// # Errors
/// [`MeshError::Io`] where the file cannot be read, [`MeshError::File`] with what is wrong in it.
pub fn load_height_map(path: &Path) -> Result<HeightMap, MeshError> {
    let name = path.display().to_string();
    let in_file = |source: MeshError| MeshError::File {
        path: name.clone(),
        source: Box::new(source),
    };
    let ending = path
        .extension()
        .map(|e| e.to_string_lossy().to_lowercase())
        .unwrap_or_default();
    if !["csv", "exr"].contains(&ending.as_str()) {
        return Err(in_file(MeshError::MapFormat { found: ending }));
    }
    let bytes = read_regular(path, MOST_BYTES).map_err(|source| MeshError::Io {
        path: name.clone(),
        source,
    })?;
    let map = match ending.as_str() {
        "csv" => HeightMap::from_csv(bytes.as_slice(), Interpolation::Bicubic),
        _ => HeightMap::from_exr(&bytes, Interpolation::Bicubic),
    };
    map.map_err(in_file)
}

impl HeightMap {
    /// Reads channel `z` [m] of an EXR image with the attributes `origin_x_m, origin_y_m, pixel_x_m, pixel_y_m`: column i,
    /// row j is centred at (origin_x_m + i pixel_x_m, origin_y_m + j pixel_y_m).
    ///
    /// # Errors
    /// [`MeshError::Exr`] where that is not what the bytes hold, and as [`HeightMap::new`].
    pub fn from_exr(bytes: &[u8], interpolation: Interpolation) -> Result<Self, MeshError> {
        let image = ExrImage::read(bytes)?;
        let heights = image.channel("z")?.to_vec();
        HeightMap::new(
            image.origin_m,
            image.pixel_m,
            image.size,
            heights,
            interpolation,
        )
    }
}

#[cfg(test)]
mod tests {
    use std::io::Cursor;

    use exr::meta::attribute::{AttributeValue, Text};
    use exr::prelude::{
        AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
        WritableImage,
    };

    use super::*;
    use crate::ice::surface::IceSurface;

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
        let map = HeightMap::from_exr(&exr("z", &PLACE), Interpolation::Bilinear).unwrap();
        assert!((map.height(0.0, 0.0) - 2.0).abs() < 1e-12);
        assert!((map.height(0.1, 0.005) - 4.5).abs() < 1e-9);
    }

    #[test]
    fn files_that_are_no_height_maps_are_refused_with_what_was_expected() {
        let refused = |bytes: &[u8]| {
            HeightMap::from_exr(bytes, Interpolation::Bicubic)
                .unwrap_err()
                .to_string()
        };
        let message = refused(&exr("p", &PLACE));
        assert!(
            message.contains("channels p; expected a channel z"),
            "{message}"
        );
        let message = refused(&exr("z", &PLACE[..3]));
        assert!(message.contains("pixel_y_m"), "{message}");
        assert!(refused(b"no image").contains("EXR"));
        // A header that claims more pixels than any map has is refused before they are allocated.
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
