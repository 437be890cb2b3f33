//! A solved pressure on the pixels of a measured map.
//!
//! The square of a contact pressure is smooth across the rim (in Hertz's contact it is a
//! paraboloid), the pressure is not. The square, continued beyond the rim ([`squared_pressure`]),
//! is interpolated between nodes, and its root is averaged over a pixel. Farther out the square is
//! NaN and the pressure 0.

use kufe::case::effects::Map;
use kufe_contact::{SurfaceField, squared_pressure};

/// Points per pixel in each direction.
const POINTS: [f64; 3] = [-1.0 / 3.0, 0.0, 1.0 / 3.0];

/// The pressure, limited to the strength of the ice `bound` [Pa], on the pixels of `like` [Pa].
pub fn sample(surface: &SurfaceField, bound: f64, like: &Map) -> Map {
    let square = squared_pressure(surface, bound);
    let nx = surface.x.len();
    let places = |nodes: &[f64], from: f64, step: f64, count: usize| -> Vec<Option<(usize, f64)>> {
        (0..count)
            .flat_map(|i| POINTS.map(|u| from + (i as f64 + u) * step))
            .map(|x| {
                let at = nodes.partition_point(|n| *n <= x);
                (at > 0 && at < nodes.len())
                    .then(|| (at - 1, (x - nodes[at - 1]) / (nodes[at] - nodes[at - 1])))
            })
            .collect()
    };
    let along = places(&surface.x, like.x0, like.dx, like.nx);
    let across = places(&surface.y, like.y0, like.dy, like.ny);
    let value = |x: Option<(usize, f64)>, y: Option<(usize, f64)>| -> f64 {
        let (Some((i, a)), Some((j, b))) = (x, y) else {
            return 0.0;
        };
        let q = |i: usize, j: usize| square[j * nx + i];
        let lower = (1.0 - a) * q(i, j) + a * q(i + 1, j);
        let upper = (1.0 - a) * q(i, j + 1) + a * q(i + 1, j + 1);
        ((1.0 - b) * lower + b * upper).max(0.0).sqrt().min(bound)
    };
    let mut map = like.clone();
    let per_pixel = (POINTS.len() * POINTS.len()) as f64;
    for j in 0..map.ny {
        for i in 0..map.nx {
            let mut sum = 0.0;
            for y in &across[POINTS.len() * j..][..POINTS.len()] {
                for x in &along[POINTS.len() * i..][..POINTS.len()] {
                    sum += value(*x, *y);
                }
            }
            map.pressure[j * map.nx + i] = sum / per_pixel;
        }
    }
    map
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hertz_ellipse_on_few_nodes_is_sampled_up_to_its_rim() {
        // Seven cells over the half axis, the rim between two nodes.
        let nodes = |half: f64| -> Vec<f64> {
            (-10..=10)
                .map(|k| f64::from(k) * half / 7.3)
                .collect::<Vec<_>>()
        };
        let (a, b) = (0.02, 1e-4);
        let exact = |x: f64, y: f64| (1.0 - (x / a).powi(2) - (y / b).powi(2)).max(0.0).sqrt();
        let (x, y) = (nodes(a), nodes(b));
        let pressure: Vec<f64> = y
            .iter()
            .flat_map(|y| x.iter().map(move |x| (*x, *y)))
            .map(|(x, y)| exact(x, y))
            .collect();
        let surface = SurfaceField {
            gap: vec![0.0; pressure.len()],
            yielded: vec![0.0; pressure.len()],
            uz: vec![0.0; pressure.len()],
            x,
            y,
            pressure,
        };
        let like = Map {
            nx: 60,
            ny: 60,
            x0: -1.2 * a,
            y0: -1.2 * b,
            dx: 0.04 * a,
            dy: 0.04 * b,
            pressure: vec![0.0; 3600],
        };
        let map = sample(&surface, f64::INFINITY, &like);
        let mut worst = 0.0_f64;
        for j in 0..60 {
            for i in 0..60 {
                let (x, y) = (like.x0 + i as f64 * like.dx, like.y0 + j as f64 * like.dy);
                let mean = POINTS
                    .iter()
                    .flat_map(|u| POINTS.map(|v| exact(x + u * like.dx, y + v * like.dy)))
                    .sum::<f64>()
                    / 9.0;
                worst = worst.max((map.pressure[j * 60 + i] - mean).abs());
            }
        }
        // Bilinear in p^2 with cells of 1/7.3: an error of (1/7.3)^2/4 of p0^2; at the rim its
        // root's share of a pixel.
        assert!(worst < 0.05, "{worst}");
    }
}
