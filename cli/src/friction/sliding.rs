//! `kufe friction CASES --groove --v-mps LIST --ice-c LIST`: the groove and the melt film's friction over speed and temperature, runners side by side.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::field::pretty;
use kufe::jobs::slide::{FrictionPoint, fastest, friction_table};
use kufe::results::{CaseRecord, FastestRunners, FrictionRow, FrictionTable, write_csv};
use kufe_contact::Options;

use crate::friction::asked::{Asked, Runner, begin};
use crate::friction::sliding_picture::sliding_picture;
use crate::output::global::Global;
use crate::output::say::say;
use crate::output::watched::watched;

/// Most points of a table, so that a slip of the hand does not run for days.
const MOST: usize = 10_000;

/// Solves, prints and writes.
///
/// # Errors
/// [`Failure::Usage`] for too long lists, else as [`friction_table`]; [`Failure::BadInput`] for an output that cannot be written.
pub fn run(asked: &Asked, global: &Global) -> Result<(), Failure> {
    let counts = [asked.speeds.len(), asked.temperatures.len()];
    let count = counts
        .iter()
        .fold(asked.cases.len(), |n, &k| n.saturating_mul(k));
    if count > MOST {
        let text = format!("{count} points: expected at most {MOST}");
        return Err(Failure::Usage(text));
    }
    let cases = asked.cases.iter().map(|path| LoadedCase::read(path));
    let cases: Vec<LoadedCase> = cases.collect::<Result<_, _>>()?;
    let output = begin(asked, &cases, global)?;
    let options = Options::default();
    let names = names(asked.cases);
    let runners = watched(global, |watch| {
        let solved = cases.iter().zip(names).map(|(loaded, name)| {
            let points = friction_table(loaded, asked.speeds, asked.temperatures, watch, &options)?;
            Ok(Runner { name, points })
        });
        solved.collect::<Result<Vec<Runner>, Failure>>()
    })?;
    let points = runners.iter().flat_map(|runner| {
        let row = |point| FrictionRow::new(&runner.name, point);
        runner.points.iter().map(row)
    });
    // A single runner is compared with none.
    let fastest = match runners.len() {
        ..2 => Vec::new(),
        _ => fastest_runners(&runners),
    };
    let result = FrictionTable {
        points: points.collect(),
        version: env!("CARGO_PKG_VERSION").to_owned(),
        cases: cases
            .iter()
            .map(|loaded| CaseRecord::of(&loaded.case))
            .collect(),
        fastest,
    };
    let mut json = pretty(&result)?;
    if let Some(output) = output {
        output.write("friction.csv", |file| write_csv(file, &result.points))?;
        output.picture("friction.png", &sliding_picture(&runners))?;
        json = output.json("friction.json", &result)?;
        output.commit()?;
    }
    if global.json {
        say(&json);
    } else if !global.quiet {
        say(&text(&result));
    }
    Ok(())
}

/// The files' names without folder and ending, or the whole paths where two have the same.
fn names(cases: &[PathBuf]) -> Vec<String> {
    let stem = |path: &Path| {
        path.file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    let stems: Vec<String> = cases.iter().map(|path| stem(path)).collect();
    let twice = |name: &String| stems.iter().filter(|other| *other == name).count() > 1;
    match stems.iter().any(twice) {
        true => cases
            .iter()
            .map(|path| path.display().to_string())
            .collect(),
        false => stems,
    }
}

/// The runners with the least friction at each speed and temperature.
fn fastest_runners(runners: &[Runner]) -> Vec<FastestRunners> {
    let count = runners.first().map_or(0, |runner| runner.points.len());
    let at = |k: usize| {
        let points: Vec<FrictionPoint> = runners.iter().map(|r| r.points[k]).collect();
        let fastest = fastest(&points).into_iter();
        FastestRunners {
            v_mps: points[0].v_mps,
            ice_c: points[0].ice_c,
            cases: fastest.map(|i| runners[i].name.clone()).collect(),
        }
    };
    (0..count).map(at).collect()
}

fn text(result: &FrictionTable) -> String {
    let names = result.points.iter().map(|row| row.case.chars().count());
    let wide = names.max().unwrap_or(0).max(6);
    let mut text = format!(
        "{:wide$}  ice [C]  speed [m/s]  mu [1e-3]       ploughing  film   boundary  groove [µm]  film [µm]\n",
        "runner"
    );
    for row in &result.points {
        text += &format!(
            "{:wide$}  {:7.1}  {:11.1}  {:6.3} +- {:5.3}  {:9.3}  {:5.3}  {:8.3}  {:11.2}  {:9.3}\n",
            row.case,
            row.ice_c,
            row.v_mps,
            1e3 * row.mu.value,
            1e3 * row.mu.error,
            1e3 * row.mu_ploughing.value,
            1e3 * row.mu_viscous.value,
            1e3 * row.mu_boundary.value,
            1e6 * row.groove_depth.value,
            1e6 * row.film_mean_m,
        );
    }
    for fastest in &result.fastest {
        let verdict = match &fastest.cases[..] {
            [one] => format!("{one} has the least friction"),
            several => format!(
                "{} have the least friction and cannot be told apart within their errors",
                several.join(", ")
            ),
        };
        text += &format!(
            "at {} m/s and {} C {verdict}\n",
            fastest.v_mps, fastest.ice_c
        );
    }
    text
}
