//! K u on some neighbouring planes: one walk up z through them and the two beside them.

use std::fmt;
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

use crate::padded_plane::{Aligned, PaddedPlane};
use crate::tensor_factors::{Factors, padded};
use crate::tensor_kernel::{LastPlane, Plane};

/// What a walk works in.
pub(crate) struct Scratch {
    u: PaddedPlane,
    sums: Aligned,
    /// Planes that belong to another walk.
    discarded: [Vec<f64>; 3],
    /// Room for a row.
    pub row: Vec<f64>,
}

impl Scratch {
    fn new([nx, ny, _]: [usize; 3]) -> Self {
        Scratch {
            u: PaddedPlane::new([nx, ny]),
            sums: Aligned::zeros(3 * 2 * ny * padded(nx)),
            discarded: std::array::from_fn(|_| vec![0.0; nx * ny]),
            row: Vec::with_capacity(nx + 2),
        }
    }
}

/// Scratch that waits for the next walk.
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

/// The planes `planes` of one material's K u into `out`, by component, but for what the ends of z add.
///
/// A plane's sum takes the plane below it, itself and the plane above in this order, wherever the walk begins.
pub(crate) fn walk(
    factors: &Factors,
    u: &[f64],
    shape: [usize; 3],
    planes: Range<usize>,
    scratch: &mut Scratch,
    out: &mut [&mut [f64]; 3],
) {
    let size = shape[0] * shape[1];
    let arch = pulp::Arch::new();
    let from = planes.start.saturating_sub(1).max(factors.first);
    let to = planes.end.min(factors.end() - 1);
    scratch.sums.all_mut().fill(0.0);
    for k in from..=to {
        scratch.u.fill(u, shape, k);
        let complete = match k.checked_sub(planes.start + 1) {
            Some(place) => part(out, place * size..(place + 1) * size),
            None => scratch.discarded.each_mut().map(|plane| &mut plane[..]),
        };
        arch.dispatch(Plane {
            factors,
            layer: k - factors.first,
            u: &scratch.u,
            sums: scratch.sums.all_mut(),
            out: complete,
            nx: shape[0],
        });
    }
    if planes.end == factors.end() {
        let place = planes.len() - 1;
        arch.dispatch(LastPlane {
            rows: shape[1],
            sums: scratch.sums.all(),
            out: part(out, place * size..(place + 1) * size),
            nx: shape[0],
        });
    }
}

/// A part of each component.
pub(crate) fn part<'a>(out: &'a mut [&mut [f64]; 3], range: Range<usize>) -> [&'a mut [f64]; 3] {
    out.each_mut()
        .map(|component| &mut component[range.clone()])
}
