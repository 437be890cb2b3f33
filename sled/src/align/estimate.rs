//! A track from the runs that felt it.

use crate::align::signature::{DistanceWarp, ReferenceProfile, TrackSignature};
use crate::model::sled::Tolerances;
use crate::track::table::Track;

/// A track made of runs, with the standard errors of each row.
#[derive(Clone, Debug)]
pub struct TrackEstimate {
    /// The track: a row a metre.
    pub track: Track,
    /// Standard errors of slope [rad], curvature [1/m] and bank [rad].
    pub sd: [Vec<f64>; 3],
    /// How many runs felt each row.
    pub runs: Vec<usize>,
}

/// Curvature, bank and slope of every run at every metre from `from_m` on; NaN where a run was not.
pub(crate) fn over_track(
    felt: &[&TrackSignature],
    warps: &[DistanceWarp],
) -> (f64, Vec<Vec<[f64; 3]>>) {
    let ends = felt.iter().zip(warps).map(|(felt, warp)| {
        let last = felt.place(felt.metres.len() - 1);
        (warp.at(felt.from_m), warp.at(last))
    });
    let (low, high) = ends.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
        (low.min(a), high.max(b))
    });
    let from_m = low.ceil();
    let count = (high - from_m).max(0.0) as usize + 1;
    let mut table = vec![vec![[f64::NAN; 3]; felt.len()]; count];
    for (run, (felt, warp)) in felt.iter().zip(warps).enumerate() {
        for i in 1..felt.metres.len() {
            let (a, b) = (warp.at(felt.place(i - 1)), warp.at(felt.place(i)));
            let (before, after) = (&felt.metres[i - 1], &felt.metres[i]);
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

/// The mean of the runs at every metre as what runs are aligned to.
pub(crate) fn mean_course(from_m: f64, table: &[Vec<[f64; 3]>]) -> ReferenceProfile {
    let rows = table.iter().map(|row| {
        let [curvature, bank, _] = [0, 1, 2].map(|k| mean_sd(row, k).0);
        [curvature, bank]
    });
    ReferenceProfile::new(from_m, rows.collect())
}

/// The mean over runs with its standard error: what the runs differ by (they feel the lines that
/// were driven, and how far their mean lies off the track's own line is not felt), and what the
/// installation, alike in all of them, may be off by (`[tolerances]`):
///
/// ```text
/// slope, bank: bias_f / g and, of the bank, scale_f sin(bank) cos(bank)      curvature: bias_q / v and scale_q curvature
/// ```
///
/// At least two runs a row; `speed_mps` is their mean speed. The distance is that of the runs in
/// the mean: a speed that is off by the same share in all of them is not seen.
pub(crate) fn estimate(
    name: &str,
    from_m: f64,
    table: &[Vec<[f64; 3]>],
    speed_mps: f64,
    tolerances: &Tolerances,
) -> Option<TrackEstimate> {
    let known = |row: &Vec<[f64; 3]>| row.iter().filter(|at| at[0].is_finite()).count();
    let first = table.iter().position(|row| known(row) >= 2)?;
    let rows: Vec<&Vec<[f64; 3]>> = table[first..]
        .iter()
        .take_while(|row| known(row) >= 2)
        .collect();
    let column =
        |k: usize| -> (Vec<f64>, Vec<f64>) { rows.iter().map(|row| mean_sd(row, k)).unzip() };
    let ((curvature_1pm, mut of_curvature), (bank_rad, mut of_bank), (slope_rad, mut of_slope)) =
        (column(0), column(1), column(2));
    let tilt = tolerances.accel_bias_mps2 / crate::friction::GRAVITY;
    let add = |sd: &mut f64, more: f64| *sd = sd.hypot(more);
    for i in 0..rows.len() {
        let turn = tolerances.gyro_bias_radps / speed_mps;
        add(
            &mut of_curvature[i],
            turn.hypot(tolerances.gyro_scale * curvature_1pm[i]),
        );
        let (sine, cosine) = bank_rad[i].sin_cos();
        add(
            &mut of_bank[i],
            tilt.hypot(tolerances.accel_scale * sine * cosine),
        );
        add(&mut of_slope[i], tilt);
    }
    Some(TrackEstimate {
        track: Track {
            ice: crate::track::table::IceAlong::default(),
            name: name.to_string(),
            s_m: (0..rows.len())
                .map(|i| from_m + (first + i) as f64)
                .collect(),
            slope_rad,
            curvature_1pm,
            bank_rad,
        },
        sd: [of_slope, of_curvature, of_bank],
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
    /// Writes the track with its errors as further columns, which a reader of tracks passes over.
    ///
    /// # Errors
    /// The writer's.
    pub fn write_csv(&self, writer: impl std::io::Write) -> std::io::Result<()> {
        let [slope, curvature, bank] = &self.sd;
        let runs: Vec<f64> = self.runs.iter().map(|count| *count as f64).collect();
        crate::columns::write_csv(
            writer,
            &[
                ("s_m", &self.track.s_m),
                ("slope_rad", &self.track.slope_rad),
                ("curvature_1pm", &self.track.curvature_1pm),
                ("bank_rad", &self.track.bank_rad),
                ("slope_sd_rad", slope),
                ("curvature_sd_1pm", curvature),
                ("bank_sd_rad", bank),
                ("runs", &runs),
            ],
        )
    }
}
