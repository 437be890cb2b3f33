//! A two-body contact problem as an input deck of CalculiX (www.calculix.de; the cards are
//! Abaqus's).
//!
//! In millimetres, newtons and megapascals: CalculiX searches contacts within absolute lengths, and
//! in metres it finds none.

use std::io::{BufWriter, Write};

use kufe_contact::{Mount, SurfaceField};
use kufe_mesh::{HexMesh, TensorGrid};

/// What a deck states; here lengths in m, moduli in Pa.
pub(super) struct Deck<'a> {
    /// First line of the heading.
    pub title: String,
    /// The ice, top at z = 0; its lower face and its sides that are no mirror planes are fixed.
    pub grid: &'a TensorGrid,
    /// Young's modulus and Poisson's ratio of the ice.
    pub ice: [f64; 2],
    /// The runner, where it first touches.
    pub runner: &'a HexMesh,
    /// Young's modulus and Poisson's ratio of the runner.
    pub steel: [f64; 2],
    /// The mount of the runner's top.
    pub mount: &'a Mount,
    /// Mirror planes x = 0 and y = 0.
    pub symmetry: [bool; 2],
    /// How far the mount is pressed down.
    pub approach: f64,
    /// Half width of the contact, for the stiffness of the contact.
    pub half_width: f64,
    /// kufe's pressures over the ice's surface, for comparison.
    pub surface: &'a SurfaceField,
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

/// Writes the deck: nodes, elements (C3D8 for the ice; C3D8I, which bends, for a runner that is
/// mounted at places), materials, supports, the contact of the faces near each other by CalculiX's
/// mortar method without friction, and one step that presses the mount down by the approach and
/// prints the forces on mount and bed and the contact's pressures.
///
/// It ends with kufe's own pressures as comments, a line for each node of the underside in contact:
/// `** node, MPa`.
///
/// # Errors
/// The writer's own.
pub(super) fn write_deck(deck: &Deck, writer: impl Write) -> std::io::Result<()> {
    let mut out = BufWriter::new(writer);
    let ice = deck.grid.hex_mesh();
    let [nx, ny, nz] = deck.grid.shape();
    let offset = ice.points.len();
    writeln!(out, "*HEADING\n{}", deck.title)?;
    writeln!(out, "*NODE, NSET=ALL")?;
    for (node, [x, y, z]) in ice.points.iter().chain(&deck.runner.points).enumerate() {
        let [x, y, z] = [x, y, z].map(|v| MM * v);
        writeln!(out, "{}, {x:.12e}, {y:.12e}, {z:.12e}", node + 1)?;
    }
    let bends = *deck.mount != Mount::Top;
    let kind = if bends { "C3D8I" } else { "C3D8" };
    let parts = [
        (&ice, "C3D8", "ICE", 0, 0),
        (deck.runner, kind, "RUNNER", offset, ice.cells.len()),
    ];
    for (mesh, kind, name, first_node, first_cell) in parts {
        writeln!(out, "*ELEMENT, TYPE={kind}, ELSET={name}")?;
        for (cell, nodes) in mesh.cells.iter().enumerate() {
            write!(out, "{}", first_cell + cell + 1)?;
            nodes
                .iter()
                .try_for_each(|node| write!(out, ", {}", first_node + node + 1))?;
            writeln!(out)?;
        }
    }
    for (name, [youngs_modulus, poissons_ratio]) in [("ICE", deck.ice), ("RUNNER", deck.steel)] {
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
            || (i == 0 && !deck.symmetry[0])
            || (j == 0 && !deck.symmetry[1])
    };
    node_set(&mut out, "BED", (0..offset).filter(fixed))?;
    let top = deck
        .runner
        .points
        .iter()
        .map(|p| p[2])
        .fold(f64::NEG_INFINITY, f64::max);
    let on_mount = |&node: &usize| {
        let [x, _, z] = deck.runner.points[node];
        z > top - 1e-9 && (!bends || deck.mount.over(x))
    };
    let mounted = (0..deck.runner.points.len()).filter(on_mount);
    node_set(&mut out, "MOUNT", mounted.map(|node| offset + node))?;
    let points = || ice.points.iter().chain(&deck.runner.points).enumerate();
    for (axis, name) in [(0, "MIRROR_X"), (1, "MIRROR_Y")] {
        if deck.symmetry[axis] {
            let on_plane = points().filter(|(_, p)| p[axis] == 0.0);
            node_set(&mut out, name, on_plane.map(|(node, _)| node))?;
        }
    }
    let near = |nodes: &[usize; 4]| {
        let lowest = nodes.iter().map(|&n| deck.runner.points[n][2]);
        lowest.fold(f64::INFINITY, f64::min) < NEAR * deck.approach
    };
    let cells = deck.runner.cells.iter().enumerate();
    let bottom = |c: &[usize; 8]| [c[0], c[1], c[2], c[3]];
    let plane = lowest_layer(deck.runner);
    let under: Vec<usize> = cells
        .filter(|(cell, c)| *cell < plane && near(&bottom(c)))
        .map(|(cell, _)| ice.cells.len() + cell + 1)
        .collect();
    let per_layer = (nx - 1) * (ny - 1);
    writeln!(out, "*SURFACE, NAME=UNDERSIDE, TYPE=ELEMENT")?;
    under
        .iter()
        .try_for_each(|cell| writeln!(out, "{cell}, S1"))?;
    writeln!(out, "*SURFACE, NAME=SURFACE_OF_ICE, TYPE=ELEMENT")?;
    let reach = deck.runner.points.iter().fold(
        [
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ],
        |r, p| {
            if p[2] < NEAR * deck.approach {
                [
                    r[0].min(p[0]),
                    r[1].max(p[0]),
                    r[2].min(p[1]),
                    r[3].max(p[1]),
                ]
            } else {
                r
            }
        },
    );
    for (cell, c) in ice.cells.iter().enumerate().skip((nz - 2) * per_layer) {
        let (low, high) = (ice.points[c[4]], ice.points[c[6]]);
        if high[0] >= reach[0] && low[0] <= reach[1] && high[1] >= reach[2] && low[1] <= reach[3] {
            writeln!(out, "{}, S2", cell + 1)?;
        }
    }
    writeln!(out, "*SURFACE INTERACTION, NAME=TOUCH")?;
    writeln!(out, "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR")?;
    let stiffness = PENALTY * MPA * deck.ice[0] / (MM * deck.half_width);
    writeln!(out, "{stiffness:e}")?;
    writeln!(out, "*CONTACT PAIR, INTERACTION=TOUCH, TYPE=MORTAR")?;
    writeln!(out, "UNDERSIDE, SURFACE_OF_ICE")?;
    writeln!(out, "*STEP, INC=100\n*STATIC\n1., 1.")?;
    writeln!(out, "*BOUNDARY\nBED, 1, 3")?;
    for (axis, name) in [(0, "MIRROR_X"), (1, "MIRROR_Y")] {
        if deck.symmetry[axis] {
            writeln!(out, "{name}, {0}, {0}", axis + 1)?;
        }
    }
    writeln!(
        out,
        "MOUNT, 1, 2\nMOUNT, 3, 3, {:.12e}",
        -MM * deck.approach
    )?;
    for name in ["MOUNT", "BED"] {
        writeln!(out, "*NODE PRINT, NSET={name}, TOTALS=ONLY\nRF")?;
    }
    writeln!(out, "*NODE FILE\nU\n*CONTACT FILE\nCDIS, CSTR")?;
    writeln!(out, "*END STEP")?;
    own_pressures(&mut out, deck, offset)?;
    out.flush()
}

/// kufe's pressures as comments; the underside's nodes are the mesh's first, in the surface's
/// columns.
fn own_pressures(out: &mut impl Write, deck: &Deck, offset: usize) -> std::io::Result<()> {
    writeln!(out, "** contact pressures by kufe: node, MPa")?;
    let SurfaceField { x, y, pressure, .. } = deck.surface;
    let underside = deck.runner.cells[0][4];
    for (node, point) in deck.runner.points.iter().take(underside).enumerate() {
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
