//! A case as an input deck of CalculiX (www.calculix.de; the cards are Abaqus's), on the mesh that
//! it is solved on.
//!
//! In millimetres, newtons and megapascals: CalculiX searches contacts within absolute lengths, and
//! in metres it finds none.

use std::io::{BufWriter, Write};
use std::path::Path;

use kufe_contact::{
    ElasticRunner, Foundation, Load, Mount, Options, Problem, Solution, SurfaceField, Tilt,
    runner_loads, solve,
};
use kufe_mesh::{HexMesh, TensorGrid};
use serde::Serialize;

use crate::jobs::case_file::{LoadedCase, around};
use crate::jobs::failure::Failure;
use crate::results::RunnerResult;

/// A solved case that can be written as a deck.
pub struct CalculixDeck<'a> {
    loaded: &'a LoadedCase,
    problem: Problem,
    solution: Solution,
}

/// The contents of a deck, and the contact on its mesh.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct DeckResult {
    /// The deck's file.
    pub deck: String,
    /// Peak pressure [Pa].
    pub p_max_pa: f64,
    /// Error of the peak pressure [Pa].
    pub p_max_error_pa: f64,
    /// Integrated normal force [N].
    pub fz_n: f64,
    /// Approach [m].
    pub approach_m: f64,
    /// Whether x = 0 and y = 0 are mirror planes.
    pub symmetry: [bool; 2],
    /// Number of unknowns.
    pub dofs: usize,
    /// Number of iterations.
    pub iterations: usize,
    /// Stress of the runner and the loads on its mount.
    #[serde(flatten)]
    pub runner: Option<RunnerResult>,
}

impl<'a> CalculixDeck<'a> {
    /// Solves a case with a level elastic runner, mounted at its top or at places, on ice on a
    /// rigid bed. `cells` is the number of cells across half the patch; `None` refines to the
    /// case's accuracy.
    ///
    /// # Errors
    /// Those of the solver, and [`Failure::BadInput`] for a problem that cannot be exported.
    pub fn solve(loaded: &'a LoadedCase, cells: Option<usize>) -> Result<Self, Failure> {
        let (problem, _) = loaded.stated()?;
        loaded.valid(check_exportable(&problem))?;
        let options = Options {
            cells,
            ..loaded.case.options()
        };
        let solution = loaded.solved(solve(&problem, &options))?;
        Ok(CalculixDeck {
            loaded,
            problem,
            solution,
        })
    }

    /// Writes the deck: nodes, elements (C3D8 for the ice; C3D8I, with incompatible modes for
    /// bending, for a runner that is mounted at places), materials, supports, frictionless mortar
    /// contact of the faces near each other, and one step. The step presses the mount down by the
    /// approach and prints the forces on mount and bed and the contact pressures.
    ///
    /// The deck ends with the pressures that kufe computed as comments, one line per node of the
    /// underside in contact: `** node, MPa`.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, writer: impl Write) -> std::io::Result<()> {
        let solution = &self.solution;
        let (Some(volume), Some(field), Some(elastic)) = (
            &solution.volume,
            &solution.runner_volume,
            &self.problem.runner.elastic,
        ) else {
            unreachable!("the runner of a problem that can be exported is elastic");
        };
        let ice_mesh = volume.grid.hex_mesh();
        let bodies = Bodies {
            problem: &self.problem,
            solution,
            elastic,
            grid: &volume.grid,
            offset: ice_mesh.points.len(),
            ice: ice_mesh,
            runner: &field.mesh,
        };
        let name = self.loaded.name.replace(char::is_control, " ");
        let mut out = BufWriter::new(writer);
        writeln!(
            out,
            "*HEADING\n{name}, by kufe {}",
            env!("CARGO_PKG_VERSION")
        )?;
        bodies.write_meshes(&mut out)?;
        bodies.write_materials(&mut out)?;
        bodies.write_supports(&mut out)?;
        bodies.write_contact(&mut out)?;
        bodies.write_step(&mut out)?;
        bodies.write_pressures(&mut out)?;
        out.flush()
    }

    /// The contact on the deck's mesh; `path` is the deck's file.
    ///
    /// # Errors
    /// Those of the loads on the mount.
    pub fn result(&self, path: &Path) -> Result<DeckResult, Failure> {
        let solution = &self.solution;
        let loads = self.loaded.solved(runner_loads(&self.problem, solution))?;
        Ok(DeckResult {
            deck: path.display().to_string(),
            p_max_pa: solution.p_max,
            p_max_error_pa: solution.p_max_error,
            fz_n: solution.fz,
            approach_m: solution.approach,
            symmetry: solution.symmetry,
            dofs: solution.dofs,
            iterations: solution.iterations,
            runner: loads.as_ref().map(RunnerResult::from),
        })
    }
}

/// The bodies of a deck. Nodes and elements of the runner follow those of the ice.
struct Bodies<'a> {
    problem: &'a Problem,
    solution: &'a Solution,
    elastic: &'a ElasticRunner,
    grid: &'a TensorGrid,
    ice: HexMesh,
    runner: &'a HexMesh,
    /// Number of nodes of the ice.
    offset: usize,
}

impl Bodies<'_> {
    /// Whether the runner is mounted at places, and so bends.
    fn bends(&self) -> bool {
        self.elastic.mount != Mount::Top
    }

    /// Axis normal to each mirror plane, and the name of its node set.
    fn mirrors(&self) -> impl Iterator<Item = (usize, &'static str)> {
        let symmetry = self.solution.symmetry;
        let planes = [(0, "MIRROR_X"), (1, "MIRROR_Y")].into_iter();
        planes.filter(move |(axis, _)| symmetry[*axis])
    }

    fn write_meshes(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (ice, runner) = (&self.ice, self.runner);
        writeln!(out, "*NODE, NSET=ALL")?;
        for (node, [x, y, z]) in ice.points.iter().chain(&runner.points).enumerate() {
            let [x, y, z] = [x, y, z].map(|v| MM * v);
            writeln!(out, "{}, {x:.12e}, {y:.12e}, {z:.12e}", node + 1)?;
        }
        let kind = if self.bends() { "C3D8I" } else { "C3D8" };
        let parts = [
            (ice, "C3D8", "ICE", 0, 0),
            (runner, kind, "RUNNER", self.offset, ice.cells.len()),
        ];
        for (mesh, kind, name, first_node, first_cell) in parts {
            writeln!(out, "*ELEMENT, TYPE={kind}, ELSET={name}")?;
            for (cell, nodes) in mesh.cells.iter().enumerate() {
                write!(out, "{}", first_cell + cell + 1)?;
                for node in nodes {
                    write!(out, ", {}", first_node + node + 1)?;
                }
                writeln!(out)?;
            }
        }
        Ok(())
    }

    fn write_materials(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (ice, steel) = (&self.problem.ice, self.elastic);
        for (name, youngs_modulus, poissons_ratio) in [
            ("ICE", ice.youngs_modulus, ice.poissons_ratio),
            ("RUNNER", steel.youngs_modulus, steel.poissons_ratio),
        ] {
            writeln!(out, "*MATERIAL, NAME={name}\n*ELASTIC")?;
            writeln!(out, "{:e}, {poissons_ratio}", MPA * youngs_modulus)?;
            writeln!(out, "*SOLID SECTION, ELSET={name}, MATERIAL={name}")?;
        }
        Ok(())
    }

    /// Writes the node sets of the bed, the mount and the mirror planes.
    fn write_supports(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (offset, runner, symmetry) = (self.offset, self.runner, self.solution.symmetry);
        let [nx, ny, _] = self.grid.shape();
        let fixed = |&node: &usize| {
            let [i, j, k] = [node % nx, node / nx % ny, node / nx / ny];
            k == 0
                || i == nx - 1
                || j == ny - 1
                || (i == 0 && !symmetry[0])
                || (j == 0 && !symmetry[1])
        };
        node_set(out, "BED", (0..offset).filter(fixed))?;
        let heights = runner.points.iter().map(|p| p[2]);
        let top = heights.fold(f64::NEG_INFINITY, f64::max);
        let on_mount = |&node: &usize| {
            let [x, _, z] = runner.points[node];
            z > top - 1e-9 && (!self.bends() || self.elastic.mount.over(x))
        };
        let mounted = (0..runner.points.len()).filter(on_mount);
        node_set(out, "MOUNT", mounted.map(|node| offset + node))?;
        for (axis, name) in self.mirrors() {
            let points = self.ice.points.iter().chain(&runner.points).enumerate();
            let on_plane = points.filter(|(_, p)| p[axis] == 0.0);
            node_set(out, name, on_plane.map(|(node, _)| node))?;
        }
        Ok(())
    }

    /// Writes the two surfaces where the bodies are near each other, and their contact pair.
    fn write_contact(&self, out: &mut impl Write) -> std::io::Result<()> {
        let (ice, runner) = (&self.ice, self.runner);
        let [nx, ny, nz] = self.grid.shape();
        let near = NEAR * self.solution.approach;
        writeln!(out, "*SURFACE, NAME=UNDERSIDE, TYPE=ELEMENT")?;
        let lowest = runner.cells.iter().take(lowest_layer(runner));
        for (cell, nodes) in lowest.enumerate() {
            if nodes[..4].iter().any(|&n| runner.points[n][2] < near) {
                writeln!(out, "{}, S1", ice.cells.len() + cell + 1)?;
            }
        }
        writeln!(out, "*SURFACE, NAME=SURFACE_OF_ICE, TYPE=ELEMENT")?;
        let near_points = runner.points.iter().filter(|p| p[2] < near);
        let [x0, x1, y0, y1] = around(near_points.map(|p| [p[0], p[1]]));
        let below_top = (nz - 2) * (nx - 1) * (ny - 1);
        for (cell, nodes) in ice.cells.iter().enumerate().skip(below_top) {
            let (from, to) = (ice.points[nodes[4]], ice.points[nodes[6]]);
            if to[0] >= x0 && from[0] <= x1 && to[1] >= y0 && from[1] <= y1 {
                writeln!(out, "{}, S2", cell + 1)?;
            }
        }
        writeln!(out, "*SURFACE INTERACTION, NAME=TOUCH")?;
        writeln!(out, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR")?;
        let half_width = 0.5 * self.solution.width;
        let stiffness = PENALTY * MPA * self.problem.ice.youngs_modulus / (MM * half_width);
        writeln!(out, "{stiffness:e}")?;
        writeln!(out, "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=MORTAR")?;
        writeln!(out, "UNDERSIDE, SURFACE_OF_ICE")
    }

    fn write_step(&self, out: &mut impl Write) -> std::io::Result<()> {
        writeln!(out, "*STEP, INC=100\n*STATIC\n1., 1.")?;
        writeln!(out, "*BOUNDARY\nBED, 1, 3")?;
        for (axis, name) in self.mirrors() {
            writeln!(out, "{name}, {0}, {0}", axis + 1)?;
        }
        let down = -MM * self.solution.approach;
        writeln!(out, "MOUNT, 1, 2\nMOUNT, 3, 3, {down:.12e}")?;
        for name in ["MOUNT", "BED"] {
            writeln!(out, "*NODE PRINT, NSET={name}, TOTALS=ONLY\nRF")?;
        }
        writeln!(out, "*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR")?;
        writeln!(out, "*END STEP")
    }

    /// Writes the pressures that kufe computed as comments. The nodes of the underside are the
    /// first of the runner's mesh and lie on the columns of the surface's grid.
    fn write_pressures(&self, out: &mut impl Write) -> std::io::Result<()> {
        writeln!(out, "** contact pressures by kufe: node, MPa")?;
        let SurfaceField { x, y, pressure, .. } = &self.solution.surface;
        let underside = self.runner.cells[0][4];
        for (node, point) in self.runner.points.iter().take(underside).enumerate() {
            let i = x.partition_point(|x| *x < point[0]);
            let j = y.partition_point(|y| *y < point[1]);
            let value = pressure[j * x.len() + i];
            if value > 0.0 {
                writeln!(out, "** {}, {:.9e}", self.offset + node + 1, MPA * value)?;
            }
        }
        Ok(())
    }
}

/// Checks that a problem can be exported; the error names the key and what was expected.
fn check_exportable(problem: &Problem) -> Result<(), &'static str> {
    let Some(elastic) = &problem.runner.elastic else {
        return Err("runner.elastic: expected true: the deck has two bodies");
    };
    let extent = problem.runner.underside.extent();
    let is_level = matches!(problem.load, Load::Force { tilt, .. } if tilt == Tilt::LEVEL);
    let reason = if elastic.solid.is_some() {
        "runner.mesh: expected a shape or a hull: the deck needs the runner's structured mesh"
    } else if extent.iter().any(|end| end.is_infinite()) {
        "runner.shape: expected a runner with ends"
    } else if matches!(elastic.mount, Mount::Loads(_)) {
        "runner.mount: expected held places, or the whole top"
    } else if !matches!(problem.ice.foundation, Foundation::RigidBed { .. }) {
        "ice.thickness_m: expected a layer on a rigid bed"
    } else if problem.ice.hardness.is_some() {
        "ice.hardness_pa: expected elastic ice"
    } else if problem.track_curvature != 0.0 {
        "track: expected a flat one"
    } else if !is_level {
        "load.tilt: expected \"fixed\" with no pitch and no roll"
    } else {
        return Ok(());
    };
    Err(reason)
}

/// Penalty stiffness of the contact in units of E / (half width of the contact), in which the ice
/// itself has about 1. CalculiX's hard contact is far softer.
const PENALTY: f64 = 1e4;
/// Height of a face's lowest node above the ice, relative to the approach, below which the face is
/// part of the contact surface.
const NEAR: f64 = 30.0;
/// Millimetres in a metre.
const MM: f64 = 1e3;
/// Megapascals in a pascal.
const MPA: f64 = 1e-6;

/// Number of cells of the lowest layer: cells are numbered layer by layer.
fn lowest_layer(mesh: &HexMesh) -> usize {
    let first_above = mesh.cells[0][4];
    let inside = |cell: &&[usize; 8]| cell[0] < first_above;
    mesh.cells.iter().take_while(inside).count()
}

fn node_set(
    out: &mut impl Write,
    name: &str,
    nodes: impl Iterator<Item = usize>,
) -> std::io::Result<()> {
    writeln!(out, "*NSET, NSET={name}")?;
    for node in nodes {
        writeln!(out, "{},", node + 1)?;
    }
    Ok(())
}
