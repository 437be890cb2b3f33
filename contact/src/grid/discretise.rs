//! From a patch and a resolution to a mesh.

use kufe_fem::{HeldFaces, LowerLayer, Material, TensorOperator};
use kufe_mesh::{HexMesh, TensorGrid};

use crate::active_set::motion::Motion;
use crate::bodies::columns::{Columns, Side};
use crate::bodies::elastic_body::ElasticBody;
use crate::bodies::runner_body::runner_body;
use crate::bodies::solid_body::solid_body;
use crate::grid::contact_mesh::ContactMesh;
use crate::grid::grading::{Start, Zone, graded_axis};
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;
use crate::problem::gap::Gap;
use crate::{Bed, Error, Foundation, Load, Problem};

/// How fine a mesh is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Resolution {
    /// Cells over half the patch, along and across.
    pub cells: f64,
    /// Growth of the spacing with the distance from the patch.
    pub growth: f64,
}

impl Resolution {
    /// Cells that half the patch really gets with these mirror planes, the mean of both axes: see [`widened`].
    pub fn real_cells(self, symmetry: [bool; 2]) -> f64 {
        self.cells
            + symmetry
                .iter()
                .map(|&s| if s { 0.25 } else { 0.0 })
                .sum::<f64>()
    }
}

/// How far the mesh reaches and which of its nodes may touch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// What the patch needs; nodes on and near it.
    Patch,
    /// Under the whole hull where that is bounded; every node under the hull. Contact far from where it is expected
    /// is seen, if coarsely.
    WholeHull,
}

/// The mesh and what belongs to it.
pub(crate) struct Discretisation {
    /// Nodes of the ice, z = 0 on top.
    pub grid: TensorGrid,
    /// The iteration's view of it.
    pub contact: ContactMesh,
    /// Mirror planes x = 0 and y = 0 that were used.
    pub symmetry: [bool; 2],
    /// Hexahedra of an elastic runner.
    pub runner_mesh: Option<HexMesh>,
}

/// Distance from the patch to the outer faces over the patch's largest half-length, on a half-space.
///
/// The faces carry the half-space's own displacements under the contact forces, so this only has to be
/// far enough for the forces to be gathered into a few lumps.
const HALF_SPACE_REACH: f64 = 3.0;
/// Distance from the patch to the sides over the thickness of what lies on the rigid bed: exp(-pi 6 / 2) < 1e-4.
const LAYER_REACH: f64 = 6.0;

/// Depth of even layers over the patch's smaller half-width: the stresses vary most there.
const EVEN_DEPTH: f64 = 1.5;

/// Meshes the ice under `patch`.
pub(crate) fn discretise(
    problem: &Problem,
    gap: &Gap,
    material: Material,
    patch: &Patch,
    resolution: Resolution,
    under: Reach,
) -> Result<Discretisation, Error> {
    let symmetry = gap.symmetry();
    let [x_low, x_high] = patch.span_x();
    let largest = 0.5 * (x_high - x_low).max(2.0 * patch.y.half());
    let (reach, depth) = match problem.ice.foundation {
        Foundation::HalfSpace => (HALF_SPACE_REACH * largest, HALF_SPACE_REACH * largest),
        Foundation::RigidBed { thickness } => (LAYER_REACH * thickness, thickness),
        Foundation::ElasticBed { thickness, bed } => {
            (LAYER_REACH * (thickness + bed.thickness), thickness)
        }
    };
    let extent = problem.runner.underside.extent();
    // An elastic hull is meshed whole, with nodes at its ends and sides.
    let on_columns = problem
        .runner
        .elastic
        .as_ref()
        .filter(|e| e.solid.is_none());
    let meshed = on_columns.is_some() && extent.iter().all(|end| end.is_finite());
    let axis = |stretches: &[Stretch], axis: usize| {
        let mut zones: Vec<Zone> = stretches
            .iter()
            .filter_map(|s| widened(s, symmetry[axis], resolution))
            .collect();
        part(&mut zones);
        let mut low = stretches[0].low - reach;
        let mut high = stretches[stretches.len() - 1].high + reach;
        let hull = [extent[2 * axis], extent[2 * axis + 1]];
        if (meshed || under == Reach::WholeHull) && hull.iter().all(|end| end.is_finite()) {
            let beyond = 0.05 * (hull[1] - hull[0]);
            low = low.min(hull[0] - beyond);
            high = high.max(hull[1] + beyond);
        }
        let start = if symmetry[axis] {
            Start::At(0.0)
        } else {
            Start::Beyond(low)
        };
        let mut nodes = graded_axis(start, high, &zones, resolution.growth);
        // Contact up to a runner's own ends needs nodes there.
        if problem.runner.elastic.is_some() && hull.iter().all(|end| end.is_finite()) {
            hull.iter().for_each(|&end| put_node(&mut nodes, end));
        }
        if let Some(elastic) = on_columns.filter(|_| meshed && axis == 0) {
            elastic.mount.refine(&mut nodes, hull);
        }
        nodes
    };
    let narrowest = patch
        .x
        .iter()
        .map(Stretch::half)
        .fold(patch.y.half(), f64::min);
    let spacing = (narrowest / resolution.cells).min(depth / 4.0);
    let even_depth = spacing * (EVEN_DEPTH * narrowest / spacing - 1e-6).ceil();
    let mut layers = Stretch::even(-even_depth.min(depth), 0.0);
    // A ridge along the runner reaches as deep as it is wide.
    layers.refine_at(0.0, patch.y.finest());
    let z_zone = Zone {
        stretch: layers,
        spacing,
    };
    let mut z = graded_axis(Start::Beyond(-depth), 0.0, &[z_zone], resolution.growth);
    if problem.ice.foundation != Foundation::HalfSpace {
        let scale = -depth / z[0];
        z.iter_mut().for_each(|z| *z *= scale);
    }
    let mut lower = None;
    if let Foundation::ElasticBed { bed, .. } = problem.ice.foundation {
        let below = below(&z, bed.thickness, resolution.growth);
        lower = Some(lower_layer(bed, below.len())?);
        z.splice(0..0, below);
    }
    let grid = TensorGrid {
        x: axis(&patch.x, 0),
        y: axis(std::slice::from_ref(&patch.y), 1),
        z,
    };
    let mut operator = TensorOperator::new(
        &grid,
        material.lame_lambda(),
        material.shear_modulus(),
        held_faces(symmetry),
    );
    if let Some(layer) = lower {
        operator = operator.on_layer(layer);
    }
    let mut contact = contact_mesh(
        problem, gap, material, patch, &grid, symmetry, under, operator,
    );
    let mut runner_mesh = None;
    if let Some(elastic) = &problem.runner.elastic {
        let fineness = (narrowest / resolution.cells, resolution.growth);
        if let Some(solid) = &elastic.solid {
            contact.bodies.push(solid_body(solid, &grid));
            runner_mesh = Some(solid.mesh().clone());
        } else {
            let for_solving = under == Reach::Patch;
            let (body, mesh) =
                runner_body(problem, elastic, &grid, symmetry, fineness, for_solving)?;
            contact.bodies.push(body);
            runner_mesh = Some(mesh);
        }
    }
    Ok(Discretisation {
        grid,
        contact,
        symmetry,
        runner_mesh,
    })
}

/// Nodes under those of `z`, down to `thickness` below them, growing on from the cells above.
fn below(z: &[f64], thickness: f64, growth: f64) -> Vec<f64> {
    let cell = (z[1] - z[0]).min(0.25 * thickness);
    let zone = Zone {
        stretch: Stretch::even(-cell, 0.0),
        spacing: cell,
    };
    let mut nodes = graded_axis(Start::Beyond(-thickness), 0.0, &[zone], growth);
    nodes.pop();
    let scale = thickness / -nodes[0];
    nodes.iter().map(|n| z[0] + n * scale).collect()
}

/// The bed as the operator sees it.
fn lower_layer(bed: Bed, cells: usize) -> Result<LowerLayer, Error> {
    let material =
        Material::new(bed.youngs_modulus, bed.poissons_ratio).map_err(|_| Error::OutOfRange {
            name: "Young's modulus of the bed",
            value: bed.youngs_modulus,
            expected: "an elastic solid",
        })?;
    Ok(LowerLayer {
        cells,
        lambda: material.lame_lambda(),
        mu: material.shear_modulus(),
    })
}

/// Moves the node nearest to `place` there where it is close, or adds one; nothing outside the axis.
fn put_node(nodes: &mut Vec<f64>, place: f64) {
    let next = nodes.partition_point(|&v| v < place);
    if next == 0 || next == nodes.len() {
        return;
    }
    let cell = nodes[next] - nodes[next - 1];
    if next + 1 < nodes.len() && nodes[next] - place < 0.35 * cell {
        nodes[next] = place;
    } else if next > 1 && place - nodes[next - 1] < 0.35 * cell {
        nodes[next - 1] = place;
    } else {
        nodes.insert(next, place);
    }
}

/// The zone of a stretch: half a cell longer at its rims, so that all meshes cut them in the middle of a cell,
/// and only its upper half where a mirror plane cuts it. Nothing of a stretch below a mirror plane.
///
/// Half an even stretch, from a node on the mirror plane to the middle of a cell, is an odd number of half cells: half a
/// cell more than asked. A zone of no whole number of cells would leave their number to rounding errors.
fn widened(stretch: &Stretch, symmetric: bool, resolution: Resolution) -> Option<Zone> {
    let halved = symmetric && stretch.low == -stretch.high && stretch.finest() == 1.0;
    let spacing = stretch.half() / (resolution.cells + if halved { 0.5 } else { 0.0 });
    let margin = |x: f64| 0.5 * spacing * stretch.size(x);
    let low = stretch.low - margin(stretch.low);
    let high = stretch.high + margin(stretch.high);
    if symmetric && high <= 0.0 {
        return None;
    }
    let cut = symmetric && low <= 0.0;
    let (from, length) = (if cut { 0.0 } else { low }, stretch.high - stretch.low);
    // Places are relative to the stretch: carry them over to the zone.
    let place = |t: f64| (stretch.low + t * length - from) / (high - from);
    let sizes = stretch.sizes.iter().map(|s| [place(s[0]), s[1]]).collect();
    Some(Zone {
        stretch: Stretch {
            low: from,
            high,
            sizes,
        },
        spacing,
    })
}

/// Lets zones that their margins made overlap meet half-way.
fn part(zones: &mut [Zone]) {
    for i in 1..zones.len() {
        let (low, high) = (zones[i].stretch.low, zones[i - 1].stretch.high);
        if low < high {
            let middle = 0.5 * (low + high);
            zones[i - 1].stretch.high = middle;
            zones[i].stretch.low = middle;
        }
    }
}

/// Outer faces held in all components, mirror planes in their normal one.
fn held_faces(symmetry: [bool; 2]) -> HeldFaces {
    std::array::from_fn(|c| {
        [
            [!symmetry[0] || c == 0, true],
            [!symmetry[1] || c == 1, true],
            [true, false],
        ]
    })
}

#[allow(clippy::too_many_arguments)]
fn contact_mesh(
    problem: &Problem,
    gap: &Gap,
    material: Material,
    patch: &Patch,
    grid: &TensorGrid,
    symmetry: [bool; 2],
    under: Reach,
    operator: TensorOperator,
) -> ContactMesh {
    let [nx, ny, _] = grid.shape();
    let mut gaps = Vec::with_capacity(nx * ny);
    let mut rows = Vec::with_capacity(nx * ny);
    let mut bound = Vec::with_capacity(nx * ny);
    let mut candidates = Vec::new();
    let hardness = problem.ice.hardness.unwrap_or(f64::INFINITY);
    let near = |stretch: &Stretch, x: f64| {
        let margin = 0.7 * stretch.half();
        (stretch.low - margin..=stretch.high + margin).contains(&x)
    };
    // The plane problem's matrix is dense: beyond some size only the expected nodes are taken.
    let everywhere = under == Reach::WholeHull && nx * ny <= 1500;
    for j in 0..ny {
        for i in 0..nx {
            let (x, y) = (grid.x[i], grid.y[j]);
            let outer =
                i + 1 == nx || j + 1 == ny || (i == 0 && !symmetry[0]) || (j == 0 && !symmetry[1]);
            let value = if outer { f64::INFINITY } else { gap.at(x, y) };
            let expected = near(&patch.y, y) && patch.x.iter().any(|s| near(s, x));
            if value.is_finite() && (everywhere || expected) {
                candidates.push(gaps.len());
            }
            gaps.push(value);
            rows.push(gap.motion_row(x, y));
            bound
                .push(hardness * operator.axes[0].lumped_mass[i] * operator.axes[1].lumped_mass[j]);
        }
    }
    let share = if symmetry[0] { 0.5 } else { 1.0 } * if symmetry[1] { 0.5 } else { 1.0 };
    let fz = match problem.load {
        Load::Force { fz, .. } => fz,
        Load::Approach { .. } => 0.0,
    };
    let free = [
        gap.free_motion[0],
        gap.free_motion[1] && !symmetry[0],
        gap.free_motion[2] && !symmetry[1],
    ];
    let columns = Columns {
        first: [0, 0],
        count: [nx, ny],
        plane_width: nx,
    };
    let lumped = [0, 1].map(|axis| operator.axes[axis].lumped_mass.clone());
    let ice = ElasticBody::on_grid(operator, material, Side::Below, columns);
    ContactMesh {
        bodies: vec![ice],
        lumped,
        gap: gaps,
        rows,
        bound,
        candidates,
        motion: Motion {
            free,
            balance: [fz * share, 0.0, 0.0],
        },
    }
}
