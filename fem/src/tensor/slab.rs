//! K u on consecutive planes: one walk in z over them and the two adjacent planes, or one for each
//! band of rows.

use std::fmt;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::tensor::factors::{Factors, WIDEST, padded};
use crate::tensor::kernel::{Band, LastPlane, Plane};

/// Workspace of a walk.
pub(crate) struct Scratch {
    ends: RowEnds,
    sums: Aligned,
    /// Planes that belong to another walk.
    discarded: [Vec<f64>; 3],
    /// Room for a row.
    pub row: Vec<f64>,
    /// Result of a further sum of products; empty if there is only one.
    pub further: Vec<f64>,
}

impl Scratch {
    fn new([nx, ny, _]: [usize; 3]) -> Self {
        Scratch {
            ends: RowEnds::new([nx, ny]),
            sums: Aligned::zeros(3 * 2 * ny * padded(nx)),
            discarded: std::array::from_fn(|_| vec![0.0; nx * ny]),
            row: Vec::with_capacity(nx + 2),
            further: Vec::new(),
        }
    }
}

/// Workspaces for reuse by the next walks.
#[derive(Default)]
pub(crate) struct Pool(Mutex<Vec<Scratch>>);

impl Pool {
    pub fn with<T>(&self, shape: [usize; 3], work: impl FnOnce(&mut Scratch) -> T) -> T {
        let waiting = || self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let taken = waiting().pop();
        let mut scratch = taken.unwrap_or_else(|| Scratch::new(shape));
        let result = work(&mut scratch);
        waiting().push(scratch);
        result
    }
}

/// A copy has scratch of its own.
impl Clone for Pool {
    fn clone(&self) -> Self {
        Pool::default()
    }
}

impl fmt::Debug for Pool {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Pool")
    }
}

/// Writes the planes `planes` of one material's K u to `out`, by component, without the terms of
/// the ends of z.
///
/// A plane's sum adds the plane below, the plane itself and the plane above in this order, wherever
/// the walk begins. Bands of `height` rows are processed together; results do not depend on it.
pub(crate) fn walk(
    factors: &Factors,
    u: &[f64],
    shape: [usize; 3],
    planes: Range<usize>,
    height: usize,
    scratch: &mut Scratch,
    out: &mut [&mut [f64]; 3],
) {
    let [nx, ny, nz] = shape;
    let size = nx * ny;
    let arch = pulp::Arch::new();
    let from = planes.start.saturating_sub(1).max(factors.first);
    let to = planes.end.min(factors.end() - 1);
    for first in (0..ny).step_by(height) {
        let band = first..(first + height).min(ny);
        let read = first.saturating_sub(1)..(band.end + 1).min(ny);
        let sums = 3 * 2 * band.len() * padded(nx);
        let sums = &mut scratch.sums.all_mut()[..sums];
        sums.fill(0.0);
        for k in from..=to {
            let rows = [0, 1, 2].map(|c| {
                let plane = (c * nz + k) * ny;
                &u[(plane + read.start) * nx..(plane + read.end) * nx]
            });
            scratch.ends.fill(rows, nx);
            let place = k.checked_sub(planes.start + 1);
            let (complete, later): ([&mut [f64]; 3], [&[f64]; 3]) = match place {
                Some(place) => {
                    let halves = out
                        .each_mut()
                        .map(|component| component[place * size..].split_at_mut(size));
                    let [(x, above_x), (y, above_y), (z, above_z)] = halves;
                    ([x, y, z], [above_x, above_y, above_z])
                }
                None => (
                    scratch.discarded.each_mut().map(|plane| &mut plane[..]),
                    out.each_ref().map(|component| &component[..size]),
                ),
            };
            let next = (k + 1).min(to);
            let ahead = [0, 1, 2].map(|c| {
                let later = later[c].get(first * nx..).unwrap_or_default();
                [&u[(c * nz + next) * size + first * nx..], later]
            });
            arch.dispatch(Plane {
                read: Band {
                    factors,
                    layer: k - factors.first,
                    rows,
                    ends: &scratch.ends,
                    nx,
                    band: band.clone(),
                    ahead,
                },
                sums,
                out: complete,
            });
        }
        if planes.end == factors.end() {
            let place = planes.len() - 1;
            arch.dispatch(LastPlane {
                sums,
                out: part(out, place * size..(place + 1) * size),
                nx,
                band,
            });
        }
    }
}

/// Number of rows of a band: all rows if u and K u fit into the last cache, otherwise as many as
/// the workspace of a walk in a core's own cache allows.
///
/// Each band recomputes the products along x of the two adjacent rows.
pub(crate) fn band_height([nx, ny, nz]: [usize; 3]) -> usize {
    const NUMBER: usize = size_of::<f64>();
    if 2 * 3 * nx * ny * nz * NUMBER <= LAST_CACHE {
        return ny;
    }
    let row = 3 * 2 * padded(nx) * NUMBER;
    let bands = (row * ny).div_ceil(SUMS).min(ny / 8).max(1);
    ny.div_ceil(bands)
}

/// Size of u and K u that is expected to stay in the last cache, together with the other vectors of
/// a solve [bytes].
const LAST_CACHE: usize = 12 << 20;
/// Size of a band's sums [bytes]. The adjacent rows of u, and prefetched data, take at least as
/// much again.
const SUMS: usize = 128 << 10;

/// A part of each component.
pub(crate) fn part<'a>(out: &'a mut [&mut [f64]; 3], range: Range<usize>) -> [&'a mut [f64]; 3] {
    out.each_mut()
        .map(|component| &mut component[range.clone()])
}

/// The ends of rows of u, padded with zeros, for vectors along x that would extend beyond the rows.
///
/// Vectors in the interior read u itself.
pub(crate) struct RowEnds {
    /// Values by component; node i of a row has the index `WIDEST + i` within `stride`.
    pub values: [Aligned; 3],
    /// Number of values from one row to the next.
    pub stride: usize,
}

/// A vector and the neighbour after it.
const END: usize = WIDEST + 1;

impl RowEnds {
    pub fn new([nx, ny]: [usize; 2]) -> Self {
        // An odd number of cache lines, so that a column of rows spreads over all of a cache's
        // sets.
        let lines = (padded(nx) + 2 * WIDEST) / 8;
        let stride = 8 * (lines | 1);
        RowEnds {
            values: std::array::from_fn(|_| Aligned::zeros(ny * stride)),
            stride,
        }
    }

    /// Copies the ends of rows of nx numbers, by component.
    pub fn fill(&mut self, rows: [&[f64]; 3], nx: usize) {
        for (values, rows) in self.values.iter_mut().zip(rows) {
            let rows = rows.chunks_exact(nx);
            for (to, from) in values.all_mut().chunks_exact_mut(self.stride).zip(rows) {
                let to = &mut to[WIDEST..WIDEST + nx];
                match (from.first_chunk::<END>(), from.last_chunk::<END>()) {
                    (Some(first), Some(last)) => {
                        to[..END].copy_from_slice(first);
                        to[nx - END..].copy_from_slice(last);
                    }
                    _ => to.copy_from_slice(from),
                }
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
