//! The groove that an earlier runner left, from its output folder.

use std::path::Path;

use crate::case::GROOVE_FILE;
use kufe_contact::GrooveProfile;
use kufe_mesh::ExrImage;

use crate::jobs::failure::Failure;

/// The section at the back of the depth map `groove.exr` in `folder`.
///
/// # Errors
/// [`Failure::BadInput`] naming the file where it is missing, has no channel `depth`, or holds no depths.
pub(crate) fn groove_left(folder: &Path) -> Result<GrooveProfile, Failure> {
    let path = folder.join(GROOVE_FILE);
    let told = |reason: String| Failure::BadInput(format!("sliding.previous: {reason}"));
    let image = ExrImage::load(&path).map_err(|error| told(error.to_string()))?;
    let depth = image
        .channel("depth")
        .map_err(|error| told(format!("{}: {error}", path.display())))?;
    let [columns, rows] = image.size;
    let y = (0..rows).map(|j| image.origin_m[1] + j as f64 * image.pixel_m[1]);
    let last = (0..rows).map(|j| depth[j * columns]);
    GrooveProfile::new(y.collect(), last.collect())
        .map_err(|error| told(format!("{}: {error}", path.display())))
}
