//! A scanned hull in runner axes.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::error::MeshError;
use crate::hull::{Axis, Hull, HullOptions};
use crate::scan::frame::ScanFrame;
use crate::scan::noise::{Noise, noise_of_hull};
use crate::scan::orientation::{Orientation, rows};

/// A scanned hull, rotated into runner axes as far as its shape determines them.
#[derive(Clone, Debug)]
pub struct PlacedScan {
    /// The hull, in metres.
    pub hull: Hull,
    /// Its unit, axes and radii; its options transform the file's coordinates into `hull`.
    pub frame: ScanFrame,
    /// The noise of its vertices.
    pub noise: Noise,
    /// Its rotation; `None` if its underside could not be compared with its mirror images.
    pub orientation: Option<Orientation>,
}

impl PlacedScan {
    /// Places `hull`, which is in the coordinates of its file: scale 1, x forward, z up.
    ///
    /// The search begins at the file's axes. If it does not determine all three angles, it is
    /// repeated from the principal axes of the surface, and the result with more angles is used.
    /// `None` if no side is rounded along and across.
    ///
    /// # Errors
    /// As [`ScanFrame::of`].
    pub fn of(hull: &Hull) -> Result<Option<Self>, MeshError> {
        let as_it_is = Self::from_start(hull, Matrix3::identity())?;
        let known = |placed: &Option<Self>| placed.as_ref().map(Self::known_angles);
        if known(&as_it_is) == Some(3) {
            return Ok(as_it_is);
        }
        let Some(axes) = principal_axes(hull) else {
            return Ok(as_it_is);
        };
        let turned = Self::from_start(hull, axes)?;
        let is_better = known(&turned) > known(&as_it_is);
        Ok(if is_better { turned } else { as_it_is })
    }

    /// The hull placed by a search that begins with this rotation.
    fn from_start(of_file: &Hull, start: Matrix3<f64>) -> Result<Option<Self>, MeshError> {
        let start = Rotation3::from_matrix_unchecked(start);
        let turned = of_file.transformed(rows(&start));
        let Some(mut frame) = ScanFrame::of(&turned)? else {
            return Ok(None);
        };
        if start != Rotation3::identity() {
            let axes = HullOptions {
                scale: 1.0,
                ..frame.options
            };
            let axes = axes.rows(Axis::Z)?;
            let axes = Matrix3::from_fn(|row, column| axes[row][column]);
            frame.options = HullOptions::turning(frame.options.scale, axes * start.matrix());
        }
        let first = frame.options.rotation;
        let unturned = HullOptions {
            rotation: [0.0; 3],
            ..frame.options
        };
        let mut hull = of_file.placed(&frame.options)?;
        let mut noise = noise_of_hull(&hull).unwrap_or_default();
        let orientation = Orientation::of(&of_file.placed(&unturned)?, noise.found, first).ok();
        frame.options.rotation = orientation.map_or(first, |found| found.rotation);
        if frame.options.rotation != first {
            hull = of_file.placed(&frame.options)?;
            noise = noise_of_hull(&hull).unwrap_or_default();
        }
        Ok(Some(Self {
            hull,
            frame,
            noise,
            orientation,
        }))
    }

    fn known_angles(&self) -> usize {
        let angles = |found: &Orientation| [found.yaw, found.pitch, found.roll];
        let angles = self.orientation.as_ref().map(angles);
        angles.into_iter().flatten().flatten().count()
    }
}

/// The rotation into the principal axes of a hull's surface, the longest first; `None` where it has
/// no area.
fn principal_axes(hull: &Hull) -> Option<Matrix3<f64>> {
    let facets = || {
        hull.triangles.iter().map(|corners| {
            let at = corners.map(|corner| Vector3::from(hull.positions[corner as usize]));
            let area = Vector3::from(hull.normal(corners)).norm();
            (area, (at[0] + at[1] + at[2]) / 3.0)
        })
    };
    let area: f64 = facets().map(|(area, _)| area).sum();
    let middle = facets().map(|(area, at)| area * at).sum::<Vector3<f64>>() / area;
    let off = facets().map(|(area, at)| (area, at - middle));
    let spread: Matrix3<f64> = off.map(|(area, off)| area * off * off.transpose()).sum();
    if !(area > 0.0 && spread.iter().all(|value| value.is_finite())) {
        return None;
    }
    let found = spread.symmetric_eigen();
    let mut order = [0, 1, 2];
    order.sort_by(|a, b| found.eigenvalues[*b].total_cmp(&found.eigenvalues[*a]));
    let [long, wide] = [order[0], order[1]].map(|k| found.eigenvectors.column(k).into_owned());
    let axes = [long, wide, long.cross(&wide)];
    Some(Matrix3::from_rows(&axes.map(|axis| axis.transpose())))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::tessellate::tessellate;
    use crate::scan::turned;
    use crate::shapes::swept::BobRunner;

    fn runner() -> Hull {
        let runner = BobRunner {
            length: 0.4,
            ..BobRunner::default()
        };
        tessellate(&runner.swept().expect("a runner"), 2e-3).expect("a hull")
    }

    #[test]
    fn a_spike_does_not_hide_the_runner() {
        let upright = runner();
        let middle = |p: &&[f64; 3]| p[0].abs() + p[1].abs() < 1.5e-3 && p[2] < 1e-3;
        let keel = upright
            .positions
            .iter()
            .filter(middle)
            .min_by(|a, b| a[2].total_cmp(&b[2]));
        let keel = *keel.expect("a vertex");
        for height in [-5.0, -1e-3, 5.0] {
            let mut hull = upright.clone();
            let spike = hull.positions.iter_mut().find(|p| **p == keel);
            spike.expect("a vertex")[2] += height;
            let frame = ScanFrame::of(&hull).expect("triangles").expect("a side");
            assert_eq!(frame.options.up, Some(Axis::Z), "{height}");
            let radii = [frame.rocker_radius / 30.0, frame.section_radius / 5e-3];
            assert!(
                radii.iter().all(|r| (r - 1.0).abs() < 0.1),
                "{height}: {radii:?}"
            );
        }
    }

    #[test]
    fn a_runner_turned_by_large_angles_is_placed() {
        let upright = runner();
        for degrees in [[0.0, 25.0, 0.0], [40.0, 0.0, 0.0], [-20.0, 30.0, 50.0]] {
            let angles = degrees.map(f64::to_radians);
            let mut hull = upright.clone();
            for p in &mut hull.positions {
                *p = turned(*p, angles);
            }
            let placed = PlacedScan::of(&hull).expect("triangles").expect("a side");
            assert_eq!(placed.known_angles(), 3, "{degrees:?}");
            let [low, high] = placed.hull.bounds();
            let [own_low, own_high] = upright.bounds();
            for k in 0..3 {
                let off = (high[k] - low[k]) - (own_high[k] - own_low[k]);
                assert!(off.abs() < 1e-4, "{degrees:?}: {off} m along axis {k}");
            }
        }
    }
}
