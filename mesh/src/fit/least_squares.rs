//! A bicubic spline through scattered heights, by least squares on given breaks.

use crate::fit::b_spline::BSpline;
use crate::fit::bicubic::{Bicubic, Sample};
use crate::fit::normal_equations::NormalEquations;

/// Weight of the bending energy, as a length in units of a cell's.
const STIFFNESS: f64 = 0.03;

/// Least squares with a trace of bending energy on fixed breaks:
/// `sum_i (w_i (s(x_i) - z_i))^2 + density * int (c hx)^4 s_xx^2 + 2 (c^2 hx hy)^2 s_xy^2 + (c hy)^4 s_yy^2`,
/// c = 0.03, hx and hy the cell's sides. The energy settles what no height decides.
pub(crate) fn fit(samples: &[Sample], breaks: &[Vec<f64>; 2]) -> Option<Bicubic> {
    let axes = [BSpline::new(&breaks[0]), BSpline::new(&breaks[1])];
    let mut equations = NormalEquations::new(axes[0].count(), axes[1].count());
    for sample in samples {
        let (i, a) = axes[0].values(sample.at[0]);
        let (j, b) = axes[1].values(sample.at[1]);
        let weight = sample.weight * sample.weight;
        equations.add([i, j], [&a, &b], weight, sample.height);
    }
    let lengths = [0, 1].map(|k| breaks[k][breaks[k].len() - 1] - breaks[k][0]);
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
    Some(Bicubic {
        coefficients: equations.solve()?,
        axes,
    })
}
