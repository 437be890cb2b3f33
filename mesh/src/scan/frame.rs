//! Unit and axes of a scanned hull, estimated from its shape.

use std::ops::RangeInclusive;

use crate::error::MeshError;
use crate::hull::{Axis, Hull, HullOptions};
use crate::parameter::range;
use crate::scan::noise::{Fitted, fit, lowest_of_stations, median};
use crate::scan::orientation::{Estimate, keel_yaw};

/// Lengths that a runner may have [m].
const LENGTHS: RangeInclusive<f64> = 0.2..=3.0;
/// Lengths that a runner, or a scanned piece of one, may have [m] ...
const LENGTHS_OF_PIECES: RangeInclusive<f64> = 0.05..=3.0;
/// ... where its section has such a radius [m].
const SECTIONS: RangeInclusive<f64> = 0.003..=0.02;
/// Metres in the units that files are written in: metres, millimetres, centimetres, inches,
/// micrometres.
const UNITS: [f64; 5] = [1.0, 1e-3, 1e-2, 0.0254, 1e-6];
/// One in this number of vertices may lie beyond each end of a hull's extent, such as spikes of a
/// scanner.
const OUTSIDE: usize = 1000;
/// Smallest ratio of a spike's distance from the parabola of the keel to the median distance.
const SPIKE: f64 = 10.0;
/// Fraction of the length, about the middle, over which the rocker is measured.
const MIDDLE: f64 = 0.8;
/// Fractions of the length on either side of the lowest vertex over which its section is taken; the
/// first with enough vertices is used.
const NEAR: [f64; 3] = [0.02, 0.05, 0.12];
/// Ratio of the height of the examined section to half its width.
const SHALLOW: f64 = 0.2;
/// Powers of x and y of the examined section. A circle is a parabola but for y^4 / (8 r^3).
const SECTION: [[i32; 2]; 6] = [[0, 0], [0, 1], [0, 2], [0, 4], [1, 0], [2, 0]];
/// Smallest ratio of a section's curvature to its standard error that is significant.
const SIGNIFICANT: f64 = 10.0;
/// Smallest ratio of a rocker's curvature to its standard error that is significant: ragged rims of
/// 48 scans had up to 2.2, their keels 14 and more.
const SIGNIFICANT_ROCKER: f64 = 5.0;
/// Largest radii of a rocker and of a section of an underside [m].
const MAX_RADII: [f64; 2] = [500.0, 0.2];

/// The most likely unit and axes of a hull in its file.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ScanFrame {
    /// Unit and axes for reading the file. The shape does not show which end is in front.
    pub options: HullOptions,
    /// Radius of the rocker [m].
    pub rocker_radius: f64,
    /// Radius of the section where it is lowest [m].
    pub section_radius: f64,
}

impl ScanFrame {
    /// Estimates unit and axes from the side that is rounded along and across, the underside.
    ///
    /// `hull` is in the coordinates of its file: scale 1, x forward, z up. The longest axis is
    /// forward. The underside is the one of the four sides along it with the largest product of the
    /// curvatures of its lowest line (rocker) and of its section there (edge), both by least
    /// squares. Sides with a significant rocker come first, as a ragged rim of an open scan is
    /// curved by chance. The unit is the first in which length and section are those of a runner,
    /// otherwise the first in which the length is. `None` if no side is rounded both ways.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] for a hull without vertices.
    pub fn of(hull: &Hull) -> Result<Option<Self>, MeshError> {
        if hull.triangles.is_empty() {
            return Err(MeshError::no_triangles());
        }
        let extent = [0, 1, 2].map(|axis| {
            let mut places: Vec<f64> = hull.positions.iter().map(|p| p[axis]).collect();
            places.sort_unstable_by(f64::total_cmp);
            let outside = places.len() / OUTSIDE;
            places[places.len() - 1 - outside] - places[outside]
        });
        let longest = (0..3).max_by(|a, b| extent[*a].total_cmp(&extent[*b]));
        let forward = longest.unwrap_or(0);
        let length = extent[forward];
        let units = |lengths: RangeInclusive<f64>| {
            let credible = move |unit: &f64| lengths.contains(&(length * unit));
            UNITS.into_iter().filter(credible)
        };
        let sides =
            units(LENGTHS_OF_PIECES).filter_map(|unit| Self::lowest_side(hull, forward, unit));
        let mut sides = sides.filter(|frame| SECTIONS.contains(&frame.section_radius));
        let by_length = || {
            let unit = units(LENGTHS).next().unwrap_or(1.0);
            Self::lowest_side(hull, forward, unit)
        };
        Ok(sides.next().or_else(by_length))
    }

    /// The side along the axis `forward` that is rounded like an underside, in a unit of `scale`
    /// [m].
    fn lowest_side(hull: &Hull, forward: usize, scale: f64) -> Option<Self> {
        let sides = (0..3)
            .filter(|axis| *axis != forward)
            .flat_map(|index| [false, true].map(|negative| Axis { index, negative }));
        let rounded = sides.filter_map(|up| {
            let ([rocker_radius, section_radius], significant) = radii(hull, forward, up, scale)?;
            let options = HullOptions {
                scale,
                up: Some(up),
                forward: Axis::positive(forward),
                ..HullOptions::default()
            };
            let frame = Self {
                options,
                rocker_radius,
                section_radius,
            };
            Some((significant, frame))
        });
        let roundness = |s: &Self| 1.0 / (s.rocker_radius * s.section_radius);
        let best = rounded.max_by(|(a_significant, a), (b_significant, b)| {
            let by_roundness = roundness(a).total_cmp(&roundness(b));
            a_significant.cmp(b_significant).then(by_roundness)
        });
        best.map(|(_, frame)| frame)
    }
}

/// Smallest ratio of the radius of a runner's rocker (metres) to that of its section (millimetres).
const MIN_RADIUS_RATIO: f64 = 10.0;
/// Largest ratio of the width of a runner to its length.
const MAX_WIDTH_RATIO: f64 = 0.5;

/// The reason why a hull, x forward and z up, is unlike a runner, given its estimated `frame`;
/// `None` if it is like one.
pub fn unlike_runner(hull: &Hull, frame: Option<&ScanFrame>) -> Option<String> {
    let unlike = |reason: String| Some(format!("this seems not to be a runner: {reason}"));
    let Some(frame) = frame else {
        return unlike(
            "no side of it is rounded along and across, as the underside of a runner is (rocker and \
             section)"
                .into(),
        );
    };
    let [along, across] = [frame.rocker_radius, frame.section_radius];
    if along < MIN_RADIUS_RATIO * across {
        return unlike(format!(
            "radii of {:.1} mm along and {:.1} mm across at its lowest place",
            1e3 * along,
            1e3 * across
        ));
    }
    let [low, high] = hull.bounds();
    let [x, y] = [0, 1].map(|axis| high[axis] - low[axis]);
    if x.min(y) > MAX_WIDTH_RATIO * x.max(y) {
        let [x, y] = [x, y].map(|size| 1e3 * size);
        return unlike(format!("it is {x:.1} mm long and {y:.1} mm wide"));
    }
    let up = frame.options.up.filter(|up| *up != Axis::Z)?;
    Some(format!(
        "the side that is rounded as a runner's underside does not face down: up = \"{up}\" would \
         turn it so"
    ))
}

/// Powers of the parabola along a keel.
const ROCKER: [[i32; 2]; 3] = [[0, 0], [1, 0], [2, 0]];

/// Radii of rocker and section of the side that faces down when `up` points up [m], and whether the
/// rocker's curvature is significant; `None` if the side is flat or concave.
fn radii(hull: &Hull, forward: usize, up: Axis, scale: f64) -> Option<([f64; 2], bool)> {
    let across = 3 - forward - up.index;
    let sign = if up.negative { -1.0 } else { 1.0 };
    let turned = |p: &[f64; 3]| {
        let height = scale * sign * p[up.index];
        [scale * p[forward], scale * p[across], height]
    };
    let mut points: Vec<[f64; 3]> = hull.positions.iter().map(turned).collect();
    // A section across a keel that is not along x would appear too wide.
    if let Some(yaw) = keel_yaw(&points).filter(Estimate::significant) {
        let (sine, cosine) = yaw.value.sin_cos();
        for p in &mut points {
            (p[0], p[1]) = (cosine * p[0] + sine * p[1], cosine * p[1] - sine * p[0]);
        }
    }
    let [from, to] = range(points.iter().map(|p| p[0]));
    let margin = 0.5 * (1.0 - MIDDLE) * (to - from);
    let middle = |p: &&[f64; 3]| p[0] > from + margin && p[0] < to - margin;
    let share = |x: f64| (x - from - margin) / (to - from - 2.0 * margin);
    let mut keel = lowest_of_stations(points.iter().filter(middle).map(|p| (*p, *p)), share);
    let mut rocker = surface(&keel, &ROCKER)?;
    let centre = keel.iter().map(|p| p[0]).sum::<f64>() / keel.len() as f64;
    let off = |p: &[f64; 3]| {
        let terms = rocker.coefficients.iter().zip(ROCKER);
        let height = terms.map(|(c, [power, _])| c * (p[0] - centre).powi(power));
        (p[2] - height.sum::<f64>()).abs()
    };
    // Rounding of coordinates does not count as a spike.
    let most = SPIKE * median(keel.iter().map(off).collect())? + 1e-6 * (to - from);
    let is_spike = |p: &[f64; 3]| off(p) > most;
    let spikes: Vec<[f64; 3]> = keel.extract_if(.., |p| is_spike(p)).collect();
    if !spikes.is_empty() {
        points.retain(|p| !spikes.contains(p));
        rocker = surface(&keel, &ROCKER)?;
    }
    let rocker_radius = radius(rocker.coefficients[2], MAX_RADII[0])?;
    let significant = rocker.coefficients[2] >= SIGNIFICANT_ROCKER * rocker.errors[2];
    let lowest = keel.iter().min_by(|a, b| a[2].total_cmp(&b[2]))?;
    let section_radius = NEAR.iter().find_map(|part| {
        let near = |p: &&[f64; 3]| (p[0] - lowest[0]).abs() < part * (to - from);
        let points: Vec<[f64; 3]> = points.iter().filter(near).copied().collect();
        section_radius(&points, lowest)
    })?;
    Some(([rocker_radius, section_radius], significant))
}

/// Radius of the section at the lowest vertex [m], from points nearby along the hull. The examined
/// width decreases while the curvature is significant and its standard error decreases: while it
/// does, the error is the misfit of the form rather than noise.
fn section_radius(points: &[[f64; 3]], lowest: &[f64; 3]) -> Option<f64> {
    let off = |p: &[f64; 3]| (p[1] - lowest[1]).abs();
    let mut half = points.iter().map(off).fold(0.0, f64::max);
    let mut found: Option<(f64, f64)> = None;
    loop {
        // Excludes the walls and the other side of the hull.
        let own = |p: &&[f64; 3]| off(p) <= half && p[2] - lowest[2] < SHALLOW * half;
        let section: Vec<[f64; 3]> = points.iter().filter(own).copied().collect();
        let estimate = surface(&section, &SECTION).map(|f| (f.coefficients[2], f.errors[2]));
        let narrower = estimate.filter(|&(c, error)| {
            let better = |(_, wider)| error < wider && radius(c, MAX_RADII[1]).is_some();
            c >= SIGNIFICANT * error && found.is_none_or(better)
        });
        let Some(narrower) = narrower else {
            return found.and_then(|(c, _)| radius(c, MAX_RADII[1]));
        };
        // Flatter curvatures do not stop the search.
        found = Some(narrower).filter(|(c, _)| radius(*c, MAX_RADII[1]).is_some());
        half = 0.7 * section.iter().map(off).fold(0.0, f64::max);
    }
}

/// Polynomial fit of the heights of points over their places.
fn surface(points: &[[f64; 3]], powers: &[[i32; 2]]) -> Option<Fitted> {
    let places: Vec<[f64; 2]> = points.iter().map(|p| [p[0], p[1]]).collect();
    let heights: Vec<f64> = points.iter().map(|p| p[2]).collect();
    fit(&places, &heights, powers)
}

/// Radius of z = c y^2; `None` if it is concave or the radius exceeds `flattest`.
fn radius(c: f64, flattest: f64) -> Option<f64> {
    let radius = 0.5 / c;
    (c > 0.0 && radius < flattest).then_some(radius)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A scan over 0.5 m of an underside of these radii [m], with a flat of this height [m] worn
    /// into its section, 2 m above its origin and in single precision.
    fn far_scan(rocker: f64, section: f64, flat: f64) -> Hull {
        let x: Vec<f64> = (-125..=125).map(|i| 2e-3 * f64::from(i)).collect();
        let y: Vec<f64> = (-80..=80).map(|j| 5e-5 * f64::from(j)).collect();
        let height = |x: f64, y: f64| {
            let lowest = section - (section * section - y * y).sqrt();
            x * x / (2.0 * rocker) + lowest.max(flat)
        };
        let heights = y.iter().flat_map(|&y| x.iter().map(move |&x| height(x, y)));
        let single = heights.map(|z| f64::from((z + 2.0) as f32));
        Hull::underside_of(&x, &y, &single.collect::<Vec<_>>())
    }

    #[test]
    fn single_precision_far_from_the_origin_leaves_the_radii() {
        for rocker in [30.0, 300.0] {
            let frame = ScanFrame::of(&far_scan(rocker, 5e-3, 0.0));
            let frame = frame.expect("triangles").expect("a side");
            let radii = [frame.rocker_radius / rocker, frame.section_radius / 5e-3];
            assert!(radii.iter().all(|r| (r - 1.0).abs() < 0.01), "{radii:?}");
        }
    }

    #[test]
    fn a_runner_worn_flat_has_the_radius_around_the_flat() {
        let frame = ScanFrame::of(&far_scan(30.0, 5e-3, 1e-6));
        let frame = frame.expect("triangles").expect("a side");
        let section = frame.section_radius / 5e-3;
        assert!((section - 1.0).abs() < 0.2, "{section}");
    }
}
