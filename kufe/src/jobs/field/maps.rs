//! Pictures of pressure maps: `pressure.png`, and two maps on one grid with their difference.

use kufe_contact::PressureMap;

use crate::plot::{
    AFTER, Axis, BEFORE, Cells, Colour, ColourBar, Figure, INK, Layer, PALETTE, Panel, Point, Rgb,
    Scales, contour, diverging, extent, tick_text,
};
use crate::results::MapDifference;

/// Background colour of a map outside the contact.
pub(super) const GROUND: Colour = Colour::new(244, 244, 246);
/// Fraction of the peak below which a point counts as outside the contact, for outline and
/// colouring.
const EDGE: f64 = 0.01;
/// Columns and rows of the picture of a map.
const CELLS: [usize; 2] = [1200, 480];

/// The maps of the parts of a contact side by side, and cuts through the highest peak.
pub fn map_picture(maps: &[PressureMap], title: &str) -> Figure {
    let peak_mpa = |map: &PressureMap| map.pressure.iter().copied().fold(0.0, f64::max) / 1e6;
    let figure = Figure::new(1500.0, title);
    let Some(main) = maps
        .iter()
        .max_by(|a, b| peak_mpa(a).total_cmp(&peak_mpa(b)))
    else {
        return figure;
    };
    let peak = match peak_mpa(main) {
        peak if peak > 0.0 => peak,
        _ => 1.0,
    };
    let bar = ColourBar::viridis("contact pressure [MPa]", [0.0, peak]);
    let [x, y] = Pixels::of(main).window();
    let (x_peak, y_peak) = main.peak();
    let mm = |[from, to]: [f64; 2], place: f64| tick_text(1e3 * place, to - from);
    let columns = (0..main.nx).map(|i| main.x0 + i as f64 * main.dx);
    let along = columns.map(|x| (1e3 * x, main.pressure_at(x, y_peak) / 1e6));
    let rows = (0..main.ny).map(|j| main.y0 + j as f64 * main.dy);
    let across = rows.map(|y| (1e3 * y, main.pressure_at(x_peak, y) / 1e6));
    let along = cut("x [mm]", along.collect(), peak);
    let across = cut("y [mm]", across.collect(), peak);
    let cuts = [
        along.titled(format!("along, at y = {} mm", mm(y, y_peak))),
        across.titled(format!("across, at x = {} mm", mm(x, x_peak))),
    ];
    let maps = maps.iter().map(|map| map_panel(map, &bar));
    figure.row(450.0, maps).bar(bar.clone()).row(270.0, cuts)
}

/// The pixels of a map in the contact plane.
#[derive(Clone, Copy)]
struct Pixels {
    size: [usize; 2],
    /// Centre of the first pixel [m].
    origin: [f64; 2],
    /// Size of a pixel [m].
    pixel: [f64; 2],
}

impl Pixels {
    fn of(map: &PressureMap) -> Pixels {
        Pixels {
            size: [map.nx, map.ny],
            origin: [map.x0, map.y0],
            pixel: [map.dx, map.dy],
        }
    }

    /// The coordinate of pixel `k` along an axis [m].
    fn at(&self, axis: usize, k: f64) -> f64 {
        self.origin[axis] + k * self.pixel[axis]
    }

    /// Range of x and of y that the pixels cover [mm].
    fn window(&self) -> [[f64; 2]; 2] {
        [0, 1].map(|axis| {
            let ends = [-0.5, self.size[axis] as f64 - 0.5];
            ends.map(|k| 1e3 * self.at(axis, k))
        })
    }

    /// The contour of the pixels' values at a level.
    fn outline(&self, values: &[f64], level: f64, colour: Colour) -> Layer {
        let rim = contour(self.size, |i, j| values[j * self.size[0] + i], level);
        let place = |(i, j): Point| (1e3 * self.at(0, i), 1e3 * self.at(1, j));
        Layer::segments(1.0, rim.into_iter().map(|ends| ends.map(place)), colour)
    }
}

fn map_panel(map: &PressureMap, bar: &ColourBar) -> Panel {
    let edge = EDGE * bar.range[1];
    let cell = |x: f64, y: f64| {
        let pressure = map.pressure_at(1e-3 * x, 1e-3 * y) / 1e6;
        (pressure > edge).then(|| bar.colour(pressure))
    };
    let pixels = Pixels::of(map);
    let outline = pixels.outline(&map.pressure, 1e6 * edge, INK);
    coloured_panel(pixels.window(), cell, vec![outline])
}

/// A map over a window [mm] with the colour of each place [mm], and further layers on it.
fn coloured_panel(
    [x, y]: [[f64; 2]; 2],
    cell: impl Fn(f64, f64) -> Option<Rgb>,
    above: Vec<Layer>,
) -> Panel {
    let middle = |[from, to]: [f64; 2], k: usize, count: usize| {
        from + (k as f64 + 0.5) / count as f64 * (to - from)
    };
    let cells = Cells::new(CELLS, |column, row| {
        cell(middle(x, column, CELLS[0]), middle(y, row, CELLS[1]))
    });
    let ground = [Layer::rectangle(x, y, GROUND), Layer::map([x, y], cells)];
    let layers = ground.into_iter().chain(above).collect();
    let x = Axis::new("x along the runner [mm]").within(x);
    let y = Axis::new("y across [mm]").within(y);
    Panel::new(x, y, layers).scaled(Scales::Stretched)
}

/// Pressure along a line through the peak.
fn cut(axis: &str, points: Vec<Point>, peak: f64) -> Panel {
    let [first, last] = extent(points.iter().map(|point| point.0));
    let below = points.iter().copied().chain([(last, 0.0), (first, 0.0)]);
    let layers = vec![
        Layer::area(below, PALETTE[0].alpha(0.15)),
        Layer::line(2.0, points, PALETTE[0]),
    ];
    let y = Axis::new("p [MPa]").within([0.0, 1.05 * peak]);
    Panel::new(Axis::new(axis).within([first, last]), y, layers)
}

/// Largest number of pixels of the common grid.
const MAX_PIXELS: f64 = 4e6;

/// Two pressure maps on one grid, in the frame of the contact plane.
///
/// The grid spans both maps with the smaller of their pixels in each direction, enlarged where it
/// would have more than four million. Between the pixels of a map its pressure is bilinear, outside
/// of the map it is 0.
pub struct ComparedMaps {
    pixels: Pixels,
    pressure: [Vec<f64>; 2],
}

impl ComparedMaps {
    /// Both maps on their common grid.
    pub fn new(maps: [&PressureMap; 2]) -> ComparedMaps {
        let ends = |map: &PressureMap| {
            let pixels = Pixels::of(map);
            [0, 1].map(|axis| [0.0, (pixels.size[axis] - 1) as f64].map(|k| pixels.at(axis, k)))
        };
        let [a, b] = maps.map(ends);
        let window = [0, 1].map(|axis| [a[axis][0].min(b[axis][0]), a[axis][1].max(b[axis][1])]);
        let finest = [maps[0].dx.min(maps[1].dx), maps[0].dy.min(maps[1].dy)];
        let count = |axis: usize| (window[axis][1] - window[axis][0]) / finest[axis] + 1.0;
        let coarser = (count(0) * count(1) / MAX_PIXELS).sqrt().max(1.0);
        let pixel = finest.map(|step| coarser * step);
        let size = [0, 1].map(|axis| {
            let [from, to] = window[axis];
            ((to - from) / pixel[axis] - 1e-6).ceil() as usize + 1
        });
        let pixels = Pixels {
            size,
            origin: window.map(|[from, _]| from),
            pixel,
        };
        let mut compared = ComparedMaps {
            pixels,
            pressure: Default::default(),
        };
        compared.pressure = maps.map(|map| {
            let places = (0..size[0] * size[1]).map(|k| compared.place(k));
            places.map(|[x, y]| pressure_at(map, x, y)).collect()
        });
        compared
    }

    fn difference_at(&self, k: usize) -> f64 {
        self.pressure[1][k] - self.pressure[0][k]
    }

    fn place(&self, k: usize) -> [f64; 2] {
        let [nx, _] = self.pixels.size;
        let pixel = [k % nx, k / nx];
        [0, 1].map(|axis| self.pixels.at(axis, pixel[axis] as f64))
    }

    /// Figures of the second map less the first.
    pub fn difference(&self) -> MapDifference {
        let pixels = 0..self.pressure[0].len();
        let differences: Vec<f64> = pixels.map(|k| self.difference_at(k)).collect();
        let largest = argmax(differences.iter().map(|difference| difference.abs()));
        let loaded = |k: &usize| self.pressure.iter().any(|p| p[*k] > 0.0);
        let (mut count, mut squares, mut net, mut l1_norm) = (0_u32, 0.0_f64, 0.0_f64, 0.0);
        for (k, difference) in differences.iter().enumerate() {
            if loaded(&k) {
                count += 1;
                squares += difference.powi(2);
            }
            net += difference;
            l1_norm += difference.abs();
        }
        let [largest_x_m, largest_y_m] = self.place(largest);
        let [pixel_x_m, pixel_y_m] = self.pixels.pixel;
        MapDifference {
            pixel_x_m,
            pixel_y_m,
            largest_pa: differences[largest],
            largest_x_m,
            largest_y_m,
            rms_pa: (squares / f64::from(count.max(1))).sqrt(),
            moved_n: 0.5 * (l1_norm - net.abs()) * pixel_x_m * pixel_y_m,
        }
    }

    /// Both maps on one colour scale, their difference, and cuts along and across through the
    /// higher peak.
    pub fn picture(&self, names: [&str; 2]) -> Figure {
        let [first, second] = names;
        let figure = Figure::new(1500.0, format!("{first} and {second}"));
        let peaks_at = self.pressure.each_ref().map(|p| argmax(p.iter().copied()));
        let peaks = [0, 1].map(|which| self.pressure[which][peaks_at[which]] / 1e6);
        let top = peaks[0].max(peaks[1]).max(f64::MIN_POSITIVE);
        let bar = ColourBar::viridis("contact pressure [MPa]", [0.0, top]);
        let outline = |which: usize, colour| {
            let rim = 1e6 * EDGE * top;
            self.pixels.outline(&self.pressure[which], rim, colour)
        };
        let maps = [0, 1].map(|which| {
            let cell = |k: usize| {
                let pressure = self.pressure[which][k] / 1e6;
                (pressure > EDGE * top).then(|| bar.colour(pressure))
            };
            let panel = self.panel(cell, vec![outline(which, INK)]);
            panel.titled(names[which])
        });
        let most = (1e-6 * self.difference().largest_pa).abs();
        let most = most.max(f64::MIN_POSITIVE);
        let signed = ColourBar::new("second less first [MPa]", [-most, most], |share| {
            diverging(2.0 * share - 1.0)
        });
        let loaded = |k: usize| self.pressure.iter().any(|p| p[k] / 1e6 > EDGE * top);
        let cell = |k: usize| loaded(k).then(|| signed.colour(self.difference_at(k) / 1e6));
        let outlines = [(0, BEFORE), (1, AFTER)]
            .map(|(which, colour)| outline(which, colour).named(names[which]));
        let difference = self.panel(cell, outlines.into()).titled("difference");
        let through = peaks_at[usize::from(peaks[1] > peaks[0])];
        let cuts = [0, 1].map(|axis| self.cut(axis, through, names, top));
        let figure = figure.row(330.0, maps).bar(bar.clone());
        let figure = figure.row(330.0, [difference]).bar(signed.clone());
        figure.row(250.0, cuts)
    }

    fn panel(&self, cell: impl Fn(usize) -> Option<Rgb>, outlines: Vec<Layer>) -> Panel {
        let Pixels {
            size,
            origin,
            pixel,
        } = self.pixels;
        let near = |axis: usize, at: f64| {
            let k = (1e-3 * at - origin[axis]) / pixel[axis];
            (k.round().max(0.0) as usize).min(size[axis] - 1)
        };
        let cell = |x: f64, y: f64| cell(near(1, y) * size[0] + near(0, x));
        coloured_panel(self.pixels.window(), cell, outlines)
    }

    /// Both pressures along an axis through a pixel.
    fn cut(&self, axis: usize, through: usize, names: [&str; 2], top: f64) -> Panel {
        let Pixels {
            size, pixel: step, ..
        } = self.pixels;
        let [i, j] = [through % size[0], through / size[0]];
        let pixel = |k: usize| match axis {
            0 => j * size[0] + k,
            _ => k * size[0] + i,
        };
        let line = |which: usize, colour| {
            let points = (0..size[axis]).map(|k| {
                let at = pixel(k);
                (1e3 * self.place(at)[axis], self.pressure[which][at] / 1e6)
            });
            Layer::line(1.6, points, colour).named(names[which])
        };
        let other = 1 - axis;
        let width = 1e3 * size[other] as f64 * step[other];
        let place = tick_text(1e3 * self.place(through)[other], width);
        let (label, title) = match axis {
            0 => ("x [mm]", format!("along, at y = {place} mm")),
            _ => ("y [mm]", format!("across, at x = {place} mm")),
        };
        let y = Axis::new("p [MPa]").within([0.0, 1.05 * top]);
        let layers = vec![line(0, BEFORE), line(1, AFTER)];
        Panel::new(Axis::new(label), y, layers).titled(title)
    }
}

/// The index of the largest value, the last of equal ones.
fn argmax(values: impl Iterator<Item = f64>) -> usize {
    let largest = values.enumerate().max_by(|a, b| a.1.total_cmp(&b.1));
    largest.map_or(0, |(index, _)| index)
}

/// The pressure at a point; one that rounding puts just outside the map is moved onto its edge.
fn pressure_at(map: &PressureMap, x: f64, y: f64) -> f64 {
    let within = |at: f64, first: f64, step: f64, count: usize| {
        let last = first + (count - 1) as f64 * step;
        let [near, inside] = [1e-6, 1e-9].map(|share| share * step);
        if (first - near..=last + near).contains(&at) {
            at.clamp(first + inside, last - inside)
        } else {
            at
        }
    };
    let x = within(x, map.x0, map.dx, map.nx);
    map.pressure_at(x, within(y, map.y0, map.dy, map.ny))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::tests::hertz_map;
    use crate::plot::Mark;

    #[test]
    fn a_needle_is_drawn_stretched_in_its_colours_and_to_the_last_row() {
        let map = hertz_map();
        let [x, y] = Pixels::of(&map).window();
        let figure = map_picture(&[map], "test");
        let panel = &figure.rows[0].panels[0];
        let Mark::Map(window, cells) = &panel.layers[1].mark else {
            panic!("{:?}", panel.layers[1]);
        };
        assert_eq!(*window, [x, y]);
        let cells = &cells.colours;
        // The ellipse of half axes 25 and 0.14 mm covers this share of a window of 75 x 0.7 mm, but
        // for its edge.
        let share = std::f64::consts::PI * 25.0 * 0.14 / (75.0 * 0.7);
        let coloured = cells.iter().flatten().count() as f64 / cells.len() as f64;
        assert!((coloured / share - 1.0).abs() < 0.01, "{coloured} {share}");
        let svg = figure.svg();
        assert!(svg.contains("y across [mm], stretched "), "{svg}");
        if let Some(folder) = std::env::var_os("KUFE_KEEP_PICTURES") {
            let path = std::path::Path::new(&folder).join("pressure-test.png");
            std::fs::write(path, figure.png()).unwrap();
        }
    }

    /// A paraboloid of pressure whose apex is `apex` [Pa] at x = `at`, on pixels of this size.
    fn map(apex: f64, at: f64, pixel: f64) -> PressureMap {
        let count = (0.2 / pixel).round() as usize + 1;
        let places = (0..count * count).map(|k| [k % count, k / count]);
        let places = places.map(|at| at.map(|k| k as f64 * pixel - 0.1));
        let pressure = places
            .map(|[x, y]| apex * (1.0 - ((x - at).powi(2) + y * y) / 0.05_f64.powi(2)).max(0.0));
        let pressure: Vec<f64> = pressure.collect();
        PressureMap {
            x0: -0.1,
            y0: -0.1,
            dx: pixel,
            dy: pixel,
            nx: count,
            ny: count,
            gap: vec![0.0; pressure.len()],
            uz: vec![0.0; pressure.len()],
            pressure,
        }
    }

    #[test]
    fn a_map_is_its_own_on_another_grid() {
        let one = hertz_map();
        let same = ComparedMaps::new([&one, &one]).difference();
        assert_eq!((same.largest_pa, same.moved_n), (0.0, 0.0));
        // A paraboloid between its pixels is off by less than (step / radius)^2 / 4 of its apex,
        // at its rim by half of a step's slope.
        let two = ComparedMaps::new([&map(2e6, 0.0, 2e-3), &map(2e6, 0.0, 1e-3)]).difference();
        assert_eq!([two.pixel_x_m, two.pixel_y_m], [1e-3, 1e-3]);
        assert!(two.largest_pa.abs() < 2e6 * 2.0 * 1e-3 / 0.05, "{two:?}");
    }

    #[test]
    fn a_higher_pressure_differs_most_at_the_apex_and_moves_no_force() {
        let found = ComparedMaps::new([&map(2e6, 0.0, 1e-3), &map(3e6, 0.0, 1e-3)]).difference();
        assert!((found.largest_pa - 1e6).abs() < 1.0, "{found:?}");
        assert!(
            found.largest_x_m.abs() < 1e-9 && found.largest_y_m.abs() < 1e-9,
            "{found:?}"
        );
        // Of a force of some 4 kN, rounding.
        assert!(found.moved_n.abs() < 1e-6, "{found:?}");
        // The mean square of 1 - r^2 over a disc is 1/3.
        assert!(
            (found.rms_pa / (1e6 / 3.0_f64.sqrt()) - 1.0).abs() < 0.01,
            "{found:?}"
        );
    }

    #[test]
    fn maps_apart_share_no_force() {
        let found = ComparedMaps::new([&map(2e6, -0.05, 1e-3), &map(2e6, 0.05, 1e-3)]).difference();
        let force = 0.5 * std::f64::consts::PI * 0.05_f64.powi(2) * 2e6;
        assert!(
            (found.moved_n / force - 1.0).abs() < 2e-3,
            "{found:?} {force}"
        );
    }
}
