//! The solution of a problem from its last mesh.

use crate::accuracy::watched::Limits;
use crate::mesh::assembled::assembled_bodies;
use crate::mesh::contact_mesh::{ContactMesh, State};
use crate::mesh::discretise::Discretisation;
use crate::problem::check::CheckedProblem;
use crate::result::measure::ROUNDED;
use crate::result::pressure::Pressure;
use crate::symmetry::unfolded;
use crate::{Foundation, Iterate, RunnerField, Solution, SurfaceField, VolumeField};

/// A mesh and the contact on it.
pub(crate) struct SolvedMesh {
    pub mesh: Discretisation,
    pub state: State,
    /// Conjugate-gradient iterations.
    pub iterations: usize,
    pub pressure: Pressure,
}

impl SolvedMesh {
    /// The solution of `problem` with the limits of fine meshes and the history of all meshes.
    pub fn solution(
        self,
        CheckedProblem { problem, gap, .. }: &CheckedProblem,
        limits: Limits,
        history: Vec<Iterate>,
    ) -> Solution {
        let SolvedMesh { mesh, state, .. } = self;
        let Pressure {
            values, figures, ..
        } = self.pressure;
        let resultant = mesh.contact.resultant(&state);
        let fz = mesh.image_count() * resultant[0];
        // A mirror plane holds the centre of pressure; otherwise it follows from the moments about
        // the line of action.
        let centre = |axis: usize, moment: f64| {
            if mesh.symmetry[axis] {
                0.0
            } else {
                gap.line_of_action[axis] + moment / resultant[0]
            }
        };
        let [pitch, roll] = gap.tilt(state.motion[1], state.motion[2]);
        let gaps = mesh.contact.gaps(&state);
        let ice_surface = mesh.contact.ice_surface(&state.displacement);
        let bound = ROUNDED * problem.ice.hardness.unwrap_or(f64::INFINITY);
        // Ice at its hardness yields by the runner's overlap with its elastic surface.
        let overlaps = values.iter().zip(&gaps);
        let yielded = overlaps.map(|(p, gap)| if *p >= bound { -gap } else { 0.0 });
        let yielded = yielded.collect();
        let kkt_residual = kkt(&mesh.contact, &state, &gaps);
        let fields = [values, gaps, ice_surface, yielded];
        let surface = unfold(&mesh.grid.x, &mesh.grid.y, mesh.symmetry, fields);
        let (on_ice, on_runner) = state.displacement.split_at(3 * mesh.grid.node_count());
        let bed = match problem.ice.foundation {
            Foundation::ElasticBed { bed, .. } => Some((bed, mesh.bed_layers())),
            _ => None,
        };
        Solution {
            p_max: limits.peak.value,
            p_max_error: limits.peak.error,
            p_max_mesh: figures.p_max,
            hardness: problem.ice.hardness,
            p_mean: fz / figures.area,
            p_mean_error: fz / figures.area * limits.area_error / figures.area,
            area: figures.area,
            area_error: limits.area_error,
            length: figures.length,
            length_error: limits.length_error,
            width: figures.width,
            width_error: limits.width_error,
            approach: limits.approach.value,
            approach_error: limits.approach.error,
            pitch,
            pitch_error: limits.tilt_errors[0],
            roll,
            roll_error: limits.tilt_errors[1],
            under_peak: None,
            fz,
            centre_of_pressure: [centre(0, resultant[1]), centre(1, -resultant[2])],
            kkt_residual,
            dofs: mesh.free_dofs(),
            iterations: self.iterations,
            history,
            surface,
            symmetry: mesh.symmetry,
            assembled: assembled_bodies(&mesh.contact),
            volume: Some(VolumeField {
                grid: mesh.grid,
                displacement: by_node(on_ice),
                youngs_modulus: problem.ice.youngs_modulus,
                poissons_ratio: problem.ice.poissons_ratio,
                element: problem.ice.element_kind(),
                bed,
            }),
            runner_volume: mesh.runner_mesh.map(|mesh| RunnerField {
                displacement: by_node(on_runner),
                mesh,
            }),
        }
    }
}

/// A vector by nodes from one by components.
fn by_node(u: &[f64]) -> Vec<[f64; 3]> {
    let nodes = u.len() / 3;
    (0..nodes)
        .map(|n| [u[n], u[nodes + n], u[2 * nodes + n]])
        .collect()
}

/// Largest relative violation of the equilibrium (by the operator), of the balance, and of the
/// contact conditions over all nodes of the plane.
fn kkt(contact: &ContactMesh, state: &State, gaps: &[f64]) -> f64 {
    let largest = state
        .force
        .iter()
        .fold(f64::MIN_POSITIVE, |m, f| m.max(f.abs()));
    let tension = worst(state.force.iter().map(|f| -f)) / largest;
    let full = |n: usize| state.force[n] >= contact.bound[n];
    let open = (0..gaps.len()).filter(|&n| !full(n));
    let penetration = worst(open.map(|n| -gaps[n])) / contact.depth(state);
    // Moments are compared with the force times half the contact's extent.
    let reach = contact
        .rows
        .iter()
        .zip(&state.force)
        .filter(|(_, f)| **f > 0.0)
        .fold([1.0f64, 1e-12, 1e-12], |m, (r, _)| {
            [1.0, m[1].max(r[1].abs()), m[2].max(r[2].abs())]
        });
    let resultant = contact.resultant(state);
    let force = resultant[0].abs().max(f64::MIN_POSITIVE);
    let free = (0..3).filter(|&a| contact.motion.free[a]);
    let balance =
        worst(free.map(|a| (resultant[a] - contact.motion.balance[a]).abs() / (force * reach[a])));
    let equilibrium = contact.out_of_equilibrium(state);
    worst([equilibrium, tension, penetration, balance].into_iter())
}

/// The largest of some values, at least 0; infinite if one is NaN.
fn worst(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |most, value| {
        if value.is_nan() {
            f64::INFINITY
        } else {
            most.max(value)
        }
    })
}

/// Mirrors plane fields over the symmetry planes.
fn unfold(x: &[f64], y: &[f64], symmetry: [bool; 2], fields: [Vec<f64>; 4]) -> SurfaceField {
    let columns: Vec<_> = unfolded(x.len(), symmetry[0]).collect();
    let rows: Vec<_> = unfolded(y.len(), symmetry[1]).collect();
    let row = |values: &[f64], j: usize| -> Vec<f64> {
        columns
            .iter()
            .map(|&(i, _)| values[j * x.len() + i])
            .collect()
    };
    let spread = |values: &[f64]| rows.iter().flat_map(|&(j, _)| row(values, j)).collect();
    let [pressure, gap, uz, yielded] = fields.map(|f| -> Vec<f64> { spread(&f) });
    SurfaceField {
        x: columns.iter().map(|&(i, sign)| sign * x[i]).collect(),
        y: rows.iter().map(|&(j, sign)| sign * y[j]).collect(),
        pressure,
        gap,
        yielded,
        uz,
    }
}

#[cfg(test)]
mod tests {
    use super::worst;

    #[test]
    fn what_is_no_number_violates_everything() {
        assert_eq!(worst([0.1, -3.0, 0.2].into_iter()), 0.2);
        assert_eq!(worst([0.1, f64::NAN, 0.2].into_iter()), f64::INFINITY);
        assert_eq!(worst(std::iter::empty()), 0.0);
    }
}
