//! Products of four cells at a time, one cell per SIMD lane.

use std::ops::{Add, AddAssign, Mul, Sub};

use pulp::Simd;

use crate::element::hex8::GAUSS;
use crate::element::hex8_axial::LINES;

/// Number of cells in a batch of the matrix-free operator; a vector register holds all of them or a
/// whole fraction.
pub(crate) const LANES: usize = 4;

/// One number of each of a batch's cells, as it is stored.
pub(crate) type Stored = [f64; LANES];

/// One number of each of the cells that a vector holds.
///
/// The vector type is explicit: loops that rely on automatic vectorisation compile to code that is
/// many times slower.
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

    /// The vector instructions of these numbers.
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

/// Values of three components at eight corners.
pub(crate) type CornerField<S> = [[Lanes<S>; 3]; 8];

/// Derivatives of one component by xi, eta, zeta at four sign pairs each: by xi at (eta, zeta), by
/// eta at (zeta, xi), by zeta at (xi, eta); pairs in the order --, +-, -+, ++.
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

/// Sums of the eight values with the signs of 1, xi, eta, xi eta, zeta, zeta xi, eta zeta, xi eta
/// zeta; its own transpose up to the order of the corners.
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

/// Indices of the Hadamard sums in the natural derivative by axis m: those of 1, the next axis, the
/// next but one, and both.
const OF_DERIVATIVE: [[usize; 4]; 3] = [[1, 3, 5, 7], [2, 6, 3, 7], [4, 5, 6, 7]];

/// Factors of these sums at the Gauss points.
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
    // Transpose of the Hadamard sums: corner values from coefficients.
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

/// Repeats the body for each Gauss point with its number as a constant, so that all indices are
/// constants.
macro_rules! each_gauss_point {
    ($g:ident, $body:block) => {
        each_gauss_point!(@ $g, $body, 0 1 2 3 4 5 6 7)
    };
    (@ $g:ident, $body:block, $($number:literal)*) => {
        $({
            const $g: usize = $number;
            $body
        })*
    };
}

/// Lame's constants of the cells of a vector [Pa].
pub(crate) struct LanesMaterial<S: Simd> {
    pub lambda: Lanes<S>,
    pub mu: Lanes<S>,
}

/// The quantity that an element averages over Gauss points.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mean {
    /// Nothing.
    None,
    /// Shear strains along the first axis.
    Shear,
    /// Dilatation of the cell.
    Dilatation,
}

/// Lower triangle by rows of the inverse stiffness of the incompatible modes' amplitudes, of a
/// batch's cells.
pub(crate) type InnerInverse = [Stored; 45];

/// Cofactors C_mi = det J d xi_m / d x_i of J_im = d x_i / d xi_m.
#[inline(always)]
fn cofactors<S: Simd>(j: &Tensor<S>) -> Tensor<S> {
    let mut c = *j;
    for m in 0..3 {
        for i in 0..3 {
            let (i1, i2, m1, m2) = ((i + 1) % 3, (i + 2) % 3, (m + 1) % 3, (m + 2) % 3);
            c[m][i] = j[i1][m1] * j[i2][m2] - j[i1][m2] * j[i2][m1];
        }
    }
    c
}

/// Stress (xx, yy, zz, yz, zx, xy) of det J times a displacement gradient.
#[inline(always)]
fn stress<S: Simd>(
    h: &Tensor<S>,
    material: &LanesMaterial<S>,
    inverse_determinant: Lanes<S>,
) -> [Lanes<S>; 6] {
    let lambda = material.lambda * inverse_determinant;
    let mu = material.mu * inverse_determinant;
    let trace = lambda * (h[0][0] + h[1][1] + h[2][2]);
    [
        trace + mu * (h[0][0] + h[0][0]),
        trace + mu * (h[1][1] + h[1][1]),
        trace + mu * (h[2][2] + h[2][2]),
        mu * (h[1][2] + h[2][1]),
        mu * (h[0][2] + h[2][0]),
        mu * (h[0][1] + h[1][0]),
    ]
}

/// A symmetric tensor times a vector.
#[inline(always)]
fn traction<S: Simd>(s: &[Lanes<S>; 6], v: &[Lanes<S>; 3]) -> [Lanes<S>; 3] {
    [
        s[0] * v[0] + s[5] * v[1] + s[4] * v[2],
        s[5] * v[0] + s[1] * v[1] + s[3] * v[2],
        s[4] * v[0] + s[3] * v[1] + s[2] * v[2],
    ]
}

/// Corner forces K u of a vector's cells. `inner` is given for cells with incompatible modes, with
/// the index of the first one in the batch; `mean` is the averaged quantity.
#[inline(always)]
pub(crate) fn apply<S: Simd>(
    corners: &CornerField<S>,
    u: &CornerField<S>,
    material: &LanesMaterial<S>,
    inner: Option<(&InnerInverse, usize)>,
    mean: Mean,
) -> CornerField<S> {
    let axial = mean == Mean::Shear;
    let zero = material.mu.filled(0.0);
    let (dx, du) = (component_derivatives(corners), component_derivatives(u));
    let mut cofactor = [[[zero; 3]; 3]; 8];
    let mut inverse_determinant = [zero; 8];
    let mut stresses = [[zero; 6]; 8];
    let (mut bracket, mut trace) = ([zero; 8], [zero; 8]);
    each_gauss_point!(G, {
        let (j, natural) = (tensor_at::<S, G>(&dx), tensor_at::<S, G>(&du));
        let c = cofactors(&j);
        let determinant = j[0][0] * c[0][0] + j[0][1] * c[1][0] + j[0][2] * c[2][0];
        let mut h = [[zero; 3]; 3];
        for i in 0..3 {
            for k in 0..3 {
                h[i][k] =
                    natural[i][0] * c[0][k] + natural[i][1] * c[1][k] + natural[i][2] * c[2][k];
            }
        }
        cofactor[G] = c;
        inverse_determinant[G] = determinant.recip();
        if axial {
            // The bracket of eps_xx is added below, averaged.
            bracket[G] = natural[0][1] * c[1][0] + natural[0][2] * c[2][0];
            h[0][0] = natural[0][0] * c[0][0];
        }
        trace[G] = h[0][0] + h[1][1] + h[2][2];
        stresses[G] = stress(&h, material, inverse_determinant[G]);
    });
    if let Some(inverse) = inner {
        add_inner_stress(&dx, material, inverse, &inverse_determinant, &mut stresses);
    }
    if axial {
        average(&bracket, material, &inverse_determinant, &mut stresses);
    }
    if mean == Mean::Dilatation {
        use_mean_dilatation(&trace, material, &inverse_determinant, &mut stresses);
    }
    // The stress xx that is conjugate to the bracket of eps_xx.
    let mut on_bracket = [zero; 8];
    for g in 0..8 {
        on_bracket[g] = stresses[g][0];
    }
    if axial {
        for [first, second] in LINES {
            let acting = [on_bracket[first], on_bracket[second]];
            let mean = mean_of(&inverse_determinant, [first, second], acting);
            on_bracket[first] = mean;
            on_bracket[second] = mean;
        }
    }
    // P_im = s_ij C_mj, gathered over Gauss points that share a sign pair.
    let mut p = [[[zero; 4]; 3]; 3];
    each_gauss_point!(G, {
        const PAIRS: [usize; 3] = [pair(G, 0), pair(G, 1), pair(G, 2)];
        for m in 0..3 {
            let mut acting = stresses[G];
            if m > 0 {
                acting[0] = on_bracket[G];
            }
            let t = traction(&acting, &cofactor[G][m]);
            for i in 0..3 {
                p[i][m][PAIRS[m]] += t[i];
            }
        }
    });
    let mut forces = [[zero; 3]; 8];
    for i in 0..3 {
        let component = transposed_derivatives(p[i]);
        for a in 0..8 {
            forces[a][i] = component[a];
        }
    }
    forces
}

/// Mean of two Gauss points' values weighted by det J, from the inverses.
#[inline(always)]
fn mean_of<S: Simd>(
    inverse_determinant: &[Lanes<S>; 8],
    [first, second]: [usize; 2],
    [value, other]: [Lanes<S>; 2],
) -> Lanes<S> {
    let (p, q) = (inverse_determinant[first], inverse_determinant[second]);
    (value * q + other * p) * (p + q).recip()
}

/// Stresses of the averaged strains: zx and xy averaged, and the stress of eps_xx's averaged
/// bracket (given times det J) added.
#[inline(always)]
fn average<S: Simd>(
    bracket: &[Lanes<S>; 8],
    material: &LanesMaterial<S>,
    inverse_determinant: &[Lanes<S>; 8],
    stresses: &mut [[Lanes<S>; 6]; 8],
) {
    for line in LINES {
        let [first, second] = line;
        let (p, q) = (inverse_determinant[first], inverse_determinant[second]);
        let strain = (bracket[first] + bracket[second]) * p * q * (p + q).recip();
        let trace = material.lambda * strain;
        let axial = trace + (material.mu + material.mu) * strain;
        for g in line {
            stresses[g][0] += axial;
            stresses[g][1] += trace;
            stresses[g][2] += trace;
        }
        for k in [4, 5] {
            let mean = mean_of(
                inverse_determinant,
                line,
                [stresses[first][k], stresses[second][k]],
            );
            stresses[first][k] = mean;
            stresses[second][k] = mean;
        }
    }
}

/// Replaces each point's dilatation (`trace`, given times det J) by the mean one: adds kappa times
/// the difference to the stresses.
///
/// The trace of the stress is then the same at all points, so that the virtual strain needs no
/// mean.
#[inline(always)]
fn use_mean_dilatation<S: Simd>(
    trace: &[Lanes<S>; 8],
    material: &LanesMaterial<S>,
    inverse_determinant: &[Lanes<S>; 8],
    stresses: &mut [[Lanes<S>; 6]; 8],
) {
    let (mut sum, mut volume) = (trace[0], inverse_determinant[0].recip());
    for g in 1..8 {
        sum += trace[g];
        volume += inverse_determinant[g].recip();
    }
    let mean = sum * volume.recip();
    let bulk = material.lambda + material.mu * material.mu.filled(2.0 / 3.0);
    for g in 0..8 {
        let more = bulk * (mean - trace[g] * inverse_determinant[g]);
        for k in 0..3 {
            stresses[g][k] += more;
        }
    }
}

/// Adds the stress of the incompatible modes with the amplitudes that balance the given stresses.
#[inline(always)]
fn add_inner_stress<S: Simd>(
    dx: &[Derivatives<S>; 3],
    material: &LanesMaterial<S>,
    (inverse, place): (&InnerInverse, usize),
    inverse_determinant: &[Lanes<S>; 8],
    stresses: &mut [[Lanes<S>; 6]; 8],
) {
    let simd = material.mu.simd();
    let zero = Lanes::splat(simd, 0.0);
    let quarter = Lanes::splat(simd, 0.25);
    let mut centre = [[zero; 3]; 3];
    for i in 0..3 {
        for m in 0..3 {
            let d = &dx[i][m];
            centre[i][m] = (d[0] + d[1] + d[2] + d[3]) * quarter;
        }
    }
    // Gradients of the modes times det J: -2 xi_m C_0m, |xi_m| = 1/sqrt(3).
    let scale = Lanes::splat(simd, -2.0 * GAUSS);
    let mut mode = cofactors(&centre);
    for m in 0..3 {
        for j in 0..3 {
            mode[m][j] = mode[m][j] * scale;
        }
    }
    let mut force = [zero; 9];
    for m in 0..3 {
        let mut sum = [zero; 6];
        for g in 0..8 {
            for k in 0..6 {
                sum[k] = if positive(g, m) {
                    sum[k] + stresses[g][k]
                } else {
                    sum[k] - stresses[g][k]
                };
            }
        }
        let f = traction(&sum, &mode[m]);
        force[3 * m..3 * m + 3].copy_from_slice(&f);
    }
    let mut amplitude = [zero; 9];
    for i in 0..9 {
        for j in 0..9 {
            let (row, column) = if i >= j { (i, j) } else { (j, i) };
            let inverse = Lanes::load(simd, &inverse[row * (row + 1) / 2 + column], place);
            amplitude[i] = amplitude[i] - inverse * force[j];
        }
    }
    let mut gradient = [[[zero; 3]; 3]; 3];
    for m in 0..3 {
        for i in 0..3 {
            for j in 0..3 {
                gradient[m][i][j] = amplitude[3 * m + i] * mode[m][j];
            }
        }
    }
    for g in 0..8 {
        let mut h = [[zero; 3]; 3];
        for m in 0..3 {
            for i in 0..3 {
                for j in 0..3 {
                    let v = gradient[m][i][j];
                    h[i][j] = if positive(g, m) {
                        h[i][j] + v
                    } else {
                        h[i][j] - v
                    };
                }
            }
        }
        let added = stress(&h, material, inverse_determinant[g]);
        for k in 0..6 {
            stresses[g][k] += added[k];
        }
    }
}
