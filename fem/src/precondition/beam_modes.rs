//! A coarse space of beam motions for slender bodies.

use faer::{Mat, MatRef};
use rayon::prelude::*;

use crate::error::Error;
use crate::tensor::axis::eigenpairs;

/// Additive coarse correction by the motions of a beam along x.
///
/// Korn's constant of a slender body decreases with (height / length)^2, and with it the quality of
/// [`crate::FastDiagonal`], whose three scalar operators do not represent bending. The correction z
/// += Z (Z^T K Z)^-1 Z^T r is exact for the motions in Z. On knots along x, Z has for each knot the
/// two cubic Hermite deflections w and v,
///
/// ```text
/// u = (-(z - z_0) w', 0, w)   and   u = (-(y - y_0) v', v, 0),
/// ```
///
/// and, piecewise linear, with y and z relative to the axis, a stretch u = (s, 0, 0), a twist u =
/// (0, -z t, y t), the warping due to a twist, u = (y z q, 0, 0), and bending across, u = (0, -2 y
/// z c, y^2 c): eight motions per knot.
///
/// On a clamped steel of 0.6 m x 20 mm x 8 mm, flat or rounded underneath, three refinements,
/// either element, to 1e-6 in energy: 245-612 iterations without, 29-40 with 25 knots (33-58 with
/// 13).
///
/// Vectors hold three numbers per node, node by node. Entries marked by `fixed` are zero in Z.
#[derive(Clone, Debug)]
pub struct BeamModes {
    knots: Vec<f64>,
    axis: [f64; 2],
    points: Vec<[f64; 3]>,
    fixed: Vec<bool>,
    /// The pseudo-inverse (Z^T K Z)^+ by columns, without motions that have no strain.
    inverse: Mat<f64>,
}

/// Number of motions of one knot.
const MOTIONS: usize = 8;
/// Number of nodes that one task sums.
const NODES_PER_TASK: usize = 2048;

impl BeamModes {
    /// The coarse space of a body whose nodes lie in planes across x.
    ///
    /// `points` are the nodes' positions, whose x are among `lines` (ascending) [m]. About
    /// `knot_count` equidistant lines become knots. `axis` = (y_0, z_0) is the beam's axis [m];
    /// `fixed` marks the displacements that are zero; `apply` writes K u and is called 24 times.
    /// Fails if a list has a wrong length.
    ///
    /// # Panics
    /// With fewer than two lines or knots.
    pub fn new(
        points: Vec<[f64; 3]>,
        lines: &[f64],
        knot_count: usize,
        axis: [f64; 2],
        fixed: Vec<bool>,
        mut apply: impl FnMut(&[f64], &mut [f64]),
    ) -> Result<Self, Error> {
        if fixed.len() != 3 * points.len() {
            return Err(Error::Length {
                what: "fixed displacements",
                found: fixed.len(),
                expected: 3 * points.len(),
            });
        }
        let knots = spread(lines, knot_count);
        let n = MOTIONS * knots.len();
        let mut modes = Self {
            knots,
            axis,
            points,
            fixed,
            inverse: Mat::zeros(n, n),
        };
        let mut reduced = Mat::<f64>::zeros(n, n);
        // Knots lie on planes of nodes, so K couples a knot only with the adjacent ones: every
        // third knot is computed at once.
        let dofs = 3 * modes.points.len();
        let (mut u, mut image, mut column) = (vec![0.0; dofs], vec![0.0; dofs], vec![0.0; n]);
        let mut partial = Vec::new();
        for colour in 0..3 {
            for motion in 0..MOTIONS {
                let mut amplitudes = vec![0.0; n];
                for knot in (colour..modes.knots.len()).step_by(3) {
                    amplitudes[MOTIONS * knot + motion] = 1.0;
                }
                u.fill(0.0);
                modes.add_motion(&amplitudes, &mut u);
                apply(&u, &mut image);
                modes.project(&image, &mut column, &mut partial);
                for knot in (colour..modes.knots.len()).step_by(3) {
                    let rows = knot.saturating_sub(1)..(knot + 2).min(modes.knots.len());
                    for row in MOTIONS * rows.start..MOTIONS * rows.end {
                        reduced[(row, MOTIONS * knot + motion)] = column[row];
                    }
                }
            }
        }
        modes.inverse = pseudo_inverse(&reduced)?;
        Ok(modes)
    }

    /// Number of motions.
    pub fn count(&self) -> usize {
        self.inverse.nrows()
    }

    /// (Z^T K Z)^+.
    pub fn inverse(&self) -> MatRef<'_, f64> {
        self.inverse.as_ref()
    }

    /// `c` = (Z^T K Z)^+ `c`.
    pub fn solve(&self, c: &mut [f64]) {
        let solved = &self.inverse * faer::ColRef::from_slice(c);
        for (c, solved) in c.iter_mut().zip(solved.iter()) {
            *c = *solved;
        }
    }

    /// Entries of Z's row of a displacement as (motion, value); empty if it is fixed.
    ///
    /// # Panics
    /// If the node or the component (0, 1, 2) does not exist.
    pub fn row(&self, node: usize, component: usize) -> Vec<(usize, f64)> {
        if self.fixed[3 * node + component] {
            return Vec::new();
        }
        let (knot, motions) = self.local(node);
        let values = motions.as_flattened().iter().map(|m| m[component]);
        values
            .enumerate()
            .map(|(k, value)| (MOTIONS * knot + k, value))
            .collect()
    }

    /// The first of the two knots around a node, and the node's displacement for each motion of
    /// both knots.
    fn local(&self, node: usize) -> (usize, [[[f64; 3]; MOTIONS]; 2]) {
        let [x, y, z] = self.points[node];
        let last = self.knots.len() - 2;
        let knot = self
            .knots
            .partition_point(|&k| k <= x)
            .saturating_sub(1)
            .min(last);
        let length = self.knots[knot + 1] - self.knots[knot];
        let s = (x - self.knots[knot]) / length;
        let (y, z) = (y - self.axis[0], z - self.axis[1]);
        // Hermite values (value, slope) at both knots, and their derivatives by x.
        let value = [
            [
                1.0 - s * s * (3.0 - 2.0 * s),
                s * (1.0 - s) * (1.0 - s) * length,
            ],
            [s * s * (3.0 - 2.0 * s), s * s * (s - 1.0) * length],
        ];
        let slope = [
            [-6.0 * s * (1.0 - s) / length, (1.0 - s) * (1.0 - 3.0 * s)],
            [6.0 * s * (1.0 - s) / length, s * (3.0 * s - 2.0)],
        ];
        let hat = [1.0 - s, s];
        let of_knot = |k: usize| {
            [
                [-z * slope[k][0], 0.0, value[k][0]],
                [-z * slope[k][1], 0.0, value[k][1]],
                [-y * slope[k][0], value[k][0], 0.0],
                [-y * slope[k][1], value[k][1], 0.0],
                [hat[k], 0.0, 0.0],
                [0.0, -z * hat[k], y * hat[k]],
                [y * z * hat[k], 0.0, 0.0],
                [0.0, -2.0 * y * z * hat[k], y * y * hat[k]],
            ]
        };
        (knot, [of_knot(0), of_knot(1)])
    }

    /// `u` += Z c.
    pub fn add_motion(&self, c: &[f64], u: &mut [f64]) {
        u.par_chunks_mut(3 * NODES_PER_TASK)
            .enumerate()
            .for_each(|(task, u)| {
                for (offset, u) in u.chunks_exact_mut(3).enumerate() {
                    let node = task * NODES_PER_TASK + offset;
                    let (knot, motions) = self.local(node);
                    for (motion, c) in motions.as_flattened().iter().zip(&c[MOTIONS * knot..]) {
                        for i in 0..3 {
                            if !self.fixed[3 * node + i] {
                                u[i] += c * motion[i];
                            }
                        }
                    }
                }
            });
    }

    /// c = Z^T r, summed by nodes in a fixed order. `partial` is scratch for the tasks' sums, which
    /// is resized.
    ///
    /// # Panics
    /// If `r` does not hold three numbers per node.
    pub fn project(&self, r: &[f64], c: &mut [f64], partial: &mut Vec<f64>) {
        assert_eq!(r.len(), 3 * self.points.len());
        let n = c.len();
        partial.resize(self.points.len().div_ceil(NODES_PER_TASK) * n, 0.0);
        partial
            .par_chunks_mut(n)
            .enumerate()
            .for_each(|(task, sums)| {
                sums.fill(0.0);
                let nodes =
                    task * NODES_PER_TASK..((task + 1) * NODES_PER_TASK).min(self.points.len());
                for node in nodes {
                    let (knot, motions) = self.local(node);
                    let sums = &mut sums[MOTIONS * knot..];
                    for (motion, sum) in motions.as_flattened().iter().zip(sums) {
                        for i in 0..3 {
                            if !self.fixed[3 * node + i] {
                                *sum += motion[i] * r[3 * node + i];
                            }
                        }
                    }
                }
            });
        c.fill(0.0);
        for sums in partial.chunks_exact(n) {
            for (c, sum) in c.iter_mut().zip(sums) {
                *c += sum;
            }
        }
    }
}

/// About `count` equidistant lines, including the first and the last.
fn spread(lines: &[f64], count: usize) -> Vec<f64> {
    assert!(
        lines.len() >= 2 && count >= 2,
        "{} lines, {count} knots",
        lines.len()
    );
    let (first, last) = (lines[0], lines[lines.len() - 1]);
    let mut knots: Vec<f64> = (0..count)
        .map(|i| {
            let wanted = first + (last - first) * i as f64 / (count - 1) as f64;
            let above = lines
                .partition_point(|&line| line < wanted)
                .min(lines.len() - 1);
            let below = above.saturating_sub(1);
            let nearer_below = (lines[below] - wanted).abs() < (lines[above] - wanted).abs();
            if nearer_below {
                lines[below]
            } else {
                lines[above]
            }
        })
        .collect();
    knots.dedup();
    knots
}

/// Eigenvalue of the matrix with unit diagonal below which the strain of a motion is rounding.
const STRAINS: f64 = 1e-12;

/// The pseudo-inverse of a positive semi-definite matrix whose rows have very different units: D V
/// L^+ V^T D from the eigenvalues L of D A D, which has a unit diagonal.
fn pseudo_inverse(a: &Mat<f64>) -> Result<Mat<f64>, Error> {
    let n = a.nrows();
    let scale: Vec<f64> = (0..n)
        .map(|i| match a[(i, i)] {
            d if d > 0.0 => d.sqrt().recip(),
            _ => 0.0,
        })
        .collect();
    let scaled = Mat::from_fn(n, n, |i, j| scale[i] * a[(i, j)] * scale[j]);
    let (values, vectors) =
        eigenpairs(&scaled).ok_or(Error::NotPositiveDefinite { free_dofs: n })?;
    let weighted = Mat::from_fn(n, n, |i, k| match values[k] {
        value if value > STRAINS => scale[i] * vectors[(i, k)] / value.sqrt(),
        _ => 0.0,
    });
    Ok(&weighted * weighted.transpose())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::Body;
    use crate::body::ElementKind;
    use crate::body::Material;
    use crate::body::tests::block;
    use crate::sparse::assembly::assemble;

    fn modes_of_a_cantilever() -> (BeamModes, crate::BlockMatrix) {
        let mesh = block([24, 3, 2], [0.6, 0.02, 0.008], 0.0);
        let points = mesh.points.clone();
        let fixed: Vec<bool> = points.iter().flat_map(|p| [p[0] == 0.0; 3]).collect();
        let lines: Vec<f64> = (0..=24).map(|i| 0.6 * i as f64 / 24.0).collect();
        let steel = Material::new(210e9, 0.3).unwrap();
        let body = Body::uniform(mesh, steel, ElementKind::Hex8Incompatible).unwrap();
        let stiffness = assemble(&body);
        let modes = BeamModes::new(points, &lines, 9, [0.01, 0.004], fixed, |u, out| {
            stiffness.apply(u, out)
        });
        (modes.unwrap(), stiffness)
    }

    /// Z (Z^T K Z)^-1 Z^T K is a projection: applied to a motion of the coarse space it gives that
    /// motion.
    #[test]
    fn the_correction_is_exact_in_the_coarse_space() {
        let (modes, stiffness) = modes_of_a_cantilever();
        let amplitudes: Vec<f64> = (0..modes.count())
            .map(|i| {
                if i < MOTIONS {
                    0.0
                } else {
                    ((i * i) as f64 * 0.7).sin()
                }
            })
            .collect();
        let dofs = stiffness.dofs();
        let (mut u, mut force, mut back) = (vec![0.0; dofs], vec![0.0; dofs], vec![0.0; dofs]);
        modes.add_motion(&amplitudes, &mut u);
        stiffness.apply(&u, &mut force);
        let mut projected = vec![0.0; modes.count()];
        modes.project(&force, &mut projected, &mut Vec::new());
        modes.solve(&mut projected);
        modes.add_motion(&projected, &mut back);
        let size = u.iter().fold(0.0f64, |s, v| s.max(v.abs()));
        for (a, b) in u.iter().zip(&back) {
            assert!((a - b).abs() < 1e-7 * size, "{a} {b}");
        }
    }

    #[test]
    fn rigid_motions_lie_in_the_coarse_space() {
        let (modes, _) = modes_of_a_cantilever();
        let [y0, z0] = modes.axis;
        // Turning about y: w = x at every knot with slope 1; u = (-(z - z_0), 0, x).
        let mut c = vec![0.0; modes.count()];
        for (k, &x) in modes.knots.iter().enumerate() {
            c[MOTIONS * k] = x;
            c[MOTIONS * k + 1] = 1.0;
        }
        let mut u = vec![0.0; 3 * modes.points.len()];
        modes.add_motion(&c, &mut u);
        for (node, p) in modes.points.iter().enumerate() {
            if p[0] > 0.0 {
                let expected = [-(p[2] - z0), 0.0, p[0]];
                for i in 0..3 {
                    assert!((u[3 * node + i] - expected[i]).abs() < 1e-15);
                }
            }
        }
        assert_eq!((y0, modes.knots.len()), (0.01, 9));
    }

    #[test]
    fn motions_that_add_nothing_are_left_out() {
        let a = faer::mat![[2.0, 2.0, 0.0], [2.0, 2.0, 0.0], [0.0, 0.0, 9.0]];
        let inverse = pseudo_inverse(&a).unwrap();
        let expected = faer::mat![
            [0.125, 0.125, 0.0],
            [0.125, 0.125, 0.0],
            [0.0, 0.0, 1.0 / 9.0]
        ];
        assert!((inverse - expected).norm_max() < 1e-15);
    }
}
