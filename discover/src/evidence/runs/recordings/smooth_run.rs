//! A recorded run, made a frame: every signal low-passed and thinned alike, with its derivative.

use kufe_sled::Run;

use crate::error::Error;
use crate::evidence::runs::recordings::frame::Frame;
use crate::evidence::runs::recordings::smooth::Kernel;
use crate::evidence::runs::recordings::survey::{Surveys, interpolate};
use crate::procedure::rules::RecordingRules;

/// The kernel of every signal with `dt` [s] between samples.
pub fn signal_kernel(dt: f64, rules: &RecordingRules) -> Kernel {
    Kernel::new(
        dt,
        rules.signal_cutoff_hz.min(0.2 / dt),
        rules.signal_rate_hz,
    )
}

/// A recorded run as a frame.
///
/// # Errors
/// [`Error::TooFew`] where it is shorter than the smoothing needs.
pub fn frame(
    run: &Run,
    kernel: &Kernel,
    surveys: &Surveys,
    rules: &RecordingRules,
) -> Result<Frame, Error> {
    let n = run.len();
    let kept_dt = kernel.stride as f64 * run.dt_s;
    let sieve = Kernel::new(
        kept_dt,
        rules.row_cutoff_hz.min(0.2 / kept_dt),
        rules.row_rate_hz,
    );
    // A second of rows at least.
    let needed = 2 * kernel.margin() + (2 * sieve.margin() + 10 * sieve.stride) * kernel.stride;
    if n < needed {
        return Err(Error::TooFew {
            what: format!("run {}: samples", run.entry.run),
            found: n,
            needed,
        });
    }
    let raw = |name: &str, default: f64| -> Vec<f64> {
        run.columns
            .get(name)
            .cloned()
            .unwrap_or_else(|| vec![default; n])
    };
    let smooth = |name: &str, default: f64| kernel.smooth(&raw(name, default));
    let slope_of = |name: &str| kernel.slope(&raw(name, 0.0));
    let v = raw("v_mps", 0.0);
    let s_raw = run.columns.get("s_m").cloned().unwrap_or_else(|| {
        let mut s = 0.0;
        v.iter()
            .map(|v| {
                s += v * run.dt_s;
                s
            })
            .collect()
    });
    let s = kernel.smooth(&s_raw);
    let known: Vec<&str> = kufe_sled::COLUMNS.iter().copied().chain(["s_m"]).collect();
    let extra = run
        .columns
        .iter()
        .filter(|(name, values)| {
            !known.contains(&name.as_str()) && values.iter().all(|x| x.is_finite())
        })
        .map(|(name, values)| (name.clone(), kernel.smooth(values)))
        .collect();
    let slope = surveys
        .get(&run.entry.track)
        .map_or_else(Vec::new, |profile| {
            s.iter().map(|s| interpolate(profile, *s)).collect()
        });
    Ok(Frame {
        name: run.entry.run.clone(),
        track: run.entry.track.clone(),
        driver: run.entry.driver.clone(),
        session: run.entry.session.clone(),
        ice_c: run.entry.conditions.ice_c,
        air_c: run.entry.conditions.air_c,
        air_pa: run.entry.conditions.air_pa,
        humidity_pct: run.entry.conditions.humidity_pct.unwrap_or(f64::NAN),
        distance_before: 0.0,
        recorded_dt: run.dt_s,
        sieve,
        t: kernel.centres(n).map(|i| i as f64 * run.dt_s).collect(),
        acceleration: [
            smooth("ax_mps2", 0.0),
            smooth("ay_mps2", 0.0),
            smooth("az_mps2", 9.81),
        ],
        rate: [
            smooth("roll_rate_radps", 0.0),
            smooth("pitch_rate_radps", 0.0),
            smooth("yaw_rate_radps", 0.0),
        ],
        rate_slope: [
            slope_of("roll_rate_radps"),
            slope_of("pitch_rate_radps"),
            slope_of("yaw_rate_radps"),
        ],
        v: kernel.smooth(&v),
        v_slope: slope_of("v_mps"),
        slip: smooth("alpha_rad", 0.0),
        slip_rate: slope_of("alpha_rad"),
        steer: smooth("delta_rad", 0.0),
        steer_rate: slope_of("delta_rad"),
        roll_split: smooth("gamma_rad", 0.0),
        s,
        slope,
        extra,
    })
}
