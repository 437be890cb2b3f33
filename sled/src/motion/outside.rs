//! Instants that lie outside what a runner's table spans.

use serde::Serialize;

use crate::model::vehicle::Vehicle;
use crate::motion::state::State;

/// How many instants a runner's table does not span; there it is asked at its edge.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct OutsideTable {
    /// `front` or `rear`.
    pub runner: &'static str,
    /// The table's file.
    pub table: String,
    /// Instants outside.
    pub samples: usize,
    /// Instants looked at.
    pub of: usize,
}

impl std::fmt::Display for OutsideTable {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}: {} of {} samples of the {} runner lie outside the table, which is taken at its edge there",
            self.table, self.samples, self.of, self.runner
        )
    }
}

/// The tables of a vehicle that do not span all of these instants.
///
/// The front runner's load is taken as `F_z,f0 / cos(gamma)`, as its law is asked first.
pub fn outside_tables<'a>(
    vehicle: &Vehicle,
    states: impl Iterator<Item = &'a State> + Clone,
) -> Vec<OutsideTable> {
    let front_load = |s: &State| s.fz_f0_n / s.gamma_rad.cos();
    let rear_load = |s: &State| s.fz_r_n;
    let loads = [front_load as fn(&State) -> f64, rear_load];
    let runners = ["front", "rear"]
        .into_iter()
        .zip(loads)
        .zip(vehicle.tables());
    let counted = runners.map(|((runner, load), table)| {
        let table = table?;
        let outside = |s: &&State| {
            let looked = table.at(load(s), s.curvature_1pm, s.v_mps, s.ice_c);
            looked.out_of_range
        };
        let samples = states.clone().filter(outside).count();
        (samples > 0).then(|| OutsideTable {
            runner,
            table: table.file.clone(),
            samples,
            of: states.clone().count(),
        })
    });
    counted.flatten().collect()
}
