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
//! Rows may go up in bands ([`crate::tensor_slab`]); a band takes the products of the rows beside it too.
//!
//! | equation | p | q | r |
//! |---|---|---|---|
//! | x | 2 D u_y | 2 D u_z | |
//! | y | 2 D u_x | | M u_z |
//! | z | | 2 D u_x | M u_y |

use std::ops::Range;

use prefetch_index::prefetch_index;
use pulp::{Simd, WithSimd};

use crate::padded_plane::PaddedPlane;
use crate::tensor_factors::{Factors, WIDEST};
use crate::tensor_stencils::{AcrossRow, AlongX, AlongZ, Behind, between};

/// The work on a band of one plane.
pub(crate) struct Plane<'a> {
    pub factors: &'a Factors,
    /// Place among the factors' layers.
    pub layer: usize,
    /// The band's rows and the two beside them.
    pub u: &'a PaddedPlane,
    /// What the plane below and this one have so far, then this one and the one above: a pair a row, by column and equation.
    pub sums: &'a mut [f64],
    /// The plane below, which is complete now, by component.
    pub out: [&'a mut [f64]; 3],
    pub nx: usize,
    /// Neighbouring rows.
    pub band: Range<usize>,
    /// Where the same band of the next plane will read and write, by component: a band's lines are asked for ahead of time.
    pub ahead: [[&'a [f64]; 2]; 3],
}

impl WithSimd for Plane<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        if self.band.len() == self.factors.rows.len() {
            self.equations::<S, true>(simd);
        } else {
            self.equations::<S, false>(simd);
        }
    }
}

impl Plane<'_> {
    #[inline(always)]
    fn equations<S: Simd, const WHOLE: bool>(&mut self, simd: S) {
        self.equation::<S, 0, WHOLE>(simd);
        self.equation::<S, 1, WHOLE>(simd);
        self.equation::<S, 2, WHOLE>(simd);
    }

    #[inline(always)]
    fn equation<S: Simd, const EQUATION: usize, const WHOLE: bool>(&mut self, simd: S) {
        let columns = self.nx.div_ceil(S::F64_LANES);
        let rows = self.band.len();
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
                band: &self.band,
                ahead: self.ahead[EQUATION],
            };
            let out = &mut *self.out[EQUATION];
            if column.column == 0 || column.column + 1 == columns {
                column.run::<S, EQUATION, true, WHOLE>(simd, sums, out);
            } else {
                column.run::<S, EQUATION, false, WHOLE>(simd, sums, out);
            }
        }
    }
}

/// A band of the topmost plane, to which no plane above will add.
pub(crate) struct LastPlane<'a> {
    /// As in [`Plane`].
    pub sums: &'a [f64],
    pub out: [&'a mut [f64]; 3],
    pub nx: usize,
    /// As in [`Plane`].
    pub band: Range<usize>,
}

impl WithSimd for LastPlane<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let height = self.band.len();
        let columns = S::as_simd_f64s(self.sums).0.chunks_exact(2 * height);
        let by_equation = self.sums.len() / (3 * 2 * height * S::F64_LANES);
        for (place, sums) in columns.enumerate() {
            let (equation, first) = (place / by_equation, place % by_equation * S::F64_LANES);
            let width = self.nx.saturating_sub(first).min(S::F64_LANES);
            let from = self.band.start * self.nx + first.min(self.nx - 1);
            let rows = self.out[equation][from..].chunks_mut(self.nx);
            for (row, sums) in rows.zip(sums.chunks_exact(2)) {
                store::<S, true>(simd, row, width, sums[0]);
            }
        }
    }
}

/// One vector of neighbours along x through the band's rows.
struct Column<'a> {
    factors: &'a Factors,
    layer: usize,
    u: &'a PaddedPlane,
    column: usize,
    nx: usize,
    band: &'a Range<usize>,
    ahead: [&'a [f64]; 2],
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
    fn run<S: Simd, const EQUATION: usize, const END: bool, const WHOLE: bool>(
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
        let rows = &factors.rows;
        let begins = WHOLE || self.band.start == 0;
        let ends = WHOLE || self.band.end == rows.len();
        // All of one length a row, so that one counter leads through them.
        let from = WIDEST - 1 + first;
        let height = self.band.len() + usize::from(!begins) + usize::from(!ends);
        let [mut ux, mut uy, mut uz] = self.u.values.each_ref().map(|values| {
            let stride = self.u.stride;
            values.all()[from..from + height * stride].chunks_exact(stride)
        });
        let (Some(x), Some(y), Some(z_row)) = (ux.next(), uy.next(), uz.next()) else {
            return;
        };
        let mut row = [x, y, z_row];
        let mut on = across.products(simd, row);
        let cell = if begins {
            let [m, d] = across.on_face(simd, row, on.r);
            [m, across.zero, simd.neg_f64s(d)]
        } else {
            let (Some(x), Some(y), Some(z_row)) = (ux.next(), uy.next(), uz.next()) else {
                return;
            };
            let next = across.products(simd, [x, y, z_row]);
            let below = &rows[self.band.start - 1];
            let cell = between::<S, EQUATION>(simd, below.above[modulus[1]], &on, &next);
            on = next;
            cell
        };
        let mut behind = Behind::new::<EQUATION>(simd, rows[self.band.start].lumped, &on, cell);
        // Rows that have one above them.
        let inner = self.band.start..self.band.end - usize::from(ends);
        let (sums, _) = sums.as_chunks_mut::<2>();
        let (sums, last_sums) = sums.split_at_mut(inner.len());
        let out = &mut out[inner.start * self.nx + first..];
        let (out, last_out) = out.split_at_mut(inner.len() * self.nx);
        let out = out.chunks_exact_mut(self.nx);
        let pairs = rows[inner.clone()].iter().zip(&rows[inner.start + 1..]);
        let steps = ux.zip(uy).zip(uz).zip(pairs).zip(sums).zip(out);
        let mut ahead = self.column * self.band.len() * lanes;
        for (((((x, y), z_row), (below, here)), sums), out) in steps {
            if !WHOLE {
                prefetch_index(self.ahead[0], ahead);
                prefetch_index(self.ahead[1], ahead);
                ahead += lanes;
            }
            row = [x, y, z_row];
            let next = across.products(simd, row);
            let cell = between::<S, EQUATION>(simd, below.above[modulus[1]], &on, &next);
            let complete = z.add(simd, behind.with(simd, cell), sums);
            store::<S, END>(simd, out, width, complete);
            behind = Behind::new::<EQUATION>(simd, here.lumped, &next, cell);
            on = next;
        }
        if let Some(sums) = last_sums.first_mut() {
            let [m, d] = across.on_face(simd, row, on.r);
            let beyond = [m, across.zero, simd.neg_f64s(d)];
            let complete = z.add(simd, behind.with(simd, beyond), sums);
            store::<S, END>(simd, last_out, width, complete);
        }
    }
}
