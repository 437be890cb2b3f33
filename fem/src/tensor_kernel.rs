//! One plane of K u on a tensor grid, row by row in vector registers.
//!
//! The three axes are gone through one after the other. z: a row of M u, K u and D u of every component from the same row of
//! three planes. y: three such rows, kept in a ring, give the rows P, Q and W of every equation. x: K P + M Q + D W.
//! In an axis D + D^T is E = diag(-1, 0 .. 0, 1), so that in the x equations, say,
//!
//! lambda D_x D_y^T + mu D_x^T D_y = D_x (lambda D_y^T - mu D_y) + mu E_x D_y:
//!
//! one product a pair of components in the grid, and what E adds on its faces. D w = (w_(i-1) - w_(i+1)) / 2 holds at the
//! ends too once w is continued by -w beyond them.

use pulp::{Simd, WithSimd};

use crate::tensor_factors::{Factors, WIDEST, padded};

/// What the rows of one plane pass through.
pub(crate) struct Scratch {
    /// Products along z of the rows j - 1, j and j + 1.
    ring: [Products; 3],
    /// The rows that the x axis acts on, by equation.
    rows: [[Vec<f64>; 3]; 3],
    /// A product along z that a face asks for.
    face: Vec<f64>,
}

/// One row's products along z.
struct Products {
    /// M u, K u and D u by component, in the factors of [`Factors`].
    by_component: [[Vec<f64>; 3]; 3],
    /// D u of x and of z at the row's two ends.
    ends: [[f64; 2]; 2],
}

impl Scratch {
    pub fn new(nx: usize) -> Self {
        let row = |length: usize| vec![0.0; length];
        Scratch {
            ring: std::array::from_fn(|_| Products {
                by_component: std::array::from_fn(|_| std::array::from_fn(|_| row(padded(nx)))),
                ends: [[0.0; 2]; 2],
            }),
            rows: std::array::from_fn(|_| std::array::from_fn(|_| row(padded(nx) + 2 * WIDEST))),
            face: row(nx),
        }
    }
}

/// The work on plane `k`: its rows of K u into `out`, x, y and z.
pub(crate) struct Plane<'a> {
    pub factors: &'a Factors,
    pub u: &'a [f64],
    pub k: usize,
    pub scratch: &'a mut Scratch,
    pub out: [&'a mut [f64]; 3],
}

impl WithSimd for Plane<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Plane {
            factors,
            u,
            k,
            scratch,
            out: [out_x, out_y, out_z],
        } = self;
        let [nx, ny, _] = factors.shape;
        let layers = Layers { factors, u, k };
        let Scratch { ring, rows, face } = scratch;
        layers.products(simd, 0, &mut ring[0]);
        let (first, last) = ring.split_at_mut(2);
        last[0].continue_beyond(&first[0]);
        for j in 0..ny {
            let (here, next) = (j % 3, (j + 1) % 3);
            if j + 1 < ny {
                layers.products(simd, j + 1, &mut ring[next]);
            } else if let Ok([on, beyond]) = ring.get_disjoint_mut([here, next]) {
                beyond.continue_beyond(on);
            }
            let three = [&ring[(j + 2) % 3], &ring[here], &ring[next]];
            along_y(simd, factors, j, three, rows);
            if j == 0 {
                layers.face_of_y(j, -1.0, three[1], rows, face);
            }
            if j + 1 == ny {
                layers.face_of_y(j, 1.0, three[1], rows, face);
            }
            let ends = factors.face_of_x(j, three);
            let range = j * nx..(j + 1) * nx;
            let targets = [
                &mut out_x[range.clone()],
                &mut out_y[range.clone()],
                &mut out_z[range],
            ];
            for (c, target) in targets.into_iter().enumerate() {
                along_x(
                    simd,
                    &factors.x[usize::from(c > 0)],
                    &factors.x[2],
                    &mut rows[c],
                    target,
                );
                target[0] -= ends[c][0];
                target[nx - 1] += ends[c][1];
            }
        }
    }
}

/// Plane `k` of a vector with its neighbours.
struct Layers<'a> {
    factors: &'a Factors,
    u: &'a [f64],
    k: usize,
}

impl Layers<'_> {
    /// Row j of component c in the planes below, at and above; where there is none its coefficient is 0.
    #[inline(always)]
    fn rows(&self, c: usize, j: usize) -> [&[f64]; 3] {
        let [nx, ny, nz] = self.factors.shape;
        let row = |k: usize| {
            let start = ((c * nz + k) * ny + j) * nx;
            &self.u[start..start + nx]
        };
        [
            row(self.k.saturating_sub(1)),
            row(self.k),
            row((self.k + 1).min(nz - 1)),
        ]
    }

    #[inline(always)]
    fn products<S: Simd>(&self, simd: S, j: usize, out: &mut Products) {
        let (factors, k) = (self.factors, self.k - self.factors.first);
        for c in 0..3 {
            let rows = self.rows(c, j);
            let matrices = [
                factors.mass_z[k],
                factors.stiffness_z[c][k],
                factors.gradient_z[c][k],
            ];
            along_z(simd, rows, matrices, &mut out.by_component[c]);
        }
        let last = factors.shape[0] - 1;
        for (end, c) in [0, 2].into_iter().enumerate() {
            let rows = self.rows(c, j);
            out.ends[end] = [0, last].map(|i| {
                let d = factors.plain_gradient_z[k];
                d[0] * rows[0][i] + d[1] * rows[1][i] + d[2] * rows[2][i]
            });
        }
    }

    /// What E of y adds on the face that row j lies on; `sign` is its entry there.
    fn face_of_y(
        &self,
        j: usize,
        sign: f64,
        on: &Products,
        [x, y, z]: &mut [[Vec<f64>; 3]; 3],
        face: &mut [f64],
    ) {
        let Factors { lambda, mu, .. } = *self.factors;
        add(&mut x[2], 0.5 * sign * lambda, &on.by_component[1][0]);
        add(&mut y[2], 0.5 * sign * mu, &on.by_component[0][0]);
        for (target, factor, c) in [(y, mu, 2), (z, lambda, 1)] {
            let rows = self.rows(c, j);
            let d = self.factors.plain_gradient_z[self.k - self.factors.first];
            for (i, value) in face.iter_mut().enumerate() {
                *value = d[0] * rows[0][i] + d[1] * rows[1][i] + d[2] * rows[2][i];
            }
            add(&mut target[1], sign * factor, face);
        }
    }
}

impl Factors {
    /// What E of x adds at both ends of row j, by equation, without its sign.
    #[inline(always)]
    fn face_of_x(&self, j: usize, rows: [&Products; 3]) -> [[f64; 2]; 3] {
        let m = self.mass_y[j];
        let ends = [0, self.shape[0] - 1];
        let mass = |what: usize, end: usize| {
            let at = |row: usize| rows[row].ends[what][end];
            m[0] * at(0) + m[1] * at(1) + m[2] * at(2)
        };
        let gradient = |c: usize, end: usize| {
            let at = |row: usize| rows[row].by_component[c][0][ends[end]];
            0.5 * (at(0) - at(2))
        };
        [
            [0, 1].map(|end| self.mu * (gradient(1, end) + mass(1, end))),
            [0, 1].map(|end| self.lambda * gradient(0, end)),
            [0, 1].map(|end| self.lambda * mass(0, end)),
        ]
    }
}

impl Products {
    /// The row beyond the first or last: `on` with its sign turned.
    fn continue_beyond(&mut self, on: &Products) {
        let pairs = self.by_component.iter_mut().zip(&on.by_component);
        for (beyond, on) in pairs.flat_map(|(beyond, on)| beyond.iter_mut().zip(on)) {
            for (beyond, on) in beyond.iter_mut().zip(on) {
                *beyond = -on;
            }
        }
        self.ends = on.ends.map(|ends| ends.map(|end| -end));
    }
}

/// Adds to the part of a padded row that holds nodes.
fn add(row: &mut [f64], factor: f64, values: &[f64]) {
    for (row, value) in row[WIDEST..].iter_mut().zip(values) {
        *row += factor * value;
    }
}

/// `t` . (low, on, high)
#[inline(always)]
fn combine<S: Simd>(simd: S, t: [S::f64s; 3], v: [S::f64s; 3]) -> S::f64s {
    let sum = simd.mul_add_e_f64s(t[0], v[0], simd.mul_f64s(t[1], v[1]));
    simd.mul_add_e_f64s(t[2], v[2], sum)
}

/// `sum` + `t` . (low, on, high)
#[inline(always)]
fn combine_onto<S: Simd>(simd: S, t: [S::f64s; 3], v: [S::f64s; 3], sum: S::f64s) -> S::f64s {
    let sum = simd.mul_add_e_f64s(t[0], v[0], sum);
    let sum = simd.mul_add_e_f64s(t[1], v[1], sum);
    simd.mul_add_e_f64s(t[2], v[2], sum)
}

/// Three tridiagonal rows acting across three rows of nodes.
#[inline(always)]
fn along_z<S: Simd>(simd: S, rows: [&[f64]; 3], matrices: [[f64; 3]; 3], out: &mut [Vec<f64>; 3]) {
    let matrices = matrices.map(|row| row.map(|t| simd.splat_f64s(t)));
    let (heads, tails) = (
        rows.map(|row| S::as_simd_f64s(row).0),
        rows.map(|row| S::as_simd_f64s(row).1),
    );
    let n = heads[0].len();
    let [low, on, high] = heads.map(|head| &head[..n]);
    let [a, b, d] = out;
    let (a, b, d) = (
        S::as_mut_simd_f64s(a).0,
        S::as_mut_simd_f64s(b).0,
        S::as_mut_simd_f64s(d).0,
    );
    {
        let (a, b, d) = (&mut a[..n], &mut b[..n], &mut d[..n]);
        for i in 0..n {
            let v = [low[i], on[i], high[i]];
            a[i] = combine(simd, matrices[0], v);
            b[i] = combine(simd, matrices[1], v);
            d[i] = combine(simd, matrices[2], v);
        }
    }
    if !tails[0].is_empty() {
        let v = tails.map(|tail| simd.partial_load_f64s(tail));
        a[n] = combine(simd, matrices[0], v);
        b[n] = combine(simd, matrices[1], v);
        d[n] = combine(simd, matrices[2], v);
    }
}

/// The rows P, Q and W (halved) of every equation in row j, from three rows' products along z.
///
/// With a, b, d the products of a component: x: P = M a_x, Q = mu K a_x + M b_x, W = M d_z - (lambda + mu) D a_y;
/// y: P = M a_y, Q = (lambda + 2 mu) K a_y + M b_y + D d_z, W = -(lambda + mu) D a_x;
/// z: P = M a_z, Q = mu K a_z + M b_z + D d_y, W = M d_x.
#[inline(always)]
fn along_y<S: Simd>(
    simd: S,
    factors: &Factors,
    j: usize,
    rows: [&Products; 3],
    out: &mut [[Vec<f64>; 3]; 3],
) {
    let splat = |t: [f64; 3]| t.map(|t| simd.splat_f64s(t));
    let mass = splat(factors.mass_y[j]);
    let (shear, axial) = (
        splat(factors.stiffness_y[0][j]),
        splat(factors.stiffness_y[1][j]),
    );
    let cross = simd.splat_f64s(-0.25 * (factors.lambda + factors.mu));
    let [x, y, z] = out;
    let of = |c: usize, product: usize| -> [&[S::f64s]; 3] {
        rows.map(|row| S::as_simd_f64s(&row.by_component[c][product]).0)
    };
    {
        let [p, q, w] = inner::<S>(x);
        let n = p.len();
        let (a, b, d, other) = (
            cut(of(0, 0), n),
            cut(of(0, 1), n),
            cut(of(2, 2), n),
            cut(of(1, 0), n),
        );
        for i in 0..n {
            let a = [a[0][i], a[1][i], a[2][i]];
            p[i] = combine(simd, mass, a);
            let stiff = combine(simd, shear, a);
            q[i] = combine_onto(simd, mass, [b[0][i], b[1][i], b[2][i]], stiff);
            let difference = simd.mul_f64s(cross, simd.sub_f64s(other[0][i], other[2][i]));
            w[i] = combine_onto(simd, mass, [d[0][i], d[1][i], d[2][i]], difference);
        }
    }
    {
        let [p, q, w] = inner::<S>(y);
        let n = p.len();
        let (a, b, d, other) = (
            cut(of(1, 0), n),
            cut(of(1, 1), n),
            cut(of(2, 2), n),
            cut(of(0, 0), n),
        );
        for i in 0..n {
            let a = [a[0][i], a[1][i], a[2][i]];
            p[i] = combine(simd, mass, a);
            let stiff = combine_onto(simd, axial, a, simd.sub_f64s(d[0][i], d[2][i]));
            q[i] = combine_onto(simd, mass, [b[0][i], b[1][i], b[2][i]], stiff);
            w[i] = simd.mul_f64s(cross, simd.sub_f64s(other[0][i], other[2][i]));
        }
    }
    {
        let [p, q, w] = inner::<S>(z);
        let n = p.len();
        let (a, b, d, other) = (
            cut(of(2, 0), n),
            cut(of(2, 1), n),
            cut(of(1, 2), n),
            cut(of(0, 2), n),
        );
        for i in 0..n {
            let a = [a[0][i], a[1][i], a[2][i]];
            p[i] = combine(simd, mass, a);
            let stiff = combine_onto(simd, shear, a, simd.sub_f64s(d[0][i], d[2][i]));
            q[i] = combine_onto(simd, mass, [b[0][i], b[1][i], b[2][i]], stiff);
            w[i] = combine(simd, mass, [other[0][i], other[1][i], other[2][i]]);
        }
    }
}

#[inline(always)]
fn cut<T>(rows: [&[T]; 3], n: usize) -> [&[T]; 3] {
    rows.map(|row| &row[..n])
}

/// The nodes' part of three padded rows, as vectors of one length.
#[inline(always)]
fn inner<S: Simd>([p, q, w]: &mut [Vec<f64>; 3]) -> [&mut [S::f64s]; 3] {
    let n = p.len() - WIDEST;
    let [p, q, w] = [p, q, w].map(|row| S::as_mut_simd_f64s(&mut row[WIDEST..n]).0);
    let n = p.len();
    [&mut p[..n], &mut q[..n], &mut w[..n]]
}

/// `out` = K P + M Q + D W along x, W being halved already.
#[inline(always)]
fn along_x<S: Simd>(
    simd: S,
    stiffness: &[Vec<f64>; 3],
    mass: &[Vec<f64>; 3],
    [p, q, w]: &mut [Vec<f64>; 3],
    out: &mut [f64],
) {
    let nx = out.len();
    w[WIDEST - 1] = -w[WIDEST];
    w[WIDEST + nx] = -w[WIDEST + nx - 1];
    let n = nx.div_ceil(S::F64_LANES);
    let p = cut(neighbours::<S>(p), n);
    let q = cut(neighbours::<S>(q), n);
    let w = cut(neighbours::<S>(w), n);
    let [k, m] = [stiffness, mass].map(|matrix| {
        let [low, on, high] = matrix;
        cut([low, on, high].map(|d| S::as_simd_f64s(d).0), n)
    });
    let (head, tail) = S::as_mut_simd_f64s(out);
    for (i, out) in head.iter_mut().enumerate() {
        *out = sum_along_x(simd, i, k, m, [p, q, w]);
    }
    if !tail.is_empty() {
        simd.partial_store_f64s(tail, sum_along_x(simd, n - 1, k, m, [p, q, w]));
    }
}

/// Vector i of K P + M Q + D W.
#[inline(always)]
fn sum_along_x<S: Simd>(
    simd: S,
    i: usize,
    k: [&[S::f64s]; 3],
    m: [&[S::f64s]; 3],
    [p, q, w]: [[&[S::f64s]; 3]; 3],
) -> S::f64s {
    let sum = simd.sub_f64s(w[0][i], w[2][i]);
    let sum = combine_onto(
        simd,
        [k[0][i], k[1][i], k[2][i]],
        [p[0][i], p[1][i], p[2][i]],
        sum,
    );
    combine_onto(
        simd,
        [m[0][i], m[1][i], m[2][i]],
        [q[0][i], q[1][i], q[2][i]],
        sum,
    )
}

/// Each node's lower neighbour, the node, its upper neighbour, in a row padded at both ends.
#[inline(always)]
fn neighbours<S: Simd>(row: &[f64]) -> [&[S::f64s]; 3] {
    let length = row.len() - 2 * WIDEST;
    [WIDEST - 1, WIDEST, WIDEST + 1].map(|from| S::as_simd_f64s(&row[from..from + length]).0)
}
