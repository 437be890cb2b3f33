//! Triangle hulls: vertices, checks, axes and units.

use std::collections::{BTreeMap, HashMap, HashSet};
use std::fmt;
use std::str::FromStr;

use nalgebra::{Matrix3, Matrix4, Point3, Rotation3, Vector3};
use rayon::prelude::*;

use crate::error::MeshError;
use crate::parameter::{expect, range};

/// Positions and triangles, counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Hull {
    /// Vertex positions [m].
    pub positions: Vec<[f64; 3]>,
    /// Corners of each triangle.
    pub triangles: Vec<[u32; 3]>,
}

impl Hull {
    /// The underside of a height map: vertices at every `x` and `y` with the `heights` [m],
    /// `y.len()` rows of `x.len()`, and two triangles per cell that face down. NaN heights leave
    /// holes.
    ///
    /// # Panics
    /// If there is not one height per vertex.
    pub fn underside_of(x: &[f64], y: &[f64], heights: &[f64]) -> Hull {
        assert_eq!(heights.len(), x.len() * y.len(), "one height a vertex");
        let mut hull = Hull::default();
        let mut number = vec![None; heights.len()];
        for (k, &z) in heights.iter().enumerate() {
            if z.is_finite() {
                number[k] = Some(hull.positions.len() as u32);
                hull.positions.push([x[k % x.len()], y[k / x.len()], z]);
            }
        }
        for j in 1..y.len() {
            for i in 1..x.len() {
                let k = j * x.len() + i;
                let corners = [k - x.len() - 1, k - x.len(), k, k - 1].map(|k| number[k]);
                if let [Some(a), Some(b), Some(c), Some(d)] = corners {
                    hull.triangles.extend([[a, c, b], [a, d, c]]);
                }
            }
        }
        hull
    }

    /// The hull with equal positions merged and degenerate triangles removed, its coordinates
    /// transformed by the matrix `rows`.
    ///
    /// # Errors
    /// [`MeshError::Invalid`] if no triangle remains, a corner has no position, or a position that
    /// a triangle uses is not finite.
    pub(crate) fn welded(
        positions: &[[f64; 3]],
        triangles: impl Iterator<Item = [usize; 3]>,
        rows: [[f64; 3]; 3],
    ) -> Result<Self, MeshError> {
        let mut hull = Self::default();
        let mut known: HashMap<[u64; 3], u32> = HashMap::new();
        for (number, corners) in triangles.enumerate() {
            let mut welded = [0; 3];
            for (corner, &index) in welded.iter_mut().zip(&corners) {
                let position = positions
                    .get(index)
                    .ok_or_else(|| MeshError::vertex_index(number + 1, index, positions.len()))?;
                if position.iter().any(|v| !v.is_finite()) {
                    return Err(MeshError::not_finite(index + 1, *position));
                }
                // Adding zero makes -0 and 0 the same bits.
                let key = position.map(|v| (v + 0.0).to_bits());
                *corner = *known.entry(key).or_insert_with(|| {
                    hull.positions.push(transformed(&rows, position));
                    (hull.positions.len() - 1) as u32
                });
            }
            let [a, b, c] = welded;
            if a != b && b != c && c != a {
                hull.triangles.push(welded);
            }
        }
        if hull.triangles.is_empty() {
            return Err(MeshError::no_triangles());
        }
        let infinite = |p: &[f64; 3]| p.iter().any(|v| !v.is_finite());
        match hull.positions.iter().position(infinite) {
            Some(vertex) => Err(MeshError::not_finite(vertex + 1, hull.positions[vertex])),
            None => Ok(hull),
        }
    }

    /// The hull in runner axes, from one in the coordinates of its file.
    ///
    /// # Errors
    /// [`MeshError::Value`] where the scale is not positive, [`MeshError::Invalid`] where the axes
    /// are parallel.
    pub fn placed(&self, options: &HullOptions) -> Result<Self, MeshError> {
        Ok(self.transformed(options.rows(Axis::Z)?))
    }

    /// The hull with its coordinates transformed by the matrix `rows`.
    pub(crate) fn transformed(&self, rows: [[f64; 3]; 3]) -> Self {
        let positions = self.positions.iter();
        Self {
            positions: positions.map(|p| transformed(&rows, p)).collect(),
            triangles: self.triangles.clone(),
        }
    }

    /// Smallest and largest coordinates [m].
    pub fn bounds(&self) -> [[f64; 3]; 2] {
        let [x, y, z] = [0, 1, 2].map(|axis| range(self.positions.iter().map(|p| p[axis])));
        [0, 1].map(|end| [x[end], y[end], z[end]])
    }

    /// Signed volume `1/6 sum a . (b x c)` [m^3], positive where the triangles of a closed hull
    /// face outwards.
    pub fn volume(&self) -> f64 {
        let [low, _] = self.bounds();
        let low = Vector3::from(low);
        let volume = |t: &[u32; 3]| {
            let [a, b, c] = t.map(|i| Vector3::from(self.positions[i as usize]) - low);
            a.dot(&b.cross(&c)) / 6.0
        };
        self.triangles.iter().map(volume).sum()
    }

    /// Twice the area vector of triangle `t` [m^2]; it points outwards.
    pub fn normal(&self, t: &[u32; 3]) -> [f64; 3] {
        let [a, b, c] = t.map(|i| Vector3::from(self.positions[i as usize]));
        (b - a).cross(&(c - a)).into()
    }
}

/// A position transformed by a matrix.
fn transformed(rows: &[[f64; 3]; 3], p: &[f64; 3]) -> [f64; 3] {
    rows.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2])
}

/// Number of triangles, and of vertices, that a file of any size may place.
const MIN_CAPACITY: usize = 1_000_000;

/// The error of more than `limit` of something in one file.
pub(crate) fn at_most(limit: usize, found: usize, what: &str) -> Result<(), MeshError> {
    if found > limit {
        return Err(MeshError::too_many(what, limit));
    }
    Ok(())
}

/// Meshes read from one file, each placed by its transform.
///
/// A file may use one mesh many times; the number of placed triangles is limited.
#[derive(Default)]
pub(crate) struct PlacedMeshes {
    /// Number of triangles, and of vertices, that a file of this size can contain.
    pub(crate) capacity: usize,
    pub(crate) positions: Vec<[f64; 3]>,
    pub(crate) triangles: Vec<[usize; 3]>,
}

impl PlacedMeshes {
    /// Adds a mesh of these vertices and triangles, transformed by `transform`.
    pub(crate) fn add(
        &mut self,
        vertices: &[[f64; 3]],
        triangles: impl ExactSizeIterator<Item = [usize; 3]>,
        transform: &Matrix4<f64>,
    ) -> Result<(), MeshError> {
        let first = self.positions.len();
        let most = self.capacity.max(MIN_CAPACITY);
        let placed = "with its meshes at every place that uses them; expected each once";
        let vertex_count = first + vertices.len();
        at_most(most, vertex_count, &format!("vertices {placed}"))?;
        let count = self.triangles.len() + triangles.len();
        at_most(most, count, &format!("triangles {placed}"))?;
        // A transform that mirrors reverses the winding.
        let mirrored = transform.fixed_view::<3, 3>(0, 0).determinant() < 0.0;
        for mut corners in triangles {
            if let Some(&index) = corners.iter().find(|&&i| i >= vertices.len()) {
                let number = self.triangles.len() + 1;
                return Err(MeshError::vertex_index(number, index, vertices.len()));
            }
            if mirrored {
                corners.swap(1, 2);
            }
            self.triangles.push(corners.map(|i| first + i));
        }
        let placed = |p: &[f64; 3]| <[f64; 3]>::from(transform.transform_point(&Point3::from(*p)));
        self.positions.extend(vertices.iter().map(placed));
        Ok(())
    }

    /// The hull of all meshes, its coordinates transformed by `rows`.
    pub(crate) fn welded(self, rows: [[f64; 3]; 3]) -> Result<Hull, MeshError> {
        Hull::welded(&self.positions, self.triangles.into_iter(), rows)
    }
}

/// An axis of a file, with its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Axis {
    /// 0, 1 or 2 for x, y or z.
    pub index: usize,
    /// Whether the negative direction of the axis is meant.
    pub negative: bool,
}

impl Axis {
    /// The axis +x.
    pub const X: Self = Self::positive(0);
    /// The axis +y.
    pub const Y: Self = Self::positive(1);
    /// The axis +z.
    pub const Z: Self = Self::positive(2);

    /// The positive axis of this index.
    pub(crate) const fn positive(index: usize) -> Self {
        let negative = false;
        Self { index, negative }
    }

    fn vector(self) -> Vector3<f64> {
        let mut vector = Vector3::zeros();
        vector[self.index] = if self.negative { -1.0 } else { 1.0 };
        vector
    }
}

impl FromStr for Axis {
    type Err = MeshError;

    /// Reads `x`, `y`, `z`, `-x`, `-y` or `-z`.
    fn from_str(text: &str) -> Result<Self, MeshError> {
        let (negative, letter) = match text.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, text.strip_prefix('+').unwrap_or(text)),
        };
        let index = ["x", "y", "z"].iter().position(|&l| l == letter);
        let wrong = || format!("axis {text:?}; expected x, y, z, -x, -y or -z");
        let index = index.ok_or_else(|| MeshError::Invalid(wrong()))?;
        Ok(Self { index, negative })
    }
}

impl fmt::Display for Axis {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.negative { "-" } else { "" };
        write!(f, "{sign}{}", ["x", "y", "z"][self.index])
    }
}

/// How a file's coordinates become metres with x forward and z up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HullOptions {
    /// Metres in one unit of the file; 0.001 for millimetres.
    pub scale: f64,
    /// The file's axis that points up; `None` for y in glTF and z in the other formats.
    pub up: Option<Axis>,
    /// The file's axis that points forward.
    pub forward: Axis,
    /// Roll, pitch and yaw [rad] that carry a scan, read with these axes, into runner axes:
    /// `R_z(yaw) R_y(pitch) R_x(roll)`.
    pub rotation: [f64; 3],
}

impl Default for HullOptions {
    fn default() -> Self {
        Self {
            scale: 1.0,
            up: None,
            forward: Axis::X,
            rotation: [0.0; 3],
        }
    }
}

impl HullOptions {
    /// The options that rotate a file's coordinates by `turn`: the nearest axes of the file, with
    /// forward in its positive direction, and the remaining rotation.
    pub(crate) fn turning(scale: f64, mut turn: Matrix3<f64>) -> Self {
        let nearest = |row: usize, except: Option<usize>| {
            let others = (0..3).filter(|k| Some(*k) != except);
            let share = |k: &usize| turn[(row, *k)].abs();
            others
                .max_by(|a, b| share(a).total_cmp(&share(b)))
                .unwrap_or(0)
        };
        let forward = nearest(0, None);
        let index = nearest(2, Some(forward));
        if turn[(0, forward)] < 0.0 {
            // Front and rear cannot be distinguished: half a turn about z.
            turn.row_mut(0).neg_mut();
            turn.row_mut(1).neg_mut();
        }
        let negative = turn[(2, index)] < 0.0;
        let (up, forward) = (Axis { index, negative }, Axis::positive(forward));
        let rest = Rotation3::from_matrix_unchecked(turn * axes(up, forward).transpose());
        let (roll, pitch, yaw) = rest.euler_angles();
        Self {
            scale,
            up: Some(up),
            forward,
            rotation: [roll, pitch, yaw],
        }
    }

    /// The rows of the matrix that carries file coordinates to metres, x forward, y left, z up.
    ///
    /// # Errors
    /// [`MeshError::Value`] where the scale is not positive, [`MeshError::Invalid`] where the axes
    /// are parallel.
    pub(crate) fn rows(&self, usual_up: Axis) -> Result<[[f64; 3]; 3], MeshError> {
        let expected = "a positive number of metres in one unit of the file";
        let positive = self.scale > 0.0 && self.scale.is_finite();
        expect(positive, "scale", self.scale, expected)?;
        let up = self.up.unwrap_or(usual_up);
        if up.index == self.forward.index {
            return Err(MeshError::Invalid(format!(
                "up = {up} and forward = {} are parallel; expected two different axes",
                self.forward
            )));
        }
        let mut rows = axes(up, self.forward);
        // Without rotation, zeros keep their signs.
        if self.rotation != [0.0; 3] {
            let [roll, pitch, yaw] = self.rotation;
            rows = Rotation3::from_euler_angles(roll, pitch, yaw) * rows;
        }
        Ok([0, 1, 2].map(|row| [0, 1, 2].map(|column| rows[(row, column)] * self.scale)))
    }
}

/// The matrix whose rows are forward, left and up.
fn axes(up: Axis, forward: Axis) -> Matrix3<f64> {
    let (z, x) = (up.vector(), forward.vector());
    Matrix3::from_rows(&[x, z.cross(&x), z].map(|axis| axis.transpose()))
}

/// Smallest and largest size of a hull without a warning about its unit [m].
const EXTENTS: [f64; 2] = [0.01, 20.0];

/// Result of the checks of a hull.
#[derive(Clone, Debug, PartialEq)]
pub struct HullReport {
    /// Number of edges that only one triangle uses.
    pub open_edges: usize,
    /// Number of edges whose two triangles have opposite orientations.
    pub flipped_edges: usize,
    /// Size along x, y and z [m].
    pub extent: [f64; 3],
    /// Signed volume [m^3]; of little meaning where edges are open.
    pub volume: f64,
    /// Descriptions of the parts of the file that were removed from the hull.
    pub removed: Vec<String>,
    /// Warnings, including `removed`.
    pub warnings: Vec<String>,
}

/// Warnings about the size of a hull or of a mesh, along x, y and z [m].
pub fn size_warnings(extent: [f64; 3]) -> Vec<String> {
    let size = extent.iter().copied().fold(0.0, f64::max);
    let [smallest, largest] = EXTENTS;
    let unit = if size > 1e3 * largest {
        "micrometres, set scale = 1e-6"
    } else {
        "millimetres, set scale = 0.001"
    };
    let large = (size > largest)
        .then(|| format!("the hull is {size:.4} m large; if the file is in {unit}"));
    let small = (size < smallest).then(|| {
        format!(
            "the hull is only {size:.3e} m large; check its scale (metres in one unit of the file)"
        )
    });
    large.or(small).into_iter().collect()
}

/// Checks a hull: its edges, its size and its volume.
///
/// # Errors
/// [`MeshError::Invalid`] where there are no triangles, where a position is not finite, and where a
/// closed hull's triangles face inwards.
pub fn check_hull(hull: &Hull) -> Result<HullReport, MeshError> {
    if hull.triangles.is_empty() {
        return Err(MeshError::no_triangles());
    }
    let infinite = |position: &[f64; 3]| !position.iter().all(|v| v.is_finite());
    if let Some(n) = hull.positions.iter().position(infinite) {
        return Err(MeshError::not_finite(n + 1, hull.positions[n]));
    }
    // Each triangle's edges, from the lower to the higher index, and whether it walks them so.
    let mut edges: Vec<([u32; 2], bool)> = hull
        .triangles
        .iter()
        .flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]])
        .map(|[from, to]| ([from.min(to), from.max(to)], from < to))
        .collect();
    edges.par_sort_unstable();
    let shared = || edges.chunk_by(|a, b| a.0 == b.0);
    let open_edges = shared().filter(|walks| walks.len() == 1).count();
    let flipped = |walks: &&[([u32; 2], bool)]| walks.len() == 2 && walks[0].1 == walks[1].1;
    let flipped_edges = shared().filter(flipped).count();
    let [low, high] = hull.bounds();
    let extent = [0, 1, 2].map(|axis| high[axis] - low[axis]);
    let volume = hull.volume();
    // The volume of a flat hull is rounding of either sign.
    let rounding = 1e-6 * extent.iter().product::<f64>();
    if open_edges == 0 && volume < -rounding {
        let remedy = if flipped_edges > 0 {
            format!("they disagree along {flipped_edges} edges: unify their winding")
        } else {
            "reverse their winding (flip normals)".to_owned()
        };
        return Err(MeshError::Invalid(format!(
            "the hull's triangles face inwards (signed volume {volume:.3e} m^3); {remedy}"
        )));
    }
    let mut warnings = size_warnings(extent);
    if open_edges > 0 {
        warnings.push(format!(
            "the hull is open: {open_edges} edges belong to one triangle only; its downward-facing \
             part is used"
        ));
    }
    // A disc or a ball is as wide as it is long.
    let [x, y, _] = extent;
    if y > 1.5 * x {
        warnings.push(format!(
            "the hull is {y:.4} m across and {x:.4} m along: expected `forward` to be the file's axis \
             along its length"
        ));
    }
    if flipped_edges > 0 {
        warnings.push(format!(
            "the hull's triangles disagree about the outside along {flipped_edges} edges; unify \
             their winding"
        ));
    }
    Ok(HullReport {
        open_edges,
        flipped_edges,
        extent,
        volume,
        removed: Vec::new(),
        warnings,
    })
}

/// Reduces a hull to the runner, its most extended body, without repeated triangles, and checks it.
/// The report lists the removed parts.
///
/// # Errors
/// As [`check_hull`].
pub fn checked_runner(mut hull: Hull) -> Result<(Hull, HullReport), MeshError> {
    let repeated = remove_repeated(&mut hull);
    let others = remove_other_bodies(&mut hull);
    let mut report = check_hull(&hull)?;
    report.removed.extend(repeated.into_iter().chain(others));
    report.warnings.extend_from_slice(&report.removed);
    Ok((hull, report))
}

/// Removes triangles that have the same corners in the same order as another one.
fn remove_repeated(hull: &mut Hull) -> Option<String> {
    let count = hull.triangles.len();
    let mut known = HashSet::with_capacity(count);
    hull.triangles.retain(|corners| {
        let mut from_lowest = *corners;
        let lowest = (0..3).min_by_key(|k| corners[*k]).unwrap_or(0);
        from_lowest.rotate_left(lowest);
        known.insert(from_lowest)
    });
    let repeated = count - hull.triangles.len();
    (repeated > 0).then(|| format!("{repeated} triangles repeat others and take no part"))
}

/// A connected surface: integrals of 1, the position and its square over its area.
#[derive(Clone, Copy, Default)]
struct Body {
    triangles: usize,
    area: f64,
    first_moment: Vector3<f64>,
    second_moment: f64,
}

impl Body {
    /// Adds a triangle with these corners.
    fn add(&mut self, corners: [Vector3<f64>; 3]) {
        let [a, b, c] = corners;
        let sum = a + b + c;
        let area = 0.5 * (b - a).cross(&(c - a)).norm();
        let squares: f64 = [a, b, c, sum].iter().map(Vector3::norm_squared).sum();
        self.triangles += 1;
        self.area += area;
        self.first_moment += area / 3.0 * sum;
        self.second_moment += area / 12.0 * squares;
    }

    /// Polar second moment of area about the centroid: large for a long surface, whatever its
    /// rotation and its number of triangles.
    fn extension(&self) -> f64 {
        self.second_moment - self.first_moment.norm_squared() / self.area.max(f64::MIN_POSITIVE)
    }
}

/// Removes all connected surfaces except the one with the largest second moment of area: a runner
/// is longer than its holder, and longer than what a scanner adds.
fn remove_other_bodies(hull: &mut Hull) -> Option<String> {
    let mut leads: Vec<u32> = (0..hull.positions.len() as u32).collect();
    fn lead(leads: &mut [u32], mut of: u32) -> u32 {
        while leads[of as usize] != of {
            leads[of as usize] = leads[leads[of as usize] as usize];
            of = leads[of as usize];
        }
        of
    }
    for [a, b, c] in &hull.triangles {
        for other in [b, c] {
            let (one, other) = (lead(&mut leads, *a), lead(&mut leads, *other));
            leads[one.max(other) as usize] = one.min(other);
        }
    }
    let origin = Vector3::from(hull.positions.first().copied()?);
    let mut bodies: BTreeMap<u32, Body> = BTreeMap::new();
    for corners in &hull.triangles {
        let body = bodies.entry(lead(&mut leads, corners[0])).or_default();
        body.add(corners.map(|corner| Vector3::from(hull.positions[corner as usize]) - origin));
    }
    let mut bodies: Vec<(u32, Body)> = bodies.into_iter().collect();
    bodies.sort_by(|(_, a), (_, b)| b.extension().total_cmp(&a.extension()));
    let [(runner, Body { triangles, .. }), others @ ..] = &bodies[..] else {
        return None;
    };
    if others.is_empty() {
        return None;
    }
    hull.triangles
        .retain(|[corner, ..]| lead(&mut leads, *corner) == *runner);
    let mut number = vec![None; hull.positions.len()];
    let mut positions = Vec::new();
    for corner in hull.triangles.iter_mut().flatten() {
        let old = *corner as usize;
        *corner = *number[old].get_or_insert_with(|| {
            positions.push(hull.positions[old]);
            (positions.len() - 1) as u32
        });
    }
    hull.positions = positions;
    const SHOWN: usize = 5;
    let shown = others.iter().take(SHOWN);
    let shown = shown.map(|(_, body)| body.triangles.to_string());
    let shown = shown.collect::<Vec<_>>().join(", ");
    let more = if others.len() > SHOWN { ", ..." } else { "" };
    Some(format!(
        "the file holds {} bodies apart: the most extended one ({triangles} triangles) is taken as \
         the runner, the others ({shown}{more}) take no part; to press another, export it alone",
        bodies.len()
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn axes_turn_a_y_up_file_right_handed() {
        let options = HullOptions {
            scale: 0.001,
            up: Some("y".parse().unwrap()),
            forward: "-z".parse().unwrap(),
            ..Default::default()
        };
        let rows = options.rows(Axis::Z).unwrap();
        let carry = |p: [f64; 3]| rows.map(|r| r[0] * p[0] + r[1] * p[1] + r[2] * p[2]);
        assert_eq!(carry([0.0, 1000.0, 0.0]), [0.0, 0.0, 1.0]);
        assert_eq!(carry([0.0, 0.0, -1000.0]), [1.0, 0.0, 0.0]);
        assert_eq!(carry([1000.0, 0.0, 0.0]), [0.0, -1.0, 0.0]);
    }

    #[test]
    fn parallel_axes_and_unknown_names_are_refused() {
        let parallel = HullOptions {
            up: Some(Axis::X),
            ..Default::default()
        };
        assert!(
            parallel
                .rows(Axis::Z)
                .unwrap_err()
                .to_string()
                .contains("parallel")
        );
        assert!(
            "w".parse::<Axis>()
                .unwrap_err()
                .to_string()
                .contains("\"w\"")
        );
        let bad_scale = HullOptions {
            scale: f64::NAN,
            ..Default::default()
        };
        assert!(
            bad_scale
                .rows(Axis::Z)
                .unwrap_err()
                .to_string()
                .contains("scale")
        );
    }

    fn tetrahedron(size: f64) -> Hull {
        let positions = vec![
            [0.0; 3],
            [size, 0.0, 0.0],
            [0.0, size, 0.0],
            [0.0, 0.0, size],
        ];
        Hull {
            positions,
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]],
        }
    }

    #[test]
    fn closed_outward_hull_has_its_volume_and_no_warning() {
        let report = check_hull(&tetrahedron(1.0)).unwrap();
        assert!((report.volume - 1.0 / 6.0).abs() < 1e-15);
        assert_eq!(
            (
                report.open_edges,
                report.flipped_edges,
                report.warnings.len()
            ),
            (0, 0, 0)
        );
    }

    #[test]
    fn inverted_hull_is_refused_with_the_fix() {
        let mut hull = tetrahedron(1.0);
        hull.triangles.iter_mut().for_each(|t| t.swap(1, 2));
        let message = check_hull(&hull).unwrap_err().to_string();
        assert!(
            message.contains("inwards") && message.contains("winding"),
            "{message}"
        );
    }

    /// A plate whose two sides are the same triangles encloses nothing: rounding leaves a volume of
    /// either sign.
    #[test]
    fn a_flat_closed_hull_is_not_inverted() {
        for turn in [0.0f64, 0.3, 1.1, 2.9] {
            let at = |x: f64, y: f64| {
                let (sine, cosine) = turn.sin_cos();
                [
                    cosine * x - sine * y,
                    sine * x + cosine * y,
                    0.1 * x + 0.7 * y,
                ]
            };
            let plate = Hull {
                positions: vec![at(0.1, 0.0), at(0.9, 0.0), at(0.3, 0.03)],
                triangles: vec![[0, 1, 2], [0, 2, 1]],
            };
            check_hull(&plate).unwrap();
        }
    }

    #[test]
    fn open_flipped_and_millimetre_hulls_are_warned_about() {
        let mut hull = tetrahedron(1000.0);
        hull.triangles.pop();
        hull.triangles[0].swap(1, 2);
        let report = check_hull(&hull).unwrap();
        assert_eq!((report.open_edges, report.flipped_edges), (3, 2));
        assert!(report.warnings[0].contains("scale = 0.001"));
        assert_eq!(report.warnings.len(), 3);
        assert!(size_warnings([3e5, 1.0, 1.0])[0].contains("scale = 1e-6"));
    }

    /// Twice the triangles of an open hull, with a speck below it that is first in the file.
    #[test]
    fn the_runner_is_the_most_extended_body_with_each_triangle_once() {
        let mut runner = tetrahedron(1.0);
        runner.triangles.pop();
        let corners = |at: f64| [0.0, 1e-3, 2e-3].map(|x| [x, 1e-3 * x, at]);
        let mut hull = Hull {
            positions: corners(-5.0).to_vec(),
            triangles: vec![[0, 1, 2]],
        };
        hull.positions.extend(&runner.positions);
        for turn in [0, 1] {
            for triangle in &runner.triangles {
                let mut corners = triangle.map(|corner| corner + 3);
                corners.rotate_left(turn);
                hull.triangles.push(corners);
            }
        }
        let (found, report) = checked_runner(hull).unwrap();
        assert_eq!(found.bounds(), runner.bounds());
        assert_eq!(found.triangles.len(), 3);
        assert_eq!((report.open_edges, report.flipped_edges), (3, 0));
        let [repeated, bodies] = &report.removed[..] else {
            panic!("{:?}", report.removed);
        };
        assert!(repeated.starts_with("3 triangles repeat"), "{repeated}");
        assert!(
            bodies.contains("one (3 triangles)") && bodies.contains("others (1)"),
            "{bodies}"
        );
    }

    /// A holder of more triangles, above a runner that is turned.
    #[test]
    fn a_holder_of_more_triangles_is_not_taken_for_the_runner() {
        let sheet = |[long, wide]: [f64; 2], count: i32, at: f64| {
            let places = |half: f64| -> Vec<f64> {
                (-count..=count)
                    .map(|k| half * f64::from(k) / f64::from(count))
                    .collect()
            };
            let (x, y) = (places(0.5 * long), places(0.5 * wide));
            let heights = vec![at; x.len() * y.len()];
            Hull::underside_of(&x, &y, &heights)
        };
        let runner = sheet([0.6, 0.01], 4, 0.0);
        let mut both = sheet([0.1, 0.08], 20, 0.05);
        let first = both.positions.len() as u32;
        both.positions.extend(&runner.positions);
        let corners = runner.triangles.iter();
        both.triangles
            .extend(corners.map(|t| t.map(|corner| corner + first)));
        let turn: [[f64; 3]; 3] = Rotation3::from_euler_angles(0.4, 1.0, 2.0)
            .into_inner()
            .into();
        let (found, report) = checked_runner(both.transformed(turn)).unwrap();
        assert_eq!(found.triangles.len(), runner.triangles.len());
        assert!(report.removed[0].contains("one (128 triangles) is taken as the runner"));
    }
}
