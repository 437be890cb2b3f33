//! A bicubic spline through scattered heights, by least squares on given breaks.

use crate::fit::b_spline::BSpline;
use crate::fit::bicubic::{Bicubic, Sample};
use crate::fit::normal_equations::{Factored, NormalEquations};

/// Weight of the bending energy, as a length in units of a cell's.
const STIFFNESS: f64 = 0.03;

/// Least squares with a trace of bending energy on fixed breaks:
/// `sum_i (w_i (s(x_i) - z_i))^2 + density * int (c hx)^4 s_xx^2 + 2 (c^2 hx hy)^2 s_xy^2 + (c hy)^4 s_yy^2`,
/// c = 0.03, hx and hy the cell's sides. The energy settles what no height decides.
pub(crate) fn fit(samples: &[Sample], breaks: &[Vec<f64>; 2]) -> Option<Bicubic> {
    let axes = [BSpline::new(&breaks[0]), BSpline::new(&breaks[1])];
    Some(Bicubic {
        coefficients: equations(samples, &axes).solve()?,
        axes,
    })
}

/// A fit whose breaks, places and weights stay as they are: other heights cost a right-hand side each.
pub(crate) struct KeptFit {
    axes: [BSpline; 2],
    factored: Factored,
}

impl KeptFit {
    /// The equations of these samples on the axes of a fit, factorised; none where they determine nothing.
    pub fn new(samples: &[Sample], axes: [BSpline; 2]) -> Option<Self> {
        let factored = equations(samples, &axes).factored()?;
        Some(KeptFit { axes, factored })
    }

    /// The fit of these samples, which differ from the first ones in their heights alone.
    pub fn fit(&self, samples: impl Iterator<Item = Sample>) -> Option<Bicubic> {
        let mut right = vec![0.0; self.factored.size()];
        for sample in samples {
            let (i, a) = self.axes[0].values(sample.at[0]);
            let (j, b) = self.axes[1].values(sample.at[1]);
            let weighted = sample.weight * sample.weight * sample.height;
            self.factored
                .add_right(&mut right, [i, j], [&a, &b], weighted);
        }
        Some(Bicubic {
            coefficients: self.factored.solve(right)?,
            axes: self.axes.clone(),
        })
    }
}

/// What [`fit`] solves.
fn equations(samples: &[Sample], axes: &[BSpline; 2]) -> NormalEquations {
    let breaks = [0, 1].map(|k| axes[k].breaks());
    let mut equations = NormalEquations::new(axes[0].count(), axes[1].count());
    for sample in samples {
        let (i, a) = axes[0].values(sample.at[0]);
        let (j, b) = axes[1].values(sample.at[1]);
        let weight = sample.weight * sample.weight;
        equations.add([i, j], [&a, &b], weight, sample.height);
    }
    let lengths = breaks.map(|breaks| breaks[breaks.len() - 1] - breaks[0]);
    let density = samples.len() as f64 / (lengths[0] * lengths[1]);
    let gauss = 0.5 / 3f64.sqrt();
    for x in breaks[0].windows(2) {
        for y in breaks[1].windows(2) {
            let (hx, hy) = (x[1] - x[0], y[1] - y[0]);
            let weight = density * 0.25 * hx * hy;
            let (cx, cy) = ((STIFFNESS * hx).powi(2), (STIFFNESS * hy).powi(2));
            for (sx, sy) in [
                (-gauss, -gauss),
                (-gauss, gauss),
                (gauss, -gauss),
                (gauss, gauss),
            ] {
                let (px, py) = (0.5 * (x[0] + x[1]) + sx * hx, 0.5 * (y[0] + y[1]) + sy * hy);
                let ((i, a0), (j, b0)) = (axes[0].values(px), axes[1].values(py));
                let ((_, a1), (_, b1)) =
                    (axes[0].first_derivatives(px), axes[1].first_derivatives(py));
                let ((_, a2), (_, b2)) = (
                    axes[0].second_derivatives(px),
                    axes[1].second_derivatives(py),
                );
                equations.add([i, j], [&a2, &b0], weight * cx * cx, 0.0);
                equations.add([i, j], [&a1, &b1], weight * 2.0 * cx * cy, 0.0);
                equations.add([i, j], [&a0, &b2], weight * cy * cy, 0.0);
            }
        }
    }
    equations
}
