//! A recorded series read at a later time: what a channel that is late said then is true now.

/// A series read so many samples ahead, between samples too; constant beyond its ends.
///
/// By the polynomial of fifth order through the six nearest samples: a wave of twelve samples is right to 1e-4 of its height,
/// one of six to 5e-3.
///
/// ```
/// let ramp: Vec<f64> = (0..20).map(f64::from).collect();
/// let later = kufe_sled::effects::ahead(&ramp, 2.25);
/// assert!((later[10] - 12.25).abs() < 1e-12);
/// ```
pub fn ahead(series: &[f64], samples: f64) -> Vec<f64> {
    const FIRST: isize = -2;
    let last = series.len() as isize - 1;
    // Further than all of it is the end, and no number is too large to be one.
    let samples = samples.clamp(-(series.len() as f64), series.len() as f64);
    let whole = samples.floor();
    let part = samples - whole;
    let nodes: [f64; 6] = std::array::from_fn(|j| j as f64 + FIRST as f64);
    let weight = |j: usize| -> f64 {
        let others = nodes.iter().enumerate().filter(|(k, _)| *k != j);
        others
            .map(|(_, node)| (part - node) / (nodes[j] - node))
            .product()
    };
    let weights: [f64; 6] = std::array::from_fn(weight);
    let first = whole as isize + FIRST;
    let mut moved = vec![0.0; series.len()];
    // What has all its neighbours, without asking for the ends; then the rest.
    let whole = (-first).max(0)..(last - 4 - first).min(series.len() as isize);
    let inside = usize::try_from(whole.start).unwrap_or(0)..usize::try_from(whole.end).unwrap_or(0);
    if !inside.is_empty() {
        let from = inside.start.wrapping_add_signed(first);
        let near = series[from..].windows(6);
        for (to, near) in moved[inside.clone()].iter_mut().zip(near) {
            *to = weights.iter().zip(near).map(|(w, x)| w * x).sum();
        }
    }
    let ends =
        (0..inside.start.min(series.len())).chain(inside.end.max(inside.start)..series.len());
    for i in ends {
        let near = weights.iter().zip(i as isize + first..);
        moved[i] = near
            .map(|(w, k)| w * series[k.clamp(0, last) as usize])
            .sum();
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_wave_read_ahead_is_the_wave_a_moment_later() {
        // The remainder of a polynomial of fifth order: the product of six distances, at most 15/64 * 15 h^6 / 6!, times w^6.
        for (radians, error) in [(0.25, 3e-6), (std::f64::consts::TAU / 12.0, 2e-4)] {
            let wave = |t: f64| (radians * t).sin();
            let x: Vec<f64> = (0..200).map(|k| wave(f64::from(k))).collect();
            for by in [-20.5, -2.3, -0.4, 0.0, 0.7, 3.0, 11.6] {
                let moved = ahead(&x, by);
                for (k, moved) in moved.iter().enumerate().take(170).skip(30) {
                    let off = (moved - wave(k as f64 + by)).abs();
                    assert!(off < error, "{radians} by {by}: {off}");
                }
            }
        }
    }

    #[test]
    fn beyond_its_ends_a_series_stays_as_it_is_there() {
        let x: Vec<f64> = (0..10).map(f64::from).collect();
        assert!(ahead(&x, 1e300).iter().all(|x| *x == 9.0));
        assert!(ahead(&x, -50.0).iter().all(|x| *x == 0.0));
        assert!(ahead(&[], 3.0).is_empty());
    }
}
