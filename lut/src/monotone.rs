//! Slopes of a C1 surface that keeps monotone data monotone.
//!
//! On each cell the surface is the bicubic Hermite patch of the values, slopes and twist at its
//! four corners, so it is C1 for any choice of them. Its Bezier net along the lower edge is
//! `f0, f0 + h d0/3, f1 - h d1/3, f1`, with the slopes `d`; the other three rows follow from the
//! values, slopes and twists carried by a third of the cell across. If all differences of the net
//! along one direction have one sign, the slope of the patch has this sign (Carlson and Fritsch,
//! SIAM J. Numer. Anal. 22, 386, 1985, state this criterion for the derivatives).

/// Value, slopes and twist at a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jet {
    /// Value.
    pub f: f64,
    /// Slopes along x and y.
    pub slopes: [f64; 2],
    /// Mixed second derivative.
    pub twist: f64,
}

/// Jets of `f` (rows of `y.len()`) on the grid `x`, `y`: three-point slopes, reduced where the
/// surface would overshoot.
///
/// Properties of the surface: along every grid line it rises (falls) between two nodes where the
/// data do; in a cell whose two edges along a direction both rise (fall), it rises (falls) in that
/// direction throughout the cell. Data that are monotone along an axis therefore give a surface
/// monotone along it.
pub(crate) fn jets(x: &[f64], y: &[f64], f: &[f64]) -> Vec<Jet> {
    assert_eq!(f.len(), x.len() * y.len(), "values do not fit the grid");
    let level = |&f: &f64| Jet {
        f,
        ..Jet::default()
    };
    let mut jets: Vec<Jet> = f.iter().map(level).collect();
    let grid = Grid { axes: [x, y] };
    for axis in 0..2 {
        for across in 0..grid.axes[1 - axis].len() {
            let nodes = (0..grid.axes[axis].len()).map(|along| grid.node(axis, along, across));
            let line: Vec<f64> = nodes.clone().map(|node| f[node]).collect();
            for (node, slope) in nodes.zip(limited_slopes(grid.axes[axis], &line)) {
                jets[node].slopes[axis] = slope;
            }
        }
    }
    for row in jets.chunks_exact_mut(y.len()) {
        let slopes: Vec<f64> = row.iter().map(|jet| jet.slopes[0]).collect();
        for (jet, twist) in row.iter_mut().zip(slopes_of(y, &slopes)) {
            jet.twist = twist;
        }
    }
    grid.reduce(&mut jets);
    jets
}

/// Three-point slopes, exact for parabolas.
fn slopes_of(x: &[f64], f: &[f64]) -> Vec<f64> {
    let n = x.len();
    if n < 2 {
        return vec![0.0; n];
    }
    let h: Vec<f64> = x.windows(2).map(|w| w[1] - w[0]).collect();
    let s = f.windows(2).zip(&h).map(|(w, h)| (w[1] - w[0]) / h);
    let s: Vec<f64> = s.collect();
    if n == 2 {
        return vec![s[0]; 2];
    }
    let mut d = vec![0.0; n];
    for i in 1..n - 1 {
        d[i] = (h[i] * s[i - 1] + h[i - 1] * s[i]) / (h[i - 1] + h[i]);
    }
    d[0] = 2.0 * s[0] - d[1];
    d[n - 1] = 2.0 * s[n - 2] - d[n - 2];
    d
}

/// Three-point slopes, 0 at turning points and at most three times the smaller adjacent secant
/// (Fritsch and Carlson, SIAM J. Numer. Anal. 17, 238, 1980).
fn limited_slopes(x: &[f64], f: &[f64]) -> Vec<f64> {
    let n = x.len();
    let mut d = slopes_of(x, f);
    let secant = |i: usize| (f[i + 1] - f[i]) / (x[i + 1] - x[i]);
    for (i, slope) in d.iter_mut().enumerate() {
        if n < 2 {
            break;
        }
        let (a, b) = (secant(i.max(1) - 1), secant(i.min(n - 2)));
        let bound = if a * b <= 0.0 {
            0.0
        } else {
            3.0 * a.abs().min(b.abs())
        };
        *slope = if *slope * a <= 0.0 {
            0.0
        } else {
            slope.clamp(-bound, bound)
        };
    }
    d
}

/// The breakpoints along x and y.
struct Grid<'a> {
    axes: [&'a [f64]; 2],
}

/// A row of a cell's Bezier net along an axis, from node `a` to node `b`, at the distance `carried`
/// across their grid line.
#[derive(Clone, Copy)]
struct Row {
    axis: usize,
    a: usize,
    b: usize,
    h: f64,
    carried: f64,
    sign: f64,
}

impl Grid<'_> {
    /// Index of the node at these breakpoints along an axis and across it.
    fn node(&self, axis: usize, along: usize, across: usize) -> usize {
        let [i, j] = if axis == 0 {
            [along, across]
        } else {
            [across, along]
        };
        i * self.axes[1].len() + j
    }

    /// Reduces slopes and twists, node by node, until no difference of the net opposes the data.
    ///
    /// Every difference is linear in them and has the sign of the data if they are 0, so that
    /// scaling always helps. Slopes and twists that still fail after [`PASSES`] are set to 0, which
    /// ends the iteration.
    fn reduce(&self, jets: &mut [Jet]) {
        const PASSES: usize = 64;
        for pass in 0.. {
            let mut changed = false;
            for axis in 0..2 {
                for along in 0..self.axes[axis].len().saturating_sub(1) {
                    for across in 0..self.axes[1 - axis].len() {
                        changed |= self.reduce_cell(jets, axis, [along, across], pass >= PASSES);
                    }
                }
            }
            if !changed {
                return;
            }
        }
    }

    fn reduce_cell(
        &self,
        jets: &mut [Jet],
        axis: usize,
        [along, across]: [usize; 2],
        to_zero: bool,
    ) -> bool {
        let (line, side) = (self.axes[axis], self.axes[1 - axis]);
        let row = |across: usize, carried: f64, sign: f64| Row {
            axis,
            a: self.node(axis, along, across),
            b: self.node(axis, along + 1, across),
            h: line[along + 1] - line[along],
            carried,
            sign,
        };
        let rise = |jets: &[Jet], row: Row| jets[row.b].f - jets[row.a].f;
        let edge = row(across, 0.0, 1.0);
        let r0 = rise(jets, edge);
        let mut changed = false;
        // On an edge with equal values the limited slopes are already 0.
        if r0 != 0.0 {
            let sign = r0.signum();
            changed |= Row { sign, ..edge }.enforce(jets, to_zero);
        }
        if across + 1 < side.len() {
            let r1 = rise(jets, row(across + 1, 0.0, 1.0));
            let third = (side[across + 1] - side[across]) / 3.0;
            for sign in [1.0, -1.0] {
                if sign * r0 >= 0.0 && sign * r1 >= 0.0 {
                    changed |= row(across, third, sign).enforce(jets, to_zero);
                    changed |= row(across + 1, -third, sign).enforce(jets, to_zero);
                }
            }
        }
        changed
    }
}

impl Row {
    /// Scales slopes and twists so that the three differences have the row's sign; returns whether
    /// anything changed.
    fn enforce(&self, jets: &mut [Jet], to_zero: bool) -> bool {
        let (axis, carried, sign) = (self.axis, self.carried, self.sign);
        let third = self.h / 3.0;
        let mut changed = false;
        for node in [self.a, self.b] {
            let slopes = sign * third * jets[node].slopes[axis];
            let twists = sign * third * carried * jets[node].twist;
            if slopes + twists < 0.0 {
                // The limited slopes have the sign of the data, so that the twist must be reduced.
                jets[node].twist *= if to_zero {
                    0.0
                } else {
                    MARGIN * slopes / -twists
                };
                changed = true;
            }
        }
        let (ja, jb) = (jets[self.a], jets[self.b]);
        let values = sign * (jb.f - ja.f);
        let across = carried * (jb.slopes[1 - axis] - ja.slopes[1 - axis]);
        let slopes = sign * (across - third * (ja.slopes[axis] + jb.slopes[axis]));
        let twists = -sign * third * carried * (ja.twist + jb.twist);
        if values + slopes + twists >= 0.0 {
            return changed;
        }
        let (slope_factor, twist_factor) = if to_zero {
            (0.0, 0.0)
        } else if values + slopes >= 0.0 {
            (1.0, MARGIN * (values + slopes) / -twists)
        } else {
            (MARGIN * values / -slopes, 0.0)
        };
        for node in [self.a, self.b] {
            let jet = &mut jets[node];
            jet.twist *= twist_factor;
            jet.slopes[axis] *= slope_factor;
            if carried != 0.0 {
                jet.slopes[1 - axis] *= slope_factor;
            }
        }
        true
    }
}

/// Factor on reductions, so that rounding does not leave a sum slightly below 0 in every pass.
const MARGIN: f64 = 1.0 - 1e-9;
