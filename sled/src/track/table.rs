//! The track under a sled: slope, vertical curvature and bank as functions of the distance.

use std::path::Path;

use crate::columns::{FileColumns, read_csv, write_csv};
use crate::conditions::CONDITIONS;
use crate::error::Error;
use crate::track::spline::Spline;

/// A track table, `track_NAME.csv`.
///
/// Along the driven line, `curvature_1pm` is `1/r_y` about the sled's own pitch axis (in a banked
/// curve most of the turn is in it), `bank_rad` the roll of the ice under the sled, positive with
/// the left side up, and `slope_rad` the pitch of the ice, positive downhill.
#[derive(Clone, Debug, PartialEq)]
pub struct Track {
    /// Name, as runs refer to it.
    pub name: String,
    /// Distance [m], strictly increasing.
    pub s_m: Vec<f64>,
    /// Slope, positive downhill [rad].
    pub slope_rad: Vec<f64>,
    /// Curvature in the vertical plane, positive in a valley [1/m].
    pub curvature_1pm: Vec<f64>,
    /// Bank, positive with the left side up [rad].
    pub bank_rad: Vec<f64>,
    /// Temperature of the ice; empty if the table does not state it.
    pub ice: IceAlong,
}

const COLUMNS: [&str; 4] = ["s_m", "slope_rad", "curvature_1pm", "bank_rad"];

/// Smallest length of a track [m]: about six sleds, and larger than the number of kilometres of any
/// track.
const MIN_SPAN_M: f64 = 20.0;

/// Further columns of an estimated track with its standard errors, which no computation uses.
const ERRORS: [&str; 4] = ["slope_sd_rad", "curvature_sd_1pm", "bank_sd_rad", "runs"];

impl Track {
    /// Reads a track; its name is the file's without `track_` and extension.
    ///
    /// # Errors
    /// Those of [`Track::from_csv`] and [`Error::File`].
    pub fn load(path: &Path) -> Result<Track, Error> {
        let file = path.display().to_string();
        let stem = path
            .file_stem()
            .and_then(|stem| stem.to_str())
            .unwrap_or("track");
        let name = stem.strip_prefix("track_").unwrap_or(stem);
        let reader = kufe_files::open_regular(path).map_err(|error| Error::file(&file, error))?;
        Track::from_csv(reader, name, &file)
    }

    /// Reads the columns `s_m, slope_rad, curvature_1pm, bank_rad`; `radius_m` may replace
    /// `curvature_1pm`, and `ice_c` [degrees Celsius] may follow, with empty cells between measured
    /// places. The errors of an estimated track are ignored.
    ///
    /// # Errors
    /// [`Error::MissingColumn`], [`Error::Column`] for unknown ones, [`Error::Cell`] with the row,
    /// [`Error::TooFew`].
    pub fn from_csv(reader: impl std::io::Read, name: &str, file: &str) -> Result<Track, Error> {
        let required = [
            "s_m",
            "slope_rad",
            "curvature_1pm",
            "radius_m",
            "bank_rad",
            "ice_c",
        ];
        let FileColumns { mut columns, lines } = read_csv(reader, &required, file)?;
        columns.retain(|name, _| !ERRORS.contains(&name.as_str()));
        let column_error = |column: &str, what: &str| {
            let columns = COLUMNS.join(", ");
            let expected = format!("{columns} (or radius_m for curvature_1pm) and perhaps ice_c");
            Error::column(file, column, what, &expected)
        };
        let unknown = |name: &&String| !required.contains(&name.as_str());
        if let Some(unknown) = columns.keys().find(unknown) {
            return Err(column_error(unknown, "unknown"));
        }
        if let Some(radius) = columns.remove("radius_m") {
            let curvature = radius.iter().map(|r| 1.0 / r).collect();
            let before = columns.insert("curvature_1pm".to_string(), curvature);
            if before.is_some() {
                return Err(column_error(
                    "radius_m",
                    "given together with curvature_1pm",
                ));
            }
        }
        let ice = columns.remove("ice_c").unwrap_or_default();
        let mut remove = |column: &str| {
            let values = columns.remove(column);
            values.ok_or_else(|| Error::missing_column(file, column, columns.keys()))
        };
        let mut track = Track {
            name: name.to_string(),
            ice: IceAlong::default(),
            s_m: remove("s_m")?,
            slope_rad: remove("slope_rad")?,
            curvature_1pm: remove("curvature_1pm")?,
            bank_rad: remove("bank_rad")?,
        };
        track.check(&lines, file)?;
        let (_, low, high) = CONDITIONS[0];
        if let Some(row) = ice.iter().position(|c| *c < low || *c > high) {
            let expected = format!("a number from {low} to {high}, or nothing");
            return Err(Error::cell(file, lines[row], "ice_c", ice[row], &expected));
        }
        track.ice = IceAlong::new(track.s_m.iter().zip(ice).map(|(s, c)| [*s, c]));
        Ok(track)
    }

    /// Checks lengths and ranges; `lines` are those of the rows in `file`, for errors.
    ///
    /// # Errors
    /// [`Error::Cell`] with row and column, [`Error::TooFew`], [`Error::Column`] for a track of a
    /// few metres.
    fn check(&self, lines: &[u64], file: &str) -> Result<(), Error> {
        if self.s_m.len() < 4 {
            return Err(Error::too_few(format!("{file}: rows"), self.s_m.len(), 4));
        }
        const EXPECTED: [(f64, &str); 4] = [
            (1e6, "a distance [m]"),
            (1.2, "radians, magnitudes below 1.2"),
            (1.0, "1/m, magnitudes below 1"),
            (3.2, "radians, magnitudes below 3.2"),
        ];
        for ((column, values), (most, expected)) in self.columns().into_iter().zip(EXPECTED) {
            if let Some(row) = values.iter().position(|v| v.is_nan() || v.abs() >= most) {
                return Err(Error::cell(file, lines[row], column, values[row], expected));
            }
        }
        if let Some(row) = self.s_m.windows(2).position(|pair| pair[1] <= pair[0]) {
            let (line, expected) = (lines[row + 1], "more than in the row before");
            return Err(Error::cell(file, line, "s_m", self.s_m[row + 1], expected));
        }
        let span = self.s_m[self.s_m.len() - 1] - self.s_m[0];
        if span < MIN_SPAN_M {
            let (from, to) = (self.s_m[0], self.s_m[0] + span);
            let what = format!("from {from} to {to}, which resembles kilometres");
            let expected = "metres, at least 20";
            return Err(Error::column(file, "s_m", &what, expected));
        }
        Ok(())
    }

    pub(crate) fn columns(&self) -> [(&'static str, &[f64]); 4] {
        let values = [
            &self.s_m,
            &self.slope_rad,
            &self.curvature_1pm,
            &self.bank_rad,
        ];
        std::array::from_fn(|k| (COLUMNS[k], values[k].as_slice()))
    }

    /// Writes the table as CSV.
    ///
    /// # Errors
    /// Errors of the writer.
    pub fn write_csv(&self, writer: impl std::io::Write) -> std::io::Result<()> {
        let mut columns = self.columns().to_vec();
        let ice: Vec<f64> = self.s_m.iter().filter_map(|s| self.ice.at(*s)).collect();
        if !ice.is_empty() {
            columns.push(("ice_c", &ice));
        }
        write_csv(writer, &columns)
    }
}

/// Temperatures of the ice at places along a track, in the order of the places.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct IceAlong {
    points: Vec<[f64; 2]>,
}

impl IceAlong {
    /// Temperatures from pairs of place [m] and temperature [degrees Celsius] in any order; pairs
    /// that are not finite are ignored.
    pub fn new(points: impl IntoIterator<Item = [f64; 2]>) -> IceAlong {
        let known = |point: &[f64; 2]| point.iter().all(|x| x.is_finite());
        let mut points: Vec<[f64; 2]> = points.into_iter().filter(known).collect();
        points.sort_by(|a, b| a[0].total_cmp(&b[0]));
        IceAlong { points }
    }

    /// Places [m] with their temperatures [degrees Celsius].
    pub fn points(&self) -> &[[f64; 2]] {
        &self.points
    }

    /// The temperature at a place [m]: linear between the nearest places, constant outside the
    /// ends; `None` without any.
    pub fn at(&self, s_m: f64) -> Option<f64> {
        let after = self.points.partition_point(|point| point[0] <= s_m);
        let Some(&[b, warm]) = self.points.get(after) else {
            return self.points.last().map(|point| point[1]);
        };
        let Some(&[a, cold]) = self.points[..after].last() else {
            return Some(warm);
        };
        Some(cold + (warm - cold) * (s_m - a) / (b - a))
    }
}

/// A smooth track: natural cubic splines through the table.
#[derive(Clone, Debug)]
pub struct TrackShape {
    /// Name of the track.
    pub name: String,
    /// Slope [rad].
    pub slope: Spline,
    /// Vertical curvature [1/m].
    pub curvature: Spline,
    /// Bank [rad].
    pub bank: Spline,
    /// Temperature of the ice, where it is stated.
    pub ice: IceAlong,
    /// Distance at the start [m].
    pub start_m: f64,
    /// Distance at the finish [m].
    pub finish_m: f64,
}

impl TrackShape {
    /// Splines through a checked table.
    pub fn new(track: &Track) -> TrackShape {
        let through = |values: &[f64]| Spline::natural(&track.s_m, values);
        TrackShape {
            name: track.name.clone(),
            slope: through(&track.slope_rad),
            curvature: through(&track.curvature_1pm),
            bank: through(&track.bank_rad),
            ice: track.ice.clone(),
            start_m: track.s_m[0],
            finish_m: track.s_m[track.s_m.len() - 1],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn between_sensors_it_is_a_straight_line_and_beyond_them_level() {
        let ice = IceAlong::new([[300.0, -4.0], [100.0, -8.0], [200.0, f64::NAN]]);
        for (s, expected) in [
            (0.0, -8.0),
            (100.0, -8.0),
            (150.0, -7.0),
            (300.0, -4.0),
            (1e6, -4.0),
        ] {
            assert_eq!(ice.at(s), Some(expected), "{s}");
        }
        assert_eq!(IceAlong::default().at(10.0), None);
    }
}
