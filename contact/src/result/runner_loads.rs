//! Loads of an elastic runner: its largest stress, and its forces on each part of the mount.

use std::collections::BTreeMap;

use kufe_fem::{Body, FACES, Material, MatrixFree, nodal_stresses, von_mises};
use kufe_mesh::HexMesh;

use crate::symmetry::images;
use crate::{ElasticRunner, Error, Mount, Problem, RunnerField, Solution};

/// Stresses in the runner and its forces on the mount, on the last mesh (not extrapolated).
#[derive(Clone, Debug, PartialEq)]
pub struct RunnerLoads {
    /// Largest von Mises stress at a node [Pa].
    pub von_mises: f64,
    /// Undeformed position of that node, as in [`RunnerField::mesh`] [m]; where mirror planes were
    /// used, its images have the same stress.
    pub at: [f64; 3],
    /// Von Mises stress at the nodes of [`RunnerField::mesh`] [Pa].
    pub von_mises_at_nodes: Vec<f64>,
    /// The parts of the mount along the runner; empty for an unbounded runner.
    pub mounts: Vec<MountForce>,
}

/// Force and moment of the runner on one part of its mount.
#[derive(Clone, Debug, PartialEq)]
pub struct MountForce {
    /// Centre of the fixed or loaded part [m].
    pub at: [f64; 3],
    /// Force on the mount; on a part that applies a load, that load, upwards [N].
    pub force: [f64; 3],
    /// Moment on the mount about `at` [N m].
    pub moment: [f64; 3],
    /// Largest von Mises stress of the steel at its nodes [Pa].
    pub von_mises: f64,
}

/// The runner's largest von Mises stress and its forces on the mount; `None` if it is rigid.
///
/// The nodal forces f = K u of the runner are the external forces on it. On the nodes of a part of
/// the mount these are the forces of the mount,
///
/// F = -sum f,  M = -sum (r - r0) x f,
///
/// with r0 the middle of the part (the nodes connected over fixed faces). They sum to the force and
/// moments of the contact up to the equilibrium residual. Stresses are [`nodal_stresses`]; at the
/// rim of a fixed part they are singular, so that they grow there with finer meshes.
///
/// # Errors
/// [`Error::Unsuitable`] if the solution's mesh is invalid.
pub fn runner_loads(problem: &Problem, solution: &Solution) -> Result<Option<RunnerLoads>, Error> {
    let (Some(elastic), Some(field)) = (&problem.runner.elastic, &solution.runner_volume) else {
        return Ok(None);
    };
    let unsuitable = Error::runner_mesh::<kufe_fem::Error>;
    let material =
        Material::new(elastic.youngs_modulus, elastic.poissons_ratio).map_err(unsuitable)?;
    let body =
        Body::uniform(field.mesh.clone(), material, elastic.element_kind()).map_err(unsuitable)?;
    let displacement: Vec<f64> = field.displacement.iter().flatten().copied().collect();
    let mises: Vec<f64> = nodal_stresses(&body, &displacement)
        .into_iter()
        .map(von_mises)
        .collect();
    let most = (0..mises.len()).fold(0, |most, n| if mises[n] > mises[most] { n } else { most });
    let mut mounts = Vec::new();
    if elastic.solid.is_some() || problem.runner.is_bounded() {
        let mut forces = vec![0.0; displacement.len()];
        MatrixFree::new(&body).apply(&displacement, &mut forces);
        let on_mount = on_mount(elastic, field);
        for nodes in parts(&field.mesh, &on_mount) {
            let von_mises = nodes.iter().fold(0.0, |m, &n| f64::max(m, mises[n]));
            let part: Vec<NodeForce> = nodes
                .iter()
                .map(|&n| {
                    let force = [0, 1, 2].map(|axis| -forces[3 * n + axis]);
                    [field.mesh.points[n], force]
                })
                .collect();
            mounts.extend(unfolded(&part, von_mises, solution.symmetry));
        }
        mounts.sort_by(|a, b| {
            a.at[0]
                .total_cmp(&b.at[0])
                .then(a.at[1].total_cmp(&b.at[1]))
        });
    }
    Ok(Some(RunnerLoads {
        von_mises: mises[most],
        at: field.mesh.points[most],
        von_mises_at_nodes: mises,
        mounts,
    }))
}

/// Whether each node is fixed or loaded by the mount.
fn on_mount(elastic: &ElasticRunner, field: &RunnerField) -> Vec<bool> {
    let points = &field.mesh.points;
    if let Some(solid) = &elastic.solid {
        let fixed = |node| solid.map.index(3 * node).is_none();
        return (0..points.len()).map(fixed).collect();
    }
    let heights = points.iter().map(|p| p[2]);
    let top = heights.fold(f64::NEG_INFINITY, f64::max);
    let slack = 1e-9 * top.abs();
    let over = |x| elastic.mount == Mount::Top || elastic.mount.over(x);
    let fixed = |p: &[f64; 3]| p[2] >= top - slack && over(p[0]);
    points.iter().map(fixed).collect()
}

/// Groups of `on` nodes that are connected over faces with all corners `on`; the remaining nodes
/// are grouped by cells.
fn parts(mesh: &HexMesh, on: &[bool]) -> Vec<Vec<usize>> {
    let mut above: Vec<usize> = (0..on.len()).collect();
    let mut join = |nodes: &[usize]| {
        let roots: Vec<usize> = nodes.iter().map(|&n| root(&mut above, n)).collect();
        let first = roots.iter().copied().min().unwrap_or(0);
        roots.into_iter().for_each(|root| above[root] = first);
    };
    let mut unassigned = on.to_vec();
    for cell in mesh.cells.iter().filter(|cell| cell.iter().any(|&n| on[n])) {
        for face in FACES.map(|face| face.map(|corner| cell[corner])) {
            if face.iter().all(|&n| on[n]) {
                join(&face);
                face.iter().for_each(|&n| unassigned[n] = false);
            }
        }
    }
    for cell in &mesh.cells {
        let nodes: Vec<usize> = cell.iter().copied().filter(|&n| unassigned[n]).collect();
        join(&nodes);
    }
    let mut parts: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for node in (0..on.len()).filter(|&n| on[n]) {
        let root = root(&mut above, node);
        parts.entry(root).or_default().push(node);
    }
    parts.into_values().collect()
}

/// The representative of a node's connected component (union-find).
fn root(above: &mut [usize], mut node: usize) -> usize {
    while above[node] != node {
        above[node] = above[above[node]];
        node = above[node];
    }
    node
}

/// Place of a node and force on the mount there [m], [N].
type NodeForce = [[f64; 3]; 2];

/// The forces on a part of the mount and its mirror images: one force if the part touches the
/// mirror plane, separate ones otherwise.
fn unfolded(part: &[NodeForce], von_mises: f64, symmetry: [bool; 2]) -> Vec<MountForce> {
    let meets =
        [0, 1].map(|axis| symmetry[axis] && part.iter().any(|[place, _]| place[axis] == 0.0));
    let separate = [0, 1].map(|axis| symmetry[axis] && !meets[axis]);
    let image = |sign: [f64; 2]| {
        let turned = images(meets).flat_map(|own| {
            let [sx, sy] = [own[0] * sign[0], own[1] * sign[1]];
            let turned = move |[x, y, z]: [f64; 3]| [sx * x, sy * y, z];
            part.iter().map(move |node| node.map(turned))
        });
        mount_force(&turned.collect::<Vec<_>>(), von_mises)
    };
    images(separate).map(image).collect()
}

/// Resultant force and moment on some nodes of the mount.
fn mount_force(nodes: &[NodeForce], von_mises: f64) -> MountForce {
    let mut ends = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for [place, _] in nodes {
        for axis in 0..3 {
            ends[0][axis] = ends[0][axis].min(place[axis]);
            ends[1][axis] = ends[1][axis].max(place[axis]);
        }
    }
    let at = [0, 1, 2].map(|axis| 0.5 * (ends[0][axis] + ends[1][axis]));
    let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
    for [place, own] in nodes {
        let ([fx, fy, fz], [x, y, z]) = (*own, [0, 1, 2].map(|axis| place[axis] - at[axis]));
        let turn = [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx];
        for axis in 0..3 {
            force[axis] += own[axis];
            moment[axis] += turn[axis];
        }
    }
    MountForce {
        at,
        force,
        moment,
        von_mises,
    }
}

#[cfg(test)]
mod tests {
    //! Loads of a runner: balance with the contact, and the stress of a beam.

    use std::sync::Arc;

    use super::*;
    use kufe_mesh::{BobRunner, TensorGrid, Underside};

    use crate::{
        Foundation, Ice, Load, LoadedPlace, Options, Place, Runner, RunnerSolid, Tilt, solve,
    };

    const STEEL: (f64, f64) = (210e9, 0.3);

    fn fixed(places: &[(f64, f64)]) -> Mount {
        let place = |&(x, length): &(f64, f64)| Place { x, length };
        Mount::Places(places.iter().map(place).collect())
    }

    fn carried(places: &[(f64, f64, f64)]) -> Mount {
        let place = |&(x, length, share): &(f64, f64, f64)| LoadedPlace {
            place: Place { x, length },
            share,
        };
        Mount::Loads(places.iter().map(place).collect())
    }

    fn problem(
        underside: Arc<dyn Underside>,
        (top, mount): (f64, Mount),
        ice: Ice,
        load: Load,
    ) -> Problem {
        let elastic = ElasticRunner {
            mount,
            ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, top)
        };
        let runner = Runner {
            underside,
            elastic: Some(elastic),
        };
        Problem::new(runner, ice, load)
    }

    fn one_mesh(problem: &Problem, cells: usize) -> (Solution, RunnerLoads) {
        let options = Options {
            cells: Some(cells),
            residual: 1e-11,
            ..Options::default()
        };
        let solution = solve(problem, &options).expect("a solution");
        let loads = runner_loads(problem, &solution).expect("a body");
        (solution, loads.expect("an elastic runner"))
    }

    /// Forces on the mounts sum to the contact's, and so do their moments about the origin.
    fn in_balance(solution: &Solution, loads: &RunnerLoads, name: &str) {
        let (mut force, mut moment) = ([0.0; 3], [0.0; 3]);
        for mount in &loads.mounts {
            let ([x, y, z], [fx, fy, fz]) = (mount.at, mount.force);
            let turn = [y * fz - z * fy, z * fx - x * fz, x * fy - y * fx];
            for axis in 0..3 {
                force[axis] += mount.force[axis];
                moment[axis] += mount.moment[axis] + turn[axis];
            }
        }
        let (fz, [x, y]) = (solution.fz, solution.centre_of_pressure);
        println!("{name}: {force:?} N, {moment:?} N m, pressed with {fz} N at {x}, {y}");
        for (found, wanted) in force.into_iter().zip([0.0, 0.0, fz]) {
            assert!((found - wanted).abs() < 1e-7 * fz, "{name}: {force:?} {fz}");
        }
        // Against the force over a hundredth of a metre.
        for (found, wanted) in moment.into_iter().zip([y * fz, -x * fz, 0.0]) {
            assert!(
                (found - wanted).abs() < 1e-7 * 0.01 * fz,
                "{name}: {moment:?} {wanted}"
            );
        }
    }

    #[test]
    fn what_mounts_bear_sums_to_the_contacts_force_and_moments() {
        let bob = BobRunner {
            length: 0.3,
            rocker_radius: 8.0,
            height: 0.02,
            ..BobRunner::default()
        };
        let hull = Arc::new(bob.swept().expect("a runner"));
        let ice = || Ice {
            foundation: Foundation::RigidBed { thickness: 0.02 },
            ..Ice::half_space(9e9, 0.33)
        };
        let two = [(-0.08, 0.02), (0.08, 0.02)];
        let mounts = [
            (Mount::Top, 0.0, Tilt::LEVEL, 1),
            (fixed(&two), 0.0, Tilt::LEVEL, 2),
            (fixed(&[(0.0, 0.04)]), 0.0, Tilt::LEVEL, 1),
            (fixed(&[(-0.08, 0.02), (0.03, 0.01)]), 0.0, Tilt::Free, 2),
            (fixed(&[(0.1, 0.02)]), 0.0, Tilt::LEVEL, 1),
            (
                carried(&[(-0.08, 0.02, 0.5), (0.08, 0.02, 0.5)]),
                0.0,
                Tilt::Free,
                2,
            ),
            (
                carried(&[(-0.1, 0.02, 0.4), (0.05, 0.02, 0.6)]),
                -0.01,
                Tilt::Free,
                2,
            ),
        ];
        for (mount, offset_x, tilt, count) in mounts {
            let name = format!("{mount:?}");
            let shares: Vec<f64> = match &mount {
                Mount::Loads(loads) => loads.iter().map(|load| load.share).collect(),
                _ => Vec::new(),
            };
            let load = Load::Force {
                fz: 800.0,
                offset_x,
                offset_y: 0.0,
                tilt,
            };
            let problem = problem(hull.clone(), (bob.height, mount), ice(), load);
            let (solution, loads) = one_mesh(&problem, 3);
            assert_eq!(loads.mounts.len(), count, "{name}");
            in_balance(&solution, &loads, &name);
            // What carries has its own share, without a moment about its middle.
            for (mount, share) in loads.mounts.iter().zip(shares) {
                assert!(
                    (mount.force[2] / (800.0 * share) - 1.0).abs() < 1e-8,
                    "{name}"
                );
                assert!(
                    mount.moment.iter().all(|m| m.abs() < 1e-6),
                    "{name}: {mount:?}"
                );
            }
            let most = loads.mounts.iter().map(|mount| mount.von_mises);
            assert!(most.fold(0.0, f64::max) <= loads.von_mises, "{name}");
        }
    }

    /// A block on hexahedra of its own, fixed at two rows of its top.
    #[test]
    fn hexahedra_from_elsewhere_bear_on_each_place_that_holds_them() {
        let line = |half: f64, n: i32| -> Vec<f64> {
            (0..=n)
                .map(|i| half * (2.0 * f64::from(i) / f64::from(n) - 1.0))
                .collect()
        };
        let grid = TensorGrid {
            x: line(0.02, 20),
            y: line(0.002, 8),
            z: (0..=4).map(|k| 0.0015 * f64::from(k)).collect(),
        };
        let mut mesh = grid.hex_mesh();
        for p in &mut mesh.points {
            let low = p[0] * p[0] / 4.0 + p[1] * p[1] / 0.02;
            p[2] = low + (0.006 - low) * p[2] / 0.006;
        }
        let on_top = |p: [f64; 3]| p[2] > 0.006 - 1e-9 && p[0].abs() > 0.0139;
        let solid = RunnerSolid::new(mesh, STEEL.0, STEEL.1, on_top).expect("a block");
        let surface = kufe_mesh::FittedUnderside::new(&solid.underside(), 0.0).expect("a surface");
        let load = Load::central(50.0, Tilt::LEVEL);
        let mut problem = problem(
            Arc::new(surface),
            (0.006, Mount::Top),
            Ice::half_space(9e9, 0.33),
            load,
        );
        if let Some(elastic) = &mut problem.runner.elastic {
            elastic.solid = Some(Arc::new(solid));
        }
        let (solution, loads) = one_mesh(&problem, 3);
        assert_eq!(loads.mounts.len(), 2);
        assert!((loads.mounts[0].at[0] + 0.017).abs() < 1e-9, "{loads:?}");
        in_balance(&solution, &loads, "a block");
    }

    /// A bar that is pressed in its middle and carried at two places: by statics the bending moment
    /// in the middle is half of each load's less that of the pressure on its side, and a beam's
    /// stress there is 6 M / (b h^2).
    #[test]
    fn a_bar_carried_at_two_places_has_a_beams_stress_in_its_middle() {
        struct Bar;
        const WIDTH: f64 = 0.01;
        const HEIGHT: f64 = 0.012;
        impl Underside for Bar {
            fn height(&self, x: f64, y: f64) -> f64 {
                if x.abs() > 0.15 || y.abs() > 0.5 * WIDTH {
                    return f64::INFINITY;
                }
                // A radius of 1 m in the middle that levels off at 2 mm, so that the ends stay off
                // the ice.
                let rise = 2e-3;
                rise * (1.0 - 1.0 / (1.0 + x * x / (2.0 * rise)))
            }
            fn extent(&self) -> [f64; 4] {
                [-0.15, 0.15, -0.5 * WIDTH, 0.5 * WIDTH]
            }
            fn mirror_symmetric(&self) -> [bool; 2] {
                [true; 2]
            }
        }
        let (arm, fz) = (0.1, 500.0);
        let soft = Ice {
            foundation: Foundation::RigidBed { thickness: 0.02 },
            ..Ice::half_space(1e9, 0.33)
        };
        let mount = carried(&[(-arm, 0.02, 0.5), (arm, 0.02, 0.5)]);
        let load = Load::central(fz, Tilt::Free);
        let problem = problem(Arc::new(Bar), (HEIGHT, mount), soft, load);
        let (solution, loads) = one_mesh(&problem, 6);
        // Over the half on which x is positive, by trapezoids; the patch is 10 mm wide all along.
        let surface = &solution.surface;
        let (nx, ny) = (surface.x.len(), surface.y.len());
        let share = |nodes: &[f64], i: usize| {
            let before = if i > 0 { nodes[i] - nodes[i - 1] } else { 0.0 };
            let after = if i + 1 < nodes.len() {
                nodes[i + 1] - nodes[i]
            } else {
                0.0
            };
            0.5 * (before + after)
        };
        let mut pressed = [0.0; 2];
        for (j, i) in (0..ny).flat_map(|j| (0..nx).map(move |i| (j, i))) {
            let force = surface.pressure[j * nx + i] * share(&surface.x, i) * share(&surface.y, j);
            pressed[0] += force;
            pressed[1] += 0.5 * force * surface.x[i].abs();
        }
        let moment = 0.5 * fz * arm - pressed[1];
        let beam = 6.0 * moment / (WIDTH * HEIGHT * HEIGHT);
        println!(
            "{:.5e} Pa at {:?} against a beam's {beam:.5e}, {pressed:?}",
            loads.von_mises, loads.at
        );
        // The trapezoids end a cell outside the patch.
        assert!((pressed[0] / fz - 1.0).abs() < 0.02, "{pressed:?}");
        assert!(
            (loads.von_mises / beam - 1.0).abs() < 0.03,
            "{loads:?} {beam}"
        );
        let [x, _, z] = loads.at;
        let outer = !(0.05 * HEIGHT..0.95 * HEIGHT).contains(&z);
        assert!(x.abs() < 0.01 && outer, "{loads:?}");
    }
}
