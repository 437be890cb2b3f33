//! The place of a run along the track, landmark by landmark.

use nalgebra::{DMatrix, DVector};

use crate::track::align::course::Course;
use crate::track::align::felt::Felt;
use crate::track::align::search::Line;
use crate::track::align::warp::Warp;

/// Distance of the knots [m]: a curve and the straight before it are one landmark.
const KNOTS_M: f64 = 100.0;
/// By how much an integrated distance drifts more on one such way than on the way before [m], a standard deviation: half a
/// per cent, of a speed whose scale wanders.
const DRIFT_M: f64 = 0.5;
/// Rounds of Gauss and Newton's method; the last ones move by less than a millimetre.
const ROUNDS: usize = 12;
/// Most that one round moves a knot [m].
const MOST_M: f64 = 5.0;
/// Differences beyond so many standard deviations count less (Huber): a wall, a bump, a line driven high.
const ORDINARY: f64 = 2.0;
/// Lags over which what is left is taken to be alike [m].
const ALIKE_M: usize = 40;

/// Shifts at knots that bring what a run felt onto the course, by robust least squares:
///
/// ```text
/// sum over metres and both quantities of  huber( (felt - course(s + shift(s))) / sd )
///   + sum over knots of ( (shift_{j+1} - 2 shift_j + shift_{j-1}) / 0.5 m )^2
/// ```
///
/// with the deviations sd of what is left. The errors are those of the linear fit, what is left being alike over some metres.
pub(crate) fn refine(felt: &Felt, course: &Course, from: &Line) -> Warp {
    let length = (felt.metres.len() - 1).max(1) as f64;
    let pieces = (length / KNOTS_M).round().max(1.0) as usize;
    let knot = |j: usize| felt.from_m + length * j as f64 / pieces as f64;
    let own_m: Vec<f64> = (0..=pieces).map(knot).collect();
    let shift = |own: f64| from.shift_m + (from.stretch - 1.0) * (own - felt.from_m);
    let mut warp = Warp {
        shift_m: own_m.iter().map(|own| shift(*own)).collect(),
        sd_m: vec![0.0; own_m.len()],
        own_m,
    };
    for _ in 0..ROUNDS {
        let left = Left::of(felt, course, &warp);
        let (mut normal, mut right) = prior(&warp.shift_m);
        left.add_to(&mut normal, &mut right);
        let Some(factor) = normal.cholesky() else {
            break;
        };
        let step = factor.solve(&right);
        for (shift, step) in warp.shift_m.iter_mut().zip(step.iter()) {
            *shift += step.clamp(-MOST_M, MOST_M);
        }
    }
    let left = Left::of(felt, course, &warp);
    let (drift, mut right) = prior(&warp.shift_m);
    let mut data = DMatrix::zeros(drift.nrows(), drift.nrows());
    left.add_to(&mut data, &mut right);
    if let Some(factor) = (&data + &drift).cholesky() {
        // Metres that say the same are fewer; the drift says what it says.
        let inverse = factor.inverse();
        let covariance = &inverse * (data * left.alike() + drift) * &inverse;
        warp.sd_m = covariance.diagonal().iter().map(|x| x.sqrt()).collect();
    }
    warp
}

/// Normal matrix and right-hand side of a drift that is even along the way.
fn prior(shift: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let n = shift.len();
    let (mut normal, mut right) = (DMatrix::zeros(n, n), DVector::zeros(n));
    for j in 1..n.saturating_sub(1) {
        let bend = [(j - 1, 1.0), (j, -2.0), (j + 1, 1.0)];
        let value: f64 = bend.iter().map(|(k, w)| w * shift[*k]).sum();
        for (a, wa) in bend {
            right[a] -= wa * value / (DRIFT_M * DRIFT_M);
            for (b, wb) in bend {
                normal[(a, b)] += wa * wb / (DRIFT_M * DRIFT_M);
            }
        }
    }
    // A run without landmarks stays where the search put it.
    for j in 0..n {
        normal[(j, j)] += 1e-6;
    }
    (normal, right)
}

/// What is left between a run and the course at a warp.
struct Left {
    /// Metre by metre: knot before, share of the next, differences and slopes of the course.
    rows: Vec<(usize, f64, [f64; 2], [f64; 2])>,
    /// Deviations of the differences.
    sd: [f64; 2],
    /// Growth of the distance by the own one at each metre is near 1 and left out of the slopes.
    knots: usize,
}

impl Left {
    fn of(felt: &Felt, course: &Course, warp: &Warp) -> Left {
        let mut rows = Vec::with_capacity(felt.metres.len());
        for (i, metre) in felt.metres.iter().enumerate() {
            let own = felt.place(i);
            if let Some((at, slope)) = course.at(warp.at(own)).filter(|_| metre[0].is_finite()) {
                let (knot, share) = warp.between(own);
                rows.push((knot, share, [metre[0] - at[0], metre[1] - at[1]], slope));
            }
        }
        let sd = [0, 1].map(|k| {
            let mut sizes: Vec<f64> = rows.iter().map(|row| row.2[k].abs()).collect();
            if sizes.is_empty() {
                return 1.0;
            }
            let middle = sizes.len() / 2;
            let median = *sizes.select_nth_unstable_by(middle, f64::total_cmp).1;
            // The median magnitude of a normal variable; and not less than a hundredth of what the course itself does.
            (median / 0.674_489_75).max(0.01 * course.spread[k])
        });
        Left {
            rows,
            sd,
            knots: warp.own_m.len(),
        }
    }

    fn add_to(&self, normal: &mut DMatrix<f64>, right: &mut DVector<f64>) {
        for (knot, share, differences, slopes) in &self.rows {
            let hats = [
                (*knot, 1.0 - share),
                ((knot + 1).min(self.knots - 1), *share),
            ];
            for k in 0..2 {
                let size = (differences[k] / self.sd[k]).abs();
                let weight = (ORDINARY / size.max(ORDINARY)) / (self.sd[k] * self.sd[k]);
                for (a, wa) in hats {
                    right[a] += weight * wa * slopes[k] * differences[k];
                    for (b, wb) in hats {
                        normal[(a, b)] += weight * wa * wb * slopes[k] * slopes[k];
                    }
                }
            }
        }
    }

    /// How many neighbouring metres say the same: `1 + 2 sum of correlations` up to the first that is not positive.
    fn alike(&self) -> f64 {
        let of = |k: usize| {
            let values: Vec<f64> = self
                .rows
                .iter()
                .map(|row| (row.2[k] / self.sd[k]).clamp(-ORDINARY, ORDINARY))
                .collect();
            let product =
                |lag: usize| -> f64 { values.iter().zip(&values[lag..]).map(|(a, b)| a * b).sum() };
            let own = product(0).max(f64::MIN_POSITIVE);
            (1..ALIKE_M.min(values.len()))
                .map(|lag| product(lag) / own)
                .take_while(|correlation| *correlation > 0.0)
                .sum::<f64>()
        };
        1.0 + 2.0 * of(0).max(of(1))
    }
}
