//! The stiffness of trilinear hexahedra on a tensor grid, applied without being stored.

use kufe_mesh::TensorGrid;
use rayon::prelude::*;

use crate::tensor_axis::{Axis, Tridiagonal};

/// Which components are held on which faces: `held[c][axis]` is (low face, high face).
pub type HeldFaces = [[[bool; 2]; 3]; 3];

/// Isotropic elasticity on a tensor grid of trilinear hexahedra.
///
/// With the 1-D matrices K, M, D of each axis ([`Axis`]) the block of test component c and trial
/// component d is a sum of Kronecker products:
///
/// * c = d: (lambda + 2 mu) K on axis c, M on the others, plus mu K on each other axis in turn;
/// * c != d: lambda D_c D_d^T + mu D_c^T D_d, M on the third axis.
///
/// Vectors hold component after component, each in [`TensorGrid::node`] order: `3 * node_count`
/// numbers. The integration is exact. Cost: about 200 operations a node.
#[derive(Clone, Debug)]
pub struct TensorOperator {
    /// x, y and z.
    pub axes: [Axis; 3],
    /// First Lame constant [Pa].
    pub lambda: f64,
    /// Shear modulus [Pa].
    pub mu: f64,
    /// Held faces; results are 0 there.
    pub held: HeldFaces,
    /// K and M of x by diagonal, so that rows run through vector registers.
    x_diagonals: [[Vec<f64>; 3]; 2],
}

impl TensorOperator {
    /// The operator of a grid; `lambda` and `mu` are the Lame constants [Pa].
    pub fn new(grid: &TensorGrid, lambda: f64, mu: f64, held: HeldFaces) -> Self {
        let axes = [Axis::new(&grid.x), Axis::new(&grid.y), Axis::new(&grid.z)];
        let diagonals =
            |t: &Tridiagonal| std::array::from_fn(|d| t.iter().map(|row| row[d]).collect());
        let x_diagonals = [diagonals(&axes[0].stiffness), diagonals(&axes[0].mass)];
        TensorOperator {
            axes,
            lambda,
            mu,
            held,
            x_diagonals,
        }
    }

    /// Nodes along each axis.
    pub fn shape(&self) -> [usize; 3] {
        [self.axes[0].len(), self.axes[1].len(), self.axes[2].len()]
    }

    /// Number of nodes.
    pub fn node_count(&self) -> usize {
        self.shape().iter().product()
    }

    /// Number of unknowns that no held face takes away.
    pub fn free_dofs(&self) -> usize {
        let free = |c: usize, axis: usize| {
            let held = self.held[c][axis];
            self.axes[axis].len() - usize::from(held[0]) - usize::from(held[1])
        };
        (0..3).map(|c| free(c, 0) * free(c, 1) * free(c, 2)).sum()
    }

    /// Sets the held entries of a vector to 0.
    pub fn mask(&self, u: &mut [f64]) {
        let [nx, ny, nz] = self.shape();
        let nodes = nx * ny * nz;
        for (c, component) in u.chunks_exact_mut(nodes).enumerate() {
            component
                .par_chunks_mut(nx * ny)
                .enumerate()
                .for_each(|(k, plane)| {
                    mask_plane(plane, self.held[c], [nx, ny, nz], k);
                });
        }
    }

    /// `out` = K `u`, with 0 on held entries; the held entries of `u` count as prescribed values.
    ///
    /// # Panics
    /// Where a vector does not have `3 * node_count` numbers.
    pub fn apply(&self, u: &[f64], out: &mut [f64]) {
        let [nx, ny, nz] = self.shape();
        let plane = nx * ny;
        let nodes = plane * nz;
        assert_eq!(
            (u.len(), out.len()),
            (3 * nodes, 3 * nodes),
            "vectors of {nodes} nodes"
        );
        let (out_x, rest) = out.split_at_mut(nodes);
        let (out_y, out_z) = rest.split_at_mut(nodes);
        out_x
            .par_chunks_mut(plane)
            .zip(out_y.par_chunks_mut(plane))
            .zip(out_z.par_chunks_mut(plane))
            .enumerate()
            .for_each_init(
                || Scratch::new(nx, ny),
                |scratch, (k, ((x, y), z))| {
                    // The same loops for the widest vectors that this machine has.
                    pulp::Arch::new().dispatch(
                        #[inline(always)]
                        || self.plane(u, k, scratch, [&mut *x, &mut *y, &mut *z]),
                    );
                },
            );
    }

    /// Plane `k` of all three components of K u.
    #[inline(always)]
    fn plane(&self, u: &[f64], k: usize, scratch: &mut Scratch, [x, y, z]: [&mut [f64]; 3]) {
        let [nx, ny, nz] = self.shape();
        self.gather_z(u, k, scratch);
        for j in 0..ny {
            let row = j * nx..(j + 1) * nx;
            self.row_x(j, scratch, &mut x[row.clone()]);
            self.row_y(j, scratch, &mut y[row.clone()]);
            self.row_z(j, scratch, &mut z[row]);
        }
        mask_plane(x, self.held[0], [nx, ny, nz], k);
        mask_plane(y, self.held[1], [nx, ny, nz], k);
        mask_plane(z, self.held[2], [nx, ny, nz], k);
    }

    /// The z-direction's share: M u, K u, D u and D^T u of every component in plane `k`.
    #[inline(always)]
    fn gather_z(&self, u: &[f64], k: usize, scratch: &mut Scratch) {
        let [nx, ny, nz] = self.shape();
        let plane = nx * ny;
        let z = &self.axes[2];
        let below = k.max(1) - 1;
        let above = (k + 1).min(nz - 1);
        for c in 0..3 {
            let at = |k: usize| &u[(c * nz + k) * plane..(c * nz + k + 1) * plane];
            let rows = [at(below), at(k), at(above)];
            combine(rows, z.mass[k], &mut scratch.mass[c]);
            combine(rows, z.stiffness[k], &mut scratch.stiffness[c]);
            combine(rows, z.gradient[k], &mut scratch.gradient[c]);
            combine(
                rows,
                z.gradient_transposed[k],
                &mut scratch.gradient_transposed[c],
            );
        }
    }

    /// Row j of the x equations:
    /// K_x[(l+2m) M_y a_x] + M_x[m K_y a_x + m M_y b_x]
    /// + D_x[l D_y^T a_y + l M_y t_z] + D_x^T[m D_y a_y + m M_y d_z],
    ///
    /// where a, b, d, t are M_z u, K_z u, D_z u, D_z^T u.
    #[inline(always)]
    fn row_x(&self, j: usize, scratch: &mut Scratch, out: &mut [f64]) {
        let (l, m) = (self.lambda, self.mu);
        let y = &self.axes[1];
        let Scratch {
            mass: a,
            stiffness: b,
            gradient: d,
            gradient_transposed: t,
            rows,
            ..
        } = scratch;
        let nx = out.len();
        rows.clear();
        rows.add(0, &a[0], nx, j, y.mass[j], l + 2.0 * m);
        rows.add(1, &a[0], nx, j, y.stiffness[j], m);
        rows.add(1, &b[0], nx, j, y.mass[j], m);
        rows.add(2, &a[1], nx, j, y.gradient_transposed[j], l);
        rows.add(2, &t[2], nx, j, y.mass[j], l);
        rows.add(3, &a[1], nx, j, y.gradient[j], m);
        rows.add(3, &d[2], nx, j, y.mass[j], m);
        rows.finish(&self.x_diagonals, out);
    }

    /// Row j of the y equations:
    /// K_x[m M_y a_y] + M_x[(l+2m) K_y a_y + m M_y b_y + l D_y t_z + m D_y^T d_z]
    /// + D_x[m D_y^T a_x] + D_x^T[l D_y a_x].
    #[inline(always)]
    fn row_y(&self, j: usize, scratch: &mut Scratch, out: &mut [f64]) {
        let (l, m) = (self.lambda, self.mu);
        let y = &self.axes[1];
        let Scratch {
            mass: a,
            stiffness: b,
            gradient: d,
            gradient_transposed: t,
            rows,
            ..
        } = scratch;
        let nx = out.len();
        rows.clear();
        rows.add(0, &a[1], nx, j, y.mass[j], m);
        rows.add(1, &a[1], nx, j, y.stiffness[j], l + 2.0 * m);
        rows.add(1, &b[1], nx, j, y.mass[j], m);
        rows.add(1, &t[2], nx, j, y.gradient[j], l);
        rows.add(1, &d[2], nx, j, y.gradient_transposed[j], m);
        rows.add(2, &a[0], nx, j, y.gradient_transposed[j], m);
        rows.add(3, &a[0], nx, j, y.gradient[j], l);
        rows.finish(&self.x_diagonals, out);
    }

    /// Row j of the z equations:
    /// K_x[m M_y a_z] + M_x[m K_y a_z + (l+2m) M_y b_z + l D_y^T d_y + m D_y t_y]
    /// + D_x[m M_y t_x] + D_x^T[l M_y d_x].
    #[inline(always)]
    fn row_z(&self, j: usize, scratch: &mut Scratch, out: &mut [f64]) {
        let (l, m) = (self.lambda, self.mu);
        let y = &self.axes[1];
        let Scratch {
            mass: a,
            stiffness: b,
            gradient: d,
            gradient_transposed: t,
            rows,
            ..
        } = scratch;
        let nx = out.len();
        rows.clear();
        rows.add(0, &a[2], nx, j, y.mass[j], m);
        rows.add(1, &a[2], nx, j, y.stiffness[j], m);
        rows.add(1, &b[2], nx, j, y.mass[j], l + 2.0 * m);
        rows.add(1, &d[1], nx, j, y.gradient_transposed[j], l);
        rows.add(1, &t[1], nx, j, y.gradient[j], m);
        rows.add(2, &t[0], nx, j, y.mass[j], m);
        rows.add(3, &d[0], nx, j, y.mass[j], l);
        rows.finish(&self.x_diagonals, out);
    }
}

/// Planes of the z-direction's products, and rows of the y-direction's.
struct Scratch {
    mass: [Vec<f64>; 3],
    stiffness: [Vec<f64>; 3],
    gradient: [Vec<f64>; 3],
    gradient_transposed: [Vec<f64>; 3],
    rows: Rows,
}

impl Scratch {
    fn new(nx: usize, ny: usize) -> Self {
        let planes = || std::array::from_fn(|_| vec![0.0; nx * ny]);
        Scratch {
            mass: planes(),
            stiffness: planes(),
            gradient: planes(),
            gradient_transposed: planes(),
            rows: Rows {
                data: std::array::from_fn(|_| vec![0.0; nx + 2]),
            },
        }
    }
}

/// What K_x, M_x, D_x and D_x^T act on, each with one pad in front and one behind.
struct Rows {
    data: [Vec<f64>; 4],
}

impl Rows {
    fn clear(&mut self) {
        for row in &mut self.data {
            row.fill(0.0);
        }
    }

    /// Adds `factor` times the tridiagonal row `t` of the y-direction acting on plane `p`.
    #[inline(always)]
    fn add(&mut self, target: usize, p: &[f64], nx: usize, j: usize, t: [f64; 3], factor: f64) {
        let row = &mut self.data[target][1..=nx];
        let [low, on, high] = t.map(|value| value * factor);
        let here = &p[j * nx..(j + 1) * nx];
        // At the ends the coefficient is 0 and any row will do.
        let under = if j > 0 {
            &p[(j - 1) * nx..j * nx]
        } else {
            here
        };
        let over = if (j + 1) * nx < p.len() {
            &p[(j + 1) * nx..(j + 2) * nx]
        } else {
            here
        };
        for (((r, u), h), o) in row.iter_mut().zip(under).zip(here).zip(over) {
            *r += low * u + on * h + high * o;
        }
    }

    /// `out` = K p + M q + D r + D^T s along x.
    ///
    /// D + D^T is diag(-1, 0 .. 0, 1), so D r + D^T s = D (r - s) plus the two ends of s; and D w is
    /// the central difference (w_(i-1) - w_(i+1)) / 2 once w is continued by -w beyond its ends.
    #[inline(always)]
    fn finish(&mut self, x: &[[Vec<f64>; 3]; 2], out: &mut [f64]) {
        let nx = out.len();
        let [p, q, r, s] = &mut self.data;
        for (r, s) in r[1..=nx].iter_mut().zip(&s[1..=nx]) {
            *r -= s;
        }
        r[0] = -r[1];
        r[nx + 1] = -r[nx];
        tridiagonal_pair(&x[0], p, &x[1], q, r, out);
        out[0] -= s[1];
        out[nx - 1] += s[nx];
    }
}

#[inline(always)]
fn tridiagonal_pair(
    k: &[Vec<f64>; 3],
    p: &[f64],
    m: &[Vec<f64>; 3],
    q: &[f64],
    w: &[f64],
    out: &mut [f64],
) {
    let n = out.len();
    let (k0, k1, k2) = (&k[0][..n], &k[1][..n], &k[2][..n]);
    let (m0, m1, m2) = (&m[0][..n], &m[1][..n], &m[2][..n]);
    let (p0, p1, p2) = (&p[..n], &p[1..n + 1], &p[2..n + 2]);
    let (q0, q1, q2) = (&q[..n], &q[1..n + 1], &q[2..n + 2]);
    let (w0, w2) = (&w[..n], &w[2..n + 2]);
    for i in 0..n {
        out[i] = k0[i] * p0[i]
            + k1[i] * p1[i]
            + k2[i] * p2[i]
            + m0[i] * q0[i]
            + m1[i] * q1[i]
            + m2[i] * q2[i]
            + 0.5 * (w0[i] - w2[i]);
    }
}

#[inline(always)]
fn combine(planes: [&[f64]; 3], t: [f64; 3], out: &mut [f64]) {
    for (((out, low), on), high) in out.iter_mut().zip(planes[0]).zip(planes[1]).zip(planes[2]) {
        *out = t[0] * low + t[1] * on + t[2] * high;
    }
}

fn mask_plane(plane: &mut [f64], held: [[bool; 2]; 3], shape: [usize; 3], k: usize) {
    let [nx, ny, nz] = shape;
    if (held[2][0] && k == 0) || (held[2][1] && k == nz - 1) {
        plane.fill(0.0);
        return;
    }
    if held[1][0] {
        plane[..nx].fill(0.0);
    }
    if held[1][1] {
        plane[(ny - 1) * nx..].fill(0.0);
    }
    for row in plane.chunks_exact_mut(nx) {
        if held[0][0] {
            row[0] = 0.0;
        }
        if held[0][1] {
            row[nx - 1] = 0.0;
        }
    }
}
