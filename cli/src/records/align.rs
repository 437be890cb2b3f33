//! `kufe runs align`: runs brought to one distance along their track.

use std::collections::BTreeMap;
use std::io::BufWriter;
use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, runs::failure};
use kufe_sled::{
    Aligned, Entry, Error, Model, Needs, OnGaps, PrepareOptions, Prepared, Run, RunFormat,
    TakingPart, Track, TrackShape, Vehicle, align, gaps_line, prepare_all, read_index, read_runs,
    state_places, write_index, write_run,
};
use rayon::prelude::*;
use serde_json::{Value, json};

use crate::output::global::Global;
use crate::output::say::say;
use crate::output::staging::Staging;
use crate::output::watched::warn;

const EXAMPLES: &str = "\
Examples:
  kufe runs align runs.csv --model model.toml -o aligned/              along track_NAME.csv beside runs.csv, where it is there
  kufe runs align runs.csv --model model.toml --estimate -o aligned/   along one another, whatever track files there are

Writes runs.csv and one file a run with s_m along the track, track_NAME.csv (the survey, or what the runs felt, with its
standard errors) and align.json. The model says where the sensors are.";

/// What marks a folder that this command wrote.
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
    /// Refuse runs with missing values or rows, uneven time or standstill, instead of leaving those samples out
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
    let told = |error: Error| failure(&error);
    let model = Model::load(&args.model).map_err(told)?;
    let vehicle = Vehicle::with_effects(&model).map_err(told)?;
    let bar = global.progress();
    bar.set_message(format!("reading {}", args.runs.display()));
    let on_gaps = if args.strict {
        OnGaps::Refuse
    } else {
        OnGaps::LeaveOut
    };
    let needs = needs(args)?;
    let mut runs = read_runs(&args.runs, &needs, on_gaps).map_err(told)?;
    let format = if args.parquet {
        RunFormat::Parquet
    } else {
        RunFormat::Csv
    };
    let staging = begin(args, &runs, format)?;
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
    .map_err(told)?;
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
        let aligned = align(&of, &vehicle, shape.as_ref(), &tolerances).map_err(told)?;
        for (i, found) in members.iter().zip(&aligned.runs) {
            state_places(&mut runs[*i], &found.warp).map_err(told)?;
        }
        write_track(&staging, name, survey.as_ref(), &aligned)?;
        told_tracks.push(described(name, survey.is_some(), &aligned));
    }
    bar.set_message("writing");
    write(&staging, &mut runs, format)?;
    let mut document = json!({
        "index": args.runs.display().to_string(),
        "tracks": told_tracks,
        "version": env!("CARGO_PKG_VERSION"),
    });
    let parts = prepared.iter().map(|run| run.taking_part.clone());
    let gaps: Vec<TakingPart> = parts.filter(|run| !run.gaps.is_none()).collect();
    if !gaps.is_empty() {
        document["gaps"] = json!(gaps);
    }
    staging.document(MARK, &mut document)?;
    staging.commit()?;
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
    let surveyed = |entry: &Entry| !args.estimate && track_file(args, &entry.track).exists();
    match entries.iter().all(surveyed) {
        true => Ok(Needs::PLACE),
        false => Ok(Needs::TRACK),
    }
}

/// The output folder, if the runs that it holds are those of this command.
fn begin(args: &Args, runs: &[Run], format: RunFormat) -> Result<Staging, Failure> {
    let index = args.out.join("runs.csv");
    if index.exists() && !args.out.join(MARK).is_file() {
        return Err(Failure::BadInput(format!(
            "{}: cannot be written: it stands there already and kufe runs align did not write it; expected another folder",
            index.display()
        )));
    }
    let mut inputs = vec![args.runs.clone(), args.model.clone()];
    inputs.extend(runs.iter().map(|run| run.entry.file.clone()));
    let mut names = vec!["runs.csv".to_owned(), MARK.to_owned()];
    for run in runs {
        names.push(file_of(&run.entry, format));
        names.push(format!("track_{}.csv", run.entry.track));
        inputs.push(track_file(args, &run.entry.track));
    }
    names.sort();
    names.dedup();
    let staging = Staging::beside(&inputs, &args.out, &names)?;
    staging.remove_on_interrupt();
    Ok(staging)
}

fn file_of(entry: &Entry, format: RunFormat) -> String {
    format!("{}.{}", entry.run, format.extension())
}

fn track_file(args: &Args, name: &str) -> PathBuf {
    let folder = args.runs.parent().unwrap_or(Path::new(""));
    folder.join(format!("track_{name}.csv"))
}

fn survey(args: &Args, name: &str) -> Result<Option<Track>, Failure> {
    let path = track_file(args, name);
    if args.estimate || !path.exists() {
        return Ok(None);
    }
    let track = Track::load(&path).map_err(|error| failure(&error))?;
    Ok(Some(track))
}

fn write_track(
    staging: &Staging,
    name: &str,
    survey: Option<&Track>,
    aligned: &Aligned,
) -> Result<(), Failure> {
    let file = format!("track_{name}.csv");
    match (survey, &aligned.estimate) {
        (Some(track), _) => staging.write(&file, |file| track.write_csv(BufWriter::new(file))),
        (None, Some(estimate)) => {
            staging.write(&file, |file| estimate.write_csv(BufWriter::new(file)))
        }
        (None, None) => {
            warn(&format!(
                "track {name}: fewer than two runs felt the same metre: no track is estimated"
            ));
            Ok(())
        }
    }
}

fn write(staging: &Staging, runs: &mut [Run], format: RunFormat) -> Result<(), Failure> {
    for run in runs.iter_mut() {
        run.entry.file = PathBuf::from(file_of(&run.entry, format));
    }
    runs.par_iter()
        .map(|run| {
            let name = run.entry.file.display().to_string();
            staging.write(&name, |mut file| write_run(run, &mut file, format))
        })
        .collect::<Result<Vec<()>, Failure>>()?;
    let entries: Vec<Entry> = runs.iter().map(|run| run.entry.clone()).collect();
    staging.write("runs.csv", |file| write_index(file, &entries))
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
