//! Frames from recorded runs: every signal low-passed and thinned alike, with its derivative.

use std::collections::BTreeMap;

use kufe_sled::effects::Sensor;
use kufe_sled::{Run, bridged};

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

/// Smallest number of rows of a run: one second.
pub const MIN_ROWS: usize = 10;
/// Largest difference between a recorded distance and the integral of the speed for them to be the
/// same [m]; below the length of a sled.
const SAME_PLACE_M: f64 = 1.0;
/// Samples next to an unused one that are unused as well: an installation's delay shifts a channel
/// by less than a retained sample, by a cubic through two samples on each side.
const DELAY_REACH: usize = 2;

/// Whether each retained sample is used: its window and those of its neighbours contain no gap.
fn used_samples(kernel: &Kernel, recorded: &[bool]) -> Vec<bool> {
    let clear = kernel.clear_centres(recorded);
    let all: Vec<usize> = kernel.centres(recorded.len()).collect();
    let is_clear: Vec<bool> = all.iter().map(|i| clear.binary_search(i).is_ok()).collect();
    (0..is_clear.len())
        .map(|k| {
            let near = k.saturating_sub(DELAY_REACH)..(k + DELAY_REACH + 1).min(is_clear.len());
            is_clear[near].iter().all(|clear| *clear)
        })
        .collect()
}

/// A recorded run as a frame.
///
/// # Errors
/// [`Error::TooFew`] if it is shorter than the smoothing needs.
pub fn frame(
    run: &Run,
    kernel: &Kernel,
    surveys: &Surveys,
    rules: &RecordingRules,
) -> Result<Frame, Error> {
    let n = run.len();
    let mut recorded = vec![false; n];
    for piece in &run.gaps.pieces {
        recorded[piece.clone()].fill(true);
    }
    let kept_dt = kernel.stride as f64 * run.dt_s;
    let row_kernel = Kernel::new(
        kept_dt,
        rules.row_cutoff_hz.min(0.2 / kept_dt),
        rules.row_rate_hz,
    );
    // At least a second of rows.
    let needed = 2 * kernel.margin()
        + (2 * row_kernel.margin() + MIN_ROWS * row_kernel.stride) * kernel.stride;
    if n < needed {
        return Err(Error::TooFew {
            what: format!("run {}: samples", run.entry.run),
            found: n,
            needed,
        });
    }
    // Gaps are interpolated linearly: a finite number for every formula, but no row.
    let raw = |name: &str, default: f64| -> Vec<f64> {
        let column = run.columns.get(name).map(|column| bridged(column));
        column.unwrap_or_else(|| vec![default; n])
    };
    let distances = raw("v_mps", 0.0).into_iter().scan(0.0, |s, v| {
        *s += v * run.dt_s;
        Some(*s)
    });
    let summed: Vec<f64> = distances.collect();
    let s_raw = run.columns.get("s_m").map(|s| bridged(s));
    let s_of_speed = s_raw.as_ref().is_none_or(|s| is_integrated(s, &summed));
    let s_raw = s_raw.unwrap_or(summed);
    let s = kernel.smooth(&s_raw);
    let known: Vec<&str> = kufe_sled::COLUMNS.iter().copied().chain(["s_m"]).collect();
    let mut extra: BTreeMap<String, Vec<f64>> = run
        .columns
        .iter()
        .filter(|(name, values)| {
            !known.contains(&name.as_str())
                && run.gaps.within(values).flatten().all(|x| x.is_finite())
        })
        .map(|(name, values)| (name.clone(), kernel.smooth(&bridged(values))))
        .collect();
    if !extra.contains_key("ice_c")
        && let Some(ice) = s.iter().map(|s| run.entry.ice_at(*s)).collect()
    {
        extra.insert("ice_c".to_owned(), ice);
    }
    let survey = surveys.get(&run.entry.track).cloned().unwrap_or_default();
    let slope = if survey.is_empty() {
        Vec::new()
    } else {
        s.iter().map(|s| interpolate(&survey, *s)).collect()
    };
    let is_used = used_samples(kernel, &recorded);
    let centres = row_kernel.clear_centres(&is_used);
    if centres.len() < MIN_ROWS {
        return Err(Error::TooFew {
            what: format!("run {}: rows without gaps in their windows", run.entry.run),
            found: centres.len(),
            needed: MIN_ROWS,
        });
    }
    let mut frame = Frame {
        is_used,
        centres,
        name: run.entry.run.clone(),
        track: run.entry.track.clone(),
        driver: run.entry.driver.clone(),
        session: run.entry.session.clone(),
        ice_c: run.entry.conditions.ice_c,
        mass_kg: Some(run.entry.conditions.mass_kg).filter(|mass| mass.is_finite()),
        air_c: run.entry.conditions.air_c,
        air_pa: run.entry.conditions.air_pa,
        humidity_pct: run.entry.conditions.humidity_pct,
        recorded_dt: run.dt_s,
        row_kernel,
        t: kernel.centres(n).map(|i| i as f64 * run.dt_s).collect(),
        s,
        slope,
        survey,
        s_of_speed,
        extra,
        ..Frame::default()
    };
    for sensor in Sensor::ALL {
        let unrecorded = if sensor == Sensor::Az { 9.81 } else { 0.0 };
        let recorded = raw(sensor.name(), unrecorded);
        let (signal, derivative) = frame.series_mut(sensor);
        *signal = kernel.smooth(&recorded);
        if let Some(derivative) = derivative {
            *derivative = kernel.slope(&recorded);
        }
    }
    Ok(frame)
}

/// Whether a recorded distance is the integral of the speed, to within the resolution of a place.
fn is_integrated(s: &[f64], summed: &[f64]) -> bool {
    let (Some(first), Some(start)) = (s.first(), summed.first()) else {
        return false;
    };
    let both = s.iter().zip(summed);
    let differences = both.map(|(s, own)| ((s - first) - (own - start)).abs());
    differences.fold(0.0, f64::max) < SAME_PLACE_M
}

/// A run at 30 m/s along a track, for tests.
#[cfg(test)]
pub fn steady_run(track: &str, samples: usize) -> Frame {
    let column = |name: &str| -> Vec<f64> {
        let value = |i: usize| match name {
            "s_m" => 0.3 * i as f64,
            "v_mps" => 30.0,
            _ => 0.1,
        };
        (0..samples).map(value).collect()
    };
    let names = kufe_sled::COLUMNS.iter().chain(&["s_m"]);
    let run = Run {
        entry: kufe_sled::Entry {
            track: track.to_owned(),
            ..Default::default()
        },
        t0_s: 0.0,
        dt_s: 0.01,
        columns: names
            .map(|name| ((*name).to_owned(), column(name)))
            .collect(),
        gaps: kufe_sled::Gaps::none(samples),
        saturated: BTreeMap::new(),
        remarks: Vec::new(),
    };
    let rules = crate::procedure::rules::Rules::default().runs.recordings;
    let kernel = signal_kernel(run.dt_s, &rules);
    frame(&run, &kernel, &Surveys::new(), &rules).expect("half a minute")
}

#[cfg(test)]
mod tests {
    use kufe_sled::{Conditions, Entry, Gaps};

    use super::*;
    use crate::procedure::rules::Rules;

    /// Waves in every channel; samples in `gone` have no value.
    fn run(gone: std::ops::Range<usize>) -> Run {
        let n = 4000;
        let wave = |c: usize, i: usize| ((0.5 + 0.1 * c as f64) * 0.01 * i as f64).sin();
        let mut columns: BTreeMap<String, Vec<f64>> = BTreeMap::new();
        for (c, name) in kufe_sled::COLUMNS.iter().chain(&["s_m", "own"]).enumerate() {
            let mut column: Vec<f64> = (0..n).map(|i| 20.0 + wave(c, i)).collect();
            column[gone.clone()].fill(f64::NAN);
            columns.insert((*name).to_owned(), column);
        }
        let mut gaps = Gaps::none(n);
        if !gone.is_empty() {
            gaps.pieces = vec![0..gone.start, gone.end..n];
        }
        Run {
            entry: Entry {
                run: "one".to_owned(),
                file: "one.csv".into(),
                track: "east".to_owned(),
                driver: String::new(),
                driver_class: String::new(),
                session: String::new(),
                conditions: Conditions {
                    ice_c: -8.0,
                    air_c: 0.0,
                    air_pa: 95e3,
                    ..Conditions::UNSTATED
                },
                ..Entry::default()
            },
            t0_s: 0.0,
            dt_s: 0.01,
            columns,
            gaps,
            saturated: BTreeMap::new(),
            remarks: Vec::new(),
        }
    }

    fn framed(run: &Run) -> Frame {
        let rules = Rules::default().runs.recordings;
        frame(
            run,
            &signal_kernel(run.dt_s, &rules),
            &Surveys::new(),
            &rules,
        )
        .unwrap()
    }

    #[test]
    fn rows_next_to_a_gap_are_omitted_and_all_others_unchanged() {
        let gone = 1500..1620;
        let (whole, holed) = (framed(&run(0..0)), framed(&run(gone.clone())));
        assert_eq!(whole.len(), holed.len());
        assert_eq!(
            whole.row_count(),
            whole.row_kernel.centres(whole.len()).count()
        );
        // Explicitly: a row depends on the row kernel's window of retained samples and the two
        // around it, each on the kernel's window.
        let rules = Rules::default().runs.recordings;
        let kernel = signal_kernel(0.01, &rules);
        let reach = kernel.margin() + (DELAY_REACH + whole.row_kernel.margin()) * kernel.stride;
        let far = |centre: &usize| {
            let sample = kernel.margin() + centre * kernel.stride;
            sample + reach < gone.start || sample >= gone.end + reach
        };
        let expected: Vec<usize> = whole.centres.iter().copied().filter(far).collect();
        assert_eq!(holed.centres, expected);
        assert!(expected.len() < whole.row_count());
        for of in [
            |f: &Frame| f.rows(&f.v),
            |f| f.rows(&f.rate_slope[2]),
            |f| f.rows(&f.extra["own"]),
            |f| f.rows(&f.s),
        ] as [fn(&Frame) -> Vec<f64>; 4]
        {
            let (all, retained) = (of(&whole), of(&holed));
            let same = whole.centres.iter().zip(all).filter(|(i, _)| far(i));
            assert!(same.map(|(_, x)| x).eq(retained.iter().copied()));
            // Samples in the gap are finite.
            assert!(holed.v.iter().all(|v| (18.0..22.0).contains(v)));
        }
        let left_out = holed.omitted_rows(&holed.s).len();
        assert_eq!(left_out + holed.row_count(), whole.row_count());
        let piece = holed.piece(holed.len() / 4, holed.len() / 2);
        assert!(piece.row_count() > 0 && piece.samples().count() < piece.len());
    }
}
