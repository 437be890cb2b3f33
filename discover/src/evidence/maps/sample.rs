//! A solved pressure on the pixels of a film that lies anywhere on the runner.
//!
//! The square of a contact pressure is smooth across the rim (in Hertz's contact it is a
//! paraboloid), the pressure is not. The square, continued beyond the rim ([`squared_pressure`]),
//! is interpolated between nodes, and its root is averaged over a pixel. Farther out the square is
//! NaN and the pressure 0.

use kufe::case::effects::Map;
use kufe_contact::{SurfaceField, squared_pressure};

/// Points per pixel in each direction.
const POINTS: [f64; 3] = [-1.0 / 3.0, 0.0, 1.0 / 3.0];

/// Position of a film against the runner.
///
/// The film's point X lies at the runner's point `x = c + R(-rotation) (X - c - shift)`, where c is
/// the film's centre and R(a) rotates by a about z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FilmPosition {
    /// Shift along and across the runner [m].
    pub shift: [f64; 2],
    /// Rotation about z [rad].
    pub rotation: f64,
}

/// Centre of a film [m].
pub fn centre(film: &Map) -> [f64; 2] {
    let middle = |from: f64, pixel: f64, count: usize| from + 0.5 * (count as f64 - 1.0) * pixel;
    [
        middle(film.x0, film.dx, film.nx),
        middle(film.y0, film.dy, film.ny),
    ]
}

/// Place of the k-th pixel of a map [m].
pub fn place(map: &Map, k: usize) -> [f64; 2] {
    let (i, j) = ((k % map.nx) as f64, (k / map.nx) as f64);
    [map.x0 + i * map.dx, map.y0 + j * map.dy]
}

/// A solved pressure, as its square on the nodes of the contact plane.
pub struct SolvedPressure {
    x: Vec<f64>,
    y: Vec<f64>,
    square: Vec<f64>,
    /// Strength of the ice [Pa].
    bound: f64,
}

impl SolvedPressure {
    /// The pressure of a solution, limited to the strength of the ice `bound` [Pa].
    pub fn new(surface: &SurfaceField, bound: f64) -> Self {
        Self {
            x: surface.x.clone(),
            y: surface.y.clone(),
            square: squared_pressure(surface, bound),
            bound,
        }
    }

    /// Smallest cell along and across [m].
    pub fn smallest_cell(&self) -> [f64; 2] {
        [&self.x, &self.y].map(|nodes| {
            let cells = nodes.windows(2).map(|pair| pair[1] - pair[0]);
            cells.fold(f64::INFINITY, f64::min)
        })
    }

    /// Nodes in contact: x [m], y [m] and force [N].
    pub fn forces(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let width = |nodes: &[f64], k: usize| {
            0.5 * (nodes[(k + 1).min(nodes.len() - 1)] - nodes[k.saturating_sub(1)])
        };
        let nx = self.x.len();
        let inside = self.square.iter().enumerate().filter(|(_, q)| **q > 0.0);
        inside.map(move |(n, q)| {
            let (i, j) = (n % nx, n / nx);
            let area = width(&self.x, i) * width(&self.y, j);
            [self.x[i], self.y[j], q.sqrt().min(self.bound) * area]
        })
    }

    /// The pressure at a point of the runner [Pa].
    fn at(&self, x: f64, y: f64) -> f64 {
        let place = |nodes: &[f64], x: f64| {
            let at = nodes.partition_point(|n| *n <= x);
            (at > 0 && at < nodes.len())
                .then(|| (at - 1, (x - nodes[at - 1]) / (nodes[at] - nodes[at - 1])))
        };
        let (Some((j, b)), Some((i, a))) = (place(&self.y, y), place(&self.x, x)) else {
            return 0.0;
        };
        let q = |i: usize, j: usize| self.square[j * self.x.len() + i];
        let lower = (1.0 - a) * q(i, j) + a * q(i + 1, j);
        let upper = (1.0 - a) * q(i, j + 1) + a * q(i + 1, j + 1);
        let square = (1.0 - b) * lower + b * upper;
        square.max(0.0).sqrt().min(self.bound)
    }

    /// The pressure on the pixels of `film` in a position [Pa].
    pub fn on(&self, film: &Map, position: &FilmPosition) -> Map {
        let (sin, cos) = position.rotation.sin_cos();
        let middle = centre(film);
        let mut map = film.clone();
        for (k, pressure) in map.pressure.iter_mut().enumerate() {
            let (i, j) = ((k % film.nx) as f64, (k / film.nx) as f64);
            let mut sum = 0.0;
            for v in POINTS {
                for u in POINTS {
                    let along = film.x0 + (i + u) * film.dx - middle[0] - position.shift[0];
                    let across = film.y0 + (j + v) * film.dy - middle[1] - position.shift[1];
                    sum += self.at(
                        middle[0] + cos * along + sin * across,
                        middle[1] - sin * along + cos * across,
                    );
                }
            }
            *pressure = sum / (POINTS.len() * POINTS.len()) as f64;
        }
        map
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hertz_ellipse_on_few_nodes_is_sampled_up_to_its_rim_in_any_position() {
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
        let solved = SolvedPressure::new(&surface, f64::INFINITY);
        let like = Map {
            nx: 60,
            ny: 60,
            x0: -1.2 * a,
            y0: -1.2 * b,
            dx: 0.04 * a,
            dy: 0.04 * b,
            pressure: vec![0.0; 3600],
        };
        // The film's centre is not the origin.
        let c = [-0.02 * a, -0.02 * b];
        for (shift, rotation) in [([0.0, 0.0], 0.0_f64), ([0.1 * a, -0.3 * b], 0.6 * b / a)] {
            let map = solved.on(&like, &FilmPosition { shift, rotation });
            let mut worst = 0.0_f64;
            for j in 0..60 {
                for i in 0..60 {
                    let (x, y) = (like.x0 + i as f64 * like.dx, like.y0 + j as f64 * like.dy);
                    let there = |u: f64, v: f64| {
                        let along = x + u * like.dx - c[0] - shift[0];
                        let across = y + v * like.dy - c[1] - shift[1];
                        exact(
                            c[0] + along * rotation.cos() + across * rotation.sin(),
                            c[1] - along * rotation.sin() + across * rotation.cos(),
                        )
                    };
                    let mean = POINTS
                        .iter()
                        .flat_map(|u| POINTS.map(|v| there(*u, v)))
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
}
