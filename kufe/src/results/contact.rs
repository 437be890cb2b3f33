//! `result.json`: one solved contact, at rest or sliding.

use kufe_contact::{Asperity, Iterate, MountForce, SlidingMesh};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::results::quantity::*;
use crate::results::record::CaseRecord;

/// One solved contact: its numbers, the case, and how they came about.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "result.json")]
#[non_exhaustive]
pub struct ContactResult {
    /// Peak pressure; the error is the sum of its parts.
    #[serde(flatten)]
    pub p_max: Measured<PeakPressure>,
    /// Error of the peak pressure due to discretisation; absent if it is the only part [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_max_discretisation_pa: Option<f64>,
    /// Error of the peak pressure due to noise of the hull's vertices, 95 % bound [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_max_noise_pa: Option<f64>,
    /// Error of the peak pressure due to the spacing of the hull's vertices [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_max_hull_pa: Option<f64>,
    /// Peak pressure on the finest mesh [Pa].
    pub p_max_mesh_pa: f64,
    /// Largest pressure of the exported map [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub p_max_map_pa: Option<f64>,
    /// Largest compressive stress across the surface in `field.vtu` [Pa].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stress_max_pa: Option<f64>,
    /// Relative error of the peak pressure that the case requests.
    pub accuracy_asked: f64,
    /// Whether the requested accuracy was reached.
    pub accuracy_reached: bool,
    /// The contact by boundary elements, as a check.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub check: Option<CheckResult>,
    /// Why boundary elements do not apply.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub check_absent: Option<String>,
    /// Ratio of force to contact area.
    #[serde(flatten)]
    pub p_mean: Measured<MeanPressure>,
    /// Contact area.
    #[serde(flatten)]
    pub area: Measured<Area>,
    /// Extent along the runner.
    #[serde(flatten)]
    pub length: Measured<Length>,
    /// Extent across the runner.
    #[serde(flatten)]
    pub width: Measured<Width>,
    /// Rigid approach from first touch.
    #[serde(flatten)]
    pub approach: Measured<Approach>,
    /// Error of the approach due to noise of the hull's vertices, 95 % bound [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach_noise_m: Option<f64>,
    /// Error of the approach due to the spacing of the hull's vertices [m].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach_hull_m: Option<f64>,
    /// Pitch about y, positive lowers the nose.
    #[serde(flatten)]
    pub pitch: Measured<Pitch>,
    /// Roll about x.
    #[serde(flatten)]
    pub roll: Measured<Roll>,
    /// Integrated normal force [N].
    pub fz_n: f64,
    /// Stress of an elastic runner, and the load on its mount.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub runner: Option<RunnerResult>,
    /// Contacts of the asperities of a rough surface.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub asperities: Option<AsperitiesResult>,
    /// Residual of the complementarity (KKT) conditions.
    pub kkt_residual: f64,
    /// How the stiffness is applied: `matrix-free`, `assembled`, or `boundary elements` where only
    /// the contact plane was solved.
    pub stiffness: String,
    /// Whether x = 0 and y = 0 are mirror planes, so that only a part of the contact is meshed.
    pub symmetry: [bool; 2],
    /// Unknowns of the finest mesh.
    pub dofs: usize,
    /// Iterations on all meshes.
    pub iterations: usize,
    /// Wall time [s].
    pub seconds: f64,
    /// Largest resident memory of the process, where the system reports it [bytes].
    pub peak_memory_bytes: Option<u64>,
    /// Version of kufe.
    pub version: String,
    /// SHA-256 of the files that the case reads, and of the version of the numerics.
    pub content_sha256: String,
    /// The surface fitted through a hull's vertices.
    pub hull_fit: Option<HullFit>,
    /// Warnings and remarks.
    pub warnings: Vec<String>,
    /// Convergence history, mesh by mesh.
    pub history: Vec<MeshResult>,
    /// The case.
    pub case: CaseRecord,
    /// Friction, groove and melt film of a sliding runner.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub sliding: Option<SlidingResult>,
    /// Stress on the line under the peak.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub subsurface: Option<SubsurfaceResult>,
}

/// A part of an error with its source.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorPart {
    /// Source of the error.
    pub source: &'static str,
    /// Size of the part, in SI units.
    pub error: f64,
}

impl ContactResult {
    /// The parts of the error of the peak pressure [Pa].
    pub fn peak_error_parts(&self) -> Vec<ErrorPart> {
        let part = |source, error: Option<f64>| error.map(|error| ErrorPart { source, error });
        let parts = [
            part(
                "discretisation",
                self.p_max_discretisation_pa.or(Some(self.p_max.error)),
            ),
            part("scan noise", self.p_max_noise_pa),
            part("fit through the vertices", self.p_max_hull_pa),
        ];
        parts.into_iter().flatten().collect()
    }
}

/// A contact by boundary elements.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct CheckResult {
    /// Peak pressure.
    #[serde(flatten)]
    pub p_max: Measured<CheckPeak>,
    /// Approach.
    #[serde(flatten)]
    pub approach: Measured<CheckApproach>,
    /// Wall time [s].
    pub check_seconds: f64,
}

/// Stress of an elastic runner, and the load on its mount.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct RunnerResult {
    /// Largest von Mises stress [Pa].
    pub runner_von_mises_max_pa: f64,
    /// Position of the largest stress [m].
    pub runner_von_mises_at_m: [f64; 3],
    /// The parts of the mount along the runner.
    pub mounts: Vec<MountResult>,
}

/// The load on one part of the mount.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MountResult {
    /// Middle of the part [m].
    pub at_m: [f64; 3],
    /// Force on the part [N].
    pub force_n: [f64; 3],
    /// Moment on the part about its middle [N m].
    pub moment_nm: [f64; 3],
    /// Largest von Mises stress of the steel there [Pa].
    pub von_mises_max_pa: f64,
}

impl From<&MountForce> for MountResult {
    fn from(mount: &MountForce) -> Self {
        MountResult {
            at_m: mount.at,
            force_n: mount.force,
            moment_nm: mount.moment,
            von_mises_max_pa: mount.von_mises,
        }
    }
}

/// Contacts of the asperities of a rough surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct AsperitiesResult {
    /// Number of asperities in contact.
    pub asperity_count: usize,
    /// The asperities, the largest force first.
    pub asperities: Vec<AsperityResult>,
}

/// One asperity in contact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct AsperityResult {
    /// Point of action of its force along the runner [m].
    pub x_m: f64,
    /// Point of action of its force across the runner [m].
    pub y_m: f64,
    /// Normal force [N].
    pub force_n: f64,
    /// Contact area: sum over its cells [m2].
    pub area_m2: f64,
    /// Largest pressure of a cell [Pa].
    pub p_max_pa: f64,
}

impl AsperitiesResult {
    pub(crate) fn of(asperities: &[Asperity]) -> Self {
        let result = |asperity: &Asperity| AsperityResult {
            x_m: asperity.centre[0],
            y_m: asperity.centre[1],
            force_n: asperity.force,
            area_m2: asperity.area,
            p_max_pa: asperity.p_max,
        };
        AsperitiesResult {
            asperity_count: asperities.len(),
            asperities: asperities.iter().map(result).collect(),
        }
    }
}

/// The surface fitted through a hull's vertices.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct HullFit {
    /// Root mean square distance of the vertices to the surface [m].
    pub residual_rms_m: f64,
    /// Largest distance of a vertex [m].
    pub residual_max_m: f64,
    /// Error of the surface between the vertices [m].
    pub resolution_error_m: f64,
    /// Ratio of the root mean square distance to the approach.
    pub residual_over_approach: f64,
    /// Number of vertices in the fit.
    pub vertices: usize,
    /// Standard deviation of the vertices' noise [m].
    pub noise_m: f64,
    /// Standard deviation of the noise that would not be detected [m].
    pub unseen_noise_m: f64,
}

/// Convergence on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct MeshResult {
    /// Number of the mesh, from the coarsest.
    pub level: usize,
    /// Number of unknowns.
    pub dofs: usize,
    /// Number of nodes in contact.
    pub contact_nodes: usize,
    /// Number of iterations.
    pub iterations: usize,
    /// Relative residual.
    pub residual: f64,
    /// Peak pressure [Pa].
    pub p_max_pa: f64,
    /// Number of projected SOR sweeps.
    pub sweeps: usize,
    /// Number of accelerations by subspace minimisation.
    pub accelerations: usize,
    /// Complementary energy [J].
    pub energy_j: f64,
    /// Complementary energy after each accepted step, in descending order [J].
    #[serde(default)]
    pub energy_steps_j: Vec<f64>,
}

impl MeshResult {
    /// The last state on a mesh, with the sums of iterations, sweeps and accelerations over its
    /// contact sets; `None` without contact sets.
    pub(crate) fn of(sets: &[Iterate]) -> Option<Self> {
        let last = sets.last()?;
        let sum = |count: fn(&Iterate) -> usize| sets.iter().map(count).sum();
        let mut energies: Vec<f64> = sets.iter().map(|set| set.energy).collect();
        // A set whose forces are not accepted does not change the energy.
        energies.dedup();
        Some(MeshResult {
            level: last.level,
            dofs: last.dofs,
            contact_nodes: last.contact_nodes,
            iterations: sum(|s| s.iterations),
            residual: last.residual,
            p_max_pa: last.p_max,
            sweeps: sum(|s| s.sweeps),
            accelerations: sum(|s| s.accelerations),
            energy_j: last.energy,
            energy_steps_j: energies,
        })
    }
}

/// Stress on the line under the peak.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct SubsurfaceResult {
    /// Position of the line along the runner [m].
    pub x_m: f64,
    /// Position of the line across the runner [m].
    pub y_m: f64,
    /// The largest shear stress; absent if it does not lie under the surface.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub shear: Option<ShearResult>,
    /// Largest shear stress on the finest mesh [Pa].
    pub max_shear_mesh_pa: Option<f64>,
}

/// The largest shear stress under the surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct ShearResult {
    /// The largest shear stress.
    #[serde(flatten)]
    pub shear: Measured<MaxShear>,
    /// Depth of the largest shear stress.
    #[serde(flatten)]
    pub depth: Measured<MaxShearDepth>,
    /// Ratio of the largest shear stress to the peak pressure.
    #[serde(flatten)]
    pub over_peak: Measured<ShearOverPeak>,
}

impl ShearResult {
    pub(crate) fn of(solution: &kufe_contact::Solution) -> Option<Self> {
        let under = solution.under_peak?;
        let ratio = under.shear / solution.p_max;
        let relative = under.shear_error / under.shear + solution.p_max_error / solution.p_max;
        Some(ShearResult {
            shear: Measured::new(under.shear, under.shear_error),
            depth: Measured::new(under.depth, under.depth_error),
            over_peak: Measured::new(ratio, ratio * relative),
        })
    }
}

/// The coefficient of friction and its parts.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct Friction {
    /// Coefficient of friction: the sum of its parts.
    #[serde(flatten)]
    pub mu: Measured<Mu>,
    /// Ratio of the ploughing force to the load.
    #[serde(flatten)]
    pub ploughing: Measured<MuPloughing>,
    /// Ratio of the viscous drag of the melt film to the load.
    #[serde(flatten)]
    pub viscous: Measured<MuViscous>,
    /// Ratio of the drag of boundary contact (steel on ice through the film) to the load.
    #[serde(flatten)]
    pub boundary: Measured<MuBoundary>,
}

/// Friction, groove and melt film of steady sliding.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct SlidingResult {
    /// Coefficient of friction with its parts.
    #[serde(flatten)]
    pub friction: Friction,
    /// Fraction of the patch in boundary contact: steel on ice through the film.
    #[serde(flatten)]
    pub boundary_share: Measured<BoundaryShare>,
    /// Depth of the groove.
    #[serde(flatten)]
    pub groove_depth: Measured<GrooveDepth>,
    /// Distance of the centre of pressure ahead of the lowest point.
    #[serde(flatten)]
    pub load_ahead: Measured<LoadAhead>,
    /// Front end of the patch from the lowest point, forward positive.
    #[serde(flatten)]
    pub front: Measured<Front>,
    /// Back end of the patch from the lowest point, forward positive.
    #[serde(flatten)]
    pub back: Measured<Back>,
    /// Mean thickness of the film.
    #[serde(flatten)]
    pub film_mean: Measured<FilmMean>,
    /// Largest thickness of the film.
    #[serde(flatten)]
    pub film_max: Measured<FilmMax>,
    /// Mass of ice melted per time.
    #[serde(flatten)]
    pub melt_rate: Measured<MeltRate>,
    /// Contact time of the ice under the runner.
    #[serde(flatten)]
    pub contact_time: Measured<ContactTime>,
    /// Hardness: pressure at which the ice yields [Pa].
    pub hardness_pa: f64,
    /// Source of the hardness: `given`, `temperature-law`, `time-law` or `melting`.
    pub hardness_from: String,
    /// Sensitivity of the coefficient of friction to its parameters.
    pub mu_sensitivity: SensitivityResult,
    /// Cross section of the groove [m2].
    pub groove_area_m2: f64,
    /// Convergence history, mesh by mesh.
    pub sliding_history: Vec<SlidingMeshResult>,
}

/// Elasticities d ln mu / d ln x of the coefficient of friction; for the temperature d ln mu / dT.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct SensitivityResult {
    /// With respect to hardness.
    #[serde(flatten)]
    pub hardness: Measured<ByHardness>,
    /// With respect to speed.
    #[serde(flatten)]
    pub speed: Measured<BySpeed>,
    /// With respect to viscosity.
    #[serde(flatten)]
    pub viscosity: Measured<ByViscosity>,
    /// With respect to roughness; absent without boundary contact.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub roughness: Option<Measured<ByRoughness>>,
    /// With respect to the shear stress of boundary contact; absent without boundary contact.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub boundary_shear: Option<Measured<ByBoundaryShear>>,
    /// With respect to the temperature of the ice [1/K].
    #[serde(flatten)]
    pub temperature: Measured<ByTemperature>,
}

/// Convergence of a sliding contact on one mesh.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[non_exhaustive]
pub struct SlidingMeshResult {
    /// Number of unknowns.
    pub dofs: usize,
    /// Number of nodes in contact.
    pub contact_nodes: usize,
    /// Number of corrections of the contact plane's response by that of the bodies.
    pub corrections: usize,
    /// Number of iterations.
    pub iterations: usize,
    /// Ratio of the change of the forces in the last correction to the load.
    pub residual: f64,
    /// Depth of the groove [m].
    pub groove_depth_m: f64,
    /// Ploughing force from the plastic work [N].
    pub ploughing_by_work_n: f64,
    /// Ploughing force from pressures and slopes [N].
    pub ploughing_by_slope_n: f64,
}

impl From<&SlidingMesh> for SlidingMeshResult {
    fn from(mesh: &SlidingMesh) -> Self {
        SlidingMeshResult {
            dofs: mesh.dofs,
            contact_nodes: mesh.contact_nodes,
            corrections: mesh.corrections,
            iterations: mesh.iterations,
            residual: mesh.residual,
            groove_depth_m: mesh.groove_depth,
            ploughing_by_work_n: mesh.plastic_work,
            ploughing_by_slope_n: mesh.ploughing_by_slope,
        }
    }
}
