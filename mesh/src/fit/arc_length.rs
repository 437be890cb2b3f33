//! Arc length along the mean section of a tessellated hull.

use crate::fit::downward::Downward;
use crate::parameter::linspace;
use crate::shapes::profile::Profile;

/// Arc length along the mean section over y: facets' slopes averaged between columns of vertices, summed up.
pub(crate) fn arc_length(part: &Downward, [y0, y1]: [f64; 2], mirrored: bool) -> Profile {
    const MOST_COLUMNS: usize = 48;
    let mut ys: Vec<f64> = part.points.iter().map(|p| p[1]).collect();
    ys.sort_by(f64::total_cmp);
    let mut columns = ys.clone();
    columns.dedup_by(|b, a| *b - *a < 1e-4 * (y1 - y0));
    if columns.len() > MOST_COLUMNS {
        columns = (0..=MOST_COLUMNS)
            .map(|i| ys[i * (ys.len() - 1) / MOST_COLUMNS])
            .collect();
        columns.dedup_by(|b, a| *b - *a < 1e-3 * (y1 - y0));
    }
    if mirrored {
        let mut half: Vec<f64> = columns.iter().map(|y| y.abs()).collect();
        half.sort_by(f64::total_cmp);
        half.dedup_by(|b, a| *b - *a < 1e-3 * y1);
        half.retain(|&y| y > 1e-3 * y1 && y < y1 * (1.0 - 1e-3));
        columns = half
            .iter()
            .rev()
            .map(|y| -y)
            .chain([0.0])
            .chain(half.iter().copied())
            .collect();
    } else {
        columns.retain(|&y| y > y0 + 1e-3 * (y1 - y0) && y < y1 - 1e-3 * (y1 - y0));
    }
    columns.insert(0, y0);
    columns.push(y1);
    // Mean slope of each strip, weighted by the facets' plan areas.
    let mut strips = vec![(0.0, 0.0); columns.len() - 1];
    for facet in &part.facets {
        let [a, b, c] = facet.map(|i| part.points[i]);
        let (u, v) = (
            [b[0] - a[0], b[1] - a[1], b[2] - a[2]],
            [c[0] - a[0], c[1] - a[1], c[2] - a[2]],
        );
        let area = u[0] * v[1] - u[1] * v[0];
        let slope = (u[0] * v[2] - u[2] * v[0]) / area;
        let middle = (a[1] + b[1] + c[1]) / 3.0;
        let i = columns
            .partition_point(|&y| y <= middle)
            .clamp(1, strips.len())
            - 1;
        strips[i].0 += area.abs();
        strips[i].1 += slope.clamp(-10.0, 10.0) * area.abs();
    }
    let mut stretch: Vec<f64> = strips
        .iter()
        .map(|(area, sum)| (sum / area.max(f64::MIN_POSITIVE)).hypot(1.0))
        .collect();
    if mirrored {
        let reversed: Vec<f64> = stretch.iter().rev().copied().collect();
        stretch
            .iter_mut()
            .zip(&reversed)
            .for_each(|(s, r)| *s = 0.5 * (*s + r));
    }
    let mut lengths = vec![0.0];
    for (pair, stretch) in columns.windows(2).zip(&stretch) {
        lengths.push(lengths[lengths.len() - 1] + stretch * (pair[1] - pair[0]));
    }
    let shift = if mirrored {
        0.5 * lengths[lengths.len() - 1]
    } else {
        0.0
    };
    let points: Vec<[f64; 2]> = columns
        .iter()
        .zip(&lengths)
        .map(|(&y, &t)| [y, t - shift])
        .collect();
    let plain = || Profile::new("section", &[[y0, y0], [y1, y1]]).expect("two finite points");
    match Profile::new("section", &points) {
        Ok(map) if linspace(y0, y1, 2000).all(|y| map.evaluate(y)[1] > 0.3) => map,
        _ => plain(),
    }
}
