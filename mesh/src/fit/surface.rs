//! A fitted surface over the contact plane.

use crate::fit::bicubic::Bicubic;
use crate::fit::downward::Outline;
use crate::shapes::lows::lows;
use crate::shapes::profile::Profile;
use crate::shapes::underside::Underside;

/// The heights z = s(x, t(y)) - level within an outline.
#[derive(Clone, Debug)]
pub(crate) struct Surface {
    /// s over x and the arc length.
    pub spline: Bicubic,
    /// t, the arc length along the mean section, over y.
    pub arc_length: Profile,
    /// Where there is a hull.
    pub outline: Outline,
    /// `[x_min, x_max, y_min, y_max]` [m].
    pub extent: [f64; 4],
    /// What is taken off all heights [m].
    pub level: f64,
    /// Whether it is even in x and in y.
    pub symmetric: [bool; 2],
}

impl Underside for Surface {
    /// Over the level; infinite where there is no hull.
    fn height(&self, x: f64, y: f64) -> f64 {
        match self.outline.sides(x) {
            Some([from, to]) if (from..=to).contains(&y) => self.spline_height(x, y) - self.level,
            _ => f64::INFINITY,
        }
    }

    fn extent(&self) -> [f64; 4] {
        self.extent
    }

    fn mirror_symmetric(&self) -> [bool; 2] {
        self.symmetric
    }
}

impl Surface {
    /// Height of the spline [m], hull or not.
    pub fn spline_height(&self, x: f64, y: f64) -> f64 {
        let x = if self.symmetric[0] { x.abs() } else { x };
        let y = if self.symmetric[1] { y.abs() } else { y };
        self.spline.value([x, self.arc_length.value(y)])
    }

    /// Where it is below what is beside it, on the spline's breaks.
    pub fn lows(&self) -> Vec<[f64; 2]> {
        let xs = self.spline.axes[0].breaks();
        let ys: Vec<f64> = self.spline.axes[1]
            .breaks()
            .iter()
            .map(|&length| self.across(length))
            .collect();
        lows([xs, &ys], |i, j| self.height(xs[i], ys[j]))
    }

    /// y of an arc length, which rises with it [m].
    fn across(&self, length: f64) -> f64 {
        let [_, _, mut low, mut high] = self.extent;
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if self.arc_length.value(middle) < length {
                low = middle;
            } else {
                high = middle;
            }
        }
        0.5 * (low + high)
    }
}
