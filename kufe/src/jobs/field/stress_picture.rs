//! `stress.png`: the von Mises stress of an elastic runner in the sections through its largest value.

use std::path::Path;

use crate::plot::{Error, PALETTE, PngRoot, colour_bar, number4, png, tick_text, viridis};
use kufe_contact::{RunnerField, RunnerLoads};
use kufe_mesh::HexMesh;
use plotters::prelude::*;

use crate::jobs::field::map_picture::stretch_text;

const WIDTH: u32 = 1500;
const HEIGHT: u32 = 1000;
const BACKGROUND: RGBColor = RGBColor(244, 244, 246);
/// The closer view reaches this many times as far around the largest stress as the cells there.
const CLOSE: f64 = 4.0;

/// What a panel's title, axes and margins take of its width and height [pixels].
const FRAME: [i32; 2] = [126, 104];

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

/// Draws the section along and the one across, and of that what is near the largest stress; where mirror planes were used, with the images.
///
/// # Errors
/// [`Error`] where the picture cannot be drawn or written.
pub fn write(
    path: &Path,
    field: &RunnerField,
    loads: &RunnerLoads,
    mirrored: [bool; 2],
) -> Result<(), Error> {
    let section = |axis| Section::new(&field.mesh, loads, axis, mirrored);
    let (along, across) = (section(1), section(0));
    let [x, y, z] = loads.at.map(|place| number4(1e3 * place));
    let highest = 1e-6 * loads.von_mises;
    let title = format!(
        "von Mises stress in the steel, the largest of {} MPa at the ring: x = {x}, y = {y}, z = {z} mm",
        number4(highest)
    );
    png(path, WIDTH, HEIGHT, &|root| {
        let root = root.margin(14, 8, 0, 0);
        let root = root.titled(&title, ("sans-serif", 24))?;
        let (panels, bar) = root.split_horizontally(WIDTH - 140);
        let colour = |stress: f64| viridis(stress / highest);
        let name = "von Mises stress [MPa]";
        colour_bar(&bar.margin(44, 70, 0, 0), [0.0, highest], colour, name)?;
        let (upper, lower) = panels.split_vertically(panels.dim_in_pixel().1 / 2);
        let caption = format!("along, at y = {y} mm");
        along.draw(&upper, &caption, along.window(), &colour)?;
        let (left, right) = lower.split_horizontally(lower.dim_in_pixel().0 / 2);
        let caption = format!("across, at x = {x} mm");
        let whole = to_scale(across.window(), &left);
        across.draw(&left, &caption, whole, &colour)?;
        let close = to_scale(across.close(&field.mesh, loads), &right);
        across.draw(&right, &format!("{caption}, closer"), close, &colour)
    })
}

/// A section along (y is constant) or across (x is), in millimetres and megapascals.
struct Section {
    triangles: Vec<[Corner; 3]>,
    /// Where the stress is largest.
    largest: [f64; 2],
    /// The axis that lies in the section beside z.
    flat: usize,
}

impl Section {
    fn new(mesh: &HexMesh, loads: &RunnerLoads, axis: usize, mirrored: [bool; 2]) -> Section {
        let (at, flat) = (loads.at[axis], 1 - axis);
        let place = |node: usize| mesh.points[node][axis];
        // A plane through nodes belongs to the cells before it; at the first nodes to those behind.
        let first = (0..mesh.points.len()).all(|node| place(node) >= at);
        let behind = |node: usize| {
            if first {
                place(node) > at
            } else {
                place(node) >= at
            }
        };
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

    /// All of it, with a margin: from and to along its first axis and along z [mm].
    fn window(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let places = self.triangles.iter().flatten().map(|corner| corner[axis]);
            let (low, high) = places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
                (low.min(at), high.max(at))
            });
            let margin = 0.05 * (high - low);
            [low - margin, high + margin]
        })
    }

    /// What lies around the largest stress, as seen from its cells [mm].
    fn close(&self, mesh: &HexMesh, loads: &RunnerLoads) -> [[f64; 2]; 2] {
        let near = |cell: &&[usize; 8]| cell.iter().any(|&node| mesh.points[node] == loads.at);
        let corners = || mesh.cells.iter().filter(near).flatten();
        let reach = |axis: usize| {
            let off = corners().map(|&node| (mesh.points[node][axis] - loads.at[axis]).abs());
            CLOSE * 1e3 * off.fold(0.0, f64::max)
        };
        let whole = self.window();
        let reach = reach(self.flat).max(reach(2));
        [0, 1].map(|axis| {
            let at = self.largest[axis];
            [
                whole[axis][0].max(at - reach),
                whole[axis][1].min(at + reach),
            ]
        })
    }

    fn draw(
        &self,
        area: &PngRoot,
        caption: &str,
        [[u0, u1], [v0, v1]]: [[f64; 2]; 2],
        colour: &dyn Fn(f64) -> RGBColor,
    ) -> Result<(), Error> {
        let mut builder = ChartBuilder::on(area);
        builder
            .caption(caption, ("sans-serif", 20))
            .margin(12)
            .margin_right(30)
            .x_label_area_size(52)
            .y_label_area_size(84);
        let mut chart = builder.build_cartesian_2d(u0..u1, v0..v1)?;
        let plane = chart.plotting_area().strip_coord_spec();
        let (width, height) = plane.dim_in_pixel();
        let scale = [f64::from(width) / (u1 - u0), f64::from(height) / (v1 - v0)];
        plane.fill(&BACKGROUND)?;
        let pixel = |[u, v, stress]: Corner| [(u - u0) * scale[0], (v1 - v) * scale[1], stress];
        for triangle in &self.triangles {
            let corners = triangle.map(pixel);
            for (at, stress) in pixels(corners, [width as usize, height as usize]) {
                plane.draw_pixel((at[0] as i32, at[1] as i32), &colour(stress))?;
            }
        }
        let along = ["x along", "y across"][self.flat];
        let stretch = stretch_text(scale[1] / scale[0]);
        chart
            .configure_mesh()
            .disable_mesh()
            .x_desc(format!("{along} [mm]"))
            .y_desc(format!("z [mm], {stretch}"))
            .x_label_formatter(&|x| tick_text(*x, u1 - u0))
            .y_label_formatter(&|y| tick_text(*y, v1 - v0))
            .y_labels(6)
            .label_style(("sans-serif", 17))
            .axis_desc_style(("sans-serif", 18))
            .draw()?;
        let largest = (self.largest[0], self.largest[1]);
        chart.draw_series([Circle::new(largest, 8, PALETTE[1].stroke_width(2))])?;
        Ok(())
    }
}

/// A window that is as wide, or as high, as its area asks for equal scales.
fn to_scale([u, v]: [[f64; 2]; 2], area: &PngRoot) -> [[f64; 2]; 2] {
    let (width, height) = area.dim_in_pixel();
    let aspect = f64::from(width as i32 - FRAME[0]) / f64::from(height as i32 - FRAME[1]);
    let longer = |[from, to]: [f64; 2], length: f64| {
        let more = 0.5 * (length - (to - from)).max(0.0);
        [from - more, to + more]
    };
    let (wide, high) = (u[1] - u[0], v[1] - v[0]);
    [longer(u, aspect * high), longer(v, wide / aspect)]
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
        let places = corners.map(|corner| corner[axis]);
        let low = places.into_iter().fold(f64::INFINITY, f64::min);
        let high = places.into_iter().fold(f64::NEG_INFINITY, f64::max);
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

    /// A plane within, one through nodes, and those at both ends: a whole unit square each, with the linear field on it.
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
