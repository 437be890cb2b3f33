//! Removes the variation of grip between sessions from the residuals.
//!
//! Grip differs from day to day and acts alike on all runs of a session in the same curve, as walls
//! act on the runs that hit them.

use kufe_sled::scatter;

use crate::evidence::runs::contacts::run_contacts::residuals_without;
use crate::evidence::runs::model::residual_model::{BASE, ChannelRows, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::screen::levels::group;

/// Lateral and yaw balance.
const BALANCES: [usize; 2] = [1, 2];
/// Deviation above which a sample is excluded, in standard deviations. Chosen: noise alone exceeds
/// it in one of 16,000 samples.
const MAX_DEVIATION: f64 = 4.0;
/// Step of the factor in central differences.
const CHANGE: f64 = 0.01;

/// Subtracts from the residuals of each run the part that a change of grip per session explains.
/// With j the derivative of the residual with respect to a factor on all side forces, and products
/// summed over the samples of the session within four standard deviations, the result is
///
/// ```text
/// residual - j (j . residual) / (j . j)
/// ```
pub fn subtract_grip(model: &ResidualModel, frames: &[Frame], residual: &mut [ChannelRows]) {
    let [more, less] = [1.0 + CHANGE, 1.0 - CHANGE].map(|factor| {
        let mut moved = model.clone();
        let grip = moved.base[1..BASE].iter_mut();
        grip.for_each(|multiplier| *multiplier *= factor);
        residuals_without(&moved, frames)
    });
    let column = |run: usize, c: usize, i: usize| more[run][c][i] - less[run][c][i];
    let scatters = BALANCES.map(|c| {
        let all: Vec<f64> = residual.iter().flat_map(|rows| rows[c].clone()).collect();
        scatter(&all)
    });
    for runs in group(frames).values() {
        let (mut jj, mut jy) = (0.0, 0.0);
        for &run in runs {
            for (c, sd) in BALANCES.into_iter().zip(scatters) {
                for i in frames[run].samples() {
                    let y = residual[run][c][i];
                    if y.abs() <= MAX_DEVIATION * sd {
                        let j = column(run, c, i);
                        (jj, jy) = (jj + (j / sd).powi(2), jy + j * y / (sd * sd));
                    }
                }
            }
        }
        if !(jj > 0.0 && jy.is_finite()) {
            continue;
        }
        let size = jy / jj;
        for &run in runs {
            for c in BALANCES {
                let each = residual[run][c].iter_mut().enumerate();
                each.for_each(|(i, y)| *y -= size * column(run, c, i));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use kufe_sled::effects::Effects;
    use kufe_sled::sample_data::{drive_sample, sample_plan};
    use kufe_sled::{Model, Vehicle};

    use super::*;
    use crate::evidence::runs::recordings::prepare::prepare;
    use crate::procedure::rules::Rules;

    #[test]
    fn a_change_of_grip_is_subtracted_and_a_push_is_not() {
        let base = Model::published();
        let mut plan = sample_plan(4);
        plan.truncate(3);
        for planned in &mut plan {
            planned.options.rate_hz = 100.0;
            planned.options.step_s = 2.5e-3;
            planned.options.contacts.clear();
        }
        let recorded = drive_sample(&plan, &base).expect("runs");
        let rules = Rules::default();
        let data = prepare(&recorded, &base, &BTreeMap::new(), &rules).expect("frames");
        let frames = &data.frames;
        let of_base = |base_multipliers| {
            let vehicle = Vehicle::new(&base).expect("the published model");
            ResidualModel::new(vehicle, base_multipliers, Effects::default())
        };
        let as_driven = residuals_without(&of_base([1.0; BASE]), frames);
        let apart = |residual: &[ChannelRows], c: usize| -> f64 {
            let both = residual.iter().zip(&as_driven);
            let all = both.flat_map(|(a, b)| a[c].iter().zip(&b[c]).map(|(a, b)| (a - b).powi(2)));
            all.sum::<f64>().sqrt()
        };
        let slippery = of_base([1.0, 1.15, 1.15, 1.15, 1.15]);
        let mut residual = residuals_without(&slippery, frames);
        // A push of 200 N over 10 m.
        let from = frames[0].s[frames[0].len() / 2];
        let wave = |s: f64| {
            if (0.0..10.0).contains(&(s - from)) {
                200.0 * (std::f64::consts::PI * (s - from) / 10.0).sin()
            } else {
                0.0
            }
        };
        let before = [1, 2].map(|c| apart(&residual, c));
        let mut pushed = residual.clone();
        let push: Vec<f64> = frames[0].s.iter().map(|s| wave(*s)).collect();
        for (y, by) in pushed[0][1].iter_mut().zip(&push) {
            *y += by;
        }
        subtract_grip(&slippery, frames, &mut residual);
        subtract_grip(&slippery, frames, &mut pushed);
        for (c, before) in [1, 2].into_iter().zip(before) {
            let after = apart(&residual, c);
            assert!(after < 0.35 * before, "{c}: {after} of {before}");
        }
        let recovered = pushed[0][1].iter().zip(&residual[0][1]).zip(&push);
        let lost: f64 = recovered
            .map(|((with, without), by)| (with - without - by).powi(2))
            .sum();
        let all: f64 = push.iter().map(|by| by * by).sum();
        assert!(lost < 0.1 * all, "{lost} of {all}");
    }
}
