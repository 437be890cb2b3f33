//! Natural derivatives of four trilinear fields at once.
//!
//! A trilinear field is eight coefficients of 1, xi, eta, zeta, xi eta, ..., xi eta zeta. Its derivative by xi depends on
//! eta and zeta alone, so that it takes four values at the eight Gauss points, and those are sums and differences of scaled
//! coefficients: neither derivatives nor their transpose need a multiplication.

use pulp::Simd;

use crate::element::hex8::GAUSS;
use crate::matrix_free::lanes::Lanes;

/// Values of three components at eight corners.
pub(crate) type CornerField<S> = [[Lanes<S>; 3]; 8];

/// Derivatives of one component by xi, eta, zeta at four sign pairs each: by xi at (eta, zeta), by eta at (zeta, xi), by
/// zeta at (xi, eta); pairs in the order --, +-, -+, ++.
pub(super) type Derivatives<S> = [[Lanes<S>; 4]; 3];

/// Sign pair of Gauss point `g` (corners' order) that a derivative by natural axis `m` depends on.
#[inline(always)]
pub(super) const fn pair(g: usize, m: usize) -> usize {
    positive(g, (m + 1) % 3) as usize + 2 * positive(g, (m + 2) % 3) as usize
}

/// Sign of natural coordinate `m` at Gauss point `g`.
#[inline(always)]
pub(super) const fn positive(g: usize, m: usize) -> bool {
    match m {
        0 => (g ^ (g >> 1)) & 1 != 0,
        1 => g & 2 != 0,
        _ => g & 4 != 0,
    }
}

#[inline(always)]
fn butterfly<S: Simd>(a: Lanes<S>, b: Lanes<S>) -> (Lanes<S>, Lanes<S>) {
    (a + b, a - b)
}

/// Sums of the eight values with the signs of 1, xi, eta, xi eta, zeta, zeta xi, eta zeta, xi eta zeta; its own transpose up to
/// the order of the corners.
#[inline(always)]
fn hadamard<S: Simd>(v: [Lanes<S>; 8]) -> [Lanes<S>; 8] {
    // v in binary order: bit 0 is xi, bit 1 eta, bit 2 zeta.
    let mut v = v;
    for bit in [1, 2, 4] {
        for i in 0..8 {
            if i & bit == 0 {
                let (sum, difference) = butterfly(v[i + bit], v[i]);
                v[i] = sum;
                v[i + bit] = difference;
            }
        }
    }
    v
}

/// VTK's corner of each binary index.
const BINARY: [usize; 8] = [0, 1, 3, 2, 4, 5, 7, 6];

/// Coefficients of the natural derivatives: by axis m those of 1, next axis, next but one, both.
const OF_DERIVATIVE: [[usize; 4]; 3] = [[1, 3, 5, 7], [2, 6, 3, 7], [4, 5, 6, 7]];

/// Their values at the Gauss points' signs over the Hadamard sums.
const SCALE: [f64; 4] = [1.0 / 8.0, GAUSS / 8.0, GAUSS / 8.0, GAUSS * GAUSS / 8.0];

#[inline(always)]
fn derivatives<S: Simd>(corners: [Lanes<S>; 8]) -> Derivatives<S> {
    let mut binary = corners;
    for i in 0..8 {
        binary[i] = corners[BINARY[i]];
    }
    let c = hadamard(binary);
    let mut out = [[c[0]; 4]; 3];
    for m in 0..3 {
        let of = OF_DERIVATIVE[m];
        let k = c[of[0]] * c[0].filled(SCALE[0]);
        let a = c[of[1]] * c[0].filled(SCALE[1]);
        let b = c[of[2]] * c[0].filled(SCALE[2]);
        let ab = c[of[3]] * c[0].filled(SCALE[3]);
        let (k_plus, k_minus) = butterfly(k, a);
        let (b_plus, b_minus) = butterfly(b, ab);
        out[m] = [
            k_minus - b_minus,
            k_plus - b_plus,
            k_minus + b_minus,
            k_plus + b_plus,
        ];
    }
    out
}

/// Transpose of [`derivatives`].
#[inline(always)]
pub(super) fn transposed_derivatives<S: Simd>(d: Derivatives<S>) -> [Lanes<S>; 8] {
    let mut c = [d[0][0].filled(0.0); 8];
    for m in 0..3 {
        let (low_plus, low_minus) = butterfly(d[m][1], d[m][0]);
        let (high_plus, high_minus) = butterfly(d[m][3], d[m][2]);
        let sums = [
            high_plus + low_plus,
            high_minus + low_minus,
            high_plus - low_plus,
            high_minus - low_minus,
        ];
        for i in 0..4 {
            c[OF_DERIVATIVE[m][i]] += sums[i] * c[0].filled(SCALE[i]);
        }
    }
    // Transpose of the Hadamard sums: from coefficients back to corners.
    for bit in [1, 2, 4] {
        for i in 0..8 {
            if i & bit == 0 {
                let (sum, difference) = butterfly(c[i], c[i + bit]);
                c[i + bit] = sum;
                c[i] = difference;
            }
        }
    }
    let mut corners = c;
    for i in 0..8 {
        corners[BINARY[i]] = c[i];
    }
    corners
}

#[inline(always)]
pub(super) fn component_derivatives<S: Simd>(field: &CornerField<S>) -> [Derivatives<S>; 3] {
    let mut out = [[[field[0][0]; 4]; 3]; 3];
    for i in 0..3 {
        let mut component = [field[0][0]; 8];
        for a in 0..8 {
            component[a] = field[a][i];
        }
        out[i] = derivatives(component);
    }
    out
}

pub(super) type Tensor<S> = [[Lanes<S>; 3]; 3];

/// The derivatives d_i by xi_m at Gauss point `G`.
#[inline(always)]
pub(super) fn tensor_at<S: Simd, const G: usize>(d: &[Derivatives<S>; 3]) -> Tensor<S> {
    let mut t = [[d[0][0][0]; 3]; 3];
    for i in 0..3 {
        for m in 0..3 {
            t[i][m] = d[i][m][pair(G, m)];
        }
    }
    t
}
