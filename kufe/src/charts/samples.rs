//! Where samples of runs lie on a table's picture.

use std::collections::BTreeSet;

use kufe_lut::{Interpolator, Sample};

/// Spots that a picture tells apart along each axis.
const SPOTS: f64 = 500.0;

/// Samples as a picture shows them, spot by spot.
pub(crate) struct Samples {
    /// Forces [N] and curvatures [1/m] that the picture spans: the table's, and those of samples not far beyond.
    pub fz: (f64, f64),
    pub curvature: (f64, f64),
    /// Curvature and force of the spots with samples in the table.
    pub inside: Vec<(f64, f64)>,
    /// The same of those outside of it, also by speed or temperature; what lies farther out stands at the border.
    pub outside: Vec<(f64, f64)>,
    /// Samples, and how many of them lie outside.
    pub count: usize,
    pub beyond: usize,
}

impl Samples {
    /// `fz` and `curvature` are what the table spans.
    pub fn new(
        samples: &[Sample],
        interpolator: &Interpolator,
        fz: (f64, f64),
        curvature: (f64, f64),
    ) -> Self {
        let room = curvature.1 - curvature.0;
        let mut at = Samples {
            fz: widened(fz, (fz.0 / 4.0, fz.1 * 4.0), samples.iter().map(|s| s.fz)),
            curvature: widened(
                curvature,
                (curvature.0 - room / 2.0, curvature.1 + room / 2.0),
                samples.iter().map(|s| s.curvature),
            ),
            inside: Vec::new(),
            outside: Vec::new(),
            count: samples.len(),
            beyond: 0,
        };
        let mut spots = [BTreeSet::new(), BTreeSet::new()];
        for s in samples {
            let outside = interpolator.at(*s).out_of_range;
            at.beyond += usize::from(outside);
            if let Some(spot) = at.spot(s) {
                spots[usize::from(outside)].insert(spot);
            }
        }
        let placed = spots.map(|spots| spots.into_iter().map(|spot| at.place(spot)).collect());
        [at.inside, at.outside] = placed;
        at
    }

    /// The spot of a sample; `None` where its place is no number.
    fn spot(&self, sample: &Sample) -> Option<(u32, u32)> {
        let (low, high) = self.curvature;
        let x = (sample.curvature - low) / (high - low);
        let y = (sample.fz.max(self.fz.0) / self.fz.0).ln() / (self.fz.1 / self.fz.0).ln();
        let spot = |t: f64| (t.clamp(0.0, 1.0) * SPOTS) as u32;
        (x.is_finite() && sample.fz.is_finite()).then(|| (spot(x), spot(y)))
    }

    /// Curvature and force of a spot.
    fn place(&self, (x, y): (u32, u32)) -> (f64, f64) {
        let (low, high) = self.curvature;
        let force = (self.fz.1 / self.fz.0).powf(f64::from(y) / SPOTS);
        (low + (high - low) * f64::from(x) / SPOTS, self.fz.0 * force)
    }

    /// What the picture says of them.
    pub fn in_words(&self) -> String {
        format!(
            "{} samples (pink), {} of them outside the table (red)",
            self.count, self.beyond
        )
    }
}

/// A range that also holds these values, up to the bounds `most`.
fn widened(range: (f64, f64), most: (f64, f64), values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.filter(|v| v.is_finite()).fold(range, |range, v| {
        (range.0.min(v.max(most.0)), range.1.max(v.min(most.1)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use kufe_lut::{Axes, Figures, Mode, Quantity, Table};

    #[test]
    fn samples_outside_are_counted_shown_and_held_to_the_border() -> Result<(), kufe_lut::Error> {
        let axes = Axes::new(vec![500.0, 4000.0], vec![0.0, 0.02])?;
        let node = Figures::at_rest([1e7, 6e6, 1e-5, 0.05, 3e-4, 1e-5]);
        let node = node.with_error(Quantity::PMax, 0.0);
        let table = Table::new(axes, &[node; 4], vec![])?;
        let lookup = Interpolator::new(&table, Quantity::PMax, Mode::Smooth, None)?;
        let at = |fz, curvature| Sample {
            fz,
            curvature,
            speed: 30.0,
            ice_c: -5.0,
        };
        let samples = [
            at(1000.0, 0.01),
            at(1000.0, 0.01),
            at(6000.0, 0.01),
            at(-50.0, 0.5),
            at(f64::NAN, 0.01),
        ];
        let found = Samples::new(&samples, &lookup, (500.0, 4000.0), (0.0, 0.02));
        assert_eq!((found.count, found.beyond), (5, 3));
        assert_eq!((found.inside.len(), found.outside.len()), (1, 2));
        assert_eq!(found.fz, (125.0, 6000.0));
        assert_eq!(found.curvature, (0.0, 0.03));
        let edge = found
            .outside
            .iter()
            .any(|&(k, fz)| (k / 0.03 - 1.0).abs() < 1e-12 && (fz / 125.0 - 1.0).abs() < 1e-12);
        assert!(edge, "{:?}", found.outside);
        assert!(found.in_words().starts_with("5 samples (pink), 3"));
        Ok(())
    }
}
