//! `kufe friction CASES --groove --v-mps LIST --ice-c LIST`: friction of groove and melt film over
//! speed and temperature, for one or several runners.

use std::collections::BTreeSet;
use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{friction_table, lowest_friction};
use kufe::plot::{Axis, Figure, Layer, PALETTE, Panel, Point, extent};
use kufe::results::{CaseRecord, FastestRunners, FrictionRow, FrictionTable, write_csv};
use kufe_contact::Options;

use crate::friction::point::Args;
use crate::terminal::Global;
use crate::text::table_text;

/// Largest number of points, so that a typing error does not start a run of days.
const MAX_POINTS: usize = 10_000;

/// The columns that are printed.
const COLUMNS: [&str; 9] = [
    "case",
    "ice_c",
    "v_mps",
    "mu",
    "mu_ploughing",
    "mu_viscous",
    "mu_boundary",
    "groove_depth_m",
    "film_mean_m",
];

/// Solves, prints and writes.
///
/// # Errors
/// [`Failure::Usage`] for too long lists, else as [`friction_table`]; [`Failure::BadInput`] for an
/// output that cannot be written; [`Failure::NotConverged`], after all is written, where a requested
/// accuracy was not reached.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let (speeds, temperatures) = (&args.v_mps, &args.ice_c);
    let counts = [args.cases.len(), speeds.len(), temperatures.len()];
    let count = counts.into_iter().fold(1, usize::saturating_mul);
    if count > MAX_POINTS {
        let text = format!("{count} points: expected at most {MAX_POINTS}");
        return Err(Failure::Usage(text));
    }
    let cases = args.cases.iter().map(|path| LoadedCase::read(path));
    let cases: Vec<LoadedCase> = cases.collect::<Result<_, _>>()?;
    let output = args.output(&cases, global)?;
    let options = Options::default();
    let names = names(&args.cases);
    let (runners, short) = global.watched(|watch| {
        let solved = cases.iter().zip(names).map(|(loaded, name)| {
            let mut table = friction_table(loaded, speeds, temperatures, watch, &options)?;
            let rows = table.points.iter_mut();
            rows.for_each(|row| row.case.clone_from(&name));
            Ok((table.points, table.short))
        });
        solved.collect::<Result<(Vec<_>, Vec<_>), Failure>>()
    })?;
    let short = short.into_iter().flatten().next();
    // A single runner is not compared.
    let fastest = match runners.len() {
        ..2 => Vec::new(),
        _ => fastest_runners(&runners),
    };
    let result = FrictionTable {
        points: runners.concat(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        cases: cases
            .iter()
            .map(|loaded| CaseRecord::of(&loaded.case))
            .collect(),
        fastest,
    };
    let text = text(&result)?;
    match output {
        None => global.print(&result, || text)?,
        Some(output) => {
            output.write("friction.csv", |file| write_csv(file, &result.points))?;
            output.picture("friction.png", &picture(&runners))?;
            output.finish("friction.json", &result, global, || text)?;
        }
    }
    short.map_or(Ok(()), Err)
}

/// The stems of the files' names, or their whole paths if two stems are equal.
fn names(cases: &[PathBuf]) -> Vec<String> {
    let stems = cases
        .iter()
        .map(|path| path.file_stem().unwrap_or_default());
    let stems: Vec<String> = stems
        .map(|stem| stem.to_string_lossy().into_owned())
        .collect();
    let distinct: BTreeSet<&String> = stems.iter().collect();
    if distinct.len() == stems.len() {
        return stems;
    }
    cases
        .iter()
        .map(|path| path.display().to_string())
        .collect()
}

/// The runners with the least friction at each speed and temperature.
fn fastest_runners(runners: &[Vec<FrictionRow>]) -> Vec<FastestRunners> {
    let count = runners.first().map_or(0, Vec::len);
    let at = |k: usize| {
        let points: Vec<&FrictionRow> = runners.iter().map(|points| &points[k]).collect();
        let fastest = lowest_friction(&points).into_iter();
        FastestRunners {
            v_mps: points[0].v_mps,
            ice_c: points[0].ice_c,
            cases: fastest.map(|i| points[i].case.clone()).collect(),
        }
    };
    (0..count).map(at).collect()
}

fn text(result: &FrictionTable) -> Result<String, Failure> {
    let mut text = table_text(&result.points, &COLUMNS)?;
    for fastest in &result.fastest {
        let (speed, ice, cases) = (fastest.v_mps, fastest.ice_c, fastest.cases.join(", "));
        let verdict = match fastest.cases.len() {
            1 => "has the least friction",
            _ => "have the least friction, equal within their errors",
        };
        text += &format!("at {speed} m/s and {ice} °C {cases} {verdict}\n");
    }
    Ok(text)
}

/// A line of the picture: its name, and abscissa, mu and error of its points [1e-3].
type Line = (String, Vec<[f64; 3]>);

/// What the points are drawn over: its label, and its value.
type Over = (&'static str, fn(&FrictionRow) -> f64);

const SPEED: Over = ("speed [m/s]", |point| point.v_mps);
const TEMPERATURE: Over = ("temperature of the ice [°C]", |point| point.ice_c);

/// Mu of each runner over speed where there are several, else over temperature, else runner by
/// runner.
fn picture(runners: &[Vec<FrictionRow>]) -> Figure {
    let points = || runners.iter().flatten();
    let differ = |(_, of): &Over| points().any(|p| Some(of(p)) != points().next().map(of));
    let over = [SPEED, TEMPERATURE].into_iter().find(differ);
    let named_by_ice = differ(&SPEED) && differ(&TEMPERATURE);
    let mut lines: Vec<Line> = Vec::new();
    let numbered = runners.iter().enumerate();
    for (k, point) in numbered.flat_map(|(k, points)| points.iter().map(move |p| (k, p))) {
        let name = if named_by_ice {
            format!("{}, {} °C", point.case, point.ice_c)
        } else {
            point.case.clone()
        };
        let place = over.map_or(0.5 + k as f64, |(_, of)| of(point));
        let mu = point.friction.mu;
        let at = [place, 1e3 * mu.value, 1e3 * mu.error];
        match lines.iter_mut().find(|line| line.0 == name) {
            Some((_, line)) => line.push(at),
            None => lines.push((name, vec![at])),
        }
    }
    let places = || lines.iter().flat_map(|(_, line)| line);
    let [least, most] = extent(places().flat_map(|[_, mu, error]| [mu - error, mu + error]));
    let (x, y) = match over {
        Some((label, _)) => {
            let ends = extent(places().map(|at| at[0]).chain([0.0]));
            (
                Axis::new(label).within(ends.map(|end| 1.05 * end)),
                [0.0, 1.1 * most],
            )
        }
        // Runner by runner the differences matter, not the size.
        None => {
            let first = runners.iter().filter_map(|points| points.first());
            let room = 0.2 * (most - least);
            let names = Axis::names("runner", first.map(|point| &*point.case));
            (names, [least - room, most + room])
        }
    };
    let mut layers = Vec::new();
    for ((name, line), colour) in lines.iter_mut().zip(PALETTE.iter().cycle()) {
        line.sort_by(|a, b| a[0].total_cmp(&b[0]));
        let point = |[x, mu, _]: &[f64; 3]| -> Point { (*x, *mu) };
        let errors = line.iter();
        let errors = errors.map(|[x, mu, error]| [(*x, mu - error), (*x, mu + error)]);
        layers.push(Layer::segments(1.0, errors, *colour));
        if over.is_some() {
            layers.push(Layer::line(2.0, line.iter().map(point), *colour).named(name.as_str()));
        }
        layers.push(Layer::dots(4.0, line.iter().map(point), *colour));
    }
    let y = Axis::new("coefficient of friction mu [1e-3]").within(y);
    let title = "friction of groove and melt film";
    Figure::new(900.0, title).row(460.0, [Panel::new(x, y, layers)])
}
