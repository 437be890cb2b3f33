//! `kufe runs align`: runs brought to one distance along their track.

use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, runs::failure};
use kufe_sled::{
    Aligned, Entry, Error, Model, Needs, OnGaps, PrepareOptions, Prepared, Run, RunFormat,
    SampleCoverage, Track, TrackShape, Vehicle, align, gaps_line, prepare_all, read_index,
    read_runs, run_file, state_places, track_file, write_index, write_run,
};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::say::{say, warn};

const EXAMPLES: &str = "\
Examples:
  kufe runs align runs.csv --model model.toml -o aligned/              along track_NAME.csv beside runs.csv, where it is there
  kufe runs align runs.csv --model model.toml --estimate -o aligned/   along one another, whatever track files there are

Writes runs.csv and one file a run with s_m along the track, track_NAME.csv (the survey, or what the runs felt, with its
standard errors) and align.json. The model says where the sensors are.";

/// What the alignment found.
const MARK: &str = "align.json";

/// Arguments of `kufe runs align`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    /// Index of the runs
    pub runs: PathBuf,
    /// Model of the sled and its friction: where its sensors are, and its tolerances
    #[arg(long, short, value_name = "MODEL.toml")]
    pub model: PathBuf,
    /// Folder for the runs
    #[arg(long, short, value_name = "FOLDER")]
    pub out: PathBuf,
    /// Estimate every track from its runs, also where there is a survey
    #[arg(long)]
    pub estimate: bool,
    /// Refuse runs that miss files, values or rows, have uneven times or stand still, instead of leaving them out
    #[arg(long)]
    pub strict: bool,
    /// Write Parquet instead of CSV
    #[arg(long)]
    pub parquet: bool,
}

/// Aligns, writes and tells.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let refusal = |error: Error| failure(&error);
    let model = Model::load(&args.model).map_err(refusal)?;
    let vehicle = Vehicle::with_effects(&model).map_err(refusal)?;
    let bar = global.progress();
    bar.set_message(format!("reading {}", args.runs.display()));
    let on_gaps = if args.strict {
        OnGaps::Refuse
    } else {
        OnGaps::LeaveOut
    };
    let needs = needs(args)?;
    let mut runs = read_runs(&args.runs, &needs, on_gaps).map_err(refusal)?;
    let format = if args.parquet {
        RunFormat::Parquet
    } else {
        RunFormat::Csv
    };
    let output = begin(args, &runs, global)?;
    bar.set_message(format!("aligning {} runs", runs.len()));
    let prepared = prepare_all(
        &runs,
        &vehicle,
        model.noise.as_ref(),
        &PrepareOptions {
            needs,
            ..PrepareOptions::default()
        },
    )
    .map_err(refusal)?;
    let mut tracks: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for (i, run) in prepared.iter().enumerate() {
        tracks.entry(&run.entry.track).or_default().push(i);
    }
    let mut told_tracks: Vec<Value> = Vec::new();
    for (name, members) in &tracks {
        let of: Vec<&Prepared> = members.iter().map(|i| &prepared[*i]).collect();
        let survey = survey(args, name)?;
        let shape = survey.as_ref().map(TrackShape::new);
        let tolerances = model.tolerances.unwrap_or_default();
        let aligned = align(&of, &vehicle, shape.as_ref(), &tolerances).map_err(refusal)?;
        for (i, found) in members.iter().zip(&aligned.runs) {
            state_places(&mut runs[*i], &found.warp).map_err(refusal)?;
        }
        write_track(&output, name, survey.as_ref(), &aligned)?;
        told_tracks.push(described(name, survey.is_some(), &aligned));
    }
    bar.set_message("writing");
    write(&output, &mut runs, format)?;
    let mut document = json!({
        "index": args.runs.display().to_string(),
        "tracks": told_tracks,
        "version": env!("CARGO_PKG_VERSION"),
    });
    let parts = prepared.iter().map(|run| run.taking_part.clone());
    let gaps: Vec<SampleCoverage> = parts.filter(|run| !run.gaps.is_none()).collect();
    if !gaps.is_empty() {
        document["gaps"] = json!(gaps);
    }
    output.json(MARK, &document)?;
    output.commit()?;
    bar.finish_and_clear();
    for remark in runs.iter().flat_map(|run| &run.remarks) {
        warn(remark);
    }
    if !gaps.is_empty() {
        warn(&gaps_line(&gaps));
    }
    if global.json {
        say(&format!("{document:#}\n"));
    } else if !global.quiet {
        say(&summary(&told_tracks));
        say(&format!(
            "{}: runs.csv, {} runs, {} tracks, {MARK}\n",
            args.out.display(),
            runs.len(),
            told_tracks.len()
        ));
    }
    Ok(())
}

/// What the runs must have: more where the track is estimated from them.
fn needs(args: &Args) -> Result<Needs, Failure> {
    let entries = read_index(&args.runs).map_err(|error| failure(&error))?;
    let surveyed = |entry: &Entry| !args.estimate && survey_file(args, &entry.track).exists();
    match entries.iter().all(surveyed) {
        true => Ok(Needs::PLACE),
        false => Ok(Needs::TRACK),
    }
}

/// The output folder.
fn begin(args: &Args, runs: &[Run], global: &Global) -> Result<OutputDir, Failure> {
    let mut inputs = vec![args.runs.clone(), args.model.clone()];
    inputs.extend(runs.iter().map(|run| run.entry.file.clone()));
    inputs.extend(runs.iter().map(|run| survey_file(args, &run.entry.track)));
    OutputDir::begin("runs align", &inputs, &args.out, global.force)
}

fn survey_file(args: &Args, name: &str) -> PathBuf {
    let folder = args.runs.parent().unwrap_or(Path::new(""));
    folder.join(track_file(name))
}

fn survey(args: &Args, name: &str) -> Result<Option<Track>, Failure> {
    let path = survey_file(args, name);
    if args.estimate || !path.exists() {
        return Ok(None);
    }
    let track = Track::load(&path).map_err(|error| failure(&error))?;
    Ok(Some(track))
}

fn write_track(
    output: &OutputDir,
    name: &str,
    survey: Option<&Track>,
    aligned: &Aligned,
) -> Result<(), Failure> {
    let file = track_file(name);
    match (survey, &aligned.estimate) {
        (Some(track), _) => output.write(&file, |file| track.write_csv(BufWriter::new(file))),
        (None, Some(estimate)) => {
            output.write(&file, |file| estimate.write_csv(BufWriter::new(file)))
        }
        (None, None) => {
            warn(&format!(
                "track {name}: fewer than two runs felt the same metre: no track is estimated"
            ));
            Ok(())
        }
    }
}

fn write(output: &OutputDir, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
    for run in runs.iter_mut() {
        run.entry.file = PathBuf::from(run_file(&run.entry.run, format));
    }
    runs.par_iter()
        .map(|run| {
            let name = run.entry.file.display().to_string();
            output.write(&name, |mut file| write_run(run, &mut file, format))
        })
        .collect::<Result<Vec<()>, Failure>>()?;
    let entries: Vec<Entry> = runs.iter().map(|run| run.entry.clone()).collect();
    output.write("runs.csv", |file| write_index(file, &entries))
}

fn described(name: &str, surveyed: bool, aligned: &Aligned) -> Value {
    let mean = |sd: &[f64]| (sd.iter().map(|x| x * x).sum::<f64>() / sd.len() as f64).sqrt();
    let estimate = aligned.estimate.as_ref().map(|estimate| {
        let [slope, curvature, bank] = estimate.sd.each_ref().map(|sd| mean(sd));
        let s = &estimate.track.s_m;
        json!({
            "from_m": s[0],
            "to_m": s[s.len() - 1],
            "slope_sd_rad": slope,
            "curvature_sd_1pm": curvature,
            "bank_sd_rad": bank,
        })
    });
    json!({ "track": name, "surveyed": surveyed, "runs": aligned.runs, "estimate": estimate })
}

fn summary(tracks: &[Value]) -> String {
    let mut text = String::new();
    for track in tracks {
        let along = if track["surveyed"] == true {
            "along the survey"
        } else {
            "along one another"
        };
        text += &format!(
            "{} {along}\nrun               starts at [m]   stretch   drift [m]   within [m]\n",
            track["track"].as_str().unwrap_or_default()
        );
        for run in track["runs"].as_array().into_iter().flatten() {
            let number = |key: &str| run[key].as_f64().unwrap_or(f64::NAN);
            text += &format!(
                "{:16} {:14.2} {:9.4} {:11.2} {:12.2}\n",
                run["run"].as_str().unwrap_or_default(),
                number("start_m"),
                number("stretch"),
                number("drift_m"),
                number("sd_m")
            );
        }
    }
    text
}
