//! Numbers of some cells in one vector.

use std::ops::{Add, AddAssign, Mul, Sub};

use pulp::Simd;

/// How many cells lie side by side in a batch of the matrix-free operator: a vector holds as many or a whole part of them.
pub(crate) const LANES: usize = 4;

/// One number of each of a batch's cells, as it is stored.
pub(crate) type Stored = [f64; LANES];

/// One number of each of the cells that a vector holds.
///
/// The vector type is named, not left to be found in loops over its numbers: those take the compiler many times as long.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<S: Simd> {
    simd: S,
    values: S::f64s,
}

impl<S: Simd> Lanes<S> {
    /// The same number in every lane.
    #[inline(always)]
    pub fn splat(simd: S, value: f64) -> Self {
        let values = simd.splat_f64s(value);
        Lanes { simd, values }
    }

    /// The vector instructions that these numbers go by.
    #[inline(always)]
    pub fn simd(self) -> S {
        self.simd
    }

    /// The same number in every lane of a vector as this one.
    #[inline(always)]
    pub fn filled(self, value: f64) -> Self {
        Self::splat(self.simd, value)
    }

    /// The stored numbers from cell `first` of the batch.
    #[inline(always)]
    pub fn load(simd: S, stored: &Stored, first: usize) -> Self {
        let values = S::as_simd_f64s(&stored[first..first + S::F64_LANES]).0[0];
        Lanes { simd, values }
    }

    /// Stores the numbers from cell `first` of the batch.
    #[inline(always)]
    pub fn store(self, stored: &mut [f64], first: usize) {
        S::as_mut_simd_f64s(&mut stored[first..first + S::F64_LANES]).0[0] = self.values;
    }

    /// One over each number.
    #[inline(always)]
    pub fn recip(self) -> Self {
        let one = self.simd.splat_f64s(1.0);
        Lanes {
            values: self.simd.div_f64s(one, self.values),
            ..self
        }
    }
}

macro_rules! elementwise {
    ($trait:ident, $method:ident, $op:ident) => {
        impl<S: Simd> $trait for Lanes<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Lanes {
                    values: self.simd.$op(self.values, other.values),
                    ..self
                }
            }
        }
    };
}

elementwise!(Add, add, add_f64s);
elementwise!(Sub, sub, sub_f64s);
elementwise!(Mul, mul, mul_f64s);

impl<S: Simd> AddAssign for Lanes<S> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}
