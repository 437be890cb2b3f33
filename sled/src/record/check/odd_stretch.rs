//! Where in a run a channel is odd: gaps, end stops, leaps, drop-outs, one value for long.

use std::ops::Range;

use serde::Serialize;

use crate::record::check::profile::{Limits, longest_still};
use crate::record::run::Run;

/// Most stretches of a channel that are listed; its profile counts them all.
const MOST: usize = 100;

/// How a channel is odd for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum OddKind {
    /// A channel has no value, or the sled stands still: no channel takes part.
    Gap,
    /// Equal values at an end of the channel's range.
    Saturated,
    /// A single value off the line of its neighbours.
    Leap,
    /// A few equal values off that line.
    DropOut,
    /// The longest stretch of one value, half a second or more.
    Still,
}

/// A stretch of a run in which a channel is odd.
#[derive(Clone, Debug, PartialEq, Serialize, schemars::JsonSchema)]
pub struct OddStretch {
    /// The channel; empty for all.
    pub column: String,
    /// How.
    pub kind: OddKind,
    /// Time of its first sample, as recorded [s].
    pub from_s: f64,
    /// Time of its last sample [s].
    pub to_s: f64,
}

/// The odd stretches of these columns of a run: the gaps, then column by column, at most 100 each.
pub(super) fn odd_stretches(run: &Run, columns: &[&str], still_s: f64) -> Vec<OddStretch> {
    let at = |column: &str, kind, samples: Range<usize>| OddStretch {
        column: column.to_owned(),
        kind,
        from_s: run.t0_s + samples.start as f64 * run.dt_s,
        to_s: run.t0_s + (samples.end - 1) as f64 * run.dt_s,
    };
    let between = run.gaps.pieces.windows(2);
    let gaps = between.map(|pair| at("", OddKind::Gap, pair[0].end..pair[1].start));
    let mut all: Vec<OddStretch> = gaps.take(MOST).collect();
    for name in columns {
        let Some(column) = run.columns.get(*name) else {
            continue;
        };
        let limits = Limits::of(run.gaps.within(column), run.rate_hz());
        let mut found = Vec::new();
        if let Some(stop) = run.saturated.get(*name) {
            found.push((OddKind::Saturated, stop.begins..stop.begins + stop.longest));
        }
        for piece in &run.gaps.pieces {
            let values = &column[piece.clone()];
            let leaps = limits.leaps(values).map(|i| (OddKind::Leap, i..i + 1));
            let dropouts = limits.dropouts(values).into_iter();
            let still = longest_still(values);
            let is_long = still.len() as f64 * run.dt_s > still_s;
            let still = is_long.then_some((OddKind::Still, still));
            let dropouts = dropouts.map(|range| (OddKind::DropOut, range));
            let of_run = |range: Range<usize>| range.start + piece.start..range.end + piece.start;
            let here = leaps.chain(dropouts).chain(still);
            found.extend(here.map(|(kind, range)| (kind, of_run(range))));
        }
        let found = found.into_iter().take(MOST);
        all.extend(found.map(|(kind, range)| at(name, kind, range)));
    }
    all
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::path::Path;

    use super::*;
    use crate::columns::read_columns;
    use crate::record::gaps::Gaps;
    use crate::record::index::read_index;

    /// A run of a sine at 100 Hz with a leap, a drop-out, a still stretch and a gap.
    fn run(folder: &Path) -> Run {
        let file = folder.join("a.csv");
        std::fs::write(folder.join("runs.csv"), "run,file\na,a.csv\n").expect("a folder");
        let mut text = String::from("t_s,v_mps,yaw_rate_radps\n");
        for i in 0..1000 {
            let t = 0.01 * f64::from(i);
            // Noise of which no two values are equal.
            let noise = 1e-2 * (f64::from(i * i % 97) / 97.0 - 0.5);
            let yaw = match i {
                200 => 9.0,
                400..=403 => -9.0,
                600..=699 => 0.25,
                800..=819 => f64::NAN,
                _ => (0.3 * t).sin() + noise,
            };
            text += &format!("{t},{},{yaw}\n", 20.0 + noise);
        }
        std::fs::write(&file, text).expect("a folder");
        let entry = read_index(&folder.join("runs.csv"))
            .expect("an index")
            .remove(0);
        let mut columns = read_columns(&file, &["v_mps", "yaw_rate_radps"]).expect("columns");
        columns.remove("t_s");
        let gaps = Gaps::find(&mut columns, &["v_mps", "yaw_rate_radps"], 0.01);
        Run {
            entry,
            t0_s: 5.0,
            dt_s: 0.01,
            columns,
            gaps,
            saturated: BTreeMap::new(),
            remarks: Vec::new(),
        }
    }

    #[test]
    fn odd_stretches_are_where_they_were_made() {
        let folder = tempfile::tempdir().expect("a folder");
        let run = run(folder.path());
        let found = odd_stretches(&run, &["v_mps", "yaw_rate_radps"], 0.5);
        let expected = [
            ("", OddKind::Gap, 13.0, 13.19),
            ("yaw_rate_radps", OddKind::Leap, 7.0, 7.0),
            ("yaw_rate_radps", OddKind::DropOut, 9.0, 9.03),
            ("yaw_rate_radps", OddKind::Still, 11.0, 11.99),
        ];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (stretch, (column, kind, from_s, to_s)) in found.iter().zip(expected) {
            assert_eq!((stretch.column.as_str(), stretch.kind), (column, kind));
            assert!((stretch.from_s - from_s).abs() < 1e-9, "{stretch:?}");
            assert!((stretch.to_s - to_s).abs() < 1e-9, "{stretch:?}");
        }
    }
}
