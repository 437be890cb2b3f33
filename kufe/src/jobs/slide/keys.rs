//! What `result.json` says of sliding.

use kufe_contact::{Measure, SlidingMesh};
use serde_json::{Map, Value, json};

use crate::jobs::slide::sensitivity::Sensitivity;
use crate::jobs::slide::slid::Slid;

impl Slid {
    /// Keys and values of `result.json`: each figure with its error.
    pub fn keys(&self) -> Map<String, Value> {
        let film = &self.film.film;
        let mut keys = Map::new();
        let mut put = |name: &str, unit: &str, measure: Measure| {
            keys.insert(format!("{name}{unit}"), json!(measure.value));
            keys.insert(format!("{name}_error{unit}"), json!(measure.error));
        };
        put("mu", "", self.friction.mu);
        put("mu_ploughing", "", self.friction.ploughing);
        put("mu_viscous", "", self.friction.viscous);
        put("groove_depth", "_m", self.groove.deepest);
        put("load_ahead", "_m", self.groove.load_ahead);
        put("front", "_m", self.groove.front);
        put("back", "_m", self.groove.back);
        let of = |value, error| Measure { value, error };
        let mean = self.film.error(|totals| totals.mean_thickness);
        put("film_mean", "_m", of(film.totals.mean_thickness, mean));
        let (thickest, error) = film
            .thickest()
            .map_or((0.0, 0.0), |s| (s.thickness, s.thickness_error));
        put("film_max", "_m", of(thickest, error));
        let melted = self.film.error(|totals| totals.melted);
        put("melt_rate", "_kgps", of(film.totals.melted, melted));
        put("contact_time", "_s", self.hardness.contact_time);
        keys.insert("hardness_pa".into(), json!(self.hardness.value));
        keys.insert("hardness_from".into(), json!(self.hardness.from.name()));
        keys.insert("mu_sensitivity".into(), sensitivity(&self.sensitivity));
        keys.insert("groove_area_m2".into(), json!(self.groove.profile.area()));
        keys.insert(
            "sliding_history".into(),
            self.groove.meshes.iter().map(mesh).collect(),
        );
        keys
    }
}

fn sensitivity(of: &Sensitivity) -> Value {
    json!({
        "dlnmu_dlnhardness": of.hardness.value,
        "dlnmu_dlnhardness_error": of.hardness.error,
        "dlnmu_dlnv": of.speed.value,
        "dlnmu_dlnv_error": of.speed.error,
        "dlnmu_dlnviscosity": of.viscosity.value,
        "dlnmu_dlnviscosity_error": of.viscosity.error,
        "dlnmu_dice_c": of.temperature.value,
        "dlnmu_dice_c_error": of.temperature.error,
    })
}

fn mesh(mesh: &SlidingMesh) -> Value {
    json!({
        "dofs": mesh.dofs,
        "contact_nodes": mesh.contact_nodes,
        "corrections": mesh.corrections,
        "iterations": mesh.iterations,
        "residual": mesh.residual,
        "groove_depth_m": mesh.groove_depth,
        "ploughing_by_work_n": mesh.plastic_work,
        "ploughing_by_slope_n": mesh.ploughing_by_slope,
    })
}
