//! How noisy the nodes of an underside are.

use std::collections::BTreeSet;

use crate::fit::fitted_underside::rounding;
use crate::hull::Hull;
use crate::scan::polynomial::fit;
use crate::scan::sampling::median;

/// Places along the underside at which its lowest node is looked at.
const PLACES: usize = 60;
/// Triangles whose normal is closer to level than this are flanks (cosine to straight down).
const DOWN: f64 = 0.2;
/// Fewest nodes that determine the polynomial with ten to spare.
const LEAST: usize = POWERS.len() + 10;
/// Rounds of neighbours that are too many.
const ROUNDS: i32 = 6;
/// Powers of the surface around a node: on a grid of five by five nodes they go through any sum of a line along and one across.
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

/// Standard deviation of a hull's vertices about a smooth underside [m], as [`noise_of_faces`] tells it of the triangles that face down.
pub fn noise_of_hull(hull: &Hull) -> Option<f64> {
    let faces_down = |t: &&[u32; 3]| {
        let n = hull.normal(t);
        -n[2] > DOWN * (n[0] * n[0] + n[1] * n[1] + n[2] * n[2]).sqrt()
    };
    let down = hull.triangles.iter().filter(faces_down);
    let faces: Vec<[usize; 3]> = down.map(|t| t.map(|corner| corner as usize)).collect();
    noise_of_faces(&hull.positions, &faces)
}

/// Standard deviation of the heights of an underside's nodes about a smooth surface [m]; 0 where it is no more than rounding, `None` where
/// the faces are too few to tell. `points` are x forward, y left and z up [m], `faces` the nodes of each face.
///
/// At the lowest node of each place along the underside a polynomial of fourth order is fitted to it and to rounds of neighbours, as many
/// as determine it; what is left is noise and what the surface has of higher orders. Of the latter r + 1 rounds leave ((r + 1) / r)^5 times
/// as much as r, of noise as much: that part is taken off. The median over the places is told.
pub fn noise_of_faces<const N: usize>(points: &[[f64; 3]], faces: &[[usize; N]]) -> Option<f64> {
    let around = FacesAround::new(points.len(), faces);
    let mut nodes: Vec<usize> = faces.iter().flatten().copied().collect();
    nodes.sort_unstable();
    nodes.dedup();
    let ends = |axis: usize| {
        let values = || nodes.iter().map(|node| points[*node][axis]);
        let low = values().fold(f64::INFINITY, f64::min);
        [low, values().fold(f64::NEG_INFINITY, f64::max)]
    };
    let ([from, to], [low, high]) = (ends(0), ends(2));
    nodes.sort_by(|a, b| points[*a][2].total_cmp(&points[*b][2]));
    let mut told: Vec<Option<f64>> = vec![None; PLACES];
    for node in nodes {
        let share = (points[node][0] - from) / (to - from);
        let place = ((share * PLACES as f64) as usize).min(PLACES - 1);
        if told[place].is_none() {
            told[place] = at_node(points, &around, node);
        }
    }
    let noise = median(told.into_iter().flatten().collect())?;
    Some(if noise > rounding(high - low) {
        noise
    } else {
        0.0
    })
}

/// What is noise around one node [m]; `None` beside a rim, where its neighbours are too few.
fn at_node<const N: usize>(
    points: &[[f64; 3]],
    around: &FacesAround<N>,
    node: usize,
) -> Option<f64> {
    let mut near = BTreeSet::from([node]);
    let mut rounds = 0;
    while near.len() < LEAST {
        rounds += 1;
        near = around.neighbours(&near);
        if rounds == ROUNDS {
            return None;
        }
    }
    let noise = left(points, &near)?;
    let farther = left(points, &around.neighbours(&near)).unwrap_or(0.0);
    let bent = (f64::from(rounds) / f64::from(rounds + 1)).powi(5) * farther;
    Some((noise * noise - bent * bent).max(0.0).sqrt())
}

/// What the polynomial leaves of the heights of some nodes [m].
fn left(points: &[[f64; 3]], nodes: &BTreeSet<usize>) -> Option<f64> {
    let at = || nodes.iter().map(|node| points[*node]);
    let places: Vec<[f64; 2]> = at().map(|[x, y, _]| [x, y]).collect();
    let heights: Vec<f64> = at().map(|[_, _, z]| z).collect();
    Some(fit(&places, &heights, &POWERS)?.deviation)
}

/// The faces at each node.
struct FacesAround<'a, const N: usize> {
    faces: &'a [[usize; N]],
    /// Where each node's begin in `at`, and the end of the last.
    starts: Vec<usize>,
    at: Vec<usize>,
}

impl<'a, const N: usize> FacesAround<'a, N> {
    fn new(nodes: usize, faces: &'a [[usize; N]]) -> Self {
        let mut starts = vec![0; nodes + 1];
        for node in faces.iter().flatten() {
            starts[node + 1] += 1;
        }
        for node in 0..nodes {
            starts[node + 1] += starts[node];
        }
        let mut free = starts.clone();
        let mut at = vec![0; N * faces.len()];
        for (index, face) in faces.iter().enumerate() {
            for node in face {
                at[free[*node]] = index;
                free[*node] += 1;
            }
        }
        FacesAround { faces, starts, at }
    }

    /// These nodes and those that share a face with one of them.
    fn neighbours(&self, nodes: &BTreeSet<usize>) -> BTreeSet<usize> {
        let faces = nodes
            .iter()
            .flat_map(|node| &self.at[self.starts[*node]..self.starts[node + 1]]);
        faces.flat_map(|face| self.faces[*face]).collect()
    }
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    const KINDS: [bool; 2] = [false, true];

    /// A grid of faces over `height`, of four corners or as triangles, its lines closer together in the middle, nodes off them by `skewed` of their distance and off the
    /// surface by noise.
    fn noise_of(
        [nx, ny]: [usize; 2],
        [long, wide]: [f64; 2],
        [skewed, noise]: [f64; 2],
        triangles: bool,
        height: impl Fn(f64, f64) -> f64,
    ) -> Option<f64> {
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
                    noise_of(cells, size, [skewed, noise], triangles, height).expect("a grid")
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
        // Three cells are too few to tell.
        assert_eq!(noise_of([3, 3], [0.1, 0.003], [0.0; 2], false, round), None);
    }
}
