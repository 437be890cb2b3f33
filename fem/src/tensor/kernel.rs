//! Contribution of one plane of u to K u on this plane and on the two adjacent ones.
//!
//! A vector of adjacent nodes along x is processed row by row in y, for one equation or two at a
//! time. Each row has the products along x,
//!
//! a = M u, b = K u of the equation's own component, p, q and r of the others (2 D u or M u),
//!
//! from them the products along y, with M, K and D as sums over cells ([`crate::tensor::factors`]),
//!
//! f_m = M b + K a - 2 D p, f_k = M a, f_d = M q + 2 D r,
//!
//! and M f_m + K f_k - 2 D f_d along z, which is added to the contributions of the previous planes.
//! Only these sums are stored: two planes of them, one column of vectors after the other.
//!
//! Rows may be processed in bands ([`crate::tensor::slab`]); a band also computes the products of
//! the adjacent rows.
//!
//! | equation | p | q | r |
//! |---|---|---|---|
//! | x | 2 D u_y | 2 D u_z | |
//! | y | 2 D u_x | | M u_z |
//! | z | | 2 D u_x | M u_y |
//!
//! The equations y and z both need M u_y, M u_z and D u_x, and are processed together. The equation
//! of x needs none of these.

use std::ops::Range;

use prefetch_index::prefetch_index;
use pulp::{Simd, WithSimd};

use crate::tensor::factors::{Factors, WIDEST};
use crate::tensor::slab::RowEnds;
use crate::tensor::stencils::{AcrossRow, AlongX, AlongZ, Behind, between};

/// Input for a band of one plane.
pub(crate) struct Band<'a> {
    pub factors: &'a Factors,
    /// Place among the factors' layers.
    pub layer: usize,
    /// The band's rows of u and the two next to them, by component.
    pub rows: [&'a [f64]; 3],
    /// The same rows' ends.
    pub ends: &'a RowEnds,
    pub nx: usize,
    /// Neighbouring rows.
    pub band: Range<usize>,
    /// Where the same band of the next plane will read and write, by component: a band's lines are
    /// prefetched.
    pub ahead: [[&'a [f64]; 2]; 3],
}

/// The work on a band of one plane.
pub(crate) struct Plane<'a> {
    pub read: Band<'a>,
    /// Partial sums of the plane below and of this one, afterwards of this one and of the one
    /// above: a pair per row and equation, by group of equations and column.
    pub sums: &'a mut [f64],
    /// The plane below, which is then complete, by component.
    pub out: [&'a mut [f64]; 3],
}

impl WithSimd for Plane<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        if self.read.band.len() == self.read.factors.rows.len() {
            self.equations::<S, true>(simd);
        } else {
            self.equations::<S, false>(simd);
        }
    }
}

/// First equation of each group and their number.
const GROUPS: [(usize, usize); 2] = [(0, 1), (1, 2)];

/// A group's part of the sums.
fn part(sums: usize, (first, number): (usize, usize)) -> Range<usize> {
    first * sums / 3..(first + number) * sums / 3
}

impl Plane<'_> {
    #[inline(always)]
    fn equations<S: Simd, const WHOLE: bool>(&mut self, simd: S) {
        self.group::<S, { GROUPS[0].0 }, { GROUPS[0].1 }, WHOLE>(simd);
        self.group::<S, { GROUPS[1].0 }, { GROUPS[1].1 }, WHOLE>(simd);
    }

    #[inline(always)]
    fn group<S: Simd, const FIRST: usize, const N: usize, const WHOLE: bool>(&mut self, simd: S) {
        let columns = self.read.nx.div_ceil(S::F64_LANES);
        let rows = self.read.band.len();
        let part = part(self.sums.len(), (FIRST, N));
        let sums = S::as_mut_simd_f64s(&mut self.sums[part]).0;
        let mut sums = sums.chunks_exact_mut(2 * N * rows);
        for column in 0..columns {
            let Some(sums) = sums.next() else { return };
            let (read, out) = (&self.read, &mut self.out[FIRST..FIRST + N]);
            if column == 0 || (column + 1) * S::F64_LANES >= read.nx {
                read.column::<S, FIRST, N, true, WHOLE>(simd, column, sums, out);
            } else {
                read.column::<S, FIRST, N, false, WHOLE>(simd, column, sums, out);
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
    fn with_simd<S: Simd>(mut self, simd: S) {
        let height = self.band.len();
        for (first, number) in GROUPS {
            let sums = S::as_simd_f64s(&self.sums[part(self.sums.len(), (first, number))]).0;
            let columns = (0..self.nx).step_by(S::F64_LANES);
            for (node, sums) in columns.zip(sums.chunks_exact(2 * number * height)) {
                let width = (self.nx - node).min(S::F64_LANES);
                for (row, sums) in self.band.clone().zip(sums.chunks_exact(2 * number)) {
                    for (out, sums) in self.out[first..].iter_mut().zip(sums.chunks_exact(2)) {
                        let to = &mut out[row * self.nx + node..];
                        store::<S, true>(simd, to, width, sums[0]);
                    }
                }
            }
        }
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

impl Band<'_> {
    /// The equations `FIRST` to `FIRST + N` at one vector of neighbours along x, at an `END` of the
    /// rows or not, in all rows or some.
    #[inline(always)]
    fn column<S: Simd, const FIRST: usize, const N: usize, const END: bool, const WHOLE: bool>(
        &self,
        simd: S,
        column: usize,
        sums: &mut [S::f64s],
        out: &mut [&mut [f64]],
    ) {
        let factors = self.factors;
        let lanes = S::F64_LANES;
        let first = column * lanes;
        let width = (self.nx - first).min(lanes);
        let across = AcrossRow::<S, FIRST, N, END> {
            x: AlongX::new(factors, column, FIRST),
            shares: factors.shares.map(|share| simd.splat_f64s(share)),
            zero: simd.splat_f64s(0.0),
        };
        let coupling = factors.coupling;
        let end = match self.layer {
            0 => Some(coupling),
            k if k + 1 == factors.layers.len() => Some(-coupling),
            _ => None,
        };
        // The modulus of K is lambda + 2 mu along the equation's own axis and mu along the others.
        let modulus = |axis: usize, e: usize| usize::from(axis == FIRST + e);
        let layer = &factors.layers[self.layer];
        let mut z = [AlongZ::new(simd, layer, modulus(2, 0), coupling, end); N];
        z[N - 1] = AlongZ::new(simd, layer, modulus(2, N - 1), coupling, end);
        let rows = &factors.rows;
        let begins = WHOLE || self.band.start == 0;
        let ends = WHOLE || self.band.end == rows.len();
        // All of one length a row, so that one counter leads through them.
        let (stride, from) = if END {
            (self.ends.stride, WIDEST + first - 1)
        } else {
            (self.nx, first - 1)
        };
        let until = from + lanes + 2;
        let height = self.band.len() + usize::from(!begins) + usize::from(!ends);
        let [mut ux, mut uy, mut uz] = [0, 1, 2].map(|c| {
            let rows = if END {
                self.ends.values[c].all()
            } else {
                self.rows[c]
            };
            let rows = rows[..height * stride].chunks_exact(stride);
            rows.map(move |row| &row[from..until])
        });
        let (Some(x), Some(y), Some(z_row)) = (ux.next(), uy.next(), uz.next()) else {
            return;
        };
        let mut row = [x, y, z_row];
        let mut on = across.products(simd, row);
        let mut cell = [[across.zero; 3]; N];
        if begins {
            for e in 0..N {
                let [m, d] = across.on_face(simd, FIRST + e, row, on[e].r);
                cell[e] = [m, across.zero, simd.neg_f64s(d)];
            }
        } else {
            let (Some(x), Some(y), Some(z_row)) = (ux.next(), uy.next(), uz.next()) else {
                return;
            };
            let next = across.products(simd, [x, y, z_row]);
            let above = &rows[self.band.start - 1].above;
            for e in 0..N {
                cell[e] = between(simd, FIRST + e, above[modulus(1, e)], &on[e], &next[e]);
            }
            on = next;
        }
        let lumped = rows[self.band.start].lumped;
        let mut behind = [Behind::new(simd, FIRST, lumped, &on[0], cell[0]); N];
        behind[N - 1] = Behind::new(simd, FIRST + N - 1, lumped, &on[N - 1], cell[N - 1]);
        // Rows that have one above them.
        let inner = self.band.start..self.band.end - usize::from(ends);
        let (sums, _) = sums.as_chunks_mut::<2>();
        let (sums, last_sums) = sums.split_at_mut(N * inner.len());
        let pairs = rows[inner.clone()].iter().zip(&rows[inner.start + 1..]);
        let steps = ux.zip(uy).zip(uz).zip(pairs).zip(sums.chunks_exact_mut(N));
        let base = inner.start * self.nx + first;
        let mut ahead = column * self.band.len() * lanes;
        for (i, ((((x, y), z_row), (below, here)), sums)) in steps.enumerate() {
            if !WHOLE {
                for [read, written] in &self.ahead[FIRST..FIRST + N] {
                    prefetch_index(read, ahead);
                    prefetch_index(written, ahead);
                }
                ahead += lanes;
            }
            row = [x, y, z_row];
            let next = across.products(simd, row);
            for e in 0..N {
                let cell = below.above[modulus(1, e)];
                let cell = between(simd, FIRST + e, cell, &on[e], &next[e]);
                let complete = z[e].add(simd, behind[e].with(simd, cell), &mut sums[e]);
                store::<S, END>(simd, &mut out[e][base + i * self.nx..], width, complete);
                behind[e] = Behind::new(simd, FIRST + e, here.lumped, &next[e], cell);
            }
            on = next;
        }
        for (e, sums) in last_sums.iter_mut().enumerate() {
            let [m, d] = across.on_face(simd, FIRST + e, row, on[e].r);
            let zeros_outside = [m, across.zero, simd.neg_f64s(d)];
            let complete = z[e].add(simd, behind[e].with(simd, zeros_outside), sums);
            let to = &mut out[e][base + inner.len() * self.nx..];
            store::<S, END>(simd, to, width, complete);
        }
    }
}
