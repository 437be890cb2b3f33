//! Products with the eigenvectors of x and y, plane by plane, in single precision.

use faer::Mat;

use crate::precondition::dense::{columns, columns_mut, product};
use crate::tensor::axis::AxisModes;

/// The eigenvectors Q of x and y, rounded.
///
/// A preconditioner need not be exact, and numbers of half the length are multiplied twice as fast. Each plane is scaled by
/// the power of two that brings its largest number to 1 or more and below 2, so nothing overflows, and what is lost is some
/// 6e-8 sqrt(nx + ny) of that largest number.
#[derive(Clone, Debug)]
pub(crate) struct RoundedModes {
    x: Mat<f32>,
    y: Mat<f32>,
}

/// What products work in.
pub(crate) struct Room {
    nodal: Vec<f32>,
    half: Vec<f32>,
    modal: Vec<f32>,
}

impl RoundedModes {
    /// Of the modes of both axes.
    pub fn new(x: &AxisModes, y: &AxisModes) -> Self {
        let rounded = |v: &Mat<f64>| Mat::from_fn(v.nrows(), v.ncols(), |i, j| v[(i, j)] as f32);
        RoundedModes {
            x: rounded(&x.vectors),
            y: rounded(&y.vectors),
        }
    }

    /// Room for one plane.
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
        product(
            columns_mut(&mut room.modal, whole),
            columns(&room.half, half),
            y,
        );
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

/// The largest size of a number, by eight running ones.
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

/// The power of two that brings `largest` to 1 or more and below 2; 1 where there is none.
pub(crate) fn scale_of(largest: f64) -> f64 {
    // Beyond these bounds the power or its reciprocal would not be a normal number.
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
    use super::*;
    use crate::tensor::axis::Axis;

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
