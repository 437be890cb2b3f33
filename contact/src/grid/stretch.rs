//! A stretch of an axis in contact, and the relative cell size at each place of it.

/// A stretch of one axis that is in contact.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Its start [m].
    pub low: f64,
    /// Its end [m].
    pub high: f64,
    /// Wanted spacing over the even one at places of the stretch (0 at its start, 1 at its end), in
    /// order; linear in between, constant outside the first and last; empty for 1 everywhere.
    pub sizes: Vec<[f64; 2]>,
}

/// Finest spacing over the even one.
const FINEST: f64 = 2e-4;
/// Largest change of the wanted spacing over the distance.
const GRADIENT: f64 = 0.35;
/// How much coarser than by the measure of [`wanted_sizes`] is still good.
const SLACK: f64 = 2.0;

impl Stretch {
    /// A stretch that is resolved evenly.
    pub fn even(low: f64, high: f64) -> Self {
        Stretch {
            low,
            high,
            sizes: Vec::new(),
        }
    }

    /// Half its length [m].
    pub fn half(&self) -> f64 {
        0.5 * (self.high - self.low)
    }

    /// Wanted spacing over the even one at `x`.
    pub fn size(&self, x: f64) -> f64 {
        let place = (x - self.low) / (self.high - self.low);
        let next = self.sizes.partition_point(|s| s[0] < place);
        let (before, after) = self.sizes.split_at(next);
        match (before.last(), after.first()) {
            (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (place - a[0]) / (b[0] - a[0]),
            (Some(only), None) | (None, Some(only)) => only[1],
            (None, None) => 1.0,
        }
    }

    /// Whether both ends of `other` are nearer to these than this part of half this stretch.
    pub fn ends_near(&self, other: &Stretch, part: f64) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() < part * self.half();
        near(self.low, other.low) && near(self.high, other.high)
    }

    /// Whether the two overlap.
    pub fn meets(&self, other: &Stretch) -> bool {
        self.low < other.high && other.low < self.high
    }

    /// Places [m] with the wanted spacings there at one cell over half the stretch [m].
    pub fn spacings(&self) -> impl Iterator<Item = [f64; 2]> {
        let length = self.high - self.low;
        let at = move |s: &[f64; 2]| [self.low + s[0] * length, s[1] * 0.5 * length];
        self.sizes.iter().map(at)
    }

    /// Smallest wanted spacing over the even one.
    pub fn finest(&self) -> f64 {
        self.sizes.iter().map(|s| s[1]).fold(1.0, f64::min)
    }

    /// Sets the wanted sizes from the pressure along the axis: `pressures[i]` is the largest at
    /// `nodes[i]`.
    ///
    /// The square of a Hertz pressure is a parabola, which even nodes resolve equally well
    /// everywhere. So the measure is the curvature of p^2 against that parabola's, 2 p_max^2 /
    /// half^2: where it is larger, as at the ends of a conformal contact or at a worn edge, the
    /// spacing falls with its root. Next to pressures at their `bound` it is infinite on every
    /// mesh, and gives no information.
    pub fn adapt(&mut self, nodes: &[f64], pressures: &[f64], bound: f64) {
        let inside: Vec<usize> = (0..nodes.len())
            .filter(|&i| nodes[i] >= self.low && nodes[i] <= self.high && pressures[i] > 0.0)
            .collect();
        let top = inside.iter().map(|&i| pressures[i]).fold(0.0, f64::max);
        let top = top.powi(2);
        let even = 2.0 * top / self.half().powi(2);
        let mut sizes: Vec<[f64; 2]> = inside
            .windows(3)
            .filter(|w| w[2] == w[0] + 2)
            .filter(|w| w.iter().all(|&i| pressures[i] < bound))
            .map(|w| {
                let [a, b, c] = [0, 1, 2].map(|k| (nodes[w[k]], pressures[w[k]].powi(2)));
                let curvature =
                    2.0 * ((c.1 - b.1) / (c.0 - b.0) - (b.1 - a.1) / (b.0 - a.0)) / (c.0 - a.0);
                let wanted = SLACK * (even / curvature.abs().max(f64::MIN_POSITIVE)).sqrt();
                [b.0, wanted.clamp(FINEST, 1.0)]
            })
            .collect();
        // A mesh three times finer than the last is as far as its curvatures can be trusted.
        for size in &mut sizes {
            size[1] = size[1].max(self.size(size[0]) / 3.0);
        }
        limit_gradient(&mut sizes, self.gradient());
        let length = self.high - self.low;
        self.sizes = sizes
            .iter()
            .map(|s| [(s[0] - self.low) / length, s[1]])
            .collect();
    }

    /// Lowers the wanted sizes to at most `size` at `x` [m], rising from there at the largest
    /// gradient.
    pub fn refine_at(&mut self, x: f64, size: f64) {
        let slope = self.gradient();
        let wanted = |x_near: f64| size + slope * (x_near - x).abs();
        if wanted(x.clamp(self.low, self.high)) >= 1.0 {
            return;
        }
        // Places that the lowered sizes need between the known ones: a ladder from the corner
        // outwards.
        let mut places: Vec<f64> = vec![self.low, self.high, x];
        let mut distance = size / slope;
        while size + slope * distance < 2.0 {
            places.extend([x - distance, x + distance]);
            distance *= 1.5;
        }
        let length = self.high - self.low;
        places.retain(|p| (self.low..=self.high).contains(p));
        places.extend(self.sizes.iter().map(|s| self.low + s[0] * length));
        places.sort_by(f64::total_cmp);
        places.dedup();
        self.sizes = places
            .iter()
            .map(|&p| [(p - self.low) / length, self.size(p).min(wanted(p))])
            .collect();
    }

    /// Largest change of the wanted size over the distance [1/m].
    fn gradient(&self) -> f64 {
        GRADIENT / self.half() * 8.0
    }
}

/// Lowers sizes until neighbours differ by at most `slope` times their distance.
fn limit_gradient(sizes: &mut [[f64; 2]], slope: f64) {
    for i in 1..sizes.len() {
        sizes[i][1] = sizes[i][1].min(sizes[i - 1][1] + slope * (sizes[i][0] - sizes[i - 1][0]));
    }
    for i in (1..sizes.len()).rev() {
        sizes[i - 1][1] =
            sizes[i - 1][1].min(sizes[i][1] + slope * (sizes[i][0] - sizes[i - 1][0]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn adapted(pressure: impl Fn(f64) -> f64) -> Stretch {
        let nodes: Vec<f64> = (0..41).map(|i| -1.0 + f64::from(i) / 20.0).collect();
        let pressures: Vec<f64> = nodes.iter().map(|&x| pressure(x)).collect();
        let mut stretch = Stretch::even(-1.0, 1.0);
        stretch.adapt(&nodes, &pressures, f64::INFINITY);
        stretch
    }

    #[test]
    fn hertz_pressure_is_resolved_evenly() {
        assert_eq!(adapted(|x| (1.0 - x * x).max(0.0).sqrt()).finest(), 1.0);
    }

    #[test]
    fn rising_ends_are_refined_and_the_middle_is_not() {
        let stretch = adapted(|x| 1.0 + (-(1.0 - x.abs()) / 0.02).exp());
        assert!(
            stretch.finest() < 0.5 && stretch.size(0.0) > 0.9,
            "{}",
            stretch.finest()
        );
        assert!(stretch.size(0.95) < 0.6);
    }
}
