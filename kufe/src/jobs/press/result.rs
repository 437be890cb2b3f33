//! `result.json`.

use kufe_contact::Iterate;
use serde_json::{Value, json};

use crate::jobs::case_json::case_json;
use crate::jobs::field::subsurface;
use crate::jobs::press::pressed::Pressed;
use crate::jobs::press::runner::runner_keys;

impl Pressed {
    /// The figures of a solve, the case that they belong to, and how they came about.
    pub fn document(&self) -> Value {
        let solution = &self.solution;
        let history: Vec<Value> = meshes(&solution.history).iter().map(line).collect();
        let fit = self.hull.as_ref().map(|hull| {
            let quality = hull.underside.quality();
            json!({
                "residual_rms_m": quality.residual_rms,
                "residual_max_m": quality.residual_max,
                "resolution_error_m": quality.resolution_error,
                "residual_over_approach": quality.residual_rms / solution.approach,
                "vertices": quality.vertices,
                "noise_m": hull.noise.found,
                "unseen_noise_m": hull.noise.unseen,
            })
        });
        let mut document = json!({
            "p_max_pa": solution.p_max,
            "p_max_error_pa": solution.p_max_error,
            "p_max_mesh_pa": solution.p_max_mesh,
            "accuracy_asked": self.loaded.case.accuracy.p_max,
            "accuracy_reached": self.short.is_none(),
            "p_mean_pa": solution.p_mean,
            "p_mean_error_pa": solution.p_mean_error,
            "area_m2": solution.area,
            "area_error_m2": solution.area_error,
            "length_m": solution.length,
            "length_error_m": solution.length_error,
            "width_m": solution.width,
            "width_error_m": solution.width_error,
            "approach_m": solution.approach,
            "approach_error_m": solution.approach_error,
            "pitch_rad": solution.pitch,
            "pitch_error_rad": solution.pitch_error,
            "roll_rad": solution.roll,
            "roll_error_rad": solution.roll_error,
            "fz_n": solution.fz,
            "kkt_residual": solution.kkt_residual,
            "stiffness": if solution.assembled.is_empty() { "matrix-free" } else { "assembled" },
            "symmetry": solution.symmetry,
            "dofs": solution.dofs,
            "iterations": solution.iterations,
            "seconds": self.seconds,
            "peak_memory_bytes": peak_memory(),
            "version": env!("CARGO_PKG_VERSION"),
            "content_sha256": self.content,
            "hull_fit": fit,
            "warnings": self.warnings,
            "history": history,
            "case": case_json(&self.loaded.case),
        });
        if let (Some(check), Value::Object(document)) = (&self.check, &mut document) {
            let place = document
                .keys()
                .position(|key| key == "p_mean_pa")
                .unwrap_or(0);
            for (shift, (key, value)) in check.keys().into_iter().enumerate() {
                document.shift_insert(place + shift, key, value);
            }
        }
        if let (Some(loads), Value::Object(document)) = (&self.runner, &mut document) {
            let place = document
                .keys()
                .position(|key| key == "fz_n")
                .map_or(0, |place| place + 1);
            for (shift, (key, value)) in runner_keys(loads).into_iter().enumerate() {
                document.shift_insert(place + shift, key, value);
            }
        }
        for (part, error) in [("hull", self.between), ("noise", self.moved)] {
            let (Some(error), Value::Object(document)) = (error, &mut document) else {
                continue;
            };
            for (figure, unit, value) in [
                ("approach", "m", error.approach),
                ("p_max", "pa", error.p_max * solution.p_max),
            ] {
                let beside = format!("{figure}_error_{unit}");
                let place = document.keys().position(|key| *key == beside);
                let place = place.map_or(0, |place| place + 1);
                document.shift_insert(place, format!("{figure}_{part}_{unit}"), json!(value));
            }
        }
        if let (Some(slid), Value::Object(document)) = (&self.sliding, &mut document) {
            document.extend(slid.keys());
        }
        if let Some(line) = &self.line {
            document["subsurface"] = subsurface::document(line, solution);
        }
        document
    }
}

/// What happened on each mesh: its last state, with the iterations, sweeps and accelerations of all its contact sets.
fn meshes(history: &[Iterate]) -> Vec<Iterate> {
    history
        .chunk_by(|a, b| a.level == b.level)
        .map(|states| {
            let sum = |count: fn(&Iterate) -> usize| states.iter().map(count).sum();
            Iterate {
                iterations: sum(|s| s.iterations),
                sweeps: sum(|s| s.sweeps),
                accelerations: sum(|s| s.accelerations),
                ..states[states.len() - 1]
            }
        })
        .collect()
}

fn line(mesh: &Iterate) -> Value {
    json!({
        "level": mesh.level,
        "dofs": mesh.dofs,
        "contact_nodes": mesh.contact_nodes,
        "iterations": mesh.iterations,
        "residual": mesh.residual,
        "p_max_pa": mesh.p_max,
        "sweeps": mesh.sweeps,
        "accelerations": mesh.accelerations,
        "energy_j": mesh.energy,
    })
}

/// Largest resident memory of this process so far, where the system tells [bytes].
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
