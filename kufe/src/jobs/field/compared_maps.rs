//! Two pressure maps on one grid: their difference, and the picture of both.

use kufe_contact::PressureMap;

use crate::jobs::field::map_picture::coloured_panel;
use crate::plot::{
    AFTER, Axis, BEFORE, Colour, ColourBar, Figure, INK, Layer, Panel, Point, Rgb, contour,
    diverging, tick_text,
};
use crate::results::MapDifference;

/// Most pixels of the common grid.
const MOST_PIXELS: f64 = 4e6;
/// Share of the highest pressure below which a point is outside of a contact.
const EDGE: f64 = 0.01;

/// Two pressure maps on one grid, in the frame of the contact plane.
///
/// The grid spans both maps with the smaller of their pixels in each direction, enlarged where it
/// would have more than four million. Between the pixels of a map its pressure is bilinear, outside
/// of the map it is 0.
pub struct ComparedMaps {
    size: [usize; 2],
    origin: [f64; 2],
    pixel: [f64; 2],
    pressure: [Vec<f64>; 2],
}

impl ComparedMaps {
    /// Both maps on their common grid.
    pub fn new(maps: [&PressureMap; 2]) -> ComparedMaps {
        let ends = |map: &PressureMap| {
            let (nx, ny) = ((map.nx - 1) as f64, (map.ny - 1) as f64);
            [
                [map.x0, map.x0 + nx * map.dx],
                [map.y0, map.y0 + ny * map.dy],
            ]
        };
        let [a, b] = maps.map(ends);
        let window = [0, 1].map(|axis| [a[axis][0].min(b[axis][0]), a[axis][1].max(b[axis][1])]);
        let finest = [maps[0].dx.min(maps[1].dx), maps[0].dy.min(maps[1].dy)];
        let count = |axis: usize| (window[axis][1] - window[axis][0]) / finest[axis] + 1.0;
        let coarser = (count(0) * count(1) / MOST_PIXELS).sqrt().max(1.0);
        let pixel = finest.map(|step| coarser * step);
        let size = [0, 1].map(|axis| {
            let [from, to] = window[axis];
            ((to - from) / pixel[axis] - 1e-6).ceil() as usize + 1
        });
        let origin = window.map(|[from, _]| from);
        let at = |axis: usize, k: usize| origin[axis] + k as f64 * pixel[axis];
        let pressure = maps.map(|map| {
            let rows = (0..size[1]).flat_map(|j| (0..size[0]).map(move |i| (i, j)));
            rows.map(|(i, j)| pressure_at(map, at(0, i), at(1, j)))
                .collect()
        });
        ComparedMaps {
            size,
            origin,
            pixel,
            pressure,
        }
    }

    fn difference_at(&self, k: usize) -> f64 {
        self.pressure[1][k] - self.pressure[0][k]
    }

    fn place(&self, k: usize) -> [f64; 2] {
        let [i, j] = [k % self.size[0], k / self.size[0]];
        let at = |axis: usize, k: usize| self.origin[axis] + k as f64 * self.pixel[axis];
        [at(0, i), at(1, j)]
    }

    fn highest(&self, which: usize) -> usize {
        let values = &self.pressure[which];
        (0..values.len())
            .max_by(|a, b| values[*a].total_cmp(&values[*b]))
            .unwrap_or(0)
    }

    /// The second map less the first.
    pub fn difference(&self) -> MapDifference {
        let all = 0..self.pressure[0].len();
        let largest = all.clone().max_by(|a, b| {
            let size = |k: usize| self.difference_at(k).abs();
            size(*a).total_cmp(&size(*b))
        });
        let largest = largest.unwrap_or(0);
        let loaded = |k: &usize| self.pressure.iter().any(|p| p[*k] > 0.0);
        let (count, squares) = all
            .clone()
            .filter(loaded)
            .fold((0_u32, 0.0_f64), |(count, sum), k| {
                (count + 1, sum + self.difference_at(k).powi(2))
            });
        let (net, sizes) = all.fold((0.0_f64, 0.0), |(net, sizes), k| {
            let difference = self.difference_at(k);
            (net + difference, sizes + difference.abs())
        });
        let [largest_x_m, largest_y_m] = self.place(largest);
        let [pixel_x_m, pixel_y_m] = self.pixel;
        MapDifference {
            pixel_x_m,
            pixel_y_m,
            largest_pa: self.difference_at(largest),
            largest_x_m,
            largest_y_m,
            rms_pa: (squares / f64::from(count.max(1))).sqrt(),
            moved_n: 0.5 * (sizes - net.abs()) * pixel_x_m * pixel_y_m,
        }
    }

    /// Both maps in one scale of colours, their difference, and cuts along and across through the
    /// higher of the peaks.
    pub fn picture(&self, names: [&str; 2]) -> Figure {
        let [first, second] = names;
        let figure = Figure::new(1500.0, format!("{first} and {second}"));
        let peaks = [0, 1].map(|which| self.pressure[which][self.highest(which)] / 1e6);
        let top = peaks[0].max(peaks[1]).max(f64::MIN_POSITIVE);
        let bar = ColourBar::viridis("contact pressure [MPa]", [0.0, top]);
        let maps = [0, 1].map(|which| {
            let cell = |k: usize| {
                let pressure = self.pressure[which][k] / 1e6;
                (pressure > EDGE * top).then(|| bar.colour(pressure))
            };
            self.panel(cell, vec![self.outline(which, top, INK)])
                .titled(names[which])
        });
        let most = (self.difference().largest_pa / 1e6)
            .abs()
            .max(f64::MIN_POSITIVE);
        let signed = ColourBar::new("second less first [MPa]", [-most, most], |share| {
            diverging(2.0 * share - 1.0)
        });
        let loaded = |k: usize| self.pressure.iter().any(|p| p[k] / 1e6 > EDGE * top);
        let cell = |k: usize| loaded(k).then(|| signed.colour(self.difference_at(k) / 1e6));
        let outlines = [(0, BEFORE), (1, AFTER)]
            .map(|(which, colour)| self.outline(which, top, colour).named(names[which]));
        let difference = self.panel(cell, outlines.into()).titled("difference");
        let through = self.highest(usize::from(peaks[1] > peaks[0]));
        figure
            .row(330.0, maps)
            .bar(bar.clone())
            .row(330.0, [difference])
            .bar(signed.clone())
            .row(
                250.0,
                [0, 1].map(|axis| self.cut(axis, through, names, top)),
            )
    }

    /// The rim of a contact.
    fn outline(&self, which: usize, top: f64, colour: Colour) -> Layer {
        let value = |i: usize, j: usize| self.pressure[which][j * self.size[0] + i];
        let rim = contour(self.size, value, 1e6 * EDGE * top);
        let place = |(i, j): Point| {
            let at = |axis: usize, k: f64| 1e3 * (self.origin[axis] + k * self.pixel[axis]);
            (at(0, i), at(1, j))
        };
        Layer::segments(1.0, rim.into_iter().map(|ends| ends.map(place)), colour)
    }

    fn panel(&self, cell: impl Fn(usize) -> Option<Rgb>, outlines: Vec<Layer>) -> Panel {
        let span = |axis: usize| {
            let [from, step] = [self.origin[axis], self.pixel[axis]];
            [-0.5, self.size[axis] as f64 - 0.5].map(|k| 1e3 * (from + k * step))
        };
        let near = |axis: usize, at: f64| {
            let k = (1e-3 * at - self.origin[axis]) / self.pixel[axis];
            (k.round().max(0.0) as usize).min(self.size[axis] - 1)
        };
        let cell = |x: f64, y: f64| cell(near(1, y) * self.size[0] + near(0, x));
        coloured_panel([span(0), span(1)], cell, outlines)
    }

    /// Both pressures along an axis through a pixel.
    fn cut(&self, axis: usize, through: usize, names: [&str; 2], top: f64) -> Panel {
        let [i, j] = [through % self.size[0], through / self.size[0]];
        let pixel = |k: usize| match axis {
            0 => j * self.size[0] + k,
            _ => k * self.size[0] + i,
        };
        let line = |which: usize, colour| {
            let points = (0..self.size[axis]).map(|k| {
                let at = pixel(k);
                (1e3 * self.place(at)[axis], self.pressure[which][at] / 1e6)
            });
            Layer::line(1.6, points, colour).named(names[which])
        };
        let other = 1 - axis;
        let width = 1e3 * self.size[other] as f64 * self.pixel[other];
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

/// The pressure at a place, also at one that rounding puts just outside of the map's last pixels.
fn pressure_at(map: &PressureMap, x: f64, y: f64) -> f64 {
    let within = |at: f64, first: f64, step: f64, count: usize| {
        let last = first + (count - 1) as f64 * step;
        let [near, inside] = [1e-6, 1e-9].map(|share| share * step);
        match (first - near..=last + near).contains(&at) {
            true => at.clamp(first + inside, last - inside),
            false => at,
        }
    };
    let x = within(x, map.x0, map.dx, map.nx);
    map.pressure_at(x, within(y, map.y0, map.dy, map.ny))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::jobs::field::hertz_map::hertz_map;

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
