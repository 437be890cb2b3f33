//! Places along a runner where its keel's curvature jumps.

/// A place where the keel's curvature changes at once, as where a rocker goes over into an end's radius.
///
/// A pressure has a peak there with a tip of logarithms: its slope grows like ln(distance) down to a distance
/// of the contact's half-width, however long the contact is. A mesh with cells longer than that does not see it, and
/// two such meshes agree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Corner {
    /// Where [m].
    pub at: f64,
    /// The length within which the curvature changes; 0 for a jump [m].
    pub within: f64,
}

/// Intervals in which the keel is looked at first.
const INTERVALS: usize = 1000;
/// Smallest change of the curvature that counts, over the curvature across: it moves a pressure by a few times as much.
const LEAST: f64 = 2e-3;
/// As many corners as are heeded, the largest changes first: a rough hull may have one everywhere.
const MOST: usize = 12;
/// A jump is looked for down to this step [m]: shorter ones drown in the rounding of heights.
const SHORTEST: f64 = 1e-5;

/// The corners of heights (x, y) -> z on their line along x at `y`, in order, within the extent [x low, x high, y low, y
/// high]; none where that is unbounded along x.
pub(crate) fn corners(heights: impl Fn(f64, f64) -> f64, extent: [f64; 4], y: f64) -> Vec<Corner> {
    let [low, high, right, left] = extent;
    let step = (high - low) / INTERVALS as f64;
    if !step.is_finite() {
        return Vec::new();
    }
    let keel = |x: f64| heights(x, y);
    let change =
        |x: f64, step: f64| (bend(keel, x + step, step) - bend(keel, x - step, step)).abs();
    let place = |i: usize| low + step * i as f64;
    let changes: Vec<f64> = (0..=INTERVALS).map(|i| change(place(i), step)).collect();
    // Beside a place that the hull does not reach nothing is known to be a corner.
    let inside = |i: usize| changes[i - 1..=i + 1].iter().all(|size| size.is_finite());
    // Flat sections count as round ones of their width.
    let flattest = 2.0 / (left - right);
    let counts = |i: &usize| {
        let across = bend(|y| heights(place(*i), y), y, 0.1 * step).abs();
        inside(*i)
            && changes[*i] >= changes[*i - 1]
            && changes[*i] > changes[*i + 1]
            && changes[*i] > LEAST * across.max(flattest).max(1.0)
    };
    let mut found: Vec<usize> = (1..INTERVALS).filter(counts).collect();
    found.sort_by(|&a, &b| changes[b].total_cmp(&changes[a]));
    found.truncate(MOST);
    found.sort_unstable();
    found
        .into_iter()
        .map(|i| narrowed(&change, place(i), step))
        .collect()
}

/// Curvature of a line through three points `step` apart.
fn bend(line: impl Fn(f64) -> f64, x: f64, step: f64) -> f64 {
    (line(x - step) - 2.0 * line(x) + line(x + step)) / (step * step)
}

/// Follows a change of curvature near `at` to shorter steps for as long as it stays as large: only a jump does.
fn narrowed(change: &impl Fn(f64, f64) -> f64, mut at: f64, mut step: f64) -> Corner {
    let change = |x: f64, step: f64| {
        let size = change(x, step);
        if size.is_finite() { size } else { 0.0 }
    };
    let size = change(at, step);
    while step > SHORTEST {
        let shorter = 0.5 * step;
        let places = (-8..=8).map(|i| at + 0.25 * step * f64::from(i));
        let place = places
            .max_by(|&a, &b| change(a, shorter).total_cmp(&change(b, shorter)))
            .unwrap_or(at);
        if change(place, shorter) < 0.7 * size {
            return Corner { at, within: step };
        }
        (at, step) = (place, shorter);
    }
    Corner { at, within: 0.0 }
}

#[cfg(test)]
mod tests {
    use kufe_mesh::{BobRunner, Paraboloid, Underside};

    use super::*;

    fn of(hull: &dyn Underside) -> Vec<Corner> {
        corners(|x, y| hull.height(x, y), hull.extent(), 0.0)
    }

    #[test]
    fn a_runner_has_its_corners_where_its_rocker_ends_and_a_paraboloid_has_none() {
        let runner = BobRunner::default().swept().unwrap();
        let start = 0.5 * runner.length() - runner.ends().unwrap().length;
        let found = of(&runner);
        assert_eq!(found.len(), 2, "{found:?}");
        for (corner, at) in found.iter().zip([-start, start]) {
            assert!((corner.at - at).abs() < SHORTEST, "{corner:?} {at}");
            assert_eq!(corner.within, 0.0);
        }
        assert_eq!(of(&Paraboloid::new(30.0, 0.005).unwrap()), Vec::new());
    }

    /// A keel whose curvature rises by 5 1/m within 4 mm about 0.2 m.
    struct Bent;

    impl Underside for Bent {
        fn height(&self, x: f64, y: f64) -> f64 {
            x * x / 60.0 + y * y / 0.01 + 2.5 * smooth_square(x - 0.2, 0.002)
        }
        fn extent(&self) -> [f64; 4] {
            [-0.5, 0.5, -0.005, 0.005]
        }
        fn mirror_symmetric(&self) -> [bool; 2] {
            [false, true]
        }
    }

    /// x^2 for x > 0, 0 for x < 0, with the bend spread over `width`.
    fn smooth_square(x: f64, width: f64) -> f64 {
        let ramp = 0.5 * (x + x.hypot(width));
        ramp * ramp
    }

    #[test]
    fn a_gradual_change_is_a_corner_as_wide_as_it_is() {
        let found = of(&Bent);
        assert_eq!(found.len(), 1, "{found:?}");
        assert!((found[0].at - 0.2).abs() < 0.002, "{found:?}");
        assert!((0.4e-3..4e-3).contains(&found[0].within), "{found:?}");
    }
}
