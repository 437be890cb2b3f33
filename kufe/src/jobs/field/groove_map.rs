//! `groove.exr`: plastic depth of the ice on the pixels of the pressure map.

use kufe_contact::{PressureMap, SurfaceField};

/// Depth at the pixels' centres [m], row by row: linear between the nodes of `field`, as at its rim beyond it.
pub fn depths(map: &PressureMap, field: &SurfaceField, depth: &[f64]) -> Vec<f64> {
    let columns = places(&field.x, map.x0, map.dx, map.nx);
    let rows = places(&field.y, map.y0, map.dy, map.ny);
    let nx = field.x.len();
    let mut pixels = Vec::with_capacity(map.nx * map.ny);
    for &(j, v) in &rows {
        for &(i, u) in &columns {
            let along = |j: usize| (1.0 - u) * depth[j * nx + i] + u * depth[j * nx + i + 1];
            pixels.push((1.0 - v) * along(j) + v * along(j + 1));
        }
    }
    pixels
}

/// For each pixel the node before it and the share of the way to the next one.
fn places(nodes: &[f64], first: f64, step: f64, count: usize) -> Vec<(usize, f64)> {
    let place = |k: usize| {
        let at = first + k as f64 * step;
        let i = nodes
            .partition_point(|&node| node <= at)
            .clamp(1, nodes.len() - 1)
            - 1;
        (
            i,
            ((at - nodes[i]) / (nodes[i + 1] - nodes[i])).clamp(0.0, 1.0),
        )
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::hertz_map::hertz_map;

    #[test]
    fn a_depth_that_is_linear_is_so_at_every_pixel() {
        let map = hertz_map();
        let [width, height] = [map.nx as f64 * map.dx, map.ny as f64 * map.dy];
        let x: Vec<f64> = (0..5)
            .map(|i| map.x0 + width * (f64::from(i) - 1.0) / 3.0)
            .collect();
        let y: Vec<f64> = (0..5)
            .map(|j| map.y0 + height * (f64::from(j) - 1.0) / 3.0)
            .collect();
        let linear = |x: f64, y: f64| 1e-5 + 2e-4 * x - 3e-3 * y;
        let depth: Vec<f64> = (0..25).map(|k| linear(x[k % 5], y[k / 5])).collect();
        let field = SurfaceField {
            pressure: vec![0.0; 25],
            gap: vec![0.0; 25],
            yielded: vec![0.0; 25],
            uz: vec![0.0; 25],
            x,
            y,
        };
        for (k, found) in depths(&map, &field, &depth).iter().enumerate() {
            let at = linear(
                map.x0 + (k % map.nx) as f64 * map.dx,
                map.y0 + (k / map.nx) as f64 * map.dy,
            );
            assert!((found - at).abs() < 1e-15);
        }
    }
}
