//! A measured run driven again by the model.

use std::path::{Path, PathBuf};

use kufe::charts::replay_picture;
use kufe::jobs::replay::{ReplayedDrive, entry_on_track};
use kufe::jobs::runs::{run_inputs, write_runs, write_track};
use kufe::jobs::view_runs::ViewOptions;
use kufe::jobs::{Failure, channel_series};
use kufe::plot::unit_of;
use kufe_sled::{Entry, Replay, SimulateOptions, Track, table_samples};

use crate::output::OutputDir;
use crate::runs::files::{draw_tables, run_format, write_mat};
use crate::runs::simulate::Args;
use crate::runs::{all_runs, write_view};
use crate::terminal::Global;

/// Drives the run again and writes it with the measurement.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::Usage`] for options out of range.
pub fn run(
    args: &Args,
    model_file: &Path,
    track_file: &Path,
    global: &Global,
) -> Result<(), Failure> {
    let track = Track::load(track_file)?;
    let mut inputs: Vec<PathBuf> = vec![model_file.to_path_buf(), track_file.to_path_buf()];
    inputs.extend(args.replay.iter().flat_map(|runs| run_inputs(runs)));
    let drive = ReplayedDrive {
        model: model_file.to_path_buf(),
        entry: entry(args, &track)?,
        track,
        strict: args.strict,
        options: SimulateOptions {
            step_s: args.step_s,
            rate_hz: args.rate_hz,
            most_s: args.most_s,
            ..SimulateOptions::default()
        },
    };
    let output = OutputDir::begin("simulate --replay", &inputs, &args.out, global.force)?;
    let mut replayed = global.watched(|watch| drive.drive(watch))?;
    write_runs(
        output.files(),
        std::slice::from_mut(&mut replayed.driven),
        run_format(args.parquet),
    )?;
    write_track(output.files(), &drive.track)?;
    let document = replayed.document();
    let (done, driven) = (&replayed.replay, &replayed.driven);
    if args.mat {
        let series = channel_series(std::slice::from_ref(driven));
        write_mat(&output, "simulation.mat", &document, series)?;
    }
    output.picture("replay.png", &replay_picture(done))?;
    let states = done.simulated.instants.iter().map(|instant| &instant.state);
    let mut pictures = draw_tables(&output, &replayed.vehicle, &table_samples(states))?;
    if let Some(run) = args.run.as_ref().filter(|_| args.view) {
        let options = ViewOptions {
            model: Some(model_file.to_path_buf()),
            track: Some(track_file.to_path_buf()),
            only: vec![run.clone()],
            ..all_runs(args.replay.clone().unwrap_or_default())
        };
        let viewer = write_view(&output, &options, global)?;
        pictures.extend(viewer.map(str::to_owned));
    }
    output.json("simulation.json", &document)?;
    output.commit()?;
    global.print(&document, || {
        let (out, run) = (args.out.display(), driven.entry.file.display());
        let track = kufe_sled::track_file(&drive.track.name);
        let pictures: String = pictures.iter().map(|name| format!(", {name}")).collect();
        summary(done)
            + &format!("{out}: runs.csv, {run}, {track}, simulation.json, replay.png{pictures}\n")
    })
}

/// The run's row: of the index where one is named by `--run`, else made of the options.
fn entry(args: &Args, track: &Track) -> Result<Entry, Failure> {
    let file = args.replay.clone().unwrap_or_default();
    let Some(name) = &args.run else {
        let stem = file.file_stem().unwrap_or_default();
        return Ok(Entry {
            run: stem.to_string_lossy().into_owned(),
            file,
            track: track.name.clone(),
            driver: "measured".to_owned(),
            driver_class: "measured".to_owned(),
            session: args.session.clone(),
            conditions: args.conditions()?,
            ..Entry::default()
        });
    };
    entry_on_track(&file, name, track)
}

fn summary(done: &Replay) -> String {
    let (run, track, from, to) = (&done.run, &done.track, done.from_m.round() + 0.0, done.to_m);
    let mut text = format!(
        "{run} on {track}, {from:.0} to {to:.0} m, measured minus model\n\
         column              root mean square        at the end           largest\n"
    );
    for difference in &done.differences {
        let (column, rms, end) = (&difference.column, difference.rms, difference.end);
        let (most, at) = (difference.largest, difference.largest_at_m);
        text += &format!("{column:18} {rms:17.4} {end:17.4} {most:17.4} at {at:.0} m\n");
    }
    let missing = done.mean_force_n;
    text += &format!("mean force along the sled missing from the model: {missing:.1} N\n");
    for section in &done.sections {
        let (column, from, to) = (&section.column, section.from_m, section.to_m);
        let unit = match column.as_str() {
            "v_mps" => "N".into(),
            column => unit_of(column),
        };
        let time = match section.lost_s {
            lost if lost >= 5e-4 => format!("; the run loses {lost:.3} s there"),
            lost if lost <= -5e-4 => format!("; the run gains {:.3} s there", -lost),
            _ => String::new(),
        };
        let (size, times) = (section.size, section.times_rms);
        text += &format!(
            "{column} differs from {from:.0} to {to:.0} m, by {size:.3} {unit} or {times:.1} times its root mean square{time}\n"
        );
    }
    text
}
