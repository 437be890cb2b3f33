//! Parametric runners as closed triangle hulls.

use crate::error::MeshError;
use crate::hull::triangles::Hull;
use crate::parameter::positive_finite;
use crate::shapes::swept::Swept;
use crate::shapes::underside::Underside;

/// Largest change of the section's direction over one facet [rad].
const LARGEST_TURN: f64 = 0.25;
/// That of a steel on its edge, whose radius is of the size of the contact [rad].
const EDGE_TURN: f64 = 0.01;
/// A facet is longer than its neighbour across by at most this part of their mean: a smooth surface
/// is fitted to them later, which cannot follow a sharp edge whose neighbour is a hundred times as
/// wide.
const GRADING: f64 = 0.25;
/// Number of samples of the section from which the facets are spaced.
const SAMPLES: usize = 4000;
/// Largest number of vertices of a hull.
const MAX_VERTICES: f64 = 2e7;

/// The runner's surface as outward triangles with edges of about `edge_length` [m] on the
/// underside.
///
/// Every vertex of the underside lies on it. Across, facets are shorter where the section turns by
/// more than 0.25 rad in one edge length. The top is flat, sides and ends are upright.
///
/// # Errors
/// [`MeshError::Value`] where the edge length is not positive, [`MeshError::Invalid`] where it is
/// so small that the hull has more than 20 million vertices.
pub fn tessellate(runner: &Swept, edge_length: f64) -> Result<Hull, MeshError> {
    tessellate_turning(runner, edge_length, LARGEST_TURN)
}

/// As [`tessellate`] for a steel on its edge: facets across turn by at most 0.01 rad, since the
/// radius of the edge is of the size of the contact.
///
/// # Errors
/// As [`tessellate`].
pub fn tessellate_steel(steel: &Swept, edge_length: f64) -> Result<Hull, MeshError> {
    tessellate_turning(steel, edge_length, EDGE_TURN)
}

fn tessellate_turning(
    runner: &Swept,
    edge_length: f64,
    largest_turn: f64,
) -> Result<Hull, MeshError> {
    positive_finite("edge length [m]", edge_length)?;
    let [x0, x1, y0, y1] = runner.extent();
    let ys = across(runner, edge_length, largest_turn)?;
    let steps = ((x1 - x0) / edge_length).ceil().max(2.0);
    if steps * ys.len() as f64 > MAX_VERTICES {
        return Err(MeshError::too_many("vertices", MAX_VERTICES as usize));
    }
    // Even in number, so that the middle is a column of vertices and the halves mirror each other.
    let half = (0.5 * steps).ceil() as i64;
    let middle = 0.5 * (x0 + x1);
    let xs: Vec<f64> = (-half..=half)
        .map(|i| (middle + 0.5 * (x1 - x0) * i as f64 / half as f64).clamp(x0, x1))
        .collect();

    let mut hull = Hull::default();
    for &x in &xs {
        let underside = ys.iter().map(|&y| [x, y, runner.height(x, y)]);
        let top = [y0, y1].map(|y| [x, y, runner.top()]);
        hull.positions.extend(underside.chain(top));
    }
    let row = ys.len() + 2;
    let (last, left, right) = (ys.len() - 1, ys.len(), ys.len() + 1);
    let node = |i: usize, j: usize| (i * row + j) as u32;
    for i in 0..xs.len() - 1 {
        let mut quad = |a: usize, b: usize| {
            // Seen from outside a is to the left of b when x points away.
            let [near_a, far_a] = [node(i, a), node(i + 1, a)];
            let [near_b, far_b] = [node(i, b), node(i + 1, b)];
            hull.triangles
                .extend([[near_a, far_a, far_b], [near_a, far_b, near_b]]);
        };
        (0..last).for_each(|j| quad(j + 1, j));
        quad(0, left);
        quad(left, right);
        quad(right, last);
    }
    for (i, outward) in [(0, false), (xs.len() - 1, true)] {
        let mut triangle = |a: usize, b: usize, c: usize| {
            let (b, c) = if outward { (b, c) } else { (c, b) };
            hull.triangles.push([node(i, a), node(i, b), node(i, c)]);
        };
        let half = ys.len() / 2;
        (0..half).for_each(|j| triangle(left, j, j + 1));
        (half..last).for_each(|j| triangle(right, j, j + 1));
        triangle(left, half, right);
    }
    Ok(hull)
}

/// Positions across: steps of at most `edge_length` along the section and turns of at most
/// `largest_turn`, which grow gradually.
fn across(runner: &Swept, edge_length: f64, largest_turn: f64) -> Result<Vec<f64>, MeshError> {
    let section = runner.section();
    let [y0, y1] = section.extent();
    // Denser towards the sides, where a half circle is upright.
    let at = |i: usize| {
        let angle = std::f64::consts::PI * (i as f64 / SAMPLES as f64 - 0.5);
        (0.5 * (y0 + y1) + 0.5 * (y1 - y0) * angle.sin()).clamp(y0, y1)
    };
    let mut lengths = Vec::with_capacity(SAMPLES);
    let mut steps = Vec::with_capacity(SAMPLES);
    let mut direction: Option<f64> = None;
    for i in 0..SAMPLES {
        let (from, to) = (at(i), at(i + 1));
        let (dy, dz) = (to - from, section.height(to) - section.height(from));
        let turned = dz.atan2(dy);
        let turn = direction.map_or(0.0, |before| (turned - before).abs());
        direction = Some(turned);
        let length = dy.hypot(dz);
        lengths.push(length);
        steps.push(length / (length / edge_length).max(turn / largest_turn));
    }
    let mut grade = |from: usize, to: usize| {
        let distance = 0.5 * (lengths[from] + lengths[to]);
        steps[to] = steps[to].min(steps[from] + GRADING * distance);
    };
    (1..SAMPLES).for_each(|i| grade(i - 1, i));
    (1..SAMPLES).rev().for_each(|i| grade(i, i - 1));
    let mut measure = vec![0.0];
    for (i, (length, step)) in lengths.iter().zip(&steps).enumerate() {
        measure.push(measure[i] + length / step);
    }
    let total = measure[SAMPLES];
    if total > MAX_VERTICES {
        return Err(MeshError::too_many("vertices", MAX_VERTICES as usize));
    }
    let count = 2 * (0.5 * total - 1e-9).ceil().max(1.0) as usize;
    let place = |j: usize| {
        let wanted = total * j as f64 / count as f64;
        let i = measure.partition_point(|&m| m < wanted).clamp(1, SAMPLES);
        let (low, high) = (measure[i - 1], measure[i]);
        let part = if high > low {
            (wanted - low) / (high - low)
        } else {
            0.0
        };
        at(i - 1) + part * (at(i) - at(i - 1))
    };
    let mut ys: Vec<f64> = (0..=count).map(place).collect();
    (ys[0], ys[count]) = (y0, y1);
    if section.is_even() {
        for j in 0..count / 2 {
            ys[count - j] = -ys[j];
        }
        ys[count / 2] = 0.0;
    }
    Ok(ys)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hull::triangles::check_hull;
    use crate::shapes::swept::BobRunner;
    use crate::shapes::swept::LugeSteel;

    #[test]
    fn tessellated_runners_are_closed_face_outwards_and_hold_the_runners_volume() {
        let steel = LugeSteel::default();
        for (runner, edge) in [
            (BobRunner::default().swept().unwrap(), 1e-3),
            (steel.swept().unwrap(), 1e-3),
        ] {
            let hull = tessellate(&runner, edge).unwrap();
            let report = check_hull(&hull).unwrap();
            assert_eq!(
                (
                    report.open_edges,
                    report.flipped_edges,
                    report.warnings.len()
                ),
                (0, 0, 0)
            );
            let [x0, x1, y0, y1] = runner.extent();
            let n = 400;
            let mut volume = 0.0;
            for i in 0..n {
                for j in 0..n {
                    let part = |k: usize| (k as f64 + 0.5) / n as f64;
                    let (x, y) = (x0 + (x1 - x0) * part(i), y0 + (y1 - y0) * part(j));
                    volume += (runner.top() - runner.height(x, y)) * (x1 - x0) * (y1 - y0)
                        / (n * n) as f64;
                }
            }
            assert!(
                (report.volume / volume - 1.0).abs() < 2e-3,
                "{} {volume}",
                report.volume
            );
        }
    }

    #[test]
    fn vertices_lie_on_the_underside_and_edges_have_the_stated_length() {
        let runner = BobRunner::default().swept().unwrap();
        let hull = tessellate(&runner, 1e-3).unwrap();
        for [x, y, z] in &hull.positions {
            assert!(*z == runner.height(*x, *y) || *z == runner.top());
        }
        let ys = across(&runner, 1e-3, LARGEST_TURN).unwrap();
        assert_eq!(ys.len(), 17);
        let arc = |y: f64| 0.005 * (y / 0.005).clamp(-1.0, 1.0).asin();
        for pair in ys.windows(2) {
            assert!(
                (arc(pair[1]) - arc(pair[0]) - 0.005 * std::f64::consts::PI / 16.0).abs() < 2e-6
            );
        }
    }

    #[test]
    fn a_sharp_edge_gets_facets_of_its_own_size() {
        let ys = across(&LugeSteel::default().swept().unwrap(), 1e-3, LARGEST_TURN).unwrap();
        assert!(ys.iter().filter(|y| y.abs() < 0.31e-3).count() > 6);
        // No facet is much wider than its neighbour.
        let steps: Vec<f64> = ys.windows(2).map(|y| y[1] - y[0]).collect();
        let last = steps.len() - 2;
        let adjacent = steps.windows(2).enumerate().skip(10).take(last - 12);
        let widest = adjacent.map(|(_, s)| s[1] / s[0]).fold(0.0, f64::max);
        assert!(widest < 2.0, "{widest} of {}", steps.len());
        assert!(steps.iter().any(|s| *s > 0.9e-3));
    }

    #[test]
    fn edge_lengths_that_cannot_be_are_refused() {
        let runner = BobRunner::default().swept().unwrap();
        assert!(
            tessellate(&runner, 0.0)
                .unwrap_err()
                .to_string()
                .contains("edge length")
        );
        assert!(
            tessellate(&runner, 1e-9)
                .unwrap_err()
                .to_string()
                .contains("20000000")
        );
    }
}
