//! A solved pressure on the pixels of a measured map.
//!
//! The square of a contact pressure is smooth up to the rim and through it (it is a paraboloid in Hertz's contact), the
//! pressure is not: the square is continued beyond the rim, interpolated between nodes, and its root is averaged over a pixel.

use kufe_case::effects::Map;
use kufe_contact::SurfaceField;

/// Points a pixel along each direction.
const POINTS: [f64; 3] = [-1.0 / 3.0, 0.0, 1.0 / 3.0];

/// The solution's pressure on the pixels of `like` [Pa].
pub fn sample(surface: &SurfaceField, like: &Map) -> Map {
    let square = continued(surface);
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
        ((1.0 - b) * lower + b * upper).max(0.0).sqrt()
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

/// p^2 at the nodes, below 0 beside the contact: along each axis from the parabola through the three nodes behind the
/// outermost one (whose own mean reaches out of the contact), at a corner from its neighbours.
fn continued(surface: &SurfaceField) -> Vec<f64> {
    let (nx, ny) = (surface.x.len(), surface.y.len());
    let inside: Vec<f64> = surface.pressure.iter().map(|p| p * p).collect();
    let touched = |i: usize, j: usize| inside[j * nx + i] > 0.0;
    let mut square = inside.clone();
    for j in 0..ny {
        for i in 0..nx {
            if touched(i, j) {
                continue;
            }
            let (mut sum, mut count) = (0.0, 0.0);
            for (axis, nodes, at, length) in [(0, &surface.x, i, nx), (1, &surface.y, j, ny)] {
                for up in [false, true] {
                    let step = |k: usize| -> Option<usize> {
                        if up {
                            Some(at + k).filter(|n| *n < length)
                        } else {
                            at.checked_sub(k)
                        }
                    };
                    let value = |n: usize| match axis {
                        0 => inside[j * nx + n],
                        _ => inside[n * nx + i],
                    };
                    let line: Vec<(f64, f64)> = (1..=4)
                        .map_while(|k| step(k).map(|n| (nodes[n], value(n))))
                        .take_while(|(_, q)| *q > 0.0)
                        .collect();
                    if let Some(first) = line.first() {
                        sum += beyond(&line, nodes[at]).unwrap_or(-first.1).min(0.0);
                        count += 1.0;
                    }
                }
            }
            if count > 0.0 {
                square[j * nx + i] = sum / count;
            }
        }
    }
    let axis_done = square.clone();
    for j in 0..ny {
        for i in 0..nx {
            if axis_done[j * nx + i] != 0.0 {
                continue;
            }
            for (u, v) in [(-1, -1), (-1, 1), (1, -1), (1, 1)] {
                let (Some(a), Some(b)) = (
                    i.checked_add_signed(u).filter(|a| *a < nx),
                    j.checked_add_signed(v).filter(|b| *b < ny),
                ) else {
                    continue;
                };
                if touched(a, b) {
                    let q = axis_done[j * nx + a] + axis_done[b * nx + i] - axis_done[b * nx + a];
                    square[j * nx + i] = q.min(0.0);
                }
            }
        }
    }
    square
}

/// The parabola through the second to fourth point of a line, at `x`; `None` with fewer points or where it does not fall.
fn beyond(line: &[(f64, f64)], x: f64) -> Option<f64> {
    let [outermost, a, b, c] = line else {
        return None;
    };
    let d1 = (b.1 - a.1) / (b.0 - a.0);
    let d2 = ((c.1 - b.1) / (c.0 - b.0) - d1) / (c.0 - a.0);
    let value = a.1 + d1 * (x - a.0) + d2 * (x - a.0) * (x - b.0);
    (value < outermost.1).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_hertz_ellipse_on_few_nodes_is_met_up_to_its_rim() {
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
        let map = sample(&surface, &like);
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
        // Bilinear in p^2 with cells of 1/7.3: (1/7.3)^2/4 of p0^2, at the rim its root's share of a pixel.
        assert!(worst < 0.05, "{worst}");
    }
}
