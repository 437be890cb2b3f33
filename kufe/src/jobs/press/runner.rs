//! What an elastic runner bears, as keys of result.json.

use kufe_contact::{MountForce, RunnerLoads};
use serde_json::{Map, Value, json};

/// The largest von Mises stress with its place, and what each part of the mount is pushed with.
pub fn runner_keys(loads: &RunnerLoads) -> Map<String, Value> {
    let mount = |mount: &MountForce| {
        json!({
            "at_m": mount.at,
            "force_n": mount.force,
            "moment_nm": mount.moment,
            "von_mises_max_pa": mount.von_mises,
        })
    };
    let mounts: Vec<Value> = loads.mounts.iter().map(mount).collect();
    let mut keys = Map::new();
    keys.insert("runner_von_mises_max_pa".into(), json!(loads.von_mises));
    keys.insert("runner_von_mises_at_m".into(), json!(loads.at));
    keys.insert("mounts".into(), Value::Array(mounts));
    keys
}
