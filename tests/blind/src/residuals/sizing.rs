//! How large an effect is to be for a share of the noise's variance.

/// The requirement on a size.
#[derive(Debug, Clone, Copy)]
pub struct Wanted {
    /// Share of the noise's variance.
    pub share: f64,
    /// Relative error that is let pass.
    pub within: f64,
    /// Least and largest size.
    pub bounds: [f64; 2],
}

/// Looks for the size with this share, from `start` on, and gives it with the share that it has;
/// within the bounds if none there has it.
///
/// Steps along `share ~ size^power`, the power taken from the last two sizes: some effects grow
/// with the square of their parameter, or saturate. A share that is not a number means that the sled
/// slid away: nothing as large is tried again.
pub fn sized(
    start: f64,
    mut power: f64,
    wanted: Wanted,
    mut share: impl FnMut(f64) -> f64,
) -> (f64, f64) {
    let [low, mut high] = wanted.bounds;
    let mut size = start.clamp(low, high);
    let mut reached = share(size);
    for _ in 0..8 {
        if reached.is_nan() {
            high = 0.7 * size;
            size = high;
            reached = share(size);
            continue;
        }
        if reached <= 0.0 || (reached / wanted.share - 1.0).abs() < wanted.within {
            break;
        }
        let old = (size, reached);
        size = (size * (wanted.share / reached).powf(1.0 / power)).clamp(low, high);
        if size == old.0 {
            break;
        }
        reached = share(size);
        let slope = (reached / old.1).ln() / (size / old.0).ln();
        power = if slope.is_finite() {
            power.signum() * (slope * power.signum()).clamp(1.0, 6.0)
        } else {
            2.0 * power.signum()
        };
    }
    (size, reached)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_size_has_the_share_asked_for_or_stands_at_its_bound() {
        let solved = |bounds, start, power, law: &dyn Fn(f64) -> f64| {
            let wanted = Wanted {
                share: 0.02,
                within: 0.01,
                bounds,
            };
            sized(start, power, wanted, law)
        };
        // Linear at first, then with the square of the parameter.
        let (size, share) = solved([0.0, 5.0], 0.01, 2.0, &|x| (0.1 * x + 0.5 * x * x).powi(2));
        assert!((share / 0.02 - 1.0).abs() < 0.01 && size < 1.0);
        // A limit: the lower, the more.
        let (size, share) = solved([0.1, 20.0], 1.0, -4.0, &|x| 1e-3 / (x * x * x * x));
        assert!((share / 0.02 - 1.0).abs() < 0.01 && size < 1.0);
        assert_eq!(solved([0.0, 0.3], 0.1, 2.0, &|x| 0.1 * x * x).0, 0.3);
        // Slides away from 0.5 on.
        let (size, share) = solved([0.0, 9.0], 2.0, 2.0, &|x| {
            if x > 0.5 { f64::NAN } else { 0.01 * x }
        });
        assert!(share.is_finite() && size <= 0.5);
    }
}
