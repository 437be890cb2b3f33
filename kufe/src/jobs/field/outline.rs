//! The line of one pressure around the contact, by marching squares.

use kufe_contact::PressureMap;

/// Segments, joined where they meet in order, of the line where the pressure equals `level` [Pa].
///
/// Each square of four pixel centres gives its crossings by linear interpolation; a saddle's two
/// segments are paired by the square's mean.
pub fn outline(map: &PressureMap, level: f64) -> Vec<[(f64, f64); 2]> {
    let mut segments = Vec::new();
    for j in 0..map.ny.saturating_sub(1) {
        for i in 0..map.nx.saturating_sub(1) {
            square(map, i, j, level, &mut segments);
        }
    }
    segments
}

fn square(map: &PressureMap, i: usize, j: usize, level: f64, segments: &mut Vec<[(f64, f64); 2]>) {
    // Corners counter-clockwise from the lower left; edge k runs from corner k to corner k + 1.
    let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
    let p = corners.map(|(i, j)| map.pressure[j * map.nx + i]);
    let above = p.map(|p| p > level);
    let crossing = |k: usize| {
        let (a, b) = (k, (k + 1) % 4);
        let t = (level - p[a]) / (p[b] - p[a]);
        let along = |from: usize, to: usize| from as f64 + t * (to as f64 - from as f64);
        (
            map.x0 + map.dx * along(corners[a].0, corners[b].0),
            map.y0 + map.dy * along(corners[a].1, corners[b].1),
        )
    };
    let crossed: Vec<usize> = (0..4).filter(|&k| above[k] != above[(k + 1) % 4]).collect();
    match crossed[..] {
        [a, b] => segments.push([crossing(a), crossing(b)]),
        [_, _, _, _] => {
            let mean_above = p.iter().sum::<f64>() / 4.0 > level;
            let pairs = if mean_above == above[0] {
                [(0, 1), (2, 3)]
            } else {
                [(3, 0), (1, 2)]
            };
            segments.extend(pairs.map(|(a, b)| [crossing(a), crossing(b)]));
        }
        _ => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cone(n: usize) -> PressureMap {
        let step = 2.0 / (n - 1) as f64;
        let at = |k: usize| -1.0 + (k as f64) * step;
        PressureMap {
            x0: -1.0,
            y0: -1.0,
            dx: step,
            dy: step,
            nx: n,
            ny: n,
            pressure: (0..n * n)
                .map(|k| 1.0 - at(k % n).hypot(at(k / n)))
                .collect(),
            gap: vec![0.0; n * n],
            uz: vec![0.0; n * n],
        }
    }

    #[test]
    fn the_outline_of_a_cone_is_a_circle_of_its_length() {
        let segments = outline(&cone(201), 0.5);
        let length: f64 = segments
            .iter()
            .map(|[a, b]| (a.0 - b.0).hypot(a.1 - b.1))
            .sum();
        assert!(
            (length / std::f64::consts::PI - 1.0).abs() < 1e-3,
            "{length}"
        );
        assert!(
            segments
                .iter()
                .flatten()
                .all(|(x, y)| (x.hypot(*y) - 0.5).abs() < 1e-3)
        );
    }

    #[test]
    fn a_saddle_keeps_its_two_sides_apart() {
        let mut map = cone(2);
        map.pressure = vec![1.0, 0.0, 1.0, 0.0];
        map.pressure.swap(2, 3);
        // Rows: [1, 0], [0, 1]; the mean 0.5 is above 0.4, so the low corners are cut off.
        let segments = outline(&map, 0.4);
        assert_eq!(segments.len(), 2);
        for [a, b] in segments {
            assert!((a.0 - b.0).hypot(a.1 - b.1) < 1.2 * std::f64::consts::SQRT_2 * 0.8);
        }
    }
}
