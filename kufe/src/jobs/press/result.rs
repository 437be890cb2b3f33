//! From a solved contact to its document.

use kufe_contact::RunnerLoads;

use crate::jobs::press::contact::SolvedContact;
use crate::results::{
    AsperitiesResult, CaseRecord, CheckResult, ContactResult, HullFit, Measured, MeshResult,
    RunnerResult, ShearResult, SubsurfaceResult,
};

impl SolvedContact {
    /// The document of the contact, without what is measured on exported files.
    pub fn result(&self) -> ContactResult {
        let solution = &self.solution;
        let check = self.check.as_ref();
        let found = check.and_then(|check| Some((check.found.as_ref().ok()?, check.seconds)));
        let reason = check.and_then(|check| check.found.as_ref().err());
        let (noise, spacing) = (self.moved, self.between);
        ContactResult {
            p_max: Measured::new(solution.p_max, solution.p_max_error),
            p_max_noise_pa: noise.map(|error| error.p_max * solution.p_max),
            p_max_hull_pa: spacing.map(|error| error.p_max * solution.p_max),
            p_max_mesh_pa: solution.p_max_mesh,
            p_max_map_pa: None,
            stress_max_pa: None,
            accuracy_asked: self.loaded.case.accuracy.p_max,
            accuracy_reached: self.short.is_none(),
            check: found.map(|(bem, check_seconds)| CheckResult {
                p_max: Measured::new(bem.p_max, bem.p_max_error),
                approach: Measured::new(bem.approach, bem.approach_error),
                check_seconds,
            }),
            check_absent: reason.map(ToString::to_string),
            p_mean: Measured::new(solution.p_mean, solution.p_mean_error),
            area: Measured::new(solution.area, solution.area_error),
            length: Measured::new(solution.length, solution.length_error),
            width: Measured::new(solution.width, solution.width_error),
            approach: Measured::new(solution.approach, solution.approach_error),
            approach_noise_m: noise.map(|error| error.approach),
            approach_hull_m: spacing.map(|error| error.approach),
            pitch: Measured::new(solution.pitch, solution.pitch_error),
            roll: Measured::new(solution.roll, solution.roll_error),
            fz_n: solution.fz,
            runner: self.runner.as_ref().map(RunnerResult::from),
            asperities: solution
                .volume
                .is_none()
                .then(|| AsperitiesResult::of(&solution.surface.asperities())),
            kkt_residual: solution.kkt_residual,
            stiffness: match &solution.volume {
                None => "boundary elements".into(),
                Some(_) if solution.assembled.is_empty() => "matrix-free".into(),
                Some(_) => "assembled".into(),
            },
            symmetry: solution.symmetry,
            dofs: solution.dofs,
            iterations: solution.iterations,
            seconds: self.seconds,
            peak_memory_bytes: peak_memory(),
            version: env!("CARGO_PKG_VERSION").into(),
            content_sha256: self.content.clone(),
            hull_fit: self.hull.as_ref().map(|hull| {
                let quality = hull.underside.quality();
                HullFit {
                    residual_rms_m: quality.residual_rms,
                    residual_max_m: quality.residual_max,
                    resolution_error_m: quality.resolution_error,
                    residual_over_approach: quality.residual_rms / solution.approach,
                    vertices: quality.vertices,
                    noise_m: hull.noise.found,
                    unseen_noise_m: hull.noise.unseen,
                }
            }),
            warnings: self.warnings.clone(),
            history: solution
                .history
                .chunk_by(|a, b| a.level == b.level)
                .filter_map(MeshResult::of)
                .collect(),
            case: CaseRecord::of(&self.loaded.case),
            sliding: self.sliding.as_ref().map(|sliding| sliding.result()),
            subsurface: self.line.as_ref().map(|line| SubsurfaceResult {
                x_m: line.at[0],
                y_m: line.at[1],
                shear: ShearResult::of(solution),
                max_shear_mesh_pa: line.largest_shear().map(|largest| largest.value),
            }),
        }
    }
}

impl From<&RunnerLoads> for RunnerResult {
    fn from(loads: &RunnerLoads) -> Self {
        RunnerResult {
            runner_von_mises_max_pa: loads.von_mises,
            runner_von_mises_at_m: loads.at,
            mounts: loads.mounts.iter().map(Into::into).collect(),
        }
    }
}

/// Largest resident memory of this process so far, where the system reports it [bytes].
fn peak_memory() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kilobytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(1024 * kilobytes)
}
