//! The folder of a plan: `plan.json` with the points of one round, the scripts that run the shards,
//! and the folder `points` with the results.

use std::path::Path;

use kufe_lut::{Origin, Point, parallel_script, slurm_script};
use serde::{Deserialize, Serialize};

use crate::jobs::failure::{Failure, Located};

/// The value of the key `format`.
const FORMAT: &str = "kufe-lut-plan";
/// Maximum size of `plan.json` [bytes].
const MAX_BYTES: u64 = 256 << 20;

/// The content of `plan.json`: the points of one round of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlanFile {
    format: String,
    /// The origin that every result must have.
    pub origin: Origin,
    /// The table file that was planned.
    pub table: String,
    /// Number of the round, from 1. Axes of given values need one round.
    pub round: usize,
    /// Number of shards into which the scripts cut the points.
    pub shards: usize,
    /// The points.
    pub points: Vec<Point>,
}

impl PlanFile {
    /// Names of the files of a plan: the points and the scripts for Slurm and GNU parallel.
    pub const NAMES: [&str; 3] = ["plan.json", "slurm.sh", "parallel.sh"];

    /// The plan of one round of a sweep.
    pub fn new(
        origin: Origin,
        table: String,
        round: usize,
        shards: usize,
        points: Vec<Point>,
    ) -> Self {
        PlanFile {
            format: FORMAT.into(),
            origin,
            table,
            round,
            shards,
            points,
        }
    }

    /// Names and texts of `plan.json` and of the scripts that run the shards in a folder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the folder does not exist or its name cannot be written in a
    /// script.
    pub fn files(&self, folder: &Path) -> Result<[(&'static str, String); 3], Failure> {
        let absolute = folder.canonicalize().in_file(folder)?;
        let kufe = std::env::current_exe().in_file(folder)?;
        let plan = serde_json::to_string(self)? + "\n";
        let slurm = slurm_script(&kufe, &absolute, self.shards)?;
        let parallel = parallel_script(&kufe, &absolute, self.shards)?;
        let [first, second, third] = PlanFile::NAMES;
        Ok([(first, plan), (second, slurm), (third, parallel)])
    }

    /// Reads `plan.json` in a folder.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the file and the place in it.
    pub fn read(folder: &Path) -> Result<Self, Failure> {
        let path = folder.join(PlanFile::NAMES[0]);
        let bytes = kufe_files::read_regular(&path, MAX_BYTES).in_file(&path)?;
        let damaged = |reason: String| Failure::in_file(&path, format_args!("damaged: {reason}"));
        let plan: serde_json::Result<PlanFile> = serde_json::from_slice(&bytes);
        let plan = plan.map_err(|error| damaged(error.to_string()))?;
        if plan.format != FORMAT || plan.round == 0 || plan.shards == 0 {
            let expected = format!("expected the format {FORMAT}, a round and shards");
            return Err(damaged(expected));
        }
        Ok(plan)
    }

    /// The points of shard `index` (from 1) of `count`; a shard is a run of consecutive points.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if `index` is not within 1 to `count`.
    pub fn shard(&self, index: usize, count: usize) -> Result<&[Point], Failure> {
        if index == 0 || index > count {
            return Err(Failure::BadInput(format!(
                "shard {index}/{count}: expected 1/{count} to {count}/{count}"
            )));
        }
        let start = |n: usize| (n as u128 * self.points.len() as u128 / count as u128) as usize;
        Ok(&self.points[start(index - 1)..start(index)])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan() -> PlanFile {
        let points = (0..23).map(|n| Point {
            fz: 100.0 + f64::from(n),
            ..Point::default()
        });
        PlanFile::new(Origin::default(), "t.toml".into(), 1, 7, points.collect())
    }

    #[test]
    fn shards_share_the_points_without_gap_or_overlap() {
        let plan = plan();
        for count in [1, 2, 5, 23, 40] {
            let shards = (1..=count).map(|i| plan.shard(i, count).expect("a shard").to_vec());
            assert_eq!(shards.collect::<Vec<_>>().concat(), plan.points);
        }
        for (index, count) in [(0, 3), (4, 3), (1, 0)] {
            assert!(plan.shard(index, count).is_err());
        }
    }

    #[test]
    fn a_plan_is_read_back_and_a_broken_one_is_named() {
        let folder = tempfile::tempdir().expect("a folder");
        for (name, text) in plan().files(folder.path()).expect("texts") {
            std::fs::write(folder.path().join(name), text).expect("written");
        }
        assert_eq!(PlanFile::read(folder.path()).expect("read"), plan());
        let path = folder.path().join("plan.json");
        let text = std::fs::read_to_string(&path).expect("the plan");
        for broken in ["", "[]", "{}", &text.replace(FORMAT, "kufe-lut")] {
            std::fs::write(&path, broken).expect("written");
            let refused = PlanFile::read(folder.path())
                .expect_err("broken")
                .to_string();
            assert!(refused.contains("plan.json: damaged"), "{refused}");
        }
    }

    #[test]
    fn a_folder_whose_name_would_end_a_line_of_a_script_is_refused() {
        let folder = tempfile::tempdir().expect("a folder");
        let odd = folder.path().join("p\ntouch X\n#");
        std::fs::create_dir(&odd).expect("a folder");
        let refused = plan().files(&odd).expect_err("a line's end").to_string();
        assert!(refused.contains("printable"), "{refused}");
    }
}
