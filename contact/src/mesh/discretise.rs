//! The mesh of a patch with a resolution.

use kufe_fem::{ElementKind, LowerLayer, TensorOperator};
use kufe_mesh::{HexMesh, TensorGrid};

use crate::bodies::elastic_body::{ElasticBody, fixed_faces};
use crate::bodies::runner_body::RunnerPlan;
use crate::bodies::solid_body::solid_body;
use crate::grid::grading::{
    Resolution, Start, Zone, below, graded_axis, increasing, part, put_node, storable, widened,
};
use crate::grid::patch::Patch;
use crate::grid::stretch::Stretch;
use crate::mesh::contact_mesh::ContactMesh;
use crate::motion::Motion;
use crate::precondition::planewise::{Columns, Side};
use crate::problem::check::{CheckedProblem, solid_material};
use crate::symmetry::image_count;
use crate::{Error, Foundation, Load};

/// Extent of the mesh and of its candidates of contact.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Reach {
    /// The mesh around the patch; candidates on and near it.
    Patch,
    /// The mesh under the whole hull, if that is bounded; every node under the hull is a candidate.
    /// It shows contact far from the patch, with coarse cells.
    WholeHull,
}

/// The mesh and what belongs to it.
pub(crate) struct Discretisation {
    /// Nodes of the ice, z = 0 on top.
    pub grid: TensorGrid,
    /// The contact problem on the mesh.
    pub contact: ContactMesh,
    /// Mirror planes x = 0 and y = 0 that were used.
    pub symmetry: [bool; 2],
    /// Hexahedra of an elastic runner.
    pub runner_mesh: Option<HexMesh>,
}

impl Discretisation {
    /// Number of layers of cells of an elastic bed, which are the lowest.
    pub fn bed_layers(&self) -> usize {
        let ice = self.contact.bodies[0].stiffness.grid();
        let layer = ice.and_then(TensorOperator::lower_layer);
        layer.map_or(0, |layer| layer.cells)
    }

    /// Unknowns.
    pub fn free_dofs(&self) -> usize {
        self.contact.bodies.iter().map(ElasticBody::free_dofs).sum()
    }

    /// Number of symmetric images of the modelled part, itself included.
    pub fn image_count(&self) -> f64 {
        image_count(self.symmetry)
    }
}

/// Ratio of the distance from the patch to the outer faces of a half-space to the patch's largest
/// half-length.
///
/// The faces have the displacements of the half-space under the contact forces, so the distance
/// only has to be large enough for the forces to be gathered into a few lumps.
const HALF_SPACE_REACH: f64 = 3.0;
/// Ratio of the distance from the patch to the sides to the thickness of the layers on the rigid
/// bed: exp(-pi 6 / 2) < 1e-4.
const LAYER_REACH: f64 = 6.0;

/// Ratio of the depth of even layers to the patch's smaller half-width: the stresses vary most
/// there.
const EVEN_DEPTH: f64 = 1.5;

/// Number of cells over half the patch for the bending of a runner in the search for the patch.
const SEARCH_CELLS: f64 = 4.0;

/// Input for a mesh.
struct MeshPlan<'a> {
    checked: &'a CheckedProblem<'a>,
    patch: &'a Patch,
    resolution: Resolution,
    reach: Reach,
}

impl CheckedProblem<'_> {
    /// Meshes the ice under the patch, and an elastic runner over it.
    pub fn mesh(
        &self,
        patch: &Patch,
        resolution: Resolution,
        reach: Reach,
    ) -> Result<Discretisation, Error> {
        MeshPlan {
            checked: self,
            patch,
            resolution,
            reach,
        }
        .mesh()
    }
}

impl MeshPlan<'_> {
    fn mesh(&self) -> Result<Discretisation, Error> {
        let symmetry = self.checked.gap.symmetry();
        let (z, lower) = self.layers()?;
        let grid = TensorGrid {
            x: self.line(&self.patch.x, 0)?,
            y: self.line(std::slice::from_ref(&self.patch.y), 1)?,
            z,
        };
        storable(grid.shape())?;
        let fixed = fixed_faces(symmetry, true, [true, false]);
        let mut operator = TensorOperator::new(&grid, self.checked.material, fixed);
        if let Some(layer) = lower {
            operator = operator.on_layer(layer);
        }
        if self.checked.problem.ice.element_kind() == ElementKind::Hex8Dilatation {
            operator = operator.with_mean_dilatation();
        }
        let mut contact = self.contact_mesh(&grid, operator)?;
        let mut runner_mesh = None;
        if let Some(elastic) = &self.checked.problem.runner.elastic {
            let (body, mesh) = match &elastic.solid {
                Some(solid) => (solid_body(solid, &grid), solid.mesh().clone()),
                None => RunnerPlan {
                    problem: self.checked.problem,
                    elastic,
                    ice: &grid,
                    symmetry,
                    spacing: self.narrowest() / self.resolution.cells,
                    growth: self.resolution.growth,
                    for_solving: self.reach == Reach::Patch,
                }
                .body()?,
            };
            contact.bodies.push(body);
            runner_mesh = Some(mesh);
        }
        Ok(Discretisation {
            grid,
            contact,
            symmetry,
            runner_mesh,
        })
    }

    /// Distance from the patch to the outer faces, along and across [m].
    fn margin(&self) -> f64 {
        match self.checked.problem.ice.foundation {
            Foundation::HalfSpace => self.depth(),
            Foundation::RigidBed { thickness } => LAYER_REACH * thickness,
            Foundation::ElasticBed { thickness, bed } => LAYER_REACH * (thickness + bed.thickness),
        }
    }

    /// Depth of the ice that is meshed [m].
    fn depth(&self) -> f64 {
        match self.checked.problem.ice.foundation {
            Foundation::HalfSpace => {
                let [x_low, x_high] = self.patch.span_x();
                HALF_SPACE_REACH * (0.5 * (x_high - x_low).max(2.0 * self.patch.y.half()))
            }
            Foundation::RigidBed { thickness } | Foundation::ElasticBed { thickness, .. } => {
                thickness
            }
        }
    }

    /// Half of the narrowest stretch of the patch [m].
    fn narrowest(&self) -> f64 {
        let halves = self.patch.x.iter().map(Stretch::half);
        halves.fold(self.patch.y.half(), f64::min)
    }

    /// Nodes along (axis 0) or across (axis 1), graded to these stretches.
    fn line(&self, stretches: &[Stretch], axis: usize) -> Result<Vec<f64>, Error> {
        let symmetric = self.checked.gap.symmetry()[axis];
        let extent = self.checked.problem.runner.underside.extent();
        // An elastic hull is meshed whole, with nodes at its ends and sides.
        let elastic = self.checked.problem.runner.elastic.as_ref();
        let on_columns = elastic.filter(|e| e.solid.is_none());
        let meshed = on_columns.is_some() && self.checked.problem.runner.is_bounded();
        let mut zones: Vec<Zone> = stretches
            .iter()
            .filter_map(|s| widened(s, symmetric, self.resolution))
            .collect();
        part(&mut zones);
        let (Some(first), Some(last)) = (stretches.first(), stretches.last()) else {
            return Err(Error::NoAnswer {
                name: "stretches of the hull near the ice",
                value: 0.0,
                expected: "1 or more",
            });
        };
        let (mut low, mut high) = (first.low - self.margin(), last.high + self.margin());
        let hull = [extent[2 * axis], extent[2 * axis + 1]];
        let bounded = hull.iter().all(|end| end.is_finite());
        if (meshed || self.reach == Reach::WholeHull) && bounded {
            let margin = 0.05 * (hull[1] - hull[0]);
            low = low.min(hull[0] - margin);
            high = high.max(hull[1] + margin);
        }
        let start = if symmetric {
            Start::At(0.0)
        } else {
            Start::AtOrBelow(low)
        };
        let mut nodes = graded_axis(start, high, &zones, self.resolution.growth)?;
        // Contact up to the ends of a runner needs nodes there.
        if elastic.is_some() && bounded {
            hull.iter().for_each(|&end| put_node(&mut nodes, end));
        }
        if let Some(elastic) = on_columns.filter(|_| meshed && axis == 0) {
            let cells = match self.reach {
                Reach::Patch => self.resolution.cells,
                Reach::WholeHull => SEARCH_CELLS,
            };
            elastic.mount.refine(&mut nodes, hull, cells);
        }
        increasing(nodes)
    }

    /// Nodes of the ice and of an elastic bed under it along z, and that bed.
    fn layers(&self) -> Result<(Vec<f64>, Option<LowerLayer>), Error> {
        let (narrowest, depth) = (self.narrowest(), self.depth());
        // Under a contact that is wider than the thickness of the ice, layers are refined with the
        // cells; the coarsest mesh has four.
        let spacing = narrowest.min(0.75 * depth) / self.resolution.cells;
        let even_depth = spacing * (EVEN_DEPTH * narrowest / spacing - 1e-6).ceil();
        let mut layers = Stretch::even(-even_depth.min(depth), 0.0);
        // Under a ridge along the runner they vary as much over a depth of its own width.
        let finest = self.patch.y.finest();
        layers.refine_over([-EVEN_DEPTH * narrowest * finest, 0.0], finest);
        let zone = Zone {
            stretch: layers,
            spacing,
        };
        let growth = self.resolution.growth;
        let mut z = graded_axis(Start::AtOrBelow(-depth), 0.0, &[zone], growth)?;
        if self.checked.problem.ice.foundation != Foundation::HalfSpace {
            let scale = -depth / z[0];
            z.iter_mut().for_each(|z| *z *= scale);
        }
        let Foundation::ElasticBed { bed, .. } = self.checked.problem.ice.foundation else {
            return Ok((z, None));
        };
        let below = below(&z, bed.thickness, growth)?;
        let (modulus, ratio) = (bed.youngs_modulus, bed.poissons_ratio);
        let lower = LowerLayer {
            cells: below.len(),
            material: solid_material("Young's modulus of the bed", modulus, ratio)?,
        };
        z.splice(0..0, below);
        Ok((increasing(z)?, Some(lower)))
    }

    /// The ice alone, with the gap, the bounds of forces and the load on the contact plane.
    fn contact_mesh(
        &self,
        grid: &TensorGrid,
        operator: TensorOperator,
    ) -> Result<ContactMesh, Error> {
        let CheckedProblem { problem, gap, .. } = self.checked;
        let symmetry = gap.symmetry();
        let [nx, ny, _] = grid.shape();
        let mut gaps = Vec::with_capacity(nx * ny);
        let mut rows = Vec::with_capacity(nx * ny);
        let mut bound = Vec::with_capacity(nx * ny);
        let mut candidates = Vec::new();
        let hardness = problem.ice.hardness.unwrap_or(f64::INFINITY);
        // On a large plane only the expected contact has candidates, to limit the cost.
        let everywhere = self.reach == Reach::WholeHull && nx * ny <= 1500;
        for j in 0..ny {
            for i in 0..nx {
                let (x, y) = (grid.x[i], grid.y[j]);
                let outer = i + 1 == nx
                    || j + 1 == ny
                    || (i == 0 && !symmetry[0])
                    || (j == 0 && !symmetry[1]);
                let value = if outer { f64::INFINITY } else { gap.at(x, y) };
                if value.is_nan() || value == f64::NEG_INFINITY {
                    return Err(Error::out_of_range(
                        "height of the hull over the ice",
                        value,
                        "a number of m, or infinity where there is no hull",
                    ));
                }
                if value.is_finite() && (everywhere || expected(self.patch, x, y)) {
                    candidates.push(gaps.len());
                }
                gaps.push(value);
                rows.push(gap.motion_row(x, y));
                bound.push(
                    hardness * operator.axes[0].lumped_mass[i] * operator.axes[1].lumped_mass[j],
                );
            }
        }
        let share = symmetry.map(|s| if s { 0.5 } else { 1.0 });
        let fz = match problem.load {
            Load::Force { fz, .. } => fz,
            Load::Approach { .. } => 0.0,
        };
        let free = [
            gap.free_motion[0],
            gap.free_motion[1] && !symmetry[0],
            gap.free_motion[2] && !symmetry[1],
        ];
        let columns = Columns::of_plane([nx, ny]);
        let lumped = [0, 1].map(|axis| operator.axes[axis].lumped_mass.clone());
        let ice = ElasticBody::on_grid(operator, Side::Below, columns);
        Ok(ContactMesh {
            bodies: vec![ice],
            lumped,
            gap: gaps,
            rows,
            bound,
            candidates,
            motion: Motion {
                free,
                balance: [fz * (share[0] * share[1]), 0.0, 0.0],
            },
        })
    }
}

/// Whether contact is expected at (x, y): on the patch and near it.
pub(crate) fn expected(patch: &Patch, x: f64, y: f64) -> bool {
    let near = |stretch: &Stretch, at: f64| {
        let margin = 0.7 * stretch.half();
        (stretch.low - margin..=stretch.high + margin).contains(&at)
    };
    near(&patch.y, y) && patch.x.iter().any(|stretch| near(stretch, x))
}
