//! Contour lines by marching squares.

/// Segments of the line where values on a grid equal `level`, in columns and rows of the grid.
///
/// Each square of four nodes gives its crossings by linear interpolation; the two segments of a
/// saddle are paired by the mean of the square.
pub fn contour(
    [columns, rows]: [usize; 2],
    value: impl Fn(usize, usize) -> f64,
    level: f64,
) -> Vec<[(f64, f64); 2]> {
    let mut segments = Vec::new();
    for j in 0..rows.saturating_sub(1) {
        for i in 0..columns.saturating_sub(1) {
            // Corners counter-clockwise from the lower left; edge k runs from corner k to corner k
            // + 1.
            let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
            let values = corners.map(|(i, j)| value(i, j));
            let above = values.map(|value| value > level);
            let crossing = |k: usize| {
                let (a, b) = (k, (k + 1) % 4);
                let share = (level - values[a]) / (values[b] - values[a]);
                let along =
                    |from: usize, to: usize| from as f64 + share * (to as f64 - from as f64);
                (
                    along(corners[a].0, corners[b].0),
                    along(corners[a].1, corners[b].1),
                )
            };
            let crossed: Vec<usize> = (0..4).filter(|&k| above[k] != above[(k + 1) % 4]).collect();
            let pairs: &[(usize, usize)] = match crossed[..] {
                [a, b] => &[(a, b)],
                [_, _, _, _] if (values.iter().sum::<f64>() > 4.0 * level) == above[0] => {
                    &[(0, 1), (2, 3)]
                }
                [_, _, _, _] => &[(3, 0), (1, 2)],
                _ => &[],
            };
            segments.extend(pairs.iter().map(|(a, b)| [crossing(*a), crossing(*b)]));
        }
    }
    segments
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_contour_of_a_cone_is_a_circle() {
        let cone = |i: usize, j: usize| 100.0 - (i as f64 - 100.0).hypot(j as f64 - 100.0);
        let segments = contour([201, 201], cone, 50.0);
        let lengths = segments.iter().map(|[a, b]| (a.0 - b.0).hypot(a.1 - b.1));
        let length: f64 = lengths.sum();
        assert!(
            (length / (100.0 * std::f64::consts::PI) - 1.0).abs() < 1e-3,
            "{length}"
        );
        let off = |(x, y): &(f64, f64)| ((x - 100.0).hypot(y - 100.0) - 50.0).abs();
        assert!(segments.iter().flatten().all(|at| off(at) < 0.1));
    }

    /// Rows: 1 0, 0 1; their mean 0.5 is above 0.4, so the low corners are cut off.
    #[test]
    fn a_saddle_separates_its_low_corners() {
        let segments = contour([2, 2], |i, j| f64::from(u8::from(i == j)), 0.4);
        let near = |corner: (f64, f64), [a, b]: &[(f64, f64); 2]| {
            [a, b]
                .iter()
                .all(|at| (at.0 - corner.0).abs() + (at.1 - corner.1).abs() < 0.5)
        };
        assert_eq!(segments.len(), 2);
        assert!(
            segments.iter().any(|s| near((1.0, 0.0), s))
                && segments.iter().any(|s| near((0.0, 1.0), s))
        );
    }
}
