//! Spacing and noise of a hull's vertices near its keel.

use nalgebra::{DMatrix, DVector, Vector3};
use rayon::prelude::*;

use crate::fit::fitted_underside::rounding;
use crate::hull::Hull;
use crate::parameter::range;

/// Stations along the underside; the lowest node of each is examined.
const STATIONS: usize = 60;
/// Smallest cosine between the normal of a triangle of the underside and straight down.
const DOWN: f64 = 0.2;
/// Slope of a triangle with the cosine [`DOWN`].
const STEEPEST: f64 = 4.9;
/// Number of nodes of a fit: one per term of the polynomial, and twenty degrees of freedom.
const NEAR: usize = POWERS.len() + 20;
/// Ratios of length to width of the neighbourhoods. A runner is straighter along than across, but
/// its direction and the ratio of its curvatures are not known beforehand.
const ASPECT_RATIOS: [f64; 7] = [1.0 / 64.0, 1.0 / 8.0, 1.0, 4.0, 16.0, 64.0, 256.0];
/// Residual ratio (2n against n nodes) above which the residual is curvature, not noise.
const CURVATURE_RATIO: f64 = 2.0;
/// Aspect ratios are equally good if their residuals with 2n nodes agree within this factor.
const EQUAL_RESIDUAL: f64 = 1.1;
/// Relative difference below which two distances are equal.
const TIE: f64 = 1e-6;
/// Smallest ratio of the distance between two lines of nodes to the faces' size along that axis;
/// closer nodes belong to one line that noise has moved.
const LINE_DISTANCE: f64 = 0.25;
/// Nodes on either side of a node that are searched first.
const FIRST: usize = 2048;
/// Powers of the surface around a node.
const POWERS: [[i32; 2]; 15] = [
    [0, 0],
    [1, 0],
    [2, 0],
    [3, 0],
    [4, 0],
    [0, 1],
    [0, 2],
    [0, 3],
    [0, 4],
    [1, 1],
    [1, 2],
    [1, 3],
    [2, 1],
    [2, 2],
    [3, 1],
];

/// Noise of an underside's nodes, estimated from their heights.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// Estimated standard deviation about a smooth surface [m]; 0 if it does not exceed rounding.
    pub found: f64,
    /// Detection limit [m]: the contribution of the surface's curvature to the residual at this
    /// spacing of the nodes. Smaller noise is not seen. 0 if the limit does not exceed rounding.
    pub unseen: f64,
}

/// A node of an underside.
#[derive(Clone, Copy)]
struct Node {
    at: [f64; 3],
    /// Sizes of the faces around it along x and y [m].
    faces: [f64; 2],
}

/// Noise of the vertices of a hull's triangles that face down; see [`noise_of_faces`].
pub fn noise_of_hull(hull: &Hull) -> Option<Noise> {
    let down = hull.triangles.iter().filter(|t| faces_down(hull, t));
    let faces: Vec<[usize; 3]> = down.map(|t| t.map(|corner| corner as usize)).collect();
    noise_of_faces(&hull.positions, &faces)
}

fn faces_down(hull: &Hull, t: &[u32; 3]) -> bool {
    let normal = Vector3::from(hull.normal(t));
    -normal.z > DOWN * normal.norm()
}

/// Noise of the heights of an underside's nodes; `None` if there are too few faces. `points` are x
/// forward, y to the left and z up [m]; `faces` are the nodes of each face.
///
/// At the lowest node of each station a polynomial of fourth order is fitted to the nearest nodes,
/// in neighbourhoods of several [`ASPECT_RATIOS`]. The residual consists of noise and of the
/// surface's higher orders. A fit to twice as many nodes, s times as far away, has the same noise
/// and s^5 times the higher orders, which are subtracted. If the residual grows by more than
/// [`CURVATURE_RATIO`], as at a jump of the curvature, the noise is reported as 0. Each aspect
/// ratio gives medians over the stations. Curvature only adds to a residual, so the ratio with the
/// smallest residual of 2n nodes is used; of ratios that agree within [`EQUAL_RESIDUAL`], the one
/// with the smallest subtraction.
pub fn noise_of_faces<const N: usize>(points: &[[f64; 3]], faces: &[[usize; N]]) -> Option<Noise> {
    let mut nodes = nodes_of(points, faces);
    nodes.sort_by(|a, b| a.at[0].total_cmp(&b.at[0]));
    let [[from, to], [low, high]] = [0, 2].map(|axis| range(nodes.iter().map(|n| n.at[axis])));
    let numbered = nodes.iter().enumerate().map(|(k, node)| (k, node.at));
    let lowest = lowest_of_stations(numbered, |x| (x - from) / (to - from));
    let medians = ASPECT_RATIOS.iter().filter_map(|&ratio| {
        let residuals = |&node: &usize| residuals_at(&nodes, node, ratio);
        let found: Vec<[f64; 3]> = lowest.par_iter().filter_map(residuals).collect();
        // If only a few stations have a fit, they are not typical of the surface.
        let usual = 2 * found.len() >= lowest.len();
        let median = |k: usize| median(found.iter().map(|of| of[k]).collect());
        Some([median(0)?, median(1)?, median(2)?]).filter(|_| usual)
    });
    let medians: Vec<[f64; 3]> = medians.collect();
    let least = medians.iter().map(|of| of[2]).reduce(f64::min)?;
    let equal = medians.iter().filter(|of| of[2] <= EQUAL_RESIDUAL * least);
    let &[residual, curvature, farther] = equal.min_by(|a, b| a[1].total_cmp(&b[1]))?;
    let least = rounding(high - low);
    let shows = |value: f64| if value > least { value } else { 0.0 };
    let (noise, unseen) = if farther > CURVATURE_RATIO * residual {
        (0.0, residual)
    } else {
        // The residual of twice as many nodes contains the noise, too, which is not curvature.
        let part = 1.0 - (curvature / farther).powi(2);
        let square = (residual * residual - curvature * curvature) / part;
        (square.max(0.0).sqrt(), curvature)
    };
    Some(Noise {
        found: shows(noise),
        unseen: shows(unseen),
    })
}

/// Sizes of a face along x and y.
fn size_of<const N: usize>(corners: [[f64; 3]; N]) -> [f64; 2] {
    [0, 1].map(|axis| {
        let [low, high] = range(corners.map(|corner| corner[axis]));
        high - low
    })
}

/// The lowest of the points at each station along the hull; `share` is the fraction of its length
/// up to x.
pub(crate) fn lowest_of_stations<T: Copy>(
    points: impl Iterator<Item = (T, [f64; 3])>,
    share: impl Fn(f64) -> f64,
) -> Vec<T> {
    let mut lowest: Vec<Option<(T, f64)>> = vec![None; STATIONS];
    for (point, [x, _, z]) in points {
        let station = ((share(x) * STATIONS as f64) as usize).min(STATIONS - 1);
        if lowest[station].is_none_or(|(_, least)| z < least) {
            lowest[station] = Some((point, z));
        }
    }
    let lowest = lowest.into_iter().flatten();
    lowest.map(|(point, _)| point).collect()
}

/// The nodes of some faces, in the points' order.
fn nodes_of<const N: usize>(points: &[[f64; 3]], faces: &[[usize; N]]) -> Vec<Node> {
    let mut reach: Vec<Option<[f64; 2]>> = vec![None; points.len()];
    for face in faces {
        let size = size_of(face.map(|corner| points[corner]));
        for &corner in face {
            let before = reach[corner].unwrap_or_default();
            reach[corner] = Some([0, 1].map(|axis| before[axis].max(size[axis])));
        }
    }
    let nodes = points.iter().zip(reach);
    let node = |(&at, faces): (&[f64; 3], Option<_>)| faces.map(|faces| Node { at, faces });
    nodes.filter_map(node).collect()
}

/// Residual of the polynomial around one node, the contribution of curvature, and the residual of
/// twice as many nodes [m]; `None` if the nodes do not determine the polynomial.
fn residuals_at(nodes: &[Node], node: usize, ratio: f64) -> Option<[f64; 3]> {
    let [x, y, z] = nodes[node].at;
    // Squares of distances.
    let far = |p: &Node| ((p.at[0] - x) / ratio).powi(2) + (p.at[1] - y).powi(2);
    // Excludes parts of the hull above.
    let same_side = |p: &&Node| {
        let above = (p.at[2] - z).max(0.0);
        above * above <= (p.at[0] - x).powi(2) + (p.at[1] - y).powi(2)
    };
    let by_distance = |a: &(f64, Node), b: &(f64, Node)| a.0.total_cmp(&b.0);
    // Nodes are sorted along the underside: the range grows until its ends are farther than the
    // nodes found.
    let mut half = FIRST;
    let mut near: Vec<(f64, Node)> = loop {
        let (from, to) = (node.saturating_sub(half), (node + half).min(nodes.len()));
        let part = nodes[from..to].iter().filter(same_side);
        let mut near: Vec<(f64, Node)> = part.map(|p| (far(p), *p)).collect();
        let whole = from == 0 && to == nodes.len();
        let width = |end: usize| match nodes.get(end) {
            Some(node) if end > 0 => ((node.at[0] - x) / ratio).powi(2),
            _ => f64::INFINITY,
        };
        let least = width(from).min(width(to));
        let enough = near.len() >= 2 * NEAR && {
            let (_, last, _) = near.select_nth_unstable_by(2 * NEAR - 1, by_distance);
            last.0 * (1.0 + TIE) < least
        };
        if whole || enough {
            break near;
        }
        half *= 4;
    };
    let mut nearest = |count: usize| {
        let last = count.checked_sub(1).filter(|&last| last < near.len())?;
        let (_, &mut (reach, _), _) = near.select_nth_unstable_by(last, by_distance);
        // All nodes at the same distance, since their order is arbitrary.
        let within = reach * (1.0 + TIE);
        let among = near.iter().filter(|(far, _)| *far <= within);
        let among: Vec<Node> = among.map(|(_, p)| *p).collect();
        Some((reach, residual_of(&among)?))
    };
    let (inner, residual) = nearest(NEAR)?;
    let (outer, farther) = nearest(2 * NEAR)?;
    Some([residual, (inner / outer).powf(2.5) * farther, farther])
}

/// Standard deviation of the residuals of a polynomial fitted to some nodes [m]; `None` if the
/// nodes do not determine it, or if it is steeper than the underside.
///
/// Noise may also move the nodes of one line sideways, in proportion to their heights. As positions
/// across, these would be fitted by a surface that is steeper than any underside.
fn residual_of(nodes: &[Node]) -> Option<f64> {
    let mut places: Vec<[f64; 2]> = nodes.iter().map(|node| [node.at[0], node.at[1]]).collect();
    straighten(&mut places);
    let heights: Vec<f64> = nodes.iter().map(|node| node.at[2]).collect();
    // n lines of nodes determine n powers of the coordinate across them.
    let mut lines = [0; 2];
    for (axis, lines) in lines.iter_mut().enumerate() {
        let apart = LINE_DISTANCE * median(nodes.iter().map(|node| node.faces[axis]).collect())?;
        let mut values: Vec<f64> = places.iter().map(|p| p[axis]).collect();
        values.sort_by(f64::total_cmp);
        values.dedup_by(|b, a| *b - *a <= apart);
        *lines = values.len() as i32;
    }
    let determined = |[i, j]: &[i32; 2]| *i < lines[0] && *j < lines[1];
    let powers: Vec<[i32; 2]> = POWERS.into_iter().filter(determined).collect();
    let fitted = fit(&places, &heights, &powers)?;
    let slope = |p: &[f64; 2], axis: usize| -> f64 {
        let terms = powers.iter().zip(&fitted.coefficients);
        let terms = terms.filter(|(power, _)| power[axis] > 0);
        let derived = terms.map(|(power, c)| {
            let [own, other] = [power[axis], power[1 - axis]];
            c * f64::from(own) * p[axis].powi(own - 1) * p[1 - axis].powi(other)
        });
        derived.sum()
    };
    let steep = |p: &[f64; 2]| slope(p, 0).hypot(slope(p, 1)) > STEEPEST;
    (!places.iter().any(steep)).then_some(fitted.deviation)
}

/// Subtracts from places their mean, and from those along the shorter axis their regression line on
/// the longer one: lines of nodes may run at an angle to the axes.
fn straighten(places: &mut [[f64; 2]]) {
    let mean = |axis: usize| places.iter().map(|p| p[axis]).sum::<f64>() / places.len() as f64;
    let middle = [mean(0), mean(1)];
    for p in &mut *places {
        (p[0], p[1]) = (p[0] - middle[0], p[1] - middle[1]);
    }
    let product = |a: usize, b: usize| places.iter().map(|p| p[a] * p[b]).sum::<f64>();
    let squares = [product(0, 0), product(1, 1)];
    let long = usize::from(squares[0] < squares[1]);
    let slope = product(0, 1) / squares[long].max(f64::MIN_POSITIVE);
    for p in places {
        p[1 - long] -= slope * p[long];
    }
}

/// Median of some values (the upper one of an even number); `None` without values.
pub(crate) fn median(mut values: Vec<f64>) -> Option<f64> {
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// A polynomial fitted to values at places: its coefficients with their standard errors, and the
/// residuals.
#[derive(Clone, Debug)]
pub struct Fitted {
    /// One coefficient per power.
    pub coefficients: Vec<f64>,
    /// Their standard errors.
    pub errors: Vec<f64>,
    /// Standard deviation of the residuals.
    pub deviation: f64,
}

/// Fits the sum of c x^i y^j over `powers` [i, j] by least squares; `None` if the places do not
/// determine it with ten degrees of freedom.
pub fn fit(places: &[[f64; 2]], values: &[f64], powers: &[[i32; 2]]) -> Option<Fitted> {
    let spare = values.len().checked_sub(powers.len())?;
    if spare < 10 {
        return None;
    }
    let mean = |axis: usize| places.iter().map(|p| p[axis]).sum::<f64>() / places.len() as f64;
    let centre = [mean(0), mean(1)];
    let scale = [0, 1].map(|axis| {
        let off = |p: &[f64; 2]| (p[axis] - centre[axis]).abs();
        let scale = places.iter().map(off).fold(0.0, f64::max);
        if scale > 0.0 { scale } else { 1.0 }
    });
    let term = |p: &[f64; 2], [i, j]: [i32; 2]| {
        let [u, v] = [0, 1].map(|axis| (p[axis] - centre[axis]) / scale[axis]);
        u.powi(i) * v.powi(j)
    };
    let design = DMatrix::from_fn(places.len(), powers.len(), |k, n| {
        term(&places[k], powers[n])
    });
    let values = DVector::from_column_slice(values);
    let normal = (design.transpose() * &design).cholesky()?;
    let coefficients = normal.solve(&(design.transpose() * &values));
    let squares = (&design * &coefficients - values).norm_squared();
    let deviation = (squares / spare as f64).sqrt();
    let inverse = normal.inverse();
    let unit = |n: usize| scale[0].powi(powers[n][0]) * scale[1].powi(powers[n][1]);
    let each = |of: &dyn Fn(usize) -> f64| (0..powers.len()).map(|n| of(n) / unit(n)).collect();
    Some(Fitted {
        coefficients: each(&|n| coefficients[n]),
        errors: each(&|n| deviation * inverse[(n, n)].sqrt()),
        deviation,
    })
}

/// Length along x [m] of the underside's triangles if most of them are long strips, as CAD programs
/// produce for a surface with little curvature along x: at least a twentieth of the hull long, and
/// twenty times as long as wide. `None` otherwise.
pub fn strips_of_hull(hull: &Hull) -> Option<f64> {
    const MANY: f64 = 20.0;
    let [low, high] = hull.bounds();
    let down = hull.triangles.iter().filter(|t| faces_down(hull, t));
    let sizes = down.map(|t| size_of(t.map(|i| hull.positions[i as usize])));
    let sizes: Vec<[f64; 2]> = sizes.collect();
    let [long, wide] = [0, 1].map(|axis| median(sizes.iter().map(|size| size[axis]).collect()));
    let (long, wide) = (long?, wide?);
    (MANY * long > high[0] - low[0] && long > MANY * wide).then_some(long)
}

/// Warning about a hull whose triangles are strips of this length along x [m].
pub fn strips_warning(length: f64) -> String {
    format!(
        "the underside's triangles are strips of {:.0} mm along the runner: export it with edges of a \
         few millimetres along",
        1e3 * length
    )
}

/// Number of places along the keel at which the vertices are examined.
const PLACES: usize = 9;
/// Ratio of half the length of such a place to the length of the hull.
const LONG: f64 = 0.01;
/// Ratio of half its width to the radius of the section.
const WIDE: f64 = 0.3;

/// Median length of the triangles' edges near the keel [m], of a hull in metres, x forward and z
/// up, whose section has this radius [m] where it is lowest; `None` if no triangle touches the
/// examined places along the keel.
pub fn keel_spacing(hull: &Hull, section_radius: f64) -> Option<f64> {
    let [low, high] = hull.bounds();
    let length = high[0] - low[0];
    let half = [LONG * length, WIDE * section_radius];
    let corner = |i: u32| Vector3::from(hull.positions[i as usize]);
    let mut edges = Vec::new();
    for k in 0..PLACES {
        let x = low[0] + length * (0.1 + 0.8 * k as f64 / (PLACES - 1) as f64);
        let along = |x_p: f64| (x_p - x).abs() <= half[0];
        let here = hull.positions.iter().filter(|p| along(p[0]));
        let Some(keel) = here.min_by(|a, b| a[2].total_cmp(&b[2])) else {
            continue;
        };
        let near = |p: Vector3<f64>| {
            along(p.x) && (p.y - keel[1]).abs() <= half[1] && p.z - keel[2] < half[1]
        };
        let touches = |t: &&[u32; 3]| t.iter().any(|&i| near(corner(i)));
        for [a, b, c] in hull.triangles.iter().filter(touches).map(|t| t.map(corner)) {
            edges.extend([(a, b), (b, c), (c, a)].map(|(a, b)| (a - b).norm()));
        }
    }
    median(edges)
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;
    use crate::hull::tessellate::tessellate;
    use crate::scan::turned;
    use crate::shapes::swept::{BobRunner, LugeSteel};

    const KINDS: [bool; 2] = [false, true];

    /// A grid of faces over `height`, of four corners or as triangles, its lines closer together in
    /// the middle, nodes off them by `skewed` of their distance and off the surface by noise.
    fn noise_of(
        [nx, ny]: [usize; 2],
        [long, wide]: [f64; 2],
        [skewed, noise]: [f64; 2],
        triangles: bool,
        height: impl Fn(f64, f64) -> f64,
    ) -> Option<Noise> {
        let mut random = ChaCha8Rng::seed_from_u64(20_261_123);
        let at = |half: f64, k: usize, n: usize, off: f64| {
            let s = (2.0 * k as f64 + off) / n as f64 - 1.0;
            half * s * (0.3 + 0.7 * s.abs())
        };
        let mut points = Vec::new();
        for i in 0..=nx {
            for j in 0..=ny {
                let [a, b, c]: [f64; 3] = [0; 3].map(|_| StandardNormal.sample(&mut random));
                let x = at(long, i, nx, skewed * a);
                let y = at(wide, j, ny, skewed * b);
                points.push([x, y, height(x, y) + noise * c]);
            }
        }
        let faces = (0..nx * ny).map(|k| {
            let a = k / ny * (ny + 1) + k % ny;
            [a, a + ny + 1, a + ny + 2, a + 1]
        });
        let faces: Vec<[usize; 4]> = faces.collect();
        if !triangles {
            return noise_of_faces(&points, &faces);
        }
        let halves = faces
            .iter()
            .flat_map(|f| [[0, 2, 1], [0, 3, 2]].map(|k| k.map(|k| f[k] as u32)));
        noise_of_hull(&Hull {
            triangles: halves.collect(),
            positions: points,
        })
    }

    #[test]
    fn noise_is_found_and_curvature_is_none() {
        let round = |x: f64, y: f64| x * x / 16.0 + 0.005 - (25e-6 - y * y).sqrt();
        let ball = |x: f64, y: f64| 0.5 - (0.25 - x * x - y * y).sqrt();
        for (cells, size, height) in [
            ([44, 40], [0.1, 0.0035], &round as &dyn Fn(f64, f64) -> f64),
            ([24, 12], [0.1, 0.004], &round),
            ([30, 30], [0.03, 0.03], &ball),
        ] {
            for (skewed, triangles) in [0.0, 0.2]
                .into_iter()
                .flat_map(|s| KINDS.map(|kind| (s, kind)))
            {
                let of = |noise| {
                    let found = noise_of(cells, size, [skewed, noise], triangles, height);
                    found.expect("a grid").found
                };
                let case = format!("{cells:?} {skewed} {triangles}");
                assert_eq!(of(0.0), 0.0, "{case}");
                for noise in [2e-7, 1e-6, 5e-6] {
                    let found = of(noise) / noise;
                    println!("{case} {noise}: {found}");
                    assert!((found - 1.0).abs() < 0.25, "{case} {noise}: {found}");
                }
            }
        }
        // Three cells are too few.
        assert_eq!(noise_of([3, 3], [0.1, 0.003], [0.0; 2], false, round), None);
    }

    /// Two millimetres between the vertices of a section of five: lines along the runner show what
    /// places as long as wide do not.
    #[test]
    fn far_between_vertices_show_noise_along_a_runner() {
        let runner = BobRunner::default().swept().expect("a runner");
        let hull = tessellate(&runner, 2e-3).expect("a hull");
        let with = |noise: f64| {
            let mut hull = hull.clone();
            let mut random = ChaCha8Rng::seed_from_u64(20_261_130);
            for p in &mut hull.positions {
                let drawn: f64 = StandardNormal.sample(&mut random);
                p[2] += noise * drawn;
            }
            noise_of_hull(&hull).expect("enough vertices")
        };
        let clean = with(0.0);
        println!("{clean:?}");
        assert!(clean.found == 0.0 && clean.unseen < 1e-8, "{clean:?}");
        for noise in [3e-8, 1e-7, 1e-6] {
            let found = with(noise);
            println!("{noise}: {found:?}");
            assert!(
                (found.found / noise - 1.0).abs() < 0.15,
                "{noise} {found:?}"
            );
        }
    }

    /// A grid that is turned after it was scanned: its lines run at an angle to the axes, and noise
    /// has moved its nodes along and across, too.
    #[test]
    fn noise_of_a_turned_grid_is_found() {
        for angles in [
            [0.0, 0.0, 0.01],
            [0.02, 0.003, 0.01],
            [0.05, 0.0, -0.05],
            [-0.01, 0.0, 0.2],
        ] {
            for noise in [0.0, 1e-6, 5e-6] {
                let mut random = ChaCha8Rng::seed_from_u64(20_261_128);
                let at = |n: usize, step: f64, k: usize| step * (k as f64 - 0.5 * n as f64);
                let (nx, ny) = (600, 26);
                let points = (0..(nx + 1) * (ny + 1)).map(|k| {
                    let (x, y) = (at(nx, 4e-4, k / (ny + 1)), at(ny, 3e-4, k % (ny + 1)));
                    let drawn: f64 = StandardNormal.sample(&mut random);
                    let z = x * x / 60.0 + 0.006 - (36e-6 - y * y).sqrt() + noise * drawn;
                    turned([x, y, z], angles)
                });
                let points: Vec<[f64; 3]> = points.collect();
                let faces = (0..nx * ny).map(|k| {
                    let a = k / ny * (ny + 1) + k % ny;
                    [a, a + ny + 1, a + ny + 2, a + 1]
                });
                let faces: Vec<[usize; 4]> = faces.collect();
                let found = noise_of_faces(&points, &faces).expect("a grid");
                println!("{angles:?} {noise}: {found:?}");
                assert!(
                    (found.found - noise).abs() <= 0.15 * noise,
                    "{noise}: {found:?}"
                );
                assert!(found.unseen <= 0.3 * noise, "{found:?}");
            }
        }
    }

    /// Noise along the normals moves the vertices of a line across, too, in proportion to their
    /// heights.
    #[test]
    fn noise_along_normals_is_found() {
        let bob = BobRunner {
            length: 0.3,
            ..Default::default()
        };
        let steel = LugeSteel {
            length: 0.2,
            ..Default::default()
        };
        for (name, runner) in [("bob", bob.swept()), ("luge", steel.swept())] {
            let hull = tessellate(&runner.expect("a runner"), 2e-4).expect("a hull");
            let mut normals = vec![[0.0; 3]; hull.positions.len()];
            for t in &hull.triangles {
                let normal = hull.normal(t);
                t.iter()
                    .for_each(|&c| (0..3).for_each(|k| normals[c as usize][k] += normal[k]));
            }
            let clean = noise_of_hull(&hull).expect("enough vertices");
            assert!(
                clean.found == 0.0 && clean.unseen < 2e-8,
                "{name} {clean:?}"
            );
            for (noise, seed) in [
                (1e-6, 1),
                (2e-6, 2),
                (5e-6, 3),
                (5e-6, 4),
                (5e-6, 5),
                (5e-6, 6),
            ] {
                let mut random = ChaCha8Rng::seed_from_u64(seed);
                let mut scan = hull.clone();
                for (p, normal) in scan.positions.iter_mut().zip(&normals) {
                    let drawn: f64 = StandardNormal.sample(&mut random);
                    let length = normal.iter().map(|v| v * v).sum::<f64>().sqrt();
                    (0..3).for_each(|k| p[k] += noise * drawn * normal[k] / length);
                }
                let found = noise_of_hull(&scan).expect("enough vertices");
                let off = found.found / noise - 1.0;
                assert!(off.abs() < 0.15, "{name} {noise}: {found:?}");
            }
        }
    }
}
