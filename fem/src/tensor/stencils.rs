//! Products of the 1-D matrices of the three axes with vectors of adjacent nodes along x
//! ([`crate::tensor::kernel`]).

use pulp::Simd;

use crate::tensor::factors::{Cell, Factors, Layer};

/// The matrices of x at a vector of nodes.
#[derive(Clone, Copy)]
pub(crate) struct AlongX<S: Simd> {
    lumped: S::f64s,
    mass: [S::f64s; 2],
    stiffness: [S::f64s; 2],
    end: S::f64s,
    plain_end: S::f64s,
}

/// Products of a row along x.
#[derive(Clone, Copy)]
pub(crate) struct Products<S: Simd> {
    pub a: S::f64s,
    pub b: S::f64s,
    pub p: S::f64s,
    pub q: S::f64s,
    pub r: S::f64s,
}

/// The matrices of z at a plane.
#[derive(Clone, Copy)]
pub(crate) struct AlongZ<S: Simd> {
    lumped: S::f64s,
    mass: [S::f64s; 2],
    stiffness: [S::f64s; 2],
    coupling: S::f64s,
    /// Diagonal entry of D at an end of z.
    end: Option<S::f64s>,
}

impl<S: Simd> AlongX<S> {
    #[inline(always)]
    pub fn new(factors: &Factors, column: usize, equation: usize) -> Self {
        let [lumped, low, high] = &factors.mass_x;
        let [k_low, k_high] = &factors.stiffness_x[usize::from(equation == 0)];
        let [lambda, mu, plain] = &factors.ends_x;
        AlongX {
            lumped: vector::<S>(lumped, column),
            mass: [vector::<S>(low, column), vector::<S>(high, column)],
            stiffness: [vector::<S>(k_low, column), vector::<S>(k_high, column)],
            end: vector::<S>(if equation == 0 { mu } else { lambda }, column),
            plain_end: vector::<S>(plain, column),
        }
    }

    /// M u and K u.
    #[inline(always)]
    pub fn both(&self, simd: S, [low, on, high]: [S::f64s; 3]) -> [S::f64s; 2] {
        let (below, above) = (simd.sub_f64s(on, low), simd.sub_f64s(high, on));
        let mass = simd.mul_add_e_f64s(self.mass[1], above, simd.mul_f64s(self.lumped, on));
        let stiffness = simd.mul_f64s(self.stiffness[0], below);
        [
            simd.negate_mul_add_e_f64s(self.mass[0], below, mass),
            simd.negate_mul_add_e_f64s(self.stiffness[1], above, stiffness),
        ]
    }

    /// 2 D u less a share of E u.
    #[inline(always)]
    pub fn slope<const END: bool>(&self, simd: S, [low, on, high]: [S::f64s; 3]) -> S::f64s {
        let slope = simd.sub_f64s(low, high);
        if END {
            simd.mul_add_e_f64s(self.end, on, slope)
        } else {
            slope
        }
    }

    /// 2 D u.
    #[inline(always)]
    pub fn plain_slope<const END: bool>(&self, simd: S, [low, on, high]: [S::f64s; 3]) -> S::f64s {
        let slope = simd.sub_f64s(low, high);
        if END {
            simd.mul_add_e_f64s(self.plain_end, on, slope)
        } else {
            slope
        }
    }
}

impl<S: Simd> AlongZ<S> {
    #[inline(always)]
    pub fn new(simd: S, layer: &Layer, modulus: usize, coupling: f64, end: Option<f64>) -> Self {
        let (below, above) = (layer.below[modulus], layer.above[modulus]);
        AlongZ {
            lumped: simd.splat_f64s(layer.lumped),
            mass: [below.mass, above.mass].map(|v| simd.splat_f64s(v)),
            stiffness: [below.stiffness, above.stiffness].map(|v| simd.splat_f64s(v)),
            coupling: simd.splat_f64s(coupling),
            end: end.map(|v| simd.splat_f64s(v)),
        }
    }

    /// Adds to the sums of the plane below and of this one; returns the first, which is complete,
    /// and starts the sum of the plane above.
    #[inline(always)]
    pub fn add(&self, simd: S, [m, k, d]: [S::f64s; 3], sums: &mut [S::f64s; 2]) -> S::f64s {
        let side = |side: usize| {
            simd.negate_mul_add_e_f64s(self.stiffness[side], k, simd.mul_f64s(self.mass[side], m))
        };
        let (below, above) = (side(0), side(1));
        let slope = simd.mul_f64s(self.coupling, d);
        let complete = simd.add_f64s(sums[0], simd.add_f64s(below, slope));
        let own = simd.mul_add_e_f64s(self.lumped, m, sums[1]);
        let mut own = simd.sub_f64s(own, simd.add_f64s(below, above));
        if let Some(end) = self.end {
            own = simd.mul_add_e_f64s(end, d, own);
        }
        *sums = [own, simd.sub_f64s(above, slope)];
        complete
    }
}

/// Vector `column` of whole vectors.
#[inline(always)]
fn vector<S: Simd>(values: &[f64], column: usize) -> S::f64s {
    S::as_simd_f64s(values).0[column]
}

/// The matrices of x at one vector, for the equations `FIRST` to `FIRST + N`: x alone, or y and z.
pub(crate) struct AcrossRow<S: Simd, const FIRST: usize, const N: usize, const END: bool> {
    pub x: AlongX<S>,
    /// [`Factors::shares`].
    pub shares: [S::f64s; 2],
    pub zero: S::f64s,
}

impl<S: Simd, const FIRST: usize, const N: usize, const END: bool> AcrossRow<S, FIRST, N, END> {
    #[inline(always)]
    pub fn products(&self, simd: S, row: [&[f64]; 3]) -> [Products<S>; N] {
        let (x, zero) = (&self.x, self.zero);
        let [u_x, u_y, u_z] = [three::<S>(row[0]), three::<S>(row[1]), three::<S>(row[2])];
        if FIRST == 0 {
            let [a, b] = x.both(simd, u_x);
            let (p, q) = (x.slope::<END>(simd, u_y), x.slope::<END>(simd, u_z));
            return [Products {
                a,
                b,
                p,
                q,
                r: zero,
            }; N];
        }
        let slope = x.slope::<END>(simd, u_x);
        let ([m_y, k_y], [m_z, k_z]) = (x.both(simd, u_y), x.both(simd, u_z));
        let of_y = Products {
            a: m_y,
            b: k_y,
            p: slope,
            q: zero,
            r: m_z,
        };
        let mut products = [of_y; N];
        products[N - 1] = Products {
            a: m_z,
            b: k_z,
            p: zero,
            q: slope,
            r: m_y,
        };
        products
    }

    /// Terms of E of y: added to f_m and subtracted from f_d on the last row, with opposite signs
    /// on the first.
    #[inline(always)]
    pub fn on_face(&self, simd: S, equation: usize, row: [&[f64]; 3], r: S::f64s) -> [S::f64s; 2] {
        let slope = |c: usize| self.x.plain_slope::<END>(simd, three::<S>(row[c]));
        let (m, d) = match equation {
            0 => (slope(1), self.zero),
            1 => (slope(0), r),
            _ => (self.zero, r),
        };
        let share = self.shares[usize::from(equation == 1)];
        [simd.mul_f64s(share, m), simd.mul_f64s(share, d)]
    }
}

/// A vector of nodes with its lower and its upper neighbours, from a row that begins at the lower.
#[inline(always)]
fn three<S: Simd>(row: &[f64]) -> [S::f64s; 3] {
    let row = &row[..S::F64_LANES + 2];
    let (low, _) = S::as_simd_f64s(&row[..S::F64_LANES]);
    let (on, _) = S::as_simd_f64s(&row[1..S::F64_LANES + 1]);
    let (high, _) = S::as_simd_f64s(&row[2..S::F64_LANES + 2]);
    [low[0], on[0], high[0]]
}

/// Contributions of row j and the row below to f_m, f_k and f_d, with the opposite sign.
#[derive(Clone, Copy)]
pub(crate) struct Behind<S: Simd>([S::f64s; 3]);

/// Sums over the cells between two rows.
#[inline(always)]
pub(crate) fn between<S: Simd>(
    simd: S,
    equation: usize,
    cell: Cell,
    before: &Products<S>,
    on: &Products<S>,
) -> [S::f64s; 3] {
    let (mass, stiffness) = (simd.splat_f64s(cell.mass), simd.splat_f64s(cell.stiffness));
    let a = simd.sub_f64s(on.a, before.a);
    let b = simd.sub_f64s(on.b, before.b);
    let mut m = simd.negate_mul_add_e_f64s(stiffness, a, simd.mul_f64s(mass, b));
    if equation < 2 {
        m = simd.add_f64s(m, simd.add_f64s(on.p, before.p));
    }
    let k = simd.mul_f64s(mass, a);
    // Of 2 D r = w_(below) - w_(above) this is the cell above.
    let d = match equation {
        0 => simd.mul_f64s(mass, simd.sub_f64s(on.q, before.q)),
        1 => simd.neg_f64s(simd.add_f64s(on.r, before.r)),
        _ => {
            let q = simd.mul_f64s(mass, simd.sub_f64s(on.q, before.q));
            simd.sub_f64s(q, simd.add_f64s(on.r, before.r))
        }
    };
    [m, k, d]
}

impl<S: Simd> Behind<S> {
    /// The terms of the cell below less those of the row's lumped masses.
    #[inline(always)]
    pub fn new(
        simd: S,
        equation: usize,
        lumped: f64,
        on: &Products<S>,
        [m, k, d]: [S::f64s; 3],
    ) -> Self {
        let lumped = simd.splat_f64s(lumped);
        Behind([
            simd.negate_mul_add_e_f64s(lumped, on.b, m),
            simd.negate_mul_add_e_f64s(lumped, on.a, k),
            match equation {
                1 => d,
                _ => simd.negate_mul_add_e_f64s(lumped, on.q, d),
            },
        ])
    }

    /// f_m, f_k and f_d with the cell above.
    #[inline(always)]
    pub fn with(&self, simd: S, [m, k, d]: [S::f64s; 3]) -> [S::f64s; 3] {
        let Behind(behind) = self;
        [
            simd.sub_f64s(m, behind[0]),
            simd.sub_f64s(k, behind[1]),
            simd.sub_f64s(d, behind[2]),
        ]
    }
}
