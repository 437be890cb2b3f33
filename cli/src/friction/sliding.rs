//! `kufe friction CASES --groove --v-mps LIST --ice-c LIST`: the groove and the melt film's
//! friction over speed and temperature, runners side by side.

use std::collections::BTreeSet;
use std::path::PathBuf;

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{fastest, friction_table};
use kufe::results::{CaseRecord, FastestRunners, FrictionRow, FrictionTable, write_csv};
use kufe_contact::Options;

use crate::friction::point::Args;
use crate::friction::sliding_picture::sliding_picture;
use crate::terminal::Global;

/// Most points of a table, so that a slip of the hand does not run for days.
const MOST: usize = 10_000;

/// Solves, prints and writes.
///
/// # Errors
/// [`Failure::Usage`] for too long lists, else as [`friction_table`]; [`Failure::BadInput`] for an
/// output that cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let (speeds, temperatures) = (&args.v_mps, &args.ice_c);
    let counts = [args.cases.len(), speeds.len(), temperatures.len()];
    let count = counts.into_iter().fold(1, usize::saturating_mul);
    if count > MOST {
        let text = format!("{count} points: expected at most {MOST}");
        return Err(Failure::Usage(text));
    }
    let cases = args.cases.iter().map(|path| LoadedCase::read(path));
    let cases: Vec<LoadedCase> = cases.collect::<Result<_, _>>()?;
    let output = args.output(&cases, global)?;
    let options = Options::default();
    let names = names(&args.cases);
    let runners = global.watched(|watch| {
        let solved = cases.iter().zip(names).map(|(loaded, name)| {
            let mut points = friction_table(loaded, speeds, temperatures, watch, &options)?;
            points.iter_mut().for_each(|row| row.case.clone_from(&name));
            Ok(points)
        });
        solved.collect::<Result<Vec<_>, Failure>>()
    })?;
    // A single runner is compared with none.
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
    if let Some(output) = output {
        output.write("friction.csv", |file| write_csv(file, &result.points))?;
        output.picture("friction.png", &sliding_picture(&runners))?;
        output.json("friction.json", &result)?;
        output.commit()?;
    }
    global.print(&result, || text(&result))
}

/// The files' names without folder and ending, or the whole paths where two have the same.
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
        let fastest = fastest(&points).into_iter();
        FastestRunners {
            v_mps: points[0].v_mps,
            ice_c: points[0].ice_c,
            cases: fastest.map(|i| points[i].case.clone()).collect(),
        }
    };
    (0..count).map(at).collect()
}

fn text(result: &FrictionTable) -> String {
    let names = result.points.iter().map(|row| row.case.chars().count());
    let wide = names.fold(6, usize::max);
    let mut text = format!(
        "{:wide$}  ice [C]  speed [m/s]  mu [1e-3]       ploughing  film   boundary  groove [µm]  film [µm]\n",
        "runner"
    );
    for row in &result.points {
        let (case, ice, speed) = (&row.case, row.ice_c, row.v_mps);
        let f = &row.friction;
        let [mu, error, ploughing] = [f.mu.value, f.mu.error, f.ploughing.value].map(|mu| 1e3 * mu);
        let [viscous, boundary] = [f.viscous.value, f.boundary.value].map(|mu| 1e3 * mu);
        let (groove, film) = (1e6 * row.groove_depth.value, 1e6 * row.film_mean_m);
        text += &format!(
            "{case:wide$}  {ice:7.1}  {speed:11.1}  {mu:6.3} +- {error:5.3}  {ploughing:9.3}  {viscous:5.3}  {boundary:8.3}  {groove:11.2}  {film:9.3}\n"
        );
    }
    for fastest in &result.fastest {
        let (speed, ice, cases) = (fastest.v_mps, fastest.ice_c, fastest.cases.join(", "));
        let verdict = match fastest.cases.len() {
            1 => "has the least friction",
            _ => "have the least friction, equal within their errors",
        };
        text += &format!("at {speed} m/s and {ice} C {cases} {verdict}\n");
    }
    text
}
