//! What one plane of u gives to K u: to its own plane and to the two beside it.
//!
//! A vector of neighbours along x goes up y, row by row, for one equation at a time. In each row come the products along x,
//!
//! a = M u, b = K u of the equation's own component, p, q and r of the others (2 D u or M u),
//!
//! from them those along y, with M, K and D as sums over cells ([`crate::tensor_factors`]),
//!
//! f_m = M b + K a - 2 D p, f_k = M a, f_d = M q + 2 D r,
//!
//! and M f_m + K f_k - 2 D f_d along z, which is added to what the planes before gave. Nothing but these sums is stored: two
//! planes of them, a vector's column after the other.
//!
//! | equation | p | q | r |
//! |---|---|---|---|
//! | x | 2 D u_y | 2 D u_z | |
//! | y | 2 D u_x | | M u_z |
//! | z | | 2 D u_x | M u_y |

use pulp::{Simd, WithSimd};

use crate::tensor_factors::{Cell, Factors, Layer, WIDEST, padded};

/// A plane of u: rows between zeros, as vectors want them.
pub(crate) struct PaddedPlane {
    /// By component.
    values: [Aligned; 3],
    /// Numbers from a row to the next.
    stride: usize,
}

impl PaddedPlane {
    pub fn new([nx, ny]: [usize; 2]) -> Self {
        // An odd number of cache lines, so that a column of rows spreads over all of a cache's sets.
        let lines = (padded(nx) + 2 * WIDEST) / 8;
        let stride = 8 * (lines | 1);
        PaddedPlane {
            // One row more, so that rows from any column on are whole.
            values: std::array::from_fn(|_| Aligned::zeros((ny + 1) * stride)),
            stride,
        }
    }

    /// Takes plane `k` of a vector on a grid of `shape`.
    pub fn fill(&mut self, u: &[f64], [nx, ny, nz]: [usize; 3], k: usize) {
        for (c, values) in self.values.iter_mut().enumerate() {
            let from = (c * nz + k) * nx * ny;
            let rows = u[from..from + nx * ny].chunks_exact(nx);
            for (to, from) in values.all_mut().chunks_exact_mut(self.stride).zip(rows) {
                to[WIDEST..WIDEST + nx].copy_from_slice(from);
            }
        }
    }
}

/// Numbers that begin at a cache line.
pub(crate) struct Aligned {
    data: Vec<f64>,
    start: usize,
    length: usize,
}

impl Aligned {
    pub fn zeros(length: usize) -> Self {
        let data = vec![0.0; length + 8];
        let start = data.as_ptr().align_offset(64).min(8);
        Aligned {
            data,
            start,
            length,
        }
    }

    pub fn all(&self) -> &[f64] {
        &self.data[self.start..self.start + self.length]
    }

    pub fn all_mut(&mut self) -> &mut [f64] {
        &mut self.data[self.start..self.start + self.length]
    }
}

/// The work on one plane.
pub(crate) struct Plane<'a> {
    pub factors: &'a Factors,
    /// Place among the factors' layers.
    pub layer: usize,
    pub u: &'a PaddedPlane,
    /// What the plane below and this one have so far, then this one and the one above: a pair a row, by column and equation.
    pub sums: &'a mut [f64],
    /// The plane below, which is complete now, by component.
    pub out: [&'a mut [f64]; 3],
    pub nx: usize,
}

impl WithSimd for Plane<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        self.equation::<S, 0>(simd);
        self.equation::<S, 1>(simd);
        self.equation::<S, 2>(simd);
    }
}

impl Plane<'_> {
    #[inline(always)]
    fn equation<S: Simd, const EQUATION: usize>(&mut self, simd: S) {
        let columns = self.nx.div_ceil(S::F64_LANES);
        let rows = self.factors.rows.len();
        let third = self.sums.len() / 3;
        let sums = &mut self.sums[EQUATION * third..(EQUATION + 1) * third];
        let mut sums = S::as_mut_simd_f64s(sums).0.chunks_exact_mut(2 * rows);
        for column in 0..columns {
            let Some(sums) = sums.next() else { return };
            let column = Column {
                factors: self.factors,
                layer: self.layer,
                u: self.u,
                column,
                nx: self.nx,
            };
            let out = &mut *self.out[EQUATION];
            if column.column == 0 || column.column + 1 == columns {
                column.run::<S, EQUATION, true>(simd, sums, out);
            } else {
                column.run::<S, EQUATION, false>(simd, sums, out);
            }
        }
    }
}

/// The topmost plane, to which no plane above will add.
pub(crate) struct LastPlane<'a> {
    pub rows: usize,
    /// As in [`Plane`].
    pub sums: &'a [f64],
    pub out: [&'a mut [f64]; 3],
    pub nx: usize,
}

impl WithSimd for LastPlane<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let columns = S::as_simd_f64s(self.sums).0.chunks_exact(2 * self.rows);
        let by_equation = self.sums.len() / (3 * 2 * self.rows * S::F64_LANES);
        let mut columns = columns.enumerate();
        while let Some((place, sums)) = columns.next() {
            let (equation, first) = (place / by_equation, place % by_equation * S::F64_LANES);
            let width = self.nx.saturating_sub(first).min(S::F64_LANES);
            let rows = self.out[equation][first.min(self.nx - 1)..].chunks_mut(self.nx);
            for (row, sums) in rows.zip(sums.chunks_exact(2)) {
                store::<S, true>(simd, row, width, sums[0]);
            }
        }
    }
}

/// One vector of neighbours along x through all rows.
struct Column<'a> {
    factors: &'a Factors,
    layer: usize,
    u: &'a PaddedPlane,
    column: usize,
    nx: usize,
}

/// The matrices of x at a vector of nodes.
#[derive(Clone, Copy)]
struct AlongX<S: Simd> {
    lumped: S::f64s,
    mass: [S::f64s; 2],
    stiffness: [S::f64s; 2],
    end: S::f64s,
    plain_end: S::f64s,
}

/// What a row has along x.
#[derive(Clone, Copy)]
struct Products<S: Simd> {
    a: S::f64s,
    b: S::f64s,
    p: S::f64s,
    q: S::f64s,
    r: S::f64s,
}

/// The matrices of z at a plane.
#[derive(Clone, Copy)]
struct AlongZ<S: Simd> {
    lumped: S::f64s,
    mass: [S::f64s; 2],
    stiffness: [S::f64s; 2],
    coupling: S::f64s,
    /// D's own entry at an end of z.
    end: Option<S::f64s>,
}

impl<S: Simd> AlongX<S> {
    #[inline(always)]
    fn new(factors: &Factors, column: usize, equation: usize) -> Self {
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
    fn both(&self, simd: S, [low, on, high]: [S::f64s; 3]) -> [S::f64s; 2] {
        let (below, above) = (simd.sub_f64s(on, low), simd.sub_f64s(high, on));
        let mass = simd.mul_add_e_f64s(self.mass[1], above, simd.mul_f64s(self.lumped, on));
        let stiffness = simd.mul_f64s(self.stiffness[0], below);
        [
            simd.negate_mul_add_e_f64s(self.mass[0], below, mass),
            simd.negate_mul_add_e_f64s(self.stiffness[1], above, stiffness),
        ]
    }

    /// M u.
    #[inline(always)]
    fn mean(&self, simd: S, u: [S::f64s; 3]) -> S::f64s {
        self.both(simd, u)[0]
    }

    /// 2 D u less a share of E u.
    #[inline(always)]
    fn slope<const END: bool>(&self, simd: S, [low, on, high]: [S::f64s; 3]) -> S::f64s {
        let slope = simd.sub_f64s(low, high);
        if END {
            simd.mul_add_e_f64s(self.end, on, slope)
        } else {
            slope
        }
    }

    /// 2 D u.
    #[inline(always)]
    fn plain_slope<const END: bool>(&self, simd: S, [low, on, high]: [S::f64s; 3]) -> S::f64s {
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
    fn new(simd: S, layer: &Layer, modulus: usize, coupling: f64, end: Option<f64>) -> Self {
        let (below, above) = (layer.below[modulus], layer.above[modulus]);
        AlongZ {
            lumped: simd.splat_f64s(layer.lumped),
            mass: [below.mass, above.mass].map(|v| simd.splat_f64s(v)),
            stiffness: [below.stiffness, above.stiffness].map(|v| simd.splat_f64s(v)),
            coupling: simd.splat_f64s(coupling),
            end: end.map(|v| simd.splat_f64s(v)),
        }
    }

    /// Adds to the sums of the plane below and of this one; returns the first, which is complete, and begins the plane above.
    #[inline(always)]
    fn add(&self, simd: S, [m, k, d]: [S::f64s; 3], sums: &mut [S::f64s; 2]) -> S::f64s {
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

/// The matrices of x at one vector, for one equation.
struct AcrossRow<S: Simd, const EQUATION: usize, const END: bool> {
    x: AlongX<S>,
    share: S::f64s,
    zero: S::f64s,
}

impl<S: Simd, const EQUATION: usize, const END: bool> AcrossRow<S, EQUATION, END> {
    #[inline(always)]
    fn products(&self, simd: S, row: [&[f64]; 3]) -> Products<S> {
        let x = &self.x;
        let [a, b] = x.both(simd, three::<S>(row[EQUATION]));
        let [p, q, r] = match EQUATION {
            0 => {
                let p = x.slope::<END>(simd, three::<S>(row[1]));
                [p, x.slope::<END>(simd, three::<S>(row[2])), self.zero]
            }
            1 => {
                let p = x.slope::<END>(simd, three::<S>(row[0]));
                [p, self.zero, x.mean(simd, three::<S>(row[2]))]
            }
            _ => {
                let q = x.slope::<END>(simd, three::<S>(row[0]));
                [self.zero, q, x.mean(simd, three::<S>(row[1]))]
            }
        };
        Products { a, b, p, q, r }
    }

    /// What E of y adds to f_m and takes from f_d on the last row, and the other way round on the first.
    #[inline(always)]
    fn on_face(&self, simd: S, row: [&[f64]; 3], r: S::f64s) -> [S::f64s; 2] {
        let (m, d) = match EQUATION {
            0 => (
                self.x.plain_slope::<END>(simd, three::<S>(row[1])),
                self.zero,
            ),
            1 => (self.x.plain_slope::<END>(simd, three::<S>(row[0])), r),
            _ => (self.zero, r),
        };
        [simd.mul_f64s(self.share, m), simd.mul_f64s(self.share, d)]
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

/// What row j has of f_m, f_k and f_d from itself and the rows below, turned in sign.
#[derive(Clone, Copy)]
struct Behind<S: Simd>([S::f64s; 3]);

/// Sums over the cells between two rows.
#[inline(always)]
fn between<S: Simd, const EQUATION: usize>(
    simd: S,
    cell: Cell,
    before: &Products<S>,
    on: &Products<S>,
) -> [S::f64s; 3] {
    let (mass, stiffness) = (simd.splat_f64s(cell.mass), simd.splat_f64s(cell.stiffness));
    let a = simd.sub_f64s(on.a, before.a);
    let b = simd.sub_f64s(on.b, before.b);
    let mut m = simd.negate_mul_add_e_f64s(stiffness, a, simd.mul_f64s(mass, b));
    if EQUATION < 2 {
        m = simd.add_f64s(m, simd.add_f64s(on.p, before.p));
    }
    let k = simd.mul_f64s(mass, a);
    // Of 2 D r = w_(below) - w_(above) this is the cell above.
    let d = match EQUATION {
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
    /// The cell below less what the row's own lumped masses give.
    #[inline(always)]
    fn new<const EQUATION: usize>(
        simd: S,
        lumped: f64,
        on: &Products<S>,
        [m, k, d]: [S::f64s; 3],
    ) -> Self {
        let lumped = simd.splat_f64s(lumped);
        Behind([
            simd.negate_mul_add_e_f64s(lumped, on.b, m),
            simd.negate_mul_add_e_f64s(lumped, on.a, k),
            match EQUATION {
                1 => d,
                _ => simd.negate_mul_add_e_f64s(lumped, on.q, d),
            },
        ])
    }

    /// f_m, f_k and f_d with the cell above.
    #[inline(always)]
    fn with(&self, simd: S, [m, k, d]: [S::f64s; 3]) -> [S::f64s; 3] {
        let Behind(behind) = self;
        [
            simd.sub_f64s(m, behind[0]),
            simd.sub_f64s(k, behind[1]),
            simd.sub_f64s(d, behind[2]),
        ]
    }
}

/// Writes a vector to the beginning of a row.
#[inline(always)]
fn store<S: Simd, const END: bool>(simd: S, row: &mut [f64], width: usize, value: S::f64s) {
    if END && width < S::F64_LANES {
        simd.partial_store_f64s(&mut row[..width], value);
    } else {
        S::as_mut_simd_f64s(&mut row[..S::F64_LANES]).0[0] = value;
    }
}

impl Column<'_> {
    #[inline(always)]
    fn run<S: Simd, const EQUATION: usize, const END: bool>(
        &self,
        simd: S,
        sums: &mut [S::f64s],
        out: &mut [f64],
    ) {
        let factors = self.factors;
        let lanes = S::F64_LANES;
        let first = self.column * lanes;
        let width = (self.nx - first).min(lanes);
        // The modulus of K is lambda + 2 mu along the equation's own axis and mu along the others.
        let modulus = [0, 1, 2].map(|axis| usize::from(axis == EQUATION));
        let across = AcrossRow::<S, EQUATION, END> {
            x: AlongX::new(factors, self.column, EQUATION),
            share: simd.splat_f64s(factors.shares[usize::from(EQUATION == 1)]),
            zero: simd.splat_f64s(0.0),
        };
        let coupling = factors.coupling;
        let end = match self.layer {
            0 => Some(coupling),
            k if k + 1 == factors.layers.len() => Some(-coupling),
            _ => None,
        };
        let z = AlongZ::new(simd, &factors.layers[self.layer], modulus[2], coupling, end);
        // All of one length a row, so that one counter leads through them.
        let from = WIDEST - 1 + first;
        let u = self.u.values.each_ref().map(|values| {
            let stride = self.u.stride;
            let rows = &values.all()[from..from + factors.rows.len() * stride];
            rows.chunks_exact(stride)
        });
        let (sums, _) = sums.as_chunks_mut::<2>();
        let (Some((last_sums, sums)), Some((_, cells))) =
            (sums.split_last_mut(), factors.rows.split_last())
        else {
            return;
        };
        let (out, last_out) = out[first..].split_at_mut(cells.len() * self.nx);
        let out = out.chunks_exact_mut(self.nx);

        let [mut ux, mut uy, mut uz] = u;
        let (Some(x), Some(y), Some(z_row)) = (ux.next(), uy.next(), uz.next()) else {
            return;
        };
        let mut row = [x, y, z_row];
        let mut on = across.products(simd, row);
        let [m, d] = across.on_face(simd, row, on.r);
        let beyond = [m, across.zero, simd.neg_f64s(d)];
        let mut behind = Behind::new::<EQUATION>(simd, factors.rows[0].lumped, &on, beyond);
        let input = ux.zip(uy).zip(uz);
        let steps = input.zip(cells).zip(&factors.rows[1..]).zip(sums).zip(out);
        for ((((((x, y), z_row), below), here), sums), out) in steps {
            row = [x, y, z_row];
            let next = across.products(simd, row);
            let cell = between::<S, EQUATION>(simd, below.above[modulus[1]], &on, &next);
            let complete = z.add(simd, behind.with(simd, cell), sums);
            store::<S, END>(simd, out, width, complete);
            behind = Behind::new::<EQUATION>(simd, here.lumped, &next, cell);
            on = next;
        }
        let [m, d] = across.on_face(simd, row, on.r);
        let beyond = [m, across.zero, simd.neg_f64s(d)];
        let complete = z.add(simd, behind.with(simd, beyond), last_sums);
        store::<S, END>(simd, last_out, width, complete);
    }
}
