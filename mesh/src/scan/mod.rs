//! Properties of a scanned hull: its unit and axes, its rotation, the spacing and the noise of its
//! vertices.

pub(crate) mod frame;
pub(crate) mod noise;
pub(crate) mod orientation;
pub(crate) mod placement;

pub use frame::{ScanFrame, unlike_runner};
pub use noise::{
    Noise, keel_spacing, noise_of_faces, noise_of_hull, strips_of_hull, strips_warning,
};
pub use orientation::{Estimate, Orientation};
pub use placement::PlacedScan;

/// A point turned by roll, pitch and yaw [rad] about fixed axes in this order, for tests.
#[cfg(test)]
pub(crate) fn turned([x, y, z]: [f64; 3], [roll, pitch, yaw]: [f64; 3]) -> [f64; 3] {
    let (y, z) = (
        y * roll.cos() - z * roll.sin(),
        y * roll.sin() + z * roll.cos(),
    );
    let (x, z) = (
        x * pitch.cos() + z * pitch.sin(),
        z * pitch.cos() - x * pitch.sin(),
    );
    [
        x * yaw.cos() - y * yaw.sin(),
        x * yaw.sin() + y * yaw.cos(),
        z,
    ]
}
