//! Curve of a channel around an anomalous stretch.

use kufe_sled::{Column, Examination, Run};

use crate::plot::{Axis, Figure, Layer, PALETTE, Panel, Point, extent, sign, unit_of};

/// Largest number of points of a curve.
const MAX_POINTS: usize = 600;
/// Smallest time that is shown before and after an anomalous stretch [s].
const AROUND_S: f64 = 1.0;

/// A channel of a run around an anomalous stretch, or over the whole run.
#[derive(Clone, Debug, PartialEq)]
pub struct OddCurve {
    /// The channel.
    pub column: String,
    /// Time of the run's first sample [s].
    pub t0_s: f64,
    /// Time [s] and value, as recorded.
    pub points: Vec<Point>,
    /// Start and end of the anomalous stretch [s].
    pub marked: Option<[f64; 2]>,
}

/// The curves of a run: each channel around its longest anomalous stretch, and faulty channels
/// without such a stretch over the whole run.
pub fn odd_curves(examination: &Examination, run: &Run) -> Vec<OddCurve> {
    let curve = |(name, column): (&String, &Vec<f64>)| {
        let stretches = examination.stretches.iter();
        let own = stretches.filter(|one| one.column == *name);
        let longest = own.max_by(|a, b| (a.to_s - a.from_s).total_cmp(&(b.to_s - b.from_s)));
        let marked = longest.map(|one| [one.from_s, one.to_s]);
        let mut faults = examination.faults.iter();
        let is_faulty = faults.any(|fault| fault.columns.contains(name));
        let [from, to] = marked.map_or([f64::NEG_INFINITY, f64::INFINITY], |[from, to]| {
            let around = AROUND_S.max(to - from);
            [from - around, to + around]
        });
        let points = column.iter().enumerate();
        let points = points.map(|(i, value)| (run.t0_s + i as f64 * run.dt_s, *value));
        let points = points.filter(|(t, _)| (from..=to).contains(t));
        (is_faulty || marked.is_some()).then(|| OddCurve {
            column: name.clone(),
            t0_s: run.t0_s,
            points: thinned(points.collect()),
            marked,
        })
    };
    run.columns.iter().filter_map(curve).collect()
}

/// Thins points to at most [`MAX_POINTS`]: of each block of consecutive points the smallest and the
/// largest value remain, in their order.
fn thinned(points: Vec<Point>) -> Vec<Point> {
    let block = (2 * points.len()).div_ceil(MAX_POINTS);
    if block <= 2 {
        return points;
    }
    let ends = points.chunks(block).flat_map(|chunk| {
        let finite = chunk.iter().filter(|point| point.1.is_finite());
        let low = finite.clone().min_by(|a, b| a.1.total_cmp(&b.1));
        let high = finite.max_by(|a, b| a.1.total_cmp(&b.1));
        match low.zip(high) {
            None => vec![(chunk[0].0, f64::NAN)],
            Some((low, high)) if low.0 <= high.0 => vec![*low, *high],
            Some((low, high)) => vec![*high, *low],
        }
    });
    ends.collect()
}

impl OddCurve {
    /// The picture of the curve, with the anomalous stretch shaded.
    pub fn figure(&self, run: &str) -> Figure {
        let label = Column::named(&self.column).map_or(&*self.column, |column| column.label());
        let [first, last] = extent(self.points.iter().map(|point| point.0));
        // The shading of a single sample is widened to be visible.
        let margin = 0.002 * (last - first);
        let shade = PALETTE[4].alpha(0.35);
        let marked = self.marked;
        let marked = marked.map(|[from, to]| Layer::stretch([from - margin, to + margin], shade));
        let line = Layer::line(1.0, self.points.iter().copied(), PALETTE[0]);
        let layers = marked.into_iter().chain([line]).collect();
        let y = Axis::new(format!("[{}]", sign(&unit_of(&self.column))));
        let panel = Panel::new(Axis::new("time [s]"), y, layers);
        let mut figure = Figure::new(860.0, format!("{label} of {run}")).row(110.0, [panel]);
        figure.letters = 12.0;
        figure
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_thinned_curve_has_its_extremes() {
        let value = |i: usize| match i {
            7000 => 9.0,
            _ => (1e-3 * i as f64).sin(),
        };
        let points: Vec<Point> = (0..20_000).map(|i| (i as f64, value(i))).collect();
        let thin = thinned(points);
        assert!(thin.len() <= MAX_POINTS, "{}", thin.len());
        assert!(thin.contains(&(7000.0, 9.0)));
        assert!(thin.windows(2).all(|pair| pair[0].0 <= pair[1].0));
    }
}
