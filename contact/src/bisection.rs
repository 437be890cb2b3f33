//! Bisection of intervals.

/// The ends of an interval after `steps` bisections, each of which keeps the upper half if `below`
/// is true in the middle.
pub(crate) fn bisect(ends: [f64; 2], steps: usize, below: impl Fn(f64) -> bool) -> [f64; 2] {
    halve(ends, steps, |low, high| 0.5 * (low + high), below)
}

/// [`bisect`] for positive ends, with geometric means.
pub(crate) fn bisect_scales(ends: [f64; 2], steps: usize, below: impl Fn(f64) -> bool) -> [f64; 2] {
    halve(ends, steps, |low, high| (low * high).sqrt(), below)
}

fn halve(
    [mut low, mut high]: [f64; 2],
    steps: usize,
    middle: fn(f64, f64) -> f64,
    below: impl Fn(f64) -> bool,
) -> [f64; 2] {
    for _ in 0..steps {
        let middle = middle(low, high);
        if below(middle) {
            low = middle;
        } else {
            high = middle;
        }
    }
    [low, high]
}
