//! Maps as EXR images of 32-bit floats with their position in metres: `pressure.exr`, `groove.exr`.

use std::io::{Cursor, Write};
use std::path::Path;

use exr::meta::attribute::{AttributeValue, Text};
use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, SmallVec,
    WritableImage,
};
use kufe_contact::PressureMap;
use kufe_mesh::ExrImage;

use crate::jobs::failure::{Failure, Located};

const COMMENTS: &str = "p: contact pressure on the last mesh [Pa], whose peak is p_max_mesh_pa; p_max_pa: the peak in the limit of fine meshes; gap [m]; uz: vertical displacement of the ice [m]. Column i, \
    row j of the pixels is centred at x = origin_x_m + i pixel_x_m (along the runner), y = origin_y_m + j pixel_y_m (across).";

/// Writes channels `p` [Pa], `gap` [m] and `uz` [m] of a contact, as [`write_channels`].
///
/// `figures` are further numbers of the contact, by name.
///
/// # Errors
/// The EXR writer's, which are those of `writer`.
pub fn write_map(
    writer: &mut dyn Write,
    map: &PressureMap,
    track_curvature: f64,
    figures: &[(&str, f64)],
) -> exr::error::UnitResult {
    let radius = match track_curvature {
        0.0 => f64::INFINITY,
        curvature => 1.0 / curvature,
    };
    let numbers = [("radius_m", radius), ("curvature_1pm", track_curvature)];
    let numbers = [&numbers[..], figures].concat();
    let channels = [("p", &map.pressure[..]), ("gap", &map.gap), ("uz", &map.uz)];
    write_channels(writer, map, COMMENTS, &numbers, &channels)
}

/// Writes channels on the pixels of `map` as ZIP-compressed scanlines.
///
/// Row `j`, column `i` is centred at (`origin_x_m + i pixel_x_m`, `origin_y_m + j pixel_y_m`).
/// These numbers and `numbers` are attributes in double precision. The pixel aspect ratio stays 1:
/// with the true one, viewers would show a narrow contact as a line.
///
/// # Errors
/// As [`write_map`].
pub fn write_channels(
    writer: &mut dyn Write,
    map: &PressureMap,
    comments: &str,
    numbers: &[(&str, f64)],
    channels: &[(&str, &[f64])],
) -> exr::error::UnitResult {
    let mut attributes = LayerAttributes {
        software_name: Some(Text::from(concat!("kufe ", env!("CARGO_PKG_VERSION")))),
        comments: Some(Text::from(comments)),
        ..LayerAttributes::default()
    };
    let place = [
        ("origin_x_m", map.x0),
        ("origin_y_m", map.y0),
        ("pixel_x_m", map.dx),
        ("pixel_y_m", map.dy),
    ];
    let numbers = place.iter().chain(numbers);
    let numbers = numbers.map(|(name, value)| (Text::from(*name), AttributeValue::F64(*value)));
    attributes.other.extend(numbers);
    let channel = |(name, values): &(&str, &[f64])| {
        let samples = values.iter().map(|&value| value as f32).collect();
        AnyChannel::new(*name, FlatSamples::F32(samples))
    };
    let channels = AnyChannels::sort(channels.iter().map(channel).collect::<SmallVec<_>>());
    let (size, encoding) = ((map.nx, map.ny), Encoding::SMALL_LOSSLESS);
    let image = Image::from_layer(Layer::new(size, attributes, encoding, channels));
    let mut file = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut file)?;
    let mut bytes = file.into_inner();
    sort_attributes(&mut bytes);
    Ok(writer.write_all(&bytes)?)
}

/// Sorts the header's attributes by name: the EXR library keeps them in random order, and equal
/// maps shall give equal bytes.
///
/// After magic number and version (8 bytes) each attribute is a name and a type, both closed by a
/// zero, the value's size as 4 bytes and the value; a zero ends the header. Sorting keeps the
/// header's length, so all offsets remain valid.
fn sort_attributes(bytes: &mut [u8]) {
    const START: usize = 8;
    let zero = |from: usize| bytes[from..].iter().position(|&b| b == 0).map(|k| from + k);
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut at = START;
    while bytes[at] != 0 {
        let end = zero(at).and_then(|name| zero(name + 1)).and_then(|kind| {
            let size = bytes.get(kind + 1..kind + 5)?.try_into().ok()?;
            Some(kind + 5 + u32::from_le_bytes(size) as usize)
        });
        let Some(end) = end.filter(|&end| end < bytes.len()) else {
            unreachable!("the EXR library wrote a broken header");
        };
        attributes.push(bytes[at..end].to_vec());
        at = end;
    }
    attributes.sort();
    bytes[START..at].copy_from_slice(&attributes.concat());
}

/// Reads the channels `p`, `gap` and `uz` with their place in metres.
///
/// # Errors
/// [`Failure::BadInput`] if the file is no EXR image with a place, has fewer than 2 x 2 pixels,
/// has no such channel or attribute, or has values that are not finite numbers.
pub fn read_map(path: &Path) -> Result<PressureMap, Failure> {
    let image = ExrImage::load(path)?;
    let [nx, ny] = image.size;
    if nx < 2 || ny < 2 {
        let text = format_args!("{nx} x {ny} pixels: expected at least 2 x 2");
        return Err(Failure::in_file(path, text));
    }
    let channel = |name: &str| {
        image
            .channel(name)
            .map(|values| values.to_vec())
            .in_file(path)
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
    use crate::jobs::field::tests::hertz_map;
    use exr::prelude::read_first_flat_layer_from_file;

    #[test]
    fn an_exr_gives_back_its_channels_and_its_place() -> Result<(), Box<dyn std::error::Error>> {
        let map = hertz_map();
        let file = tempfile::Builder::new().suffix(".exr").tempfile()?;
        write_map(&mut file.as_file(), &map, 0.0, &[("fz_n", 1000.0)])?;
        let image = read_first_flat_layer_from_file(file.path())?;
        let names: Vec<String> = image
            .layer_data
            .channel_data
            .list
            .iter()
            .map(|channel| channel.name.to_string())
            .collect();
        assert_eq!(names, ["gap", "p", "uz"]);
        let pressure: Vec<f32> = image.layer_data.channel_data.list[1]
            .sample_data
            .values_as_f32()
            .collect();
        assert_eq!(pressure.len(), map.nx * map.ny);
        assert!(
            pressure
                .iter()
                .zip(&map.pressure)
                .all(|(a, b)| *a == *b as f32)
        );
        let other = &image.layer_data.attributes.other;
        assert_eq!(
            other.get(&Text::from("pixel_x_m")),
            Some(&AttributeValue::F64(map.dx))
        );
        assert_eq!(
            other.get(&Text::from("radius_m")),
            Some(&AttributeValue::F64(f64::INFINITY))
        );
        Ok(())
    }

    #[test]
    fn a_map_comes_back_as_it_was_written() -> Result<(), Box<dyn std::error::Error>> {
        let map = hertz_map();
        let file = tempfile::Builder::new().suffix(".exr").tempfile()?;
        write_map(&mut file.as_file(), &map, 0.0, &[])?;
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
