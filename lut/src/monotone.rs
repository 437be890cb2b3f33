//! Slopes of a C1 surface that keeps monotone data monotone.
//!
//! On each cell the surface is the bicubic Hermite patch of the values, slopes and twist at its
//! four corners, so it is C1 for any choice of them. Its Bezier net along the lower edge is
//! `f0, f0 + h d0/3, f1 - h d1/3, f1`, with the slopes `d`; the other three rows follow from the
//! values, slopes and twists carried by a third of the cell across. Where all differences of the
//! net along one direction have one sign, so has the slope of the patch (Carlson and Fritsch, SIAM
//! J. Numer. Anal. 22, 386, 1985, state the same idea on the derivatives).

/// Value, slopes and twist at a node.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Jet {
    /// Value.
    pub f: f64,
    /// Slope along x.
    pub fx: f64,
    /// Slope along y.
    pub fy: f64,
    /// Mixed second derivative.
    pub fxy: f64,
}

/// Jets of `f` (rows of `y.len()`) on the grid `x`, `y`: three-point slopes, reduced where the
/// surface would overshoot.
///
/// What holds afterwards: along every grid line the surface rises (falls) between two nodes where
/// the data do; and in a cell whose two edges along a direction both rise (fall), it rises (falls)
/// throughout the cell in that direction. So data that are monotone along an axis give a surface
/// that is.
pub(crate) fn jets(x: &[f64], y: &[f64], f: &[f64]) -> Vec<Jet> {
    let (nx, ny) = (x.len(), y.len());
    assert_eq!(f.len(), nx * ny, "values do not fit the grid");
    let level = |&f: &f64| Jet {
        f,
        ..Jet::default()
    };
    let mut jets: Vec<Jet> = f.iter().map(level).collect();
    let mut line = Vec::new();
    for j in 0..ny {
        line.clear();
        line.extend((0..nx).map(|i| f[i * ny + j]));
        for (i, slope) in limited_slopes(x, &line).into_iter().enumerate() {
            jets[i * ny + j].fx = slope;
        }
    }
    for i in 0..nx {
        let slopes = limited_slopes(y, &f[i * ny..(i + 1) * ny]);
        line.clear();
        line.extend((0..ny).map(|j| jets[i * ny + j].fx));
        let twists = slopes_of(y, &line);
        for (j, (slope, twist)) in slopes.into_iter().zip(twists).enumerate() {
            jets[i * ny + j].fy = slope;
            jets[i * ny + j].fxy = twist;
        }
    }
    reduce(x, y, &mut jets);
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

/// Scales slopes and twists down, node by node, until no net difference opposes its data.
///
/// Every difference is linear in them and has the data's sign when they vanish, so scaling always
/// helps; what still fails after [`PASSES`] is set to 0, which ends it.
fn reduce(x: &[f64], y: &[f64], jets: &mut [Jet]) {
    const PASSES: usize = 64;
    for pass in 0.. {
        let mut changed = false;
        for along_x in [true, false] {
            let direction = Direction { x, y, along_x };
            let (line, side) = direction.axes();
            for along in 0..line.len().saturating_sub(1) {
                for across in 0..side.len() {
                    changed |= direction.reduce_cell(jets, along, across, pass >= PASSES);
                }
            }
        }
        if !changed {
            return;
        }
    }
}

/// The grid as seen along one axis.
struct Direction<'a> {
    x: &'a [f64],
    y: &'a [f64],
    along_x: bool,
}

/// A row of a cell's Bezier net: from node `a` to node `b`, carried across its grid line.
#[derive(Clone, Copy)]
struct Row {
    a: usize,
    b: usize,
    h: f64,
    carried: f64,
    sign: f64,
}

impl Direction<'_> {
    /// The axis along the direction, and the one across it.
    fn axes(&self) -> (&[f64], &[f64]) {
        if self.along_x {
            (self.x, self.y)
        } else {
            (self.y, self.x)
        }
    }

    fn node(&self, along: usize, across: usize) -> usize {
        if self.along_x {
            along * self.y.len() + across
        } else {
            across * self.y.len() + along
        }
    }

    fn reduce_cell(&self, jets: &mut [Jet], along: usize, across: usize, to_zero: bool) -> bool {
        let (line, side) = self.axes();
        let row = |across: usize, carried: f64, sign: f64| Row {
            a: self.node(along, across),
            b: self.node(along + 1, across),
            h: line[along + 1] - line[along],
            carried,
            sign,
        };
        let rise = |jets: &[Jet], row: Row| jets[row.b].f - jets[row.a].f;
        let edge = row(across, 0.0, 1.0);
        let r0 = rise(jets, edge);
        let mut changed = false;
        // On a level edge the limited slopes are 0 already.
        if r0 != 0.0 {
            let sign = r0.signum();
            changed |= self.enforce(jets, Row { sign, ..edge }, to_zero);
        }
        if across + 1 < side.len() {
            let r1 = rise(jets, row(across + 1, 0.0, 1.0));
            let third = (side[across + 1] - side[across]) / 3.0;
            for sign in [1.0, -1.0] {
                if sign * r0 >= 0.0 && sign * r1 >= 0.0 {
                    changed |= self.enforce(jets, row(across, third, sign), to_zero);
                    changed |= self.enforce(jets, row(across + 1, -third, sign), to_zero);
                }
            }
        }
        changed
    }

    /// Makes the three differences of a row have its sign.
    fn enforce(&self, jets: &mut [Jet], row: Row, to_zero: bool) -> bool {
        let (carried, sign) = (row.carried, row.sign);
        let third = row.h / 3.0;
        let slope = |jet: &Jet| if self.along_x { jet.fx } else { jet.fy };
        let across = |jet: &Jet| if self.along_x { jet.fy } else { jet.fx };
        let mut changed = false;
        for node in [row.a, row.b] {
            let slopes = sign * third * slope(&jets[node]);
            let twists = sign * third * carried * jets[node].fxy;
            if slopes + twists < 0.0 {
                // The limited slopes have the data's sign: the twist is at fault.
                jets[node].fxy *= if to_zero {
                    0.0
                } else {
                    PAST * slopes / -twists
                };
                changed = true;
            }
        }
        let (ja, jb) = (jets[row.a], jets[row.b]);
        let values = sign * (jb.f - ja.f);
        let slopes =
            sign * (carried * (across(&jb) - across(&ja)) - third * (slope(&ja) + slope(&jb)));
        let twists = -sign * third * carried * (ja.fxy + jb.fxy);
        if values + slopes + twists >= 0.0 {
            return changed;
        }
        let (of_slopes, of_twists) = if to_zero {
            (0.0, 0.0)
        } else if values + slopes >= 0.0 {
            (1.0, PAST * (values + slopes) / -twists)
        } else {
            (PAST * values / -slopes, 0.0)
        };
        for node in [row.a, row.b] {
            let jet = &mut jets[node];
            jet.fxy *= of_twists;
            if carried != 0.0 || self.along_x {
                jet.fx *= of_slopes;
            }
            if carried != 0.0 || !self.along_x {
                jet.fy *= of_slopes;
            }
        }
        true
    }
}

/// Rounding may leave a sum a hair below 0 for ever: step past it.
const PAST: f64 = 1.0 - 1e-9;
