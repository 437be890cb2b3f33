//! What a run feels of the track, metre by metre of its own distance.

use crate::model::sled::Sled;
use crate::signals::derivative::{HALF_WIDTH, derivative};
use crate::signals::prepare::Prepared;

/// The slope is a mean over this way on either side [m]: it hangs on the derivative of the speed, whose noise falls with the
/// length, and turns over tens of metres.
const ABOUT_M: usize = 3;

/// Curvature [1/m], bank and slope [rad] at every metre of a run's own distance.
#[derive(Clone, Debug)]
pub(crate) struct Felt {
    /// The first metre [m].
    pub from_m: f64,
    /// Means over each metre; NaN where no sample lies.
    pub metres: Vec<[f64; 3]>,
}

impl Felt {
    /// The curvature is `-pitch_rate / v`; bank and slope are those of the upward direction u in the body's axes, which what the
    /// sensors say of the motion leaves of the specific force f at the centre of gravity, without a law of friction:
    ///
    /// ```text
    /// g u_x = f_x + r v_y - dv_x/dt      g u_y = f_y - r v_x - dv_y/dt      g u_z = f_z - p v_y + q v_x
    /// slope = atan2(-u_x, |u_y, u_z|)    bank = atan2(u_y, u_z)
    /// ```
    ///
    /// with roll, pitch and yaw rate (p, q, r) and `v_z = 0`: the body moves on the ice.
    pub(crate) fn of(run: &Prepared, sled: &Sled) -> Felt {
        let from_m = run.states[0].s_m.round();
        let last = run
            .states
            .iter()
            .map(|state| state.s_m)
            .fold(from_m, f64::max);
        let count = (last - from_m).round() as usize + 1;
        // Curvature, g u and the number of samples.
        let mut sums = vec![[0.0; 5]; count];
        for piece in run.pieces.iter().filter(|p| p.len() > 2 * HALF_WIDTH) {
            let states = &run.states[piece.clone()];
            let velocity: Vec<[f64; 2]> = states
                .iter()
                .map(|state| {
                    let turn = state.yaw_rate_radps / state.v_mps;
                    let alpha = state.alpha_cog_rad - turn * sled.slip_x_m;
                    let (sine, cosine) = alpha.sin_cos();
                    let across = -state.v_mps * sine - sled.slip_x_m * state.yaw_rate_radps;
                    [state.v_mps * cosine, across]
                })
                .collect();
            let growth = [0, 1].map(|k| {
                let of: Vec<f64> = velocity.iter().map(|v| v[k]).collect();
                derivative(&of, run.dt_s)
            });
            for (i, state) in states.iter().enumerate() {
                let place = (state.s_m - from_m).round();
                if place < 0.0 {
                    continue;
                }
                let f = &run.motions[piece.start + i].accel_mps2;
                let [vx, vy] = velocity[i];
                let sum = &mut sums[place as usize];
                sum[0] -= state.pitch_rate_radps / state.v_mps;
                sum[1] += f[0] + state.yaw_rate_radps * vy - growth[0][i];
                sum[2] += f[1] - state.yaw_rate_radps * vx - growth[1][i];
                sum[3] += f[2] - state.roll_rate_radps * vy + state.pitch_rate_radps * vx;
                sum[4] += 1.0;
            }
        }
        let metres = (0..count)
            .map(|i| {
                let [curvature, _, y, z, count] = sums[i];
                let about = &sums[i.saturating_sub(ABOUT_M)..sums.len().min(i + ABOUT_M + 1)];
                let (x, all) = about
                    .iter()
                    .fold((0.0, 0.0), |(x, n), at| (x + at[1], n + at[4]));
                match count {
                    0.0 => [f64::NAN; 3],
                    _ => [
                        curvature / count,
                        y.atan2(z),
                        (-x / all).atan2(y.hypot(z) / count),
                    ],
                }
            })
            .collect();
        Felt { from_m, metres }
    }

    /// The place of metre `i` in the run's own distance [m].
    pub(crate) fn place(&self, i: usize) -> f64 {
        self.from_m + i as f64
    }
}
