//! Instants outside the range of a runner's table.

use kufe_lut::Point;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::model::vehicle::Vehicle;
use crate::motion::state::State;

/// Number of instants outside a runner's table, where its edge values are used.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct OutsideTable {
    /// `front` or `rear`.
    pub runner: String,
    /// The table's file.
    pub table: String,
    /// Number of instants outside.
    pub samples: usize,
    /// Number of instants examined.
    pub of: usize,
}

impl std::fmt::Display for OutsideTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}: {} of {} samples of the {} runner lie outside the table, where its edge values are used",
            self.table, self.samples, self.of, self.runner
        )
    }
}

/// Points at which the tables of the front and the rear runner are read.
///
/// The front runner's load is approximated by `F_z,f0 / cos(gamma)`, the first iterate of its law.
pub fn table_samples<'a>(states: impl Iterator<Item = &'a State>) -> [Vec<Point>; 2] {
    let pairs = states.map(|s| {
        let at = |fz| Point::sliding(fz, s.curvature_1pm, s.v_mps, s.conditions.ice_c);
        (at(s.fz_f0_n / s.gamma_rad.cos()), at(s.fz_r_n))
    });
    let (front, rear) = pairs.unzip();
    [front, rear]
}

/// The tables of a vehicle with instants outside their range.
pub fn outside_tables<'a>(
    vehicle: &Vehicle,
    states: impl Iterator<Item = &'a State>,
) -> Vec<OutsideTable> {
    let tables = vehicle.tables();
    if tables.iter().all(Option::is_none) {
        return Vec::new();
    }
    let runners = ["front", "rear"].into_iter().zip(tables);
    let counted = runners
        .zip(table_samples(states))
        .map(|((runner, table), requested)| {
            let table = table?;
            let outside = |point: &&Point| table.at(**point).out_of_range;
            let samples = requested.iter().filter(outside).count();
            (samples > 0).then(|| OutsideTable {
                runner: runner.to_owned(),
                table: table.file.clone(),
                samples,
                of: requested.len(),
            })
        });
    counted.flatten().collect()
}

/// Sums over runs by table, each with its number of runs.
pub fn together(runs: Vec<OutsideTable>) -> Vec<(OutsideTable, usize)> {
    let mut all: Vec<(OutsideTable, usize)> = Vec::new();
    for one in runs {
        let same = |(other, _): &&mut (OutsideTable, usize)| {
            other.runner == one.runner && other.table == one.table
        };
        match all.iter_mut().find(same) {
            Some((sum, count)) => {
                sum.samples += one.samples;
                sum.of += one.of;
                *count += 1;
            }
            None => all.push((one, 1)),
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_runs_ask_outside_is_summed_by_table() {
        let of = |runner: &str, samples| OutsideTable {
            runner: runner.to_owned(),
            table: "t.lut".to_owned(),
            samples,
            of: 100,
        };
        let all = together(vec![of("front", 3), of("rear", 5), of("front", 4)]);
        assert_eq!(all.len(), 2);
        assert_eq!((all[0].0.samples, all[0].0.of, all[0].1), (7, 200, 2));
        assert_eq!((all[1].0.samples, all[1].1), (5, 1));
    }
}
