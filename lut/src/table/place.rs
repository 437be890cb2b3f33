//! Where an input lies on an axis.

/// The breakpoints of an axis.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// The breakpoints.
    pub plain: Vec<f64>,
    /// The breakpoints as the smooth mode sees them.
    pub scaled: Vec<f64>,
}

/// Where an input lies on an axis: the breakpoint at or below it and the next one.
pub(crate) struct Place {
    pub low: usize,
    pub high: usize,
    /// The input, held to the axis.
    pub clipped: f64,
    pub outside: bool,
}

impl Axis {
    /// Breakpoints that the smooth mode sees in logarithms.
    pub fn logarithmic(breakpoints: &[f64]) -> Self {
        Axis {
            plain: breakpoints.to_vec(),
            scaled: breakpoints.iter().map(|v| v.ln()).collect(),
        }
    }

    /// Breakpoints that both modes see as they are.
    pub fn plain(breakpoints: &[f64]) -> Self {
        Axis {
            plain: breakpoints.to_vec(),
            scaled: breakpoints.to_vec(),
        }
    }

    #[inline]
    pub fn place(&self, value: f64) -> Place {
        let last = self.plain.len() - 1;
        if value >= self.plain[last] {
            return Place {
                low: last,
                high: last,
                clipped: self.plain[last],
                outside: value > self.plain[last],
            };
        }
        if value <= self.plain[0] {
            return Place {
                low: 0,
                high: 1.min(last),
                clipped: self.plain[0],
                outside: value < self.plain[0],
            };
        }
        // Halving without branches: random inputs would mispredict every other one.
        let (mut low, mut left) = (0, last);
        while left > 1 {
            let half = left / 2;
            let above = value >= self.plain[low + half];
            low = std::hint::select_unpredictable(above, low + half, low);
            left -= half;
        }
        Place {
            low,
            high: low + 1,
            clipped: value,
            outside: false,
        }
    }
}

/// Part of the way from one breakpoint to the next, 0 where they are one.
#[inline]
pub(crate) fn fraction(axis: &[f64], place: &Place, value: f64) -> f64 {
    if place.low == place.high {
        return 0.0;
    }
    (value - axis[place.low]) / (axis[place.high] - axis[place.low])
}
