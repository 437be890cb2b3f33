//! How noisy the nodes of an underside's faces are.

use std::collections::{BTreeSet, HashMap};

use crate::fit::fitted_underside::rounding;
use crate::scan::polynomial::fit;
use crate::scan::sampling::median;

/// Places along the underside at which its lowest node is looked at.
const PLACES: usize = 60;
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

/// Standard deviation of the heights of an underside's nodes about a smooth surface [m]; 0 where it is no more than rounding, `None` where
/// the faces are too few to tell. `points` are x forward, y left and z up [m], `faces` the nodes of each face.
///
/// At the lowest node of each place along the underside a polynomial of fourth order is fitted to it, its neighbours and theirs; what is
/// left is noise and what the surface has of higher orders. Of the latter the neighbours a round farther away leave (3/2)^5 times as
/// much, of noise as much: that part is taken off. The median over the places is told.
pub fn noise_of_faces(points: &[[f64; 3]], faces: &[[usize; 4]]) -> Option<f64> {
    let mut at_node: HashMap<usize, Vec<&[usize; 4]>> = HashMap::new();
    for face in faces {
        for node in face {
            at_node.entry(*node).or_default().push(face);
        }
    }
    let around = |nodes: &BTreeSet<usize>| -> BTreeSet<usize> {
        let faces = nodes.iter().flat_map(|node| &at_node[node]);
        faces.flat_map(|face| face.iter().copied()).collect()
    };
    let ends = |axis: usize| {
        let values = || at_node.keys().map(|node| points[*node][axis]);
        let low = values().fold(f64::INFINITY, f64::min);
        [low, values().fold(f64::NEG_INFINITY, f64::max)]
    };
    let [from, to] = ends(0);
    let mut by_height: Vec<usize> = at_node.keys().copied().collect();
    by_height.sort_by(|a, b| points[*a][2].total_cmp(&points[*b][2]).then(a.cmp(b)));
    let left = |nodes: &BTreeSet<usize>| {
        let places: Vec<[f64; 2]> = nodes.iter().map(|n| [points[*n][0], points[*n][1]]).collect();
        let heights: Vec<f64> = nodes.iter().map(|n| points[*n][2]).collect();
        Some(fit(&places, &heights, &POWERS)?.deviation)
    };
    let mut told: Vec<Option<f64>> = vec![None; PLACES];
    for node in by_height {
        let share = (points[node][0] - from) / (to - from);
        let place = ((share * PLACES as f64) as usize).min(PLACES - 1);
        if told[place].is_some() {
            continue;
        }
        let near = around(&around(&BTreeSet::from([node])));
        // Beside a rim they are fewer.
        told[place] = left(&near).map(|noise| {
            let farther = left(&around(&near)).unwrap_or(0.0);
            let bent = (2.0f64 / 3.0).powi(5) * farther;
            (noise * noise - bent * bent).max(0.0).sqrt()
        });
    }
    let noise = median(told.into_iter().flatten().collect())?;
    let [low, high] = ends(2);
    Some(if noise > rounding(high - low) { noise } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use rand::SeedableRng;
    use rand_chacha::ChaCha8Rng;
    use rand_distr::{Distribution, StandardNormal};

    use super::*;

    /// A grid of faces over `height`, its lines closer together in the middle, nodes off them by `skewed` of their distance and off the
    /// surface by noise.
    fn noise_of(
        [nx, ny]: [usize; 2],
        [long, wide]: [f64; 2],
        [skewed, noise]: [f64; 2],
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
        noise_of_faces(&points, &faces.collect::<Vec<_>>())
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
            for skewed in [0.0, 0.2] {
                let of = |noise| noise_of(cells, size, [skewed, noise], height).expect("a grid");
                assert!(of(0.0) < 2e-9, "{cells:?} {skewed}: {:e}", of(0.0));
                for noise in [5e-8, 2e-7, 1e-6, 5e-6] {
                    let found = of(noise) / noise;
                    assert!((found - 1.0).abs() < 0.2, "{cells:?} {skewed} {noise}: {found}");
                }
            }
        }
        // Four cells along are too few to tell.
        assert_eq!(noise_of([3, 8], [0.1, 0.003], [0.0; 2], round), None);
    }
}
