//! `kufe friction CASES --groove --v-mps LIST --ice-c LIST`: the groove and the melt film's friction over speed and temperature, runners side by side.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

use kufe::jobs::case_file::LoadedCase;
use kufe::jobs::slide::{FrictionPoint, fastest, friction_table};
use kufe::jobs::{Failure, case_json};
use kufe_contact::Options;
use serde_json::{Value, json};

use crate::friction::asked::{Asked, Runner, begin};
use crate::friction::sliding_picture;
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
    let staging = begin(asked, &cases)?;
    let options = Options::default();
    let names = names(asked.cases);
    let runners = watched(global, |watch| {
        let solved = cases.iter().zip(names).map(|(loaded, name)| {
            let points = friction_table(loaded, asked.speeds, asked.temperatures, watch, &options)?;
            Ok(Runner { name, points })
        });
        solved.collect::<Result<Vec<Runner>, Failure>>()
    })?;
    let rows = runners
        .iter()
        .flat_map(|r| r.points.iter().map(|p| row(&r.name, p)));
    let mut document = json!({
        "points": rows.collect::<Vec<Value>>(),
        "version": env!("CARGO_PKG_VERSION"),
        "cases": cases.iter().map(|loaded| case_json(&loaded.case)).collect::<Vec<Value>>(),
    });
    // A single runner is compared with none.
    let verdicts = if runners.len() > 1 {
        verdicts(&runners)
    } else {
        Vec::new()
    };
    if !verdicts.is_empty() {
        document["fastest"] = verdicts.iter().map(Verdict::json).collect();
    }
    if let Some(staging) = staging {
        staging.write("friction.csv", |file| write_csv(file, &runners))?;
        kufe::plot::png(&staging.path("friction.png"), 900, 620, &|root| {
            sliding_picture::draw(&root, &runners)
        })
        .map_err(|error| staging.failure("friction.png", &error))?;
        staging.document("friction.json", &mut document)?;
        staging.commit()?;
    }
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        let mut text = table(&runners);
        verdicts.iter().for_each(|v| text += &v.text());
        say(&text);
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

/// Which runners have the least friction at one speed and temperature.
struct Verdict<'a> {
    v_mps: f64,
    ice_c: f64,
    fastest: Vec<&'a str>,
}

fn verdicts(runners: &[Runner]) -> Vec<Verdict<'_>> {
    let count = runners.first().map_or(0, |runner| runner.points.len());
    let at = |k: usize| {
        let points: Vec<FrictionPoint> = runners.iter().map(|r| r.points[k]).collect();
        Verdict {
            v_mps: points[0].v_mps,
            ice_c: points[0].ice_c,
            fastest: fastest(&points)
                .into_iter()
                .map(|i| runners[i].name.as_str())
                .collect(),
        }
    };
    (0..count).map(at).collect()
}

impl Verdict<'_> {
    fn json(&self) -> Value {
        json!({ "v_mps": self.v_mps, "ice_c": self.ice_c, "cases": self.fastest })
    }

    fn text(&self) -> String {
        let told = match self.fastest[..] {
            [one] => format!("{one} has the least friction"),
            _ => format!(
                "{} have the least friction and cannot be told apart within their errors",
                self.fastest.join(", ")
            ),
        };
        format!("at {} m/s and {} C {told}\n", self.v_mps, self.ice_c)
    }
}

const HEADER: &str = "case,ice_c,v_mps,mu,mu_error,mu_ploughing,mu_ploughing_error,mu_viscous,mu_viscous_error,groove_depth_m,groove_depth_error_m,film_mean_m,hardness_pa";

fn values(point: &FrictionPoint) -> [f64; 12] {
    let friction = &point.friction;
    [
        point.ice_c,
        point.v_mps,
        friction.mu.value,
        friction.mu.error,
        friction.ploughing.value,
        friction.ploughing.error,
        friction.viscous.value,
        friction.viscous.error,
        point.groove_depth.value,
        point.groove_depth.error,
        point.film_mean,
        point.hardness,
    ]
}

fn row(name: &str, point: &FrictionPoint) -> Value {
    let numbers = values(point).map(|value| json!(value));
    let pairs = HEADER
        .split(',')
        .zip([json!(name)].into_iter().chain(numbers));
    pairs
        .map(|(key, value)| (key.to_owned(), value))
        .collect::<serde_json::Map<_, _>>()
        .into()
}

fn write_csv(file: impl Write, runners: &[Runner]) -> io::Result<()> {
    let mut csv = csv::Writer::from_writer(file);
    csv.write_record(HEADER.split(','))?;
    for runner in runners {
        for point in &runner.points {
            let cells = values(point).map(|value| value.to_string());
            csv.write_record([runner.name.clone()].iter().chain(&cells))?;
        }
    }
    csv.flush()
}

fn table(runners: &[Runner]) -> String {
    let wide = runners
        .iter()
        .map(|r| r.name.chars().count())
        .max()
        .unwrap_or(0)
        .max(6);
    let mut text = format!(
        "{:wide$}  ice [C]  speed [m/s]  mu [1e-3]       ploughing  film   groove [µm]  film [µm]\n",
        "runner"
    );
    for (runner, point) in runners
        .iter()
        .flat_map(|r| r.points.iter().map(move |p| (r, p)))
    {
        let friction = &point.friction;
        text += &format!(
            "{:wide$}  {:7.1}  {:11.1}  {:6.3} +- {:5.3}  {:9.3}  {:5.3}  {:11.2}  {:9.3}\n",
            runner.name,
            point.ice_c,
            point.v_mps,
            1e3 * friction.mu.value,
            1e3 * friction.mu.error,
            1e3 * friction.ploughing.value,
            1e3 * friction.viscous.value,
            1e6 * point.groove_depth.value,
            1e6 * point.film_mean,
        );
    }
    text
}
