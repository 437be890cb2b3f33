//! Four numbers at once.

use std::ops::{Add, AddAssign, Mul, Sub};

/// How many cells go through the matrix-free operator side by side.
pub(crate) const LANES: usize = 4;

/// One number of each of four cells. Its loops are of fixed length, so that they become vector instructions.
#[derive(Clone, Copy, Debug, Default)]
#[repr(align(32))]
pub(crate) struct Lanes(pub [f64; LANES]);

macro_rules! elementwise {
    ($trait:ident, $method:ident, $op:tt) => {
        impl $trait for Lanes {
            type Output = Lanes;

            #[inline(always)]
            fn $method(self, other: Lanes) -> Lanes {
                let mut out = [0.0; LANES];
                for l in 0..LANES {
                    out[l] = self.0[l] $op other.0[l];
                }
                Lanes(out)
            }
        }
    };
}

elementwise!(Add, add, +);
elementwise!(Sub, sub, -);
elementwise!(Mul, mul, *);

impl AddAssign for Lanes {
    #[inline(always)]
    fn add_assign(&mut self, other: Lanes) {
        *self = *self + other;
    }
}

impl Lanes {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(value: f64) -> Self {
        Lanes([value; LANES])
    }

    /// One over each number.
    #[inline(always)]
    pub fn recip(self) -> Self {
        let mut out = [0.0; LANES];
        for l in 0..LANES {
            out[l] = 1.0 / self.0[l];
        }
        Lanes(out)
    }
}
