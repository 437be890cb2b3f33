//! Estimate of a track from aligned runs.

use crate::align::AlignedRun;
use crate::align::signature::{ReferenceProfile, TrackSignature};
use crate::columns::write_csv;
use crate::friction::GRAVITY;
use crate::sled::Tolerances;
use crate::track::table::{IceAlong, Track};

/// A track estimated from runs, with the standard errors of each row.
#[derive(Clone, Debug)]
pub struct TrackEstimate {
    /// The track, one row per metre.
    pub track: Track,
    /// Standard errors of slope [rad], curvature [1/m] and bank [rad].
    pub sd: [Vec<f64>; 3],
    /// Number of runs that measured each row.
    pub runs: Vec<usize>,
}

/// Curvature, bank and slope of every run at every metre from `from_m` on; NaN outside a run.
pub(crate) fn over_track(
    measured: &[TrackSignature],
    aligned: &[AlignedRun],
) -> (f64, Vec<Vec<[f64; 3]>>) {
    let pairs = || measured.iter().zip(aligned.iter().map(|run| &run.warp));
    let starts = pairs().map(|(measured, warp)| warp.at(measured.from_m));
    let ends = pairs().map(|(measured, warp)| warp.at(measured.place(measured.metres.len() - 1)));
    let low = starts.fold(f64::INFINITY, f64::min);
    let high = ends.fold(f64::NEG_INFINITY, f64::max);
    let from_m = low.ceil();
    let count = (high - from_m).max(0.0) as usize + 1;
    let mut table = vec![vec![[f64::NAN; 3]; measured.len()]; count];
    for (run, (measured, warp)) in pairs().enumerate() {
        for i in 1..measured.metres.len() {
            let (a, b) = (warp.at(measured.place(i - 1)), warp.at(measured.place(i)));
            let (before, after) = (&measured.metres[i - 1], &measured.metres[i]);
            let rows = (a - from_m).ceil().max(0.0) as usize..=(b - from_m).max(0.0) as usize;
            for row in rows {
                let share = (from_m + row as f64 - a) / (b - a);
                if row < count && (0.0..=1.0).contains(&share) {
                    table[row][run] =
                        std::array::from_fn(|k| before[k] + share * (after[k] - before[k]));
                }
            }
        }
    }
    (from_m, table)
}

/// The mean of the runs at every metre, as a reference for alignment.
pub(crate) fn mean_profile(from_m: f64, table: &[Vec<[f64; 3]>]) -> ReferenceProfile {
    let rows = table.iter().map(|row| {
        let [curvature, bank, _] = [0, 1, 2].map(|k| mean_sd(row, k).0);
        [curvature, bank]
    });
    ReferenceProfile::new(from_m, rows.collect())
}

/// The mean over runs with its standard error. The error is the standard deviation between runs,
/// not divided by their number, since the mean of the driven lines may be off the track's own line.
/// To it is added the error of the installation, common to all runs (`[tolerances]`):
///
/// ```text
/// slope, bank: bias_f / g and, of the bank, scale_f sin(bank) cos(bank)      curvature: bias_q / v and scale_q curvature
/// ```
///
/// A row has at least two runs; `None` if there is no such row. `speed_mps` is the mean speed. An
/// error of scale of the speed common to all runs is not included.
pub(crate) fn estimate(
    name: &str,
    from_m: f64,
    table: &[Vec<[f64; 3]>],
    speed_mps: f64,
    tolerances: &Tolerances,
) -> Option<TrackEstimate> {
    let known = |row: &Vec<[f64; 3]>| row.iter().filter(|at| at[0].is_finite()).count();
    let first = table.iter().position(|row| known(row) >= 2)?;
    let rows = table[first..].iter().take_while(|row| known(row) >= 2);
    let rows: Vec<&Vec<[f64; 3]>> = rows.collect();
    let tilt = tolerances.accel_bias_mps2 / GRAVITY;
    let turn = tolerances.gyro_bias_radps / speed_mps;
    // Means of quantity `k`, and their errors with those of the installation.
    let column = |k: usize, installation: &dyn Fn(f64) -> f64| -> (Vec<f64>, Vec<f64>) {
        let means = rows.iter().map(|row| mean_sd(row, k));
        means
            .map(|(mean, sd)| (mean, sd.hypot(installation(mean))))
            .unzip()
    };
    let of_curvature = |curvature: f64| turn.hypot(tolerances.gyro_scale * curvature);
    let of_bank = |bank: f64| {
        let (sine, cosine) = bank.sin_cos();
        tilt.hypot(tolerances.accel_scale * sine * cosine)
    };
    let (curvature_1pm, curvature_sd) = column(0, &of_curvature);
    let (bank_rad, bank_sd) = column(1, &of_bank);
    let (slope_rad, slope_sd) = column(2, &|_| tilt);
    let places = (0..rows.len()).map(|i| from_m + (first + i) as f64);
    Some(TrackEstimate {
        track: Track {
            ice: IceAlong::default(),
            name: name.to_string(),
            s_m: places.collect(),
            slope_rad,
            curvature_1pm,
            bank_rad,
        },
        sd: [slope_sd, curvature_sd, bank_sd],
        runs: rows.iter().map(|row| known(row)).collect(),
    })
}

/// Mean of quantity `k` over the runs that have it, and their standard deviation.
fn mean_sd(row: &[[f64; 3]], k: usize) -> (f64, f64) {
    let values = row.iter().map(|at| at[k]).filter(|x| x.is_finite());
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let variance = values.map(|x| (x - mean).powi(2)).sum::<f64>() / (count - 1.0).max(1.0);
    (mean, variance.sqrt())
}

impl TrackEstimate {
    /// Writes the track with its errors as further columns, which a reader of tracks ignores.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, writer: impl std::io::Write) -> std::io::Result<()> {
        let [slope, curvature, bank] = &self.sd;
        let runs: Vec<f64> = self.runs.iter().map(|count| *count as f64).collect();
        let errors: [(&str, &[f64]); 4] = [
            ("slope_sd_rad", slope),
            ("curvature_sd_1pm", curvature),
            ("bank_sd_rad", bank),
            ("runs", &runs),
        ];
        write_csv(writer, &[self.track.columns(), errors].concat())
    }
}
