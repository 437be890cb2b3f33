//! `stress.png`: the von Mises stress of an elastic runner in the sections through its largest
//! value.

use kufe_contact::{RunnerField, RunnerLoads};
use kufe_mesh::HexMesh;

use crate::jobs::field::maps::GROUND;
use crate::plot::{
    Axis, Cells, ColourBar, Figure, Layer, PALETTE, Panel, Rgb, Scales, Symbol, extent, number4,
};

/// Ratio of the half width of the closer view to the size of the cells at the largest stress.
const CLOSE_RATIO: f64 = 4.0;
/// Columns and rows of the picture of a section.
const CELLS: [usize; 2] = [1200, 400];

/// Corners of the six tetrahedra around a hexahedron's diagonal, in VTK's order.
const TETRAHEDRA: [[usize; 4]; 6] = [
    [0, 1, 2, 6],
    [0, 2, 3, 6],
    [0, 3, 7, 6],
    [0, 7, 4, 6],
    [0, 4, 5, 6],
    [0, 5, 1, 6],
];

/// Place [mm] and stress [MPa] of a corner in a section's own plane.
type Corner = [f64; 3];

/// The longitudinal section, the cross-section, and a closer view of the latter around the largest
/// stress; with mirror images where mirror planes were used.
pub fn stress_picture(field: &RunnerField, loads: &RunnerLoads, mirrored: [bool; 2]) -> Figure {
    let section = |axis| Section::new(&field.mesh, loads, axis, mirrored);
    let (along, across) = (section(1), section(0));
    let [x, y, z] = loads.at.map(|place| number4(1e3 * place));
    let highest = 1e-6 * loads.von_mises;
    let bar = ColourBar::viridis("von Mises stress [MPa]", [0.0, highest]);
    let title = format!(
        "von Mises stress in the steel, the largest of {} MPa at the ring: x = {x}, y = {y}, z = {z} mm",
        number4(highest)
    );
    let upper = along.panel(format!("along, at y = {y} mm"), along.window(), &bar);
    let caption = format!("across, at x = {x} mm");
    let window = across.close(&field.mesh, loads);
    let close = across.panel(format!("{caption}, closer"), window, &bar);
    let whole = across.panel(caption, across.window(), &bar);
    let lower = [whole, close].map(|panel| panel.scaled(Scales::Equal));
    let figure = Figure::new(1500.0, title).row(370.0, [upper]);
    figure.bar(bar.clone()).row(370.0, lower).bar(bar)
}

/// A section at constant y (along) or at constant x (across), in millimetres and megapascals.
struct Section {
    triangles: Vec<[Corner; 3]>,
    /// Position of the largest stress in the section.
    largest: [f64; 2],
    /// Index of the horizontal axis of the section.
    flat: usize,
}

impl Section {
    fn new(mesh: &HexMesh, loads: &RunnerLoads, axis: usize, mirrored: [bool; 2]) -> Section {
        let (at, flat) = (loads.at[axis], 1 - axis);
        let place = |node: usize| mesh.points[node][axis];
        // A plane through nodes cuts the cells before it, at the first nodes the cells behind it.
        let first = (0..mesh.points.len()).all(|node| place(node) >= at);
        let behind = |node: usize| place(node) > at || (!first && place(node) == at);
        let corner = |from: usize, to: usize| -> Corner {
            let share = (at - place(from)) / (place(to) - place(from));
            let value = |a: f64, b: f64| a + share * (b - a);
            let on = |axis: usize| 1e3 * value(mesh.points[from][axis], mesh.points[to][axis]);
            let stress = &loads.von_mises_at_nodes;
            [on(flat), on(2), 1e-6 * value(stress[from], stress[to])]
        };
        let mut triangles = Vec::new();
        let cut = |cell: &&[usize; 8]| {
            let count = cell.iter().filter(|&&node| behind(node)).count();
            (1..8).contains(&count)
        };
        for cell in mesh.cells.iter().filter(cut) {
            for corners in TETRAHEDRA {
                let nodes = corners.map(|corner| cell[corner]);
                let (there, here): (Vec<usize>, Vec<usize>) =
                    nodes.into_iter().partition(|&node| behind(node));
                match (&here[..], &there[..]) {
                    (&[a], &[b, c, d]) | (&[b, c, d], &[a]) => {
                        triangles.push([corner(a, b), corner(a, c), corner(a, d)]);
                    }
                    (&[a, b], &[c, d]) => {
                        let [ac, ad] = [corner(a, c), corner(a, d)];
                        let [bc, bd] = [corner(b, c), corner(b, d)];
                        triangles.extend([[ac, ad, bd], [ac, bd, bc]]);
                    }
                    _ => {}
                }
            }
        }
        if mirrored[flat] {
            let image = |[u, v, stress]: Corner| [-u, v, stress];
            let images: Vec<[Corner; 3]> = triangles.iter().map(|t| t.map(image)).collect();
            triangles.extend(images);
        }
        Section {
            triangles,
            largest: [1e3 * loads.at[flat], 1e3 * loads.at[2]],
            flat,
        }
    }

    /// Range of the whole section along its horizontal axis and along z, with a margin [mm].
    fn window(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let places = self.triangles.iter().flatten().map(|corner| corner[axis]);
            let [low, high] = extent(places);
            let margin = 0.05 * (high - low);
            [low - margin, high + margin]
        })
    }

    /// Range of the closer view around the largest stress [mm].
    fn close(&self, mesh: &HexMesh, loads: &RunnerLoads) -> [[f64; 2]; 2] {
        let near = |cell: &&[usize; 8]| cell.iter().any(|&node| mesh.points[node] == loads.at);
        let corners = || mesh.cells.iter().filter(near).flatten();
        let reach = |axis: usize| {
            let off = corners().map(|&node| (mesh.points[node][axis] - loads.at[axis]).abs());
            CLOSE_RATIO * 1e3 * off.fold(0.0, f64::max)
        };
        let whole = self.window();
        let reach = reach(self.flat).max(reach(2));
        [0, 1].map(|axis| {
            let (at, [low, high]) = (self.largest[axis], whole[axis]);
            [low.max(at - reach), high.min(at + reach)]
        })
    }

    /// The part of the section within a window, with a ring around the largest stress.
    fn panel(&self, title: String, window: [[f64; 2]; 2], bar: &ColourBar) -> Panel {
        let [[u0, u1], [v0, v1]] = window;
        let scale = [CELLS[0] as f64 / (u1 - u0), CELLS[1] as f64 / (v1 - v0)];
        let cell = |[u, v, stress]: Corner| [(u - u0) * scale[0], (v1 - v) * scale[1], stress];
        let mut colours: Vec<Option<Rgb>> = vec![None; CELLS[0] * CELLS[1]];
        for triangle in &self.triangles {
            for ([column, row], stress) in pixels(triangle.map(cell), CELLS) {
                colours[row * CELLS[0] + column] = Some(bar.colour(stress));
            }
        }
        let size = CELLS;
        let cells = Cells { size, colours };
        let largest = [(self.largest[0], self.largest[1])];
        let whole = [f64::NEG_INFINITY, f64::INFINITY];
        let layers = vec![
            Layer::rectangle(whole, whole, GROUND),
            Layer::map(window, cells),
            Layer::symbols(Symbol::Ring, 8.0, largest, PALETTE[1]),
        ];
        let x = Axis::new(["x along [mm]", "y across [mm]"][self.flat]).within(window[0]);
        let y = Axis::new("z [mm]").within(window[1]);
        Panel::new(x, y, layers)
            .titled(title)
            .scaled(Scales::Stretched)
    }
}

/// The pixels whose middles lie in a triangle, with the value there, linear between its corners.
fn pixels(corners: [Corner; 3], size: [usize; 2]) -> Vec<([usize; 2], f64)> {
    let [a, b, c] = corners;
    let twice = |p: Corner, q: Corner, [x, y]: [f64; 2]| {
        (q[0] - p[0]) * (y - p[1]) - (q[1] - p[1]) * (x - p[0])
    };
    let whole = twice(a, b, [c[0], c[1]]);
    if whole == 0.0 {
        return Vec::new();
    }
    let range = |axis: usize| {
        let [low, high] = extent(corners.map(|corner| corner[axis]));
        let end = (high + 1.0).clamp(0.0, size[axis] as f64);
        low.clamp(0.0, end) as usize..end as usize
    };
    let mut found = Vec::new();
    for row in range(1) {
        for column in range(0) {
            let middle = [column as f64 + 0.5, row as f64 + 0.5];
            let shares = [(b, c), (c, a), (a, b)].map(|(p, q)| twice(p, q, middle) / whole);
            if shares.iter().all(|&share| share >= -1e-9) {
                let value = shares[0] * a[2] + shares[1] * b[2] + shares[2] * c[2];
                found.push(([column, row], value));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two bricks behind each other, from x = 0 to 2 m, with a stress that is linear.
    fn bricks() -> (HexMesh, Vec<f64>) {
        let node = |i: usize, j: usize, k: usize| i + 3 * (j + 2 * k);
        let mut points = Vec::new();
        for k in 0..2 {
            for j in 0..2 {
                points.extend((0..3).map(|i| [f64::from(i), f64::from(j), f64::from(k)]));
            }
        }
        let cell = |i: usize| {
            let flat = [(i, 0), (i + 1, 0), (i + 1, 1), (i, 1)];
            let corner = |n: usize| node(flat[n % 4].0, flat[n % 4].1, n / 4);
            std::array::from_fn(corner)
        };
        let stress = points.iter().map(|[x, y, z]| 1e6 * (x + 2.0 * y + 4.0 * z));
        let (cells, stress) = (vec![cell(0), cell(1)], stress.collect());
        (HexMesh { points, cells }, stress)
    }

    /// A plane within, one through nodes, and those at both ends: a whole unit square each, with
    /// the linear field on it.
    #[test]
    fn a_section_is_whole_wherever_it_lies_and_has_the_stress_there() {
        let (mesh, von_mises_at_nodes) = bricks();
        for x in [0.0, 0.3, 1.0, 2.0] {
            let loads = RunnerLoads {
                von_mises: 0.0,
                at: [x, 1.0, 1.0],
                von_mises_at_nodes: von_mises_at_nodes.clone(),
                mounts: Vec::new(),
            };
            let section = Section::new(&mesh, &loads, 0, [false, false]);
            let scaled = section
                .triangles
                .iter()
                .map(|triangle| triangle.map(|[u, v, stress]| [0.1 * u, 0.1 * v, stress]));
            let mut seen = vec![0; 100 * 100];
            for ([column, row], stress) in scaled.flat_map(|t| pixels(t, [100, 100])) {
                let [y, z] = [column, row].map(|k| (k as f64 + 0.5) / 100.0);
                assert!((stress - (x + 2.0 * y + 4.0 * z)).abs() < 1e-9, "{x}");
                seen[100 * row + column] += 1;
            }
            assert!(seen.iter().all(|&count| count > 0), "{x}");
            let both = Section::new(&mesh, &loads, 0, [false, true]);
            assert_eq!(both.window()[0], [-1100.0, 1100.0]);
        }
    }
}
