//! A stretch of an axis in contact, and the relative cell size at each place of it.

/// A stretch of one axis that is in contact.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stretch {
    /// Its start [m].
    pub low: f64,
    /// Its end [m].
    pub high: f64,
    /// Pairs of position (0 at the start, 1 at the end of the stretch) and ratio of the spacing
    /// there to the even one, in order; linear in between, constant outside; empty for a ratio of
    /// 1.
    pub sizes: Vec<[f64; 2]>,
}

/// Smallest ratio of a spacing to the even one.
const FINEST: f64 = 2e-4;
/// Largest gradient of the spacing along the axis.
const GRADIENT: f64 = 0.35;
/// Ratio by which a pressure may be narrower than a Hertz pressure for even cells to be sufficient.
const SLACK: f64 = 2.0;
/// Ratio of the number of cells over half the width of a narrow ridge to that over half the
/// stretch.
///
/// The errors of a peak by the cells across and by the cells in depth have opposite signs. With as
/// many cells as on a smooth contact they cancel on coarse meshes, and no order is observed. With
/// twice as many across, the errors of worn flats, blades and scratches with 4, 6 and 8 cells have
/// one sign and decrease with second order.
pub(crate) const ON_RIDGES: f64 = 2.0;
/// The ratio under a runner of hexahedra, where the edges of faces look like ridges.
pub(crate) const ON_FACES: f64 = 0.5;

impl Stretch {
    /// A stretch with even cells.
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

    /// Ratio of the spacing at `x` to the even one.
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

    /// Whether both ends of `other` differ from those of this stretch by less than the fraction
    /// `part` of its half.
    pub fn ends_near(&self, other: &Stretch, part: f64) -> bool {
        let near = |a: f64, b: f64| (a - b).abs() < part * self.half();
        near(self.low, other.low) && near(self.high, other.high)
    }

    /// Whether the two overlap.
    pub fn meets(&self, other: &Stretch) -> bool {
        self.low < other.high && other.low < self.high
    }

    /// Pairs of position [m] and spacing there for one cell over half the stretch [m].
    pub fn spacings(&self) -> impl Iterator<Item = [f64; 2]> {
        let length = self.high - self.low;
        let at = move |s: &[f64; 2]| [self.low + s[0] * length, s[1] * 0.5 * length];
        self.sizes.iter().map(at)
    }

    /// Smallest ratio of the spacing to the even one.
    pub fn finest(&self) -> f64 {
        self.sizes.iter().map(|s| s[1]).fold(1.0, f64::min)
    }

    /// Sets the relative sizes from the pressure along the axis: `pressures[i]` is the largest at
    /// `nodes[i]`.
    ///
    /// The square of a Hertz pressure is a parabola, which even nodes resolve equally well
    /// everywhere. The measure is the ratio of the curvature of p^2 to that of the parabola, 2
    /// p_max^2 / half^2. Its root is the ratio by which the pressure is narrower than the stretch,
    /// as at the ends of a conformal contact or on a ridge along a worn edge. Above [`SLACK`], the
    /// size of cells is in inverse proportion to it, finally `finer` times smaller ([`ON_RIDGES`]
    /// or [`ON_FACES`]). Between places of contact sizes grow from both sides.
    pub fn adapt(&mut self, nodes: &[f64], pressures: &[f64], finer: f64) {
        let inside: Vec<usize> = (0..nodes.len())
            .filter(|&i| nodes[i] >= self.low && nodes[i] <= self.high && pressures[i] > 0.0)
            .collect();
        let top = inside.iter().map(|&i| pressures[i]).fold(0.0, f64::max);
        let even = 2.0 * top.powi(2) / self.half().powi(2);
        let slope = self.gradient();
        let mut sizes: Vec<[f64; 2]> = Vec::new();
        let mut end = 0;
        for run in inside.chunk_by(|i, next| next - i == 1) {
            let measured = self.measured(run, [nodes, pressures], even, finer);
            if let (Some(&[_, before]), Some(&[_, after])) = (sizes.last(), measured.first()) {
                let gap = [[nodes[end + 1], before], [nodes[run[0] - 1], after]];
                sizes.extend(rising(gap, slope));
            }
            if !measured.is_empty() {
                end = run[run.len() - 1];
            }
            sizes.extend(measured);
        }
        limit_gradient(&mut sizes, slope);
        let length = self.high - self.low;
        self.sizes = sizes
            .iter()
            .map(|s| [(s[0] - self.low) / length, s[1]])
            .collect();
    }

    /// Pairs of position [m] and relative size along adjacent nodes in contact; `even` is the
    /// curvature of p^2 for even cells.
    fn measured(
        &self,
        run: &[usize],
        [nodes, pressures]: [&[f64]; 2],
        even: f64,
        finer: f64,
    ) -> Vec<[f64; 2]> {
        let wanted = |k: usize| {
            let size = self.size(nodes[run[k]]);
            let ends = [k.checked_sub(1)?, k, k + 1];
            let at = |k: usize| run.get(k).map(|&i| (nodes[i], pressures[i].powi(2)));
            let [a, b, c] = [at(ends[0])?, at(ends[1])?, at(ends[2])?];
            let curvature =
                2.0 * ((c.1 - b.1) / (c.0 - b.0) - (b.1 - a.1) / (b.0 - a.0)) / (c.0 - a.0);
            let narrower = (curvature.abs() / even).sqrt();
            let wanted = 1.0 / (1.0 + finer * (narrower - SLACK).max(0.0));
            // The curvatures of a mesh are accurate enough for cells up to three times smaller.
            Some([b.0, wanted.max(FINEST).max(size / 3.0)])
        };
        (0..run.len()).filter_map(wanted).collect()
    }

    /// Lowers the relative sizes to at most `size` at `x` [m], rising from there at the largest
    /// gradient.
    pub fn refine_at(&mut self, x: f64, size: f64) {
        self.refine_over([x, x], size);
    }

    /// Lowers the relative sizes to at most `size` from `low` to `high` [m], rising from there at
    /// the largest gradient.
    pub fn refine_over(&mut self, [low, high]: [f64; 2], size: f64) {
        let slope = self.gradient();
        let wanted = |x: f64| size + slope * (low - x).max(x - high).max(0.0);
        if wanted(low.clamp(self.low, self.high)) >= 1.0 {
            return;
        }
        // Additional positions for the lowered sizes, outwards from either end.
        let mut places: Vec<f64> = vec![self.low, self.high, low, high];
        let mut distance = size / slope;
        while size + slope * distance < 2.0 {
            places.extend([low - distance, high + distance]);
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

    /// Largest gradient of the relative size [1/m].
    fn gradient(&self) -> f64 {
        GRADIENT / self.half() * 8.0
    }
}

/// Places and sizes between two runs of nodes in contact: from either end they rise.
fn rising([[from, before], [to, after]]: [[f64; 2]; 2], slope: f64) -> Vec<[f64; 2]> {
    let met = 0.5 * (to - from + (after - before) / slope);
    let most = (before + slope * met).min(1.0);
    let places = [
        [from, before],
        [from + (most - before) / slope, most],
        [to - (most - after) / slope, most],
        [to, after],
    ];
    let increase = places.windows(2).all(|w| w[0][0] <= w[1][0]);
    places.into_iter().filter(|_| increase).collect()
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
        stretch.adapt(&nodes, &pressures, ON_RIDGES);
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

    /// A stretch of half-length 1 adapted to a pressure until nothing changes any more.
    fn settled(pressure: impl Fn(f64) -> f64) -> Stretch {
        let nodes: Vec<f64> = (0..4001).map(|i| f64::from(i) / 2000.0 - 1.0).collect();
        let pressures: Vec<f64> = nodes.iter().map(|&x| pressure(x)).collect();
        let mut stretch = Stretch::even(-1.0, 1.0);
        for _ in 0..6 {
            stretch.adapt(&nodes, &pressures, ON_RIDGES);
        }
        stretch
    }

    /// Half a ridge's width over the size of its cells, where half the stretch has one.
    #[test]
    fn a_ridge_has_about_twice_the_cells_of_the_stretch_and_few_lie_beside_it() {
        let width = 0.04;
        let ridge = |x: f64| 1.0 - ((x - 0.5) / width).powi(2);
        let stretch = settled(|x| (0.3 + ridge(x).max(0.0)).sqrt());
        let cells = width / stretch.size(0.5);
        assert!((1.4..=ON_RIDGES).contains(&cells), "{cells}");
        assert!(stretch.size(-0.5) > 0.9, "{}", stretch.size(-0.5));
    }

    #[test]
    fn cells_grow_where_nothing_touches_between_two_ridges() {
        let pressed = |at: f64| (1.0 - (at / 0.05).powi(2)).max(0.0).sqrt();
        let stretch = settled(|x| pressed(x.abs() - 0.9));
        let sizes = [-0.9, -0.6, 0.0, 0.6, 0.9].map(|x| stretch.size(x));
        assert!(sizes[0] < 0.05 && sizes[4] < 0.05, "{sizes:?}");
        assert!(
            sizes[1] > 0.5 && sizes[2] == 1.0 && sizes[3] > 0.5,
            "{sizes:?}"
        );
    }
}
