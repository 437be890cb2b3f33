//! By how much each channel comes late, by the relations of a rigid body.

use crate::record::check::relations::coefficients::{Coefficient, coefficients};
use crate::record::check::relations::rigid_body::instants;
use crate::record::check::relations::slow::Slow;

/// How late each channel is beside the others, if it alone is [s], with its standard error; in the order of the columns.
///
/// What is left of the relations is fitted by how it would change were the channel read a hundredth of a second later, beside
/// how it would change were the accelerometer or the slip sensor a metre off.
pub fn delays(slow: &Slow) -> [Option<Coefficient>; 8] {
    const STEP_S: f64 = 0.01;
    let all = instants(slow);
    let there = [0, 1, 2].map(|axis: usize| slow.channels[axis].is_some());
    let scale = [0, 1, 2].map(|axis: usize| {
        let squares = all
            .iter()
            .flat_map(|at| at.terms[axis])
            .map(|t| t * t)
            .sum::<f64>();
        if there[axis] && squares > 0.0 {
            squares.sqrt().recip()
        } else {
            0.0
        }
    });
    let left = |slow: &Slow| -> Vec<f64> {
        let sum = |terms: &[f64; 5]| terms.iter().sum::<f64>();
        let instants = instants(slow);
        let each = instants
            .iter()
            .flat_map(|at| (0..3).map(|axis| scale[axis] * sum(&at.terms[axis])));
        each.collect()
    };
    let now = left(slow);
    let change =
        |other: &Slow| -> Vec<f64> { left(other).iter().zip(&now).map(|(a, b)| a - b).collect() };
    let mut places: Vec<Vec<f64>> = (0..3).map(|axis| change(&displaced(slow, axis))).collect();
    let mut ahead = slow.clone();
    if let (Some(alpha), Some(yaw), Some(v)) =
        (&mut ahead.channels[7], &slow.channels[5], &slow.channels[6])
    {
        for (alpha, (r, v)) in alpha.iter_mut().zip(yaw.iter().zip(v)) {
            *alpha -= r / v;
        }
    }
    places.push(change(&ahead));
    places.retain(|place| place.iter().any(|x| *x != 0.0));
    std::array::from_fn(|c| {
        let x = slow.channels[c].as_ref()?;
        let mut later = slow.clone();
        let rates = rate(slow, x);
        for (x, rate) in later.channels[c].as_mut()?.iter_mut().zip(rates) {
            *x += STEP_S * rate;
        }
        let change = change(&later);
        let columns: Vec<&[f64]> = std::iter::once(&change)
            .chain(&places)
            .map(Vec::as_slice)
            .collect();
        let rows: Vec<(usize, f64)> = now.iter().map(|left| -left).enumerate().collect();
        let (steps, error) = *coefficients(&columns, &rows)?.first()?;
        Some((STEP_S * steps, STEP_S * error))
    })
}

/// What the accelerometers would read a metre further along an axis: `dw/dt x e + w x (w x e)` more.
fn displaced(slow: &Slow, axis: usize) -> Slow {
    let mut moved = slow.clone();
    let n = slow.pieces.last().map_or(0, |piece| piece.end);
    let still = vec![0.0; n];
    let w = [3, 4, 5].map(|c: usize| slow.channels[c].as_ref().unwrap_or(&still));
    let turning = w.map(|w| rate(slow, w));
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    for i in 0..n {
        // dw/dt x e has components along the other two axes, w x (w x e) along all: w_axis w - |w|^2 e.
        let mut more = [0.0; 3];
        more[j] += turning[k][i];
        more[k] -= turning[j][i];
        let size: f64 = w.iter().map(|w| w[i] * w[i]).sum();
        for (to, own) in more.iter_mut().zip(w) {
            *to += w[axis][i] * own[i];
        }
        more[axis] -= size;
        for (channel, more) in moved.channels[..3].iter_mut().zip(more) {
            if let Some(a) = channel {
                a[i] += more;
            }
        }
    }
    moved
}

/// Rate of a slow channel, stretch by stretch.
fn rate(slow: &Slow, x: &[f64]) -> Vec<f64> {
    let mut rates = vec![0.0; x.len()];
    for piece in &slow.pieces {
        for i in piece.clone() {
            let (before, after) = (i.max(piece.start + 1) - 1, (i + 1).min(piece.end - 1));
            rates[i] = (x[after] - x[before]) / ((after - before) as f64 * slow.dt_s);
        }
    }
    rates
}
