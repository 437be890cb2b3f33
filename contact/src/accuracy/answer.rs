//! From the last mesh to what a solve returns.

use crate::accuracy::watched::Limits;
use crate::active_set::contact_set::Progress;
use crate::mesh::assembled::assembled_bodies;
use crate::mesh::contact_mesh::{ContactMesh, State};
use crate::mesh::discretise::Discretisation;
use crate::problem::gap::Gap;
use crate::result::measure::ROUNDED;
use crate::result::pressure::Pressure;
use crate::{Foundation, Iterate, Problem, RunnerField, Solution, SurfaceField, VolumeField};

/// The last mesh's solution and what it is of.
pub(crate) struct Answer<'a> {
    pub problem: &'a Problem,
    pub gap: &'a Gap<'a>,
    pub mesh: Discretisation,
    pub state: State,
    pub progress: Progress,
    pub pressure: Pressure,
    /// Unknowns.
    pub dofs: usize,
}

impl Answer<'_> {
    /// With the limits of fine meshes and what happened on all of them.
    pub fn solution(self, limits: Limits, history: Vec<Iterate>) -> Solution {
        let Answer {
            problem,
            gap,
            mesh,
            state,
            progress,
            pressure,
            dofs,
        } = self;
        let Pressure {
            values, figures, ..
        } = pressure;
        let resultant = mesh.contact.resultant(&state);
        let fz = mesh.copies() * resultant[0];
        // A mirror plane holds the centre of pressure; otherwise it follows from the moments about
        // the line of action.
        let centre = |axis: usize, moment: f64| {
            if mesh.symmetry[axis] {
                0.0
            } else {
                gap.line_of_action[axis] + moment / resultant[0]
            }
        };
        let centre_of_pressure = [centre(0, resultant[1]), centre(1, -resultant[2])];
        let [pitch, roll] = gap.tilt(state.motion[1], state.motion[2]);
        let gaps = mesh.contact.gaps(&state);
        let ice_surface = mesh.contact.ice_surface(&state.displacement);
        let bound = ROUNDED * problem.ice.hardness.unwrap_or(f64::INFINITY);
        // Ice that bears all it can takes the runner's shape: the overlap with its elastic surface.
        let overlaps = values.iter().zip(&gaps);
        let yielded = overlaps.map(|(p, gap)| if *p >= bound { -gap } else { 0.0 });
        let yielded = yielded.collect();
        let surface = unfold(
            &mesh.grid.x,
            &mesh.grid.y,
            mesh.symmetry,
            [values, gaps, ice_surface, yielded],
        );
        let depth = mesh.contact.depth(&state);
        let kkt_residual = kkt(&mesh.contact, &state, depth);
        let nodes = mesh.grid.node_count();
        let u = &state.displacement;
        let displacement = by_node(&u[..3 * nodes]);
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
            // Where nothing else is known: as uncertain as what is judged by.
            width_error: figures.width * limits.length_error / figures.length,
            approach: limits.approach,
            approach_error: limits.approach * limits.relative,
            pitch,
            pitch_error: turned(pitch, limits.relative),
            roll,
            roll_error: turned(roll, limits.relative),
            under_peak: None,
            fz,
            centre_of_pressure,
            kkt_residual,
            dofs,
            iterations: progress.iterations,
            history,
            surface,
            volume: Some(VolumeField {
                grid: mesh.grid,
                displacement,
                youngs_modulus: problem.ice.youngs_modulus,
                poissons_ratio: problem.ice.poissons_ratio,
                element: problem.ice.element_kind(),
                bed,
            }),
            runner_volume: mesh.runner_mesh.map(|mesh| RunnerField {
                displacement: by_node(&u[3 * nodes..]),
                mesh,
            }),
            symmetry: mesh.symmetry,
            assembled: assembled_bodies(&mesh.contact),
        }
    }
}

/// From component after component to node by node.
fn by_node(u: &[f64]) -> Vec<[f64; 3]> {
    let nodes = u.len() / 3;
    (0..nodes)
        .map(|n| [u[n], u[nodes + n], u[2 * nodes + n]])
        .collect()
}

/// Largest relative violation: equilibrium by the operator, balance, and tension and penetration
/// over all nodes of the plane.
fn kkt(contact: &ContactMesh, state: &State, depth: f64) -> f64 {
    let largest = state
        .force
        .iter()
        .fold(f64::MIN_POSITIVE, |m, f| m.max(f.abs()));
    let tension = worst(state.force.iter().map(|f| -f)) / largest;
    let gaps = contact.gaps(state);
    let full = |n: usize| state.force[n] >= contact.bound[n];
    let open = (0..gaps.len()).filter(|&n| !full(n));
    let penetration = worst(open.map(|n| -gaps[n])) / depth;
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

/// The largest, at least 0; infinite where one is no number.
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
    let whole = |nodes: &[f64], symmetric: bool| -> (Vec<f64>, Vec<usize>) {
        if !symmetric {
            return (nodes.to_vec(), (0..nodes.len()).collect());
        }
        let mirrored = (1..nodes.len()).rev().map(|i| (-nodes[i], i));
        mirrored
            .chain((0..nodes.len()).map(|i| (nodes[i], i)))
            .unzip()
    };
    let (xs, is) = whole(x, symmetry[0]);
    let (ys, js) = whole(y, symmetry[1]);
    let spread = |values: &[f64]| -> Vec<f64> {
        js.iter()
            .flat_map(|&j| is.iter().map(move |&i| values[j * x.len() + i]))
            .collect()
    };
    let [pressure, gap, uz, yielded] = fields.map(|f| spread(&f));
    SurfaceField {
        x: xs,
        y: ys,
        pressure,
        gap,
        yielded,
        uz,
    }
}

/// The error of a tilt by a relative one; of one mesh nothing is known, of a tilt of 0 neither.
fn turned(tilt: f64, relative: f64) -> f64 {
    if relative.is_finite() {
        tilt.abs() * relative
    } else {
        relative
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
