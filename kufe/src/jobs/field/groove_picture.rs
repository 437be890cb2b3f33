//! `groove.png`: the groove across and along, and pressure and film along the patch.

use kufe_sled::friction::film::FilmStation;

use crate::jobs::SolvedContact;
use crate::jobs::slide::SolvedSliding;
use crate::plot::{Axis, Figure, Layer, PALETTE, Panel, Point};

/// Places between two stations at which a line between them is drawn.
const BETWEEN: u32 = 16;

/// The three pictures one below the other; dots are at the nodes of the mesh, and at the stations
/// of the film.
pub fn groove_picture(pressed: &SolvedContact, slid: &SolvedSliding) -> Figure {
    let groove = &slid.groove;
    let widths = groove.sections.iter().map(|section| section.width);
    let widest = 0.75e3 * widths.fold(0.0, f64::max);
    let profile = groove.profile.y().iter().zip(groove.profile.depth());
    let across = profile.map(|(y, depth)| (1e3 * y, -1e6 * depth));
    let across = across.filter(|(y, _)| y.abs() <= widest).collect();
    let panels = [
        panel(
            "the remaining groove (dots: nodes of the mesh)",
            ["y across [mm]", "height of the ice [µm]"],
            vec![Line::between("", across)],
        ),
        panel(
            "the groove's deepest line under the runner, which slides to the right (dots: nodes)",
            ["x along the runner [mm]", "height of the unloaded ice [µm]"],
            vec![Line::between("", deepest_line(pressed, slid))],
        ),
        panel(
            "the patch (dots: stations of the film)",
            ["x along the runner [mm]", "each in its own unit"],
            along(slid),
        ),
    ];
    Figure::new(1100.0, "").column(300.0, panels)
}

/// Plastic depth along the line on which the groove is deepest, as far as the patch reaches.
fn deepest_line(pressed: &SolvedContact, slid: &SolvedSliding) -> Vec<Point> {
    let field = &pressed.solution.surface;
    let groove = &slid.groove;
    let nx = field.x.len();
    let deepest = (0..field.y.len())
        .max_by(|&i, &j| groove.depth[i * nx].total_cmp(&groove.depth[j * nx]))
        .unwrap_or(0);
    let length = groove.front.value - groove.back.value;
    let from = groove.lowest + groove.back.value - 0.2 * length;
    let to = groove.lowest + groove.front.value + 0.2 * length;
    (0..nx)
        .filter(|&i| (from..=to).contains(&field.x[i]))
        .map(|i| (1e3 * field.x[i], -1e6 * groove.depth[deepest * nx + i]))
        .collect()
}

/// Film, pressure and width over the stations. Between these the film's strip takes the pressure as
/// linear, and the square of the width.
fn along(slid: &SolvedSliding) -> Vec<Line> {
    let stations = &slid.film.film.stations;
    let dots = |value: fn(&FilmStation) -> f64| -> Vec<Point> {
        let point = |s: &FilmStation| (1e3 * (slid.film.front - s.xi), value(s));
        stations.iter().map(point).collect()
    };
    let width = dots(|s| 1e4 * s.width);
    let squares = width.windows(2).flat_map(|pair| {
        let [(x, from), (to_x, to)] = [pair[0], pair[1]];
        (0..=BETWEEN).map(move |k| {
            let share = f64::from(k) / f64::from(BETWEEN);
            let square = from * from + share * (to * to - from * from);
            (x + share * (to_x - x), square.sqrt())
        })
    });
    let mut lines = vec![
        Line::between("film [0.1 µm]", dots(|s| 1e7 * s.thickness)),
        Line::between("pressure [MPa]", dots(|s| 1e-6 * s.pressure)),
        Line {
            name: "width [0.1 mm]",
            points: squares.collect(),
            dots: width,
        },
    ];
    if slid.friction.boundary.value > 0.0 {
        let share = dots(|s| 1e2 * s.boundary_share);
        lines.push(Line::between("boundary contact [%]", share));
    }
    lines
}

struct Line {
    name: &'static str,
    /// What is known, and the line through it.
    dots: Vec<Point>,
    points: Vec<Point>,
}

impl Line {
    /// Linear between its dots.
    fn between(name: &'static str, dots: Vec<Point>) -> Line {
        Line {
            name,
            points: dots.clone(),
            dots,
        }
    }
}

fn panel(title: &str, [x, y]: [&str; 2], lines: Vec<Line>) -> Panel {
    let layers = lines.into_iter().zip(PALETTE).flat_map(|(line, colour)| {
        [
            Layer::line(2.0, line.points, colour).named(line.name),
            Layer::dots(3.0, line.dots, colour),
        ]
    });
    Panel::new(Axis::new(x), Axis::new(y), layers.collect()).titled(title)
}
