//! A case as an input deck of CalculiX (www.calculix.de; the cards are Abaqus's), on the mesh that
//! it is solved on.
//!
//! In millimetres, newtons and megapascals: CalculiX searches contacts within absolute lengths, and
//! in metres it finds none.

use std::io::{BufWriter, Write};
use std::path::Path;

use kufe_contact::{
    Foundation, Load, Mount, Options, Problem, Solution, SurfaceField, Tilt, runner_loads, solve,
};
use kufe_mesh::HexMesh;
use serde::Serialize;

use crate::jobs::case_file::{LoadedCase, around};
use crate::jobs::failure::Failure;
use crate::results::RunnerResult;

/// A solved case that a deck can state.
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
    /// Its error [Pa].
    pub p_max_error_pa: f64,
    /// Integrated normal force [N].
    pub fz_n: f64,
    /// Approach [m].
    pub approach_m: f64,
    /// Mirror planes: y = 0 and x = 0.
    pub symmetry: [bool; 2],
    /// Unknowns.
    pub dofs: usize,
    /// Iterations.
    pub iterations: usize,
    /// Stress of the runner and the loads on its mount.
    #[serde(flatten)]
    pub runner: Option<RunnerResult>,
}

impl<'a> CalculixDeck<'a> {
    /// Solves a case with an elastic runner, mounted at its top or at places, level, on ice on a
    /// rigid bed; with `cells` across half the patch, else to the accuracy that the case requests.
    ///
    /// # Errors
    /// Those of the solver, and [`Failure::BadInput`] for a problem that the deck cannot state.
    pub fn solve(loaded: &'a LoadedCase, cells: Option<usize>) -> Result<Self, Failure> {
        let (problem, _) = loaded.stated()?;
        loaded.valid(check_statable(&problem))?;
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

    /// Writes the deck: nodes, elements (C3D8 for the ice; C3D8I, which bends, for a runner that is
    /// mounted at places), materials, supports, the contact of the faces near each other by
    /// CalculiX's mortar method without friction, and one step that presses the mount down by the
    /// approach and prints the forces on mount and bed and the contact's pressures.
    ///
    /// It ends with kufe's own pressures as comments, a line for each node of the underside in
    /// contact: `** node, MPa`.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, writer: impl Write) -> std::io::Result<()> {
        let (problem, solution) = (&self.problem, &self.solution);
        let (ice, steel) = (&solution.volume, &solution.runner_volume);
        let (Some(volume), Some(field), Some(elastic)) = (ice, steel, &problem.runner.elastic)
        else {
            unreachable!("the runner of a problem that a deck can state is elastic");
        };
        let (grid, runner) = (&volume.grid, &field.mesh);
        let (symmetry, approach) = (solution.symmetry, solution.approach);
        let half_width = 0.5 * solution.width;
        let ice = [problem.ice.youngs_modulus, problem.ice.poissons_ratio];
        let steel = [elastic.youngs_modulus, elastic.poissons_ratio];
        let materials = [("ICE", ice), ("RUNNER", steel)];
        let name = self.loaded.name.replace(char::is_control, " ");
        let title = format!("{name}, by kufe {}", env!("CARGO_PKG_VERSION"));
        let mut out = BufWriter::new(writer);
        let ice = grid.hex_mesh();
        let [nx, ny, nz] = grid.shape();
        let offset = ice.points.len();
        writeln!(out, "*HEADING\n{}", title)?;
        writeln!(out, "*NODE, NSET=ALL")?;
        for (node, [x, y, z]) in ice.points.iter().chain(&runner.points).enumerate() {
            let [x, y, z] = [x, y, z].map(|v| MM * v);
            writeln!(out, "{}, {x:.12e}, {y:.12e}, {z:.12e}", node + 1)?;
        }
        let bends = elastic.mount != Mount::Top;
        let kind = if bends { "C3D8I" } else { "C3D8" };
        let parts = [
            (&ice, "C3D8", "ICE", 0, 0),
            (runner, kind, "RUNNER", offset, ice.cells.len()),
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
        for (name, [youngs_modulus, poissons_ratio]) in materials {
            writeln!(out, "*MATERIAL, NAME={name}\n*ELASTIC")?;
            writeln!(out, "{:e}, {poissons_ratio}", MPA * youngs_modulus)?;
            writeln!(out, "*SOLID SECTION, ELSET={name}, MATERIAL={name}")?;
        }
        let of_ice = |node: usize| [node % nx, node / nx % ny, node / nx / ny];
        let fixed = |&node: &usize| {
            let [i, j, k] = of_ice(node);
            k == 0
                || i == nx - 1
                || j == ny - 1
                || (i == 0 && !symmetry[0])
                || (j == 0 && !symmetry[1])
        };
        node_set(&mut out, "BED", (0..offset).filter(fixed))?;
        let heights = runner.points.iter().map(|p| p[2]);
        let top = heights.fold(f64::NEG_INFINITY, f64::max);
        let on_mount = |&node: &usize| {
            let [x, _, z] = runner.points[node];
            z > top - 1e-9 && (!bends || elastic.mount.over(x))
        };
        let mounted = (0..runner.points.len()).filter(on_mount);
        node_set(&mut out, "MOUNT", mounted.map(|node| offset + node))?;
        let points = || ice.points.iter().chain(&runner.points).enumerate();
        for (axis, name) in [(0, "MIRROR_X"), (1, "MIRROR_Y")] {
            if symmetry[axis] {
                let on_plane = points().filter(|(_, p)| p[axis] == 0.0);
                node_set(&mut out, name, on_plane.map(|(node, _)| node))?;
            }
        }
        let near = |nodes: &[usize; 4]| {
            let lowest = nodes.iter().map(|&n| runner.points[n][2]);
            lowest.fold(f64::INFINITY, f64::min) < NEAR * approach
        };
        let cells = runner.cells.iter().enumerate();
        let bottom = |c: &[usize; 8]| [c[0], c[1], c[2], c[3]];
        let plane = lowest_layer(runner);
        let under = cells.filter(|(cell, c)| *cell < plane && near(&bottom(c)));
        let per_layer = (nx - 1) * (ny - 1);
        writeln!(out, "*SURFACE, NAME=UNDERSIDE, TYPE=ELEMENT")?;
        for (cell, _) in under {
            writeln!(out, "{}, S1", ice.cells.len() + cell + 1)?;
        }
        writeln!(out, "*SURFACE, NAME=SURFACE_OF_ICE, TYPE=ELEMENT")?;
        let low = runner.points.iter().filter(|p| p[2] < NEAR * approach);
        let [x0, x1, y0, y1] = around(low.map(|p| [p[0], p[1]]));
        for (cell, c) in ice.cells.iter().enumerate().skip((nz - 2) * per_layer) {
            let (low, high) = (ice.points[c[4]], ice.points[c[6]]);
            if high[0] >= x0 && low[0] <= x1 && high[1] >= y0 && low[1] <= y1 {
                writeln!(out, "{}, S2", cell + 1)?;
            }
        }
        writeln!(out, "*SURFACE INTERACTION, NAME=TOUCH")?;
        writeln!(out, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR")?;
        let stiffness = PENALTY * MPA * problem.ice.youngs_modulus / (MM * half_width);
        writeln!(out, "{stiffness:e}")?;
        writeln!(out, "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=MORTAR")?;
        writeln!(out, "UNDERSIDE, SURFACE_OF_ICE")?;
        writeln!(out, "*STEP, INC=100\n*STATIC\n1., 1.")?;
        writeln!(out, "*BOUNDARY\nBED, 1, 3")?;
        for (axis, name) in [(0, "MIRROR_X"), (1, "MIRROR_Y")] {
            if symmetry[axis] {
                writeln!(out, "{name}, {0}, {0}", axis + 1)?;
            }
        }
        let down = -MM * approach;
        writeln!(out, "MOUNT, 1, 2\nMOUNT, 3, 3, {down:.12e}")?;
        for name in ["MOUNT", "BED"] {
            writeln!(out, "*NODE PRINT, NSET={name}, TOTALS=ONLY\nRF")?;
        }
        writeln!(out, "*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR")?;
        writeln!(out, "*END STEP")?;
        own_pressures(&mut out, runner, &solution.surface, offset)?;
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

/// Why a deck cannot state a problem.
fn check_statable(problem: &Problem) -> Result<(), &'static str> {
    let Some(elastic) = &problem.runner.elastic else {
        return Err("runner.elastic: expected true: the deck has two bodies");
    };
    let extent = problem.runner.underside.extent();
    let is_level = matches!(problem.load, Load::Force { tilt, .. } if tilt == Tilt::LEVEL);
    let reason = if elastic.solid.is_some() {
        "runner.mesh: expected a shape or a hull: the deck takes the hexahedra on the ice's columns"
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

/// Stiffness of the contact over E / half width, of which the ice's own is about 1. CalculiX's hard
/// contact is far softer.
const PENALTY: f64 = 1e4;
/// Faces may touch whose lowest node is less than this many approaches above the ice.
const NEAR: f64 = 30.0;
/// Millimetres in a metre.
const MM: f64 = 1e3;
/// Megapascals in a pascal.
const MPA: f64 = 1e-6;

/// kufe's pressures as comments; the underside's nodes are the mesh's first, in the surface's
/// columns.
fn own_pressures(
    out: &mut impl Write,
    runner: &HexMesh,
    surface: &SurfaceField,
    offset: usize,
) -> std::io::Result<()> {
    writeln!(out, "** contact pressures by kufe: node, MPa")?;
    let SurfaceField { x, y, pressure, .. } = surface;
    let underside = runner.cells[0][4];
    for (node, point) in runner.points.iter().take(underside).enumerate() {
        let i = x.partition_point(|x| *x < point[0]);
        let j = y.partition_point(|y| *y < point[1]);
        let value = pressure[j * x.len() + i];
        if value > 0.0 {
            writeln!(out, "** {}, {:.9e}", offset + node + 1, MPA * value)?;
        }
    }
    Ok(())
}

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
