//! The preconditioner of [`crate::FastDiagonal`] at a lower cost: x and y by eigenvectors, z by
//! elimination.

use std::collections::{BTreeMap, BTreeSet};

use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use crate::precondition::elimination::{Elimination, End};
use crate::precondition::fast_diagonal::{columns, columns_mut, product};
use crate::tensor::axis::{Axis, AxisModes};
use crate::tensor::operator::TensorOperator;

/// Inverse of the block diagonal of elasticity on a tensor grid, plane by plane.
///
/// Operator and result are those of [`crate::FastDiagonal`]. In the modes of x and y a component's
/// operator decouples into one tridiagonal matrix per pair (a, b) of modes,
///
/// T = c_z K_z + (c_x theta_a + c_y theta_b) M_z,
///
/// which is eliminated towards one end of z: four small matrix products per component instead of
/// six. The right-hand side y at that end after the forward pass gives the solution there, z = y /
/// (last pivot), before the backward pass. A constraint on that plane acts between
/// [`PlanewiseDiagonal::gather`] and [`PlanewiseDiagonal::spread`].
///
/// The products are computed in single precision. The elimination, and the solution on that plane,
/// where a constraint must be satisfied to rounding, are computed in double precision.
#[derive(Clone, Debug)]
pub struct PlanewiseDiagonal {
    pub(crate) shape: [usize; 3],
    pub(crate) components: [Component; 3],
}

#[derive(Clone, Debug)]
pub(crate) struct Component {
    pub x: AxisModes,
    pub y: AxisModes,
    pub z: Elimination,
    rounded: RoundedModes,
    /// Where this component's modal values start.
    pub start: usize,
}

impl PlanewiseDiagonal {
    /// Diagonalises x and y once for each pair of fixed ends that occurs, and eliminates z towards
    /// `end`.
    ///
    /// # Panics
    /// If the plane at `end` is fixed in z.
    pub fn new(operator: &TensorOperator, end: End) -> Self {
        let key = |c: usize, axis: usize| (axis, operator.fixed[c][axis]);
        let keys: BTreeSet<_> = (0..6).map(|k| key(k / 2, k % 2)).collect();
        let solved: BTreeMap<_, AxisModes> = keys
            .into_par_iter()
            .map(|(axis, fixed)| ((axis, fixed), operator.axes[axis].modes(fixed)))
            .collect();
        let mut start = 0;
        let components = std::array::from_fn(|c| {
            let coefficients = operator.scalar_coefficients(c);
            let component = Component::new(
                [0, 1].map(|axis| solved[&key(c, axis)].clone()),
                &operator.preconditioned_z(c),
                operator.fixed[c][2],
                coefficients,
                end,
                start,
            );
            start += component.z.inverse_pivots.len();
            component
        });
        assert!(
            !operator.fixed[2][2][usize::from(end == End::High)],
            "the plane that elimination ends on is fixed"
        );
        PlanewiseDiagonal {
            shape: operator.shape(),
            components,
        }
    }

    /// Length of a modal vector.
    pub fn mode_count(&self) -> usize {
        self.components
            .iter()
            .map(|c| c.z.inverse_pivots.len())
            .sum()
    }

    /// Modes of the vertical displacement along x and along y.
    pub fn plane_modes(&self) -> [&AxisModes; 2] {
        [&self.components[2].x, &self.components[2].y]
    }

    /// Vertical displacement of the end plane under unit vertical forces on it, modes of x by modes
    /// of y [m/N].
    pub fn end_response(&self) -> MatRef<'_, f64> {
        let vertical = &self.components[2];
        let [mx, my] = vertical.pairs();
        let last = vertical.z.inverse_pivots.len() - mx * my;
        columns(&vertical.z.inverse_pivots[last..], [mx, my])
    }

    /// Right-hand side of the vertical component on the end plane after the forward pass, modes of
    /// x by modes of y; times [`PlanewiseDiagonal::end_response`] it is the displacement there.
    pub fn gathered<'a>(&self, modal: &'a [f64]) -> MatRef<'a, f64> {
        let [mx, my] = self.components[2].pairs();
        columns(&modal[self.end_plane()], [mx, my])
    }

    /// [`PlanewiseDiagonal::gathered`], mutable, for forces on the end plane.
    pub fn gathered_mut<'a>(&self, modal: &'a mut [f64]) -> MatMut<'a, f64> {
        let [mx, my] = self.components[2].pairs();
        columns_mut(&mut modal[self.end_plane()], [mx, my])
    }

    fn end_plane(&self) -> std::ops::Range<usize> {
        let vertical = &self.components[2];
        let [mx, my] = vertical.pairs();
        let end = vertical.start + vertical.z.inverse_pivots.len();
        end - mx * my..end
    }

    /// First part of P^-1 `r`: transforms to modes, solves the horizontal components and eliminates
    /// the vertical one up to the end plane (forward pass).
    pub fn gather(&self, r: &[f64], modal: &mut [f64]) {
        let nodes: usize = self.shape.iter().product();
        assert_eq!((r.len(), modal.len()), (3 * nodes, self.mode_count()));
        for (c, component) in self.components.iter().enumerate() {
            let modal = &mut modal[component.range()];
            component.to_modes(self.shape, &r[c * nodes..(c + 1) * nodes], modal);
            let passes = if c < 2 { [true, true] } else { [true, false] };
            component.z.run(modal, passes);
        }
    }

    /// Second part: `z` from the result of [`PlanewiseDiagonal::gather`], which is overwritten.
    pub fn spread(&self, modal: &mut [f64], z: &mut [f64]) {
        let nodes: usize = self.shape.iter().product();
        assert_eq!((z.len(), modal.len()), (3 * nodes, self.mode_count()));
        let vertical = &self.components[2];
        vertical.z.run(&mut modal[vertical.range()], [false, true]);
        for (c, component) in self.components.iter().enumerate() {
            let z = &mut z[c * nodes..(c + 1) * nodes];
            component.leave_modes(self.shape, &modal[component.range()], z);
        }
    }

    /// `z` = P^-1 `r`.
    pub fn apply(&self, r: &[f64], z: &mut [f64], modal: &mut [f64]) {
        self.gather(r, modal);
        self.spread(modal, z);
    }
}

impl Component {
    fn new(
        [x, y]: [AxisModes; 2],
        z: &Axis,
        fixed: [bool; 2],
        coefficients: [f64; 3],
        end: End,
        start: usize,
    ) -> Self {
        let mut shift = Vec::with_capacity(x.values.len() * y.values.len());
        for theta_y in &y.values {
            let y = coefficients[1] * theta_y;
            shift.extend(x.values.iter().map(|theta| coefficients[0] * theta + y));
        }
        let z = Elimination::new(z, fixed, coefficients[2], shift, end);
        let rounded = RoundedModes::new(&x, &y);
        Component {
            x,
            y,
            z,
            rounded,
            start,
        }
    }

    /// Modes of x and of y.
    pub fn pairs(&self) -> [usize; 2] {
        [self.x.values.len(), self.y.values.len()]
    }

    fn range(&self) -> std::ops::Range<usize> {
        self.start..self.start + self.z.inverse_pivots.len()
    }

    /// `modal` = (Qx x Qy)^T `r`, plane by plane in the order of elimination.
    fn to_modes(&self, [nx, ny, _]: [usize; 3], r: &[f64], modal: &mut [f64]) {
        let [mx, my] = self.pairs();
        let planes = modal.par_chunks_mut(mx * my).zip(&self.z.planes);
        planes.for_each_init(
            || self.rounded.room(),
            |room, (modal, &k)| {
                let nodal = &r[k * nx * ny..(k + 1) * nx * ny];
                self.rounded.to_modes(nodal, modal, room);
            },
        );
    }

    /// `z` = (Qx x Qy) `modal`, plane by plane; 0 on fixed planes.
    fn leave_modes(&self, [nx, ny, _]: [usize; 3], modal: &[f64], z: &mut [f64]) {
        let [mx, my] = self.pairs();
        let upwards = self.z.planes.first() < self.z.planes.last();
        let step_of = |k: usize| {
            let ends = (self.z.planes[0], self.z.planes[self.z.planes.len() - 1]);
            let (low, high) = if upwards { ends } else { (ends.1, ends.0) };
            (low..=high)
                .contains(&k)
                .then(|| if upwards { k - low } else { high - k })
        };
        z.par_chunks_mut(nx * ny).enumerate().for_each_init(
            || self.rounded.room(),
            |room, (k, plane)| {
                let Some(step) = step_of(k) else {
                    plane.fill(0.0);
                    return;
                };
                let modal = &modal[step * mx * my..(step + 1) * mx * my];
                if step + 1 < self.z.planes.len() {
                    self.rounded.leave_modes(modal, plane, room);
                } else {
                    let mut half = Mat::zeros(nx, my);
                    let modal = columns(modal, [mx, my]);
                    product(half.as_mut(), self.x.vectors.as_ref(), modal);
                    let plane = columns_mut(plane, [nx, ny]);
                    product(plane, half.as_ref(), self.y.vectors.transpose());
                }
            },
        );
    }
}

/// The eigenvectors Q of x and y, rounded.
///
/// A preconditioner need not be exact, and numbers of half the length are multiplied twice as fast.
/// Each plane is scaled by the power of two that brings its largest number into [1, 2), so that
/// nothing overflows. The rounding error is about 6e-8 sqrt(nx + ny) times the largest number.
#[derive(Clone, Debug)]
pub(crate) struct RoundedModes {
    x: Mat<f32>,
    y: Mat<f32>,
}

/// Workspace of products.
pub(crate) struct Room {
    nodal: Vec<f32>,
    half: Vec<f32>,
    modal: Vec<f32>,
}

impl RoundedModes {
    /// The rounded modes of both axes.
    pub fn new(x: &AxisModes, y: &AxisModes) -> Self {
        let rounded = |v: &Mat<f64>| Mat::from_fn(v.nrows(), v.ncols(), |i, j| v[(i, j)] as f32);
        RoundedModes {
            x: rounded(&x.vectors),
            y: rounded(&y.vectors),
        }
    }

    /// Workspace for one plane.
    pub fn room(&self) -> Room {
        let (x, y) = (&self.x, &self.y);
        Room {
            nodal: vec![0.0; x.nrows() * y.nrows()],
            half: vec![0.0; (x.ncols() * y.nrows()).max(x.nrows() * y.ncols())],
            modal: vec![0.0; x.ncols() * y.ncols()],
        }
    }

    /// `modal` = Qx^T `nodal` Qy, first axis fastest.
    pub fn to_modes(&self, nodal: &[f64], modal: &mut [f64], room: &mut Room) {
        let (x, y) = (self.x.as_ref(), self.y.as_ref());
        let half = [x.ncols(), y.nrows()];
        let scale = narrow(nodal, &mut room.nodal);
        let narrowed = columns(&room.nodal, [x.nrows(), y.nrows()]);
        product(columns_mut(&mut room.half, half), x.transpose(), narrowed);
        let whole = [x.ncols(), y.ncols()];
        let halved = columns(&room.half, half);
        product(columns_mut(&mut room.modal, whole), halved, y);
        widen(&room.modal, scale, modal);
    }

    /// `nodal` = Qx `modal` Qy^T.
    pub fn leave_modes(&self, modal: &[f64], nodal: &mut [f64], room: &mut Room) {
        let (x, y) = (self.x.as_ref(), self.y.as_ref());
        let half = [x.nrows(), y.ncols()];
        let scale = narrow(modal, &mut room.modal);
        let narrowed = columns(&room.modal, [x.ncols(), y.ncols()]);
        product(columns_mut(&mut room.half, half), x, narrowed);
        let whole = [x.nrows(), y.nrows()];
        let halved = columns(&room.half, half);
        product(columns_mut(&mut room.nodal, whole), halved, y.transpose());
        widen(&room.nodal, scale, nodal);
    }
}

/// `to` = `scale` `from` in single precision, `scale` a power of two, which is returned.
fn narrow(from: &[f64], to: &mut [f32]) -> f64 {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            let scale = scale_of(largest(from));
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to = (scale * from) as f32);
            scale
        },
    )
}

/// `to` = `from` / `scale`.
fn widen(from: &[f32], scale: f64, to: &mut [f64]) {
    let back = scale.recip();
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            to.iter_mut()
                .zip(from)
                .for_each(|(to, from)| *to = back * f64::from(*from));
        },
    );
}

/// Largest absolute value, with eight running maxima.
#[inline(always)]
fn largest(values: &[f64]) -> f64 {
    let (whole, rest) = values.as_chunks::<8>();
    let mut running = [0.0f64; 8];
    for v in whole {
        for l in 0..8 {
            running[l] = running[l].max(v[l].abs());
        }
    }
    let all = running.iter().chain(rest);
    all.fold(0.0, |largest, v| largest.max(v.abs()))
}

/// The power of two that brings `largest` into [1, 2); 1 if there is none.
pub(crate) fn scale_of(largest: f64) -> f64 {
    // Outside these bounds the power or its reciprocal would not be a normal number.
    if (1e-300..1e300).contains(&largest) {
        let exponent = largest.to_bits() >> 52;
        f64::from_bits((2 * ONE - exponent) << 52)
    } else {
        1.0
    }
}

/// The exponent bits of 1.
const ONE: u64 = 1.0f64.to_bits() >> 52;

#[cfg(test)]
mod tests {
    use kufe_mesh::TensorGrid;

    use super::*;
    use crate::body::Material;
    use crate::precondition::fast_diagonal::FastDiagonal;

    fn operator(fixed_high: bool) -> TensorOperator {
        let graded = |n: usize, growth: f64| -> Vec<f64> {
            (0..n).map(|i| growth.powi(i as i32) - 1.0).collect()
        };
        let grid = TensorGrid {
            x: graded(19, 1.3),
            y: graded(21, 1.4),
            z: graded(11, 1.2),
        };
        let ice = Material::new(9e9, 0.33).unwrap();
        let fixed =
            std::array::from_fn(|c| [[c == 0, true], [c == 1, true], [!fixed_high, fixed_high]]);
        TensorOperator::new(&grid, ice, fixed)
    }

    #[test]
    fn elimination_and_eigenvectors_invert_the_same_operator_to_single_precision() {
        for (end, fixed_high) in [(End::High, false), (End::Low, true)] {
            let operator = operator(fixed_high);
            let plain = FastDiagonal::new(&operator, None);
            let layered = PlanewiseDiagonal::new(&operator, end);
            let n = 3 * operator.node_count();
            let r: Vec<f64> = (0..n).map(|i| (0.7 * i as f64).sin()).collect();
            let (mut expected, mut found) = (vec![0.0; n], vec![f64::NAN; n]);
            let mut modal = vec![0.0; plain.mode_count()];
            plain.apply(
                &r,
                &mut expected,
                &mut modal,
                &mut vec![0.0; plain.scratch_len()],
            );
            assert_eq!(layered.mode_count(), plain.mode_count());
            layered.apply(&r, &mut found, &mut modal);
            let size = expected.iter().fold(0.0f64, |m, v| m.max(v.abs()));
            for (expected, found) in expected.iter().zip(&found) {
                assert!((expected - found).abs() < 1e-5 * size, "{expected} {found}");
            }
        }
    }

    #[test]
    fn response_times_what_the_end_has_gathered_is_the_displacement_there() {
        let operator = operator(false);
        let layered = PlanewiseDiagonal::new(&operator, End::High);
        let n = 3 * operator.node_count();
        let r: Vec<f64> = (0..n).map(|i| (0.3 * i as f64).cos()).collect();
        let mut modal = vec![0.0; layered.mode_count()];
        layered.gather(&r, &mut modal);
        let gathered = layered.gathered(&modal);
        let response = layered.end_response();
        let expected = Mat::from_fn(gathered.nrows(), gathered.ncols(), |a, b| {
            gathered[(a, b)] * response[(a, b)]
        });
        let [x, y] = layered.plane_modes();
        let expected = &x.vectors * expected * y.vectors.transpose();
        let mut z = vec![0.0; n];
        layered.spread(&mut modal, &mut z);
        let [nx, ny, _] = operator.shape();
        let size = z.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for (place, z) in z[n - nx * ny..].iter().enumerate() {
            assert!((z - expected[(place % nx, place / nx)]).abs() < 1e-13 * size);
        }
    }

    fn modes() -> (AxisModes, AxisModes) {
        let axis = |n: usize, growth: f64| -> AxisModes {
            let nodes: Vec<f64> = (0..n).map(|i| growth.powi(i as i32)).collect();
            Axis::new(&nodes).modes([true, false])
        };
        (axis(23, 1.3), axis(11, 1.5))
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        let differences = a.iter().zip(b).map(|(a, b)| (a - b).abs());
        differences.fold(0.0, f64::max)
    }

    /// In both directions, of planes from very small to very large numbers.
    #[test]
    fn products_are_those_in_double_precision_to_one_in_a_million_of_the_largest() {
        let (x, y) = modes();
        let single = RoundedModes::new(&x, &y);
        let mut room = single.room();
        let (qx, qy) = (&x.vectors, &y.vectors);
        let [[nx, mx], [ny, my]] = [qx, qy].map(|q| [q.nrows(), q.ncols()]);
        for size in [1e-250, 1e-45, 1.0, 1e60, 1e250] {
            let plane = |rows: usize, cols: usize| {
                Mat::from_fn(rows, cols, |i, j| size * (1.3 * i as f64 + j as f64).sin())
            };
            let flat = |m: &Mat<f64>| -> Vec<f64> {
                let columns = 0..m.ncols();
                columns.flat_map(|j| m.col_as_slice(j).to_vec()).collect()
            };
            let nodal = plane(nx, ny);
            let expected = flat(&(qx.transpose() * &nodal * qy));
            let mut found = vec![f64::NAN; mx * my];
            single.to_modes(&flat(&nodal), &mut found, &mut room);
            assert!(largest_difference(&expected, &found) < 1e-6 * largest(&expected));
            let modal = plane(mx, my);
            let expected = flat(&(qx * &modal * qy.transpose()));
            let mut found = vec![f64::NAN; nx * ny];
            single.leave_modes(&flat(&modal), &mut found, &mut room);
            assert!(largest_difference(&expected, &found) < 1e-6 * largest(&expected));
        }
    }

    #[test]
    fn zeros_stay_zeros_and_what_is_no_number_stays_none() {
        let (x, y) = modes();
        let single = RoundedModes::new(&x, &y);
        let mut room = single.room();
        let mut modal = vec![f64::NAN; x.values.len() * y.values.len()];
        let mut nodal = vec![0.0; x.vectors.nrows() * y.vectors.nrows()];
        single.to_modes(&nodal, &mut modal, &mut room);
        assert!(modal.iter().all(|v| *v == 0.0));
        nodal[30] = f64::NAN;
        single.to_modes(&nodal, &mut modal, &mut room);
        assert!(modal.iter().any(|v| v.is_nan()));
    }

    #[test]
    fn scale_is_the_power_of_two_that_leads_to_between_one_and_two() {
        for largest in [1e-299, 0.3, 1.0, 1.999, 2.0, 3e7, 1e299] {
            let scale = scale_of(largest);
            assert!((1.0..2.0).contains(&(scale * largest)), "{largest}");
            assert_eq!(scale.to_bits() << 12, 0);
        }
        assert_eq!(scale_of(0.0), 1.0);
        assert_eq!(scale_of(f64::INFINITY), 1.0);
    }
}
