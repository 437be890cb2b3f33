//! The preconditioner of [`crate::FastDiagonal`] with less work: x and y by eigenvectors, z by elimination.

use faer::{Mat, MatMut, MatRef};
use rayon::prelude::*;

use crate::precondition::dense::{columns, columns_mut, product};
use crate::precondition::elimination::{Elimination, End};
use crate::precondition::single_precision::RoundedModes;
use crate::tensor::axis::{Axis, AxisModes};
use crate::tensor::operator::TensorOperator;

/// Inverse of the block diagonal of elasticity on a tensor grid, plane by plane.
///
/// The operator is [`crate::FastDiagonal`]'s, and so is the result. In the modes of x and y a component's operator falls apart
/// into one tridiagonal matrix a pair (a, b) of modes,
///
/// T = c_z K_z + (c_x theta_a + c_y theta_b) M_z,
///
/// which is eliminated towards one end of z: four small matrix products a component instead of six. What that end has
/// gathered, y, tells the answer there before any other is known: z = T y with T one over the last pivot. A constraint on
/// that plane acts between [`PlanewiseDiagonal::gather`] and [`PlanewiseDiagonal::spread`].
///
/// The products are done in single precision ([`crate::precondition::single_precision`]), the elimination in double; so is the answer on that
/// plane, where a constraint must hold to rounding.
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
    /// Diagonalises x and y once for each pair of held ends that occurs, and eliminates z towards `end`.
    ///
    /// # Panics
    /// Where the plane at `end` is held in z: nothing could act there.
    pub fn new(operator: &TensorOperator, end: End) -> Self {
        let mut wanted: Vec<(usize, [bool; 2])> = Vec::new();
        for held in &operator.held {
            for (axis, &held) in held.iter().enumerate().take(2) {
                if !wanted.contains(&(axis, held)) {
                    wanted.push((axis, held));
                }
            }
        }
        let solved: Vec<AxisModes> = wanted
            .par_iter()
            .map(|&(axis, held)| operator.axes[axis].modes(held))
            .collect();
        let modes = |axis: usize, held: [bool; 2]| {
            let place = wanted.iter().position(|key| *key == (axis, held));
            solved[place.unwrap_or_else(|| unreachable!("every pair was collected"))].clone()
        };
        let mut start = 0;
        let components = std::array::from_fn(|c| {
            let held = operator.held[c];
            let coefficient = |axis: usize| {
                operator.mu
                    + if axis == c {
                        operator.lambda + operator.mu
                    } else {
                        0.0
                    }
            };
            let component = Component::new(
                [modes(0, held[0]), modes(1, held[1])],
                &operator.preconditioned_z(c),
                held[2],
                [coefficient(0), coefficient(1), coefficient(2)],
                end,
                start,
            );
            start += component.z.inverse_pivots.len();
            component
        });
        assert!(
            !operator.held[2][2][usize::from(end == End::High)],
            "the plane that elimination ends on is held"
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

    /// What unit vertical forces on the end plane move there: modes of x by modes of y [m/N].
    pub fn end_response(&self) -> MatRef<'_, f64> {
        let vertical = &self.components[2];
        let [mx, my] = vertical.pairs();
        let last = vertical.z.inverse_pivots.len() - mx * my;
        columns(&vertical.z.inverse_pivots[last..], [mx, my])
    }

    /// What the end plane has gathered of the vertical component, modes of x by modes of y: times
    /// [`PlanewiseDiagonal::end_response`] it is the displacement there.
    pub fn gathered<'a>(&self, modal: &'a [f64]) -> MatRef<'a, f64> {
        let [mx, my] = self.components[2].pairs();
        columns(&modal[self.end_plane()], [mx, my])
    }

    /// The same to be changed by forces on the end plane.
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

    /// The modal form of `r`, solved but for the vertical component, which is eliminated up to the end plane.
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

    /// `z` from what [`PlanewiseDiagonal::gather`] left, which it uses up.
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
        held: [bool; 2],
        coefficients: [f64; 3],
        end: End,
        start: usize,
    ) -> Self {
        let mut shift = Vec::with_capacity(x.values.len() * y.values.len());
        for theta_y in &y.values {
            let y = coefficients[1] * theta_y;
            shift.extend(x.values.iter().map(|theta| coefficients[0] * theta + y));
        }
        let z = Elimination::new(z, held, coefficients[2], shift, end);
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

    /// `z` = (Qx x Qy) `modal`, plane by plane; 0 on held planes.
    fn leave_modes(&self, [nx, ny, _]: [usize; 3], modal: &[f64], z: &mut [f64]) {
        let [mx, my] = self.pairs();
        let upwards = self.z.planes.first() < self.z.planes.last();
        let step_of = |k: usize| {
            let (low, high) = match upwards {
                true => (self.z.planes[0], self.z.planes[self.z.planes.len() - 1]),
                false => (self.z.planes[self.z.planes.len() - 1], self.z.planes[0]),
            };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::material::Material;
    use crate::precondition::fast_diagonal::FastDiagonal;
    use kufe_mesh::TensorGrid;

    fn operator(held_high: bool) -> TensorOperator {
        let graded = |n: usize, growth: f64| -> Vec<f64> {
            (0..n).map(|i| growth.powi(i as i32) - 1.0).collect()
        };
        let grid = TensorGrid {
            x: graded(19, 1.3),
            y: graded(21, 1.4),
            z: graded(11, 1.2),
        };
        let ice = Material::new(9e9, 0.33).unwrap();
        let held =
            std::array::from_fn(|c| [[c == 0, true], [c == 1, true], [!held_high, held_high]]);
        TensorOperator::new(&grid, ice.lame_lambda(), ice.shear_modulus(), held)
    }

    #[test]
    fn elimination_and_eigenvectors_invert_the_same_operator_to_single_precision() {
        for (end, held_high) in [(End::High, false), (End::Low, true)] {
            let operator = operator(held_high);
            let plain = FastDiagonal::new(&operator);
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
        let told = Mat::from_fn(gathered.nrows(), gathered.ncols(), |a, b| {
            gathered[(a, b)] * response[(a, b)]
        });
        let [x, y] = layered.plane_modes();
        let told = &x.vectors * told * y.vectors.transpose();
        let mut z = vec![0.0; n];
        layered.spread(&mut modal, &mut z);
        let [nx, ny, _] = operator.shape();
        let size = z.iter().fold(0.0f64, |m, v| m.max(v.abs()));
        for (place, z) in z[n - nx * ny..].iter().enumerate() {
            assert!((z - told[(place % nx, place / nx)]).abs() < 1e-13 * size);
        }
    }
}
