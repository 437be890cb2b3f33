//! The surveyed slope of each track.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use kufe_sled::{Run, Track};

use crate::error::Error;
use crate::evidence::runs::recordings::frame::Frame;
use crate::input::table::Table;

/// Slope over distance, by track.
pub type Surveys = BTreeMap<String, Vec<(f64, f64)>>;

/// Tables of the runs' tracks.
pub struct TrackTables {
    /// The surveyed slope of each track that has a table.
    pub slopes: Surveys,
    /// The tables with all columns of a simulation, not the slope alone.
    pub whole: Vec<Track>,
}

impl TrackTables {
    /// Reads `track_NAME.csv` from the folder of the index, if present.
    ///
    /// # Errors
    /// Errors of the table; [`Error::File`] if s_m does not increase.
    pub fn in_folder(folder: &Path, runs: &[Run]) -> Result<TrackTables, Error> {
        let mut tables = TrackTables {
            slopes: Surveys::new(),
            whole: Vec::new(),
        };
        let names: BTreeSet<&String> = runs.iter().map(|run| &run.entry.track).collect();
        for name in names {
            let path = folder.join(kufe_sled::track_file(name));
            if !path.is_file() {
                continue;
            }
            let table = Table::read(&path)?;
            let s = table.numbers("s_m", -1e6, 1e6)?;
            let slope = table.numbers("slope_rad", -1.5, 1.5)?;
            if s.windows(2).any(|pair| pair[1] <= pair[0]) {
                return Err(Error::File {
                    file: path.display().to_string(),
                    reason: "column s_m does not increase from row to row".to_owned(),
                });
            }
            let slope = s.into_iter().zip(slope).collect();
            tables.slopes.insert(name.clone(), slope);
            tables.whole.extend(Track::load(&path).ok());
        }
        Ok(tables)
    }
}

/// Makes the slope positive downhill. A track table may count it uphill: the sign is the one that
/// agrees with the speeds of these frames. Returns whether it was reversed.
pub fn count_slopes_downhill(
    frames: &mut [Frame],
    training: &[usize],
    remarks: &mut Vec<String>,
) -> bool {
    let mut agreement = 0.0;
    for frame in training.iter().map(|i| &frames[*i]) {
        if frame.slope.is_empty() {
            continue;
        }
        for i in frame.samples() {
            agreement += (frame.v_slope[i] - frame.acceleration[0][i]) * frame.slope[i];
        }
    }
    if agreement < 0.0 {
        remarks.push("the track's slope is counted positive uphill, as the speeds show".to_owned());
        for frame in frames {
            let survey = frame.survey.iter_mut().map(|(_, slope)| slope);
            survey.chain(&mut frame.slope).for_each(|x| *x = -*x);
        }
    }
    agreement < 0.0
}

/// Linear interpolation, constant outside the ends.
pub fn interpolate(profile: &[(f64, f64)], s: f64) -> f64 {
    let at = profile.partition_point(|(x, _)| *x < s);
    if at == 0 {
        return profile.first().map_or(f64::NAN, |p| p.1);
    }
    if at == profile.len() {
        return profile[at - 1].1;
    }
    let ((x0, y0), (x1, y1)) = (profile[at - 1], profile[at]);
    y0 + (y1 - y0) * (s - x0) / (x1 - x0)
}
