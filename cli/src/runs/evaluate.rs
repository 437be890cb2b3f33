//! `kufe evaluate`: losses of drivers over a straight glide.

use kufe::charts::{angle_picture, energy_picture, force_picture, losses_picture};
use kufe::jobs::Failure;
use kufe::jobs::view_runs::ViewOptions;
use kufe::plot::Figure;
use kufe::results::{Evaluation, write_evaluation_csv};
use kufe_sled::{
    DriverLosses, Group, RunEvaluation, distinct, evaluate, file_stem, groups, losses_by_driver,
    table_samples,
};

use crate::output::OutputDir;
use crate::runs::arguments::RunArgs;
use crate::runs::files::draw_tables;
use crate::runs::{all_runs, write_view};
use crate::terminal::Global;

/// Arguments of `kufe evaluate`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    runs: RunArgs,
    /// Run whose forces are drawn (default: the first)
    #[arg(long, value_name = "NAME")]
    run: Option<String>,
    /// Seed of the random choices behind the intervals
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Write view.html too, the page of kufe runs view with these runs: the page of kufe report links into it
    #[arg(long)]
    view: bool,
}

/// Evaluates and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let inputs = args.runs.inputs();
    let output = OutputDir::begin("evaluate", &inputs, &args.runs.out, global.force)?;
    let selection = args.runs.selection();
    let loaded = global.watched(|watch| selection.load(watch, |_| true))?;
    let runs = evaluate(&loaded.prepared, &loaded.vehicle);
    let groups = groups(&runs, args.seed);
    let drivers = losses_by_driver(&runs);
    let document = Evaluation {
        runs,
        groups,
        drivers,
        interval: "95 % of the mean, bootstrap over runs".to_owned(),
        used: loaded.used.clone(),
    };
    let runs = &document.runs;
    let drawn = match &args.run {
        None => &runs[0],
        Some(name) => runs.iter().find(|run| run.run == *name).ok_or_else(|| {
            let names: Vec<&str> = runs.iter().map(|run| run.run.as_str()).collect();
            Failure::BadInput(format!("--run {name}: the runs are {}", names.join(", ")))
        })?,
    };
    output.write("evaluation.csv", |file| write_evaluation_csv(file, runs))?;
    let mut written = draw(&output, runs, &document.drivers, drawn)?;
    let states = loaded.prepared.iter().flat_map(|run| &run.states);
    let samples = table_samples(states);
    written.extend(draw_tables(&output, &loaded.vehicle, &samples)?);
    if args.view {
        let options = ViewOptions {
            model: Some(args.runs.model.clone()),
            only: runs.iter().map(|run| run.run.clone()).collect(),
            ..all_runs(args.runs.runs.clone())
        };
        let viewer = write_view(&output, &options, global)?;
        written.extend(viewer.map(str::to_owned));
    }
    output.json("evaluation.json", &document)?;
    output.commit()?;
    global.print(&document, || {
        summary(&document.groups)
            + &places(&document.drivers)
            + &format!(
                "{}: evaluation.json, evaluation.csv, {}\n",
                args.runs.out.display(),
                written.join(", ")
            )
    })
}

/// Draws the losses on each track and by track, the angles, and the forces of one run; returns the
/// names of the pictures.
fn draw(
    output: &OutputDir,
    runs: &[RunEvaluation],
    drivers: &[DriverLosses],
    drawn: &RunEvaluation,
) -> Result<Vec<String>, Failure> {
    let mut files = Vec::new();
    let mut picture = |name: String, figure: &Figure| -> Result<(), Failure> {
        output.picture(&name, figure)?;
        files.push(name);
        Ok(())
    };
    let tracks = distinct(runs, |run| &run.track);
    for track in &tracks {
        let here = runs.iter().filter(|run| run.track == *track);
        let here: Vec<RunEvaluation> = here.cloned().collect();
        let title = format!("Drivers on {track}");
        picture(
            format!("energy_{}.png", file_stem(track)),
            &energy_picture(&title, &here, |run| &run.driver),
        )?;
        let drivers = drivers.iter().filter(|one| one.track == *track);
        picture(
            format!("losses_{}.png", file_stem(track)),
            &losses_picture(track, &drivers.collect::<Vec<_>>()),
        )?;
    }
    if tracks.len() > 1 {
        picture(
            "energy_tracks.png".to_owned(),
            &energy_picture("Tracks, every driver", runs, |run| &run.track),
        )?;
    }
    picture("angles.png".to_owned(), &angle_picture(runs))?;
    let forces = format!("forces_{}.png", file_stem(&drawn.run));
    picture(forces, &force_picture(drawn))?;
    Ok(files)
}

/// Where each driver loses most, by the time that it costs.
fn places(drivers: &[DriverLosses]) -> String {
    const MOST: usize = 3;
    let mut text = String::from("time lost over a straight glide, mean of runs\n");
    for driver in drivers {
        let mut worst: Vec<_> = driver.stretches.iter().collect();
        worst.sort_by(|a, b| b.lost_s.total_cmp(&a.lost_s));
        let worst = worst.iter().take(MOST).map(|one| {
            format!(
                "{:.3} s at {:.0} to {:.0} m",
                one.lost_s, one.from_m, one.to_m
            )
        });
        text += &format!(
            "{:9} {:9} {:7.3} s, of them {}\n",
            driver.driver,
            driver.track,
            driver.lost_s,
            worst.collect::<Vec<_>>().join(", ")
        );
    }
    text
}

fn summary(groups: &[Group]) -> String {
    let mut text = String::from(
        "loss increase over a straight glide [%], mean with 95 % interval over runs\n\
         by      name      track     runs   front   rear    air   total                  steering > 2°  > 4°\n",
    );
    for group in groups {
        let interval = match (group.increase_total.low, group.increase_total.high) {
            (Some(low), Some(high)) => format!("({:.2} to {:.2})", 100.0 * low, 100.0 * high),
            _ => "(one run)".to_string(),
        };
        text += &format!(
            "{:7} {:9} {:9} {:4}  {:6.2} {:6.2} {:6.2}  {:6.2} {:16}  {:10.2} {:8.2}\n",
            group.by,
            group.name,
            group.track.as_deref().unwrap_or("all"),
            group.runs,
            100.0 * group.increase_front.mean,
            100.0 * group.increase_rear.mean,
            100.0 * group.increase_aero.mean,
            100.0 * group.increase_total.mean,
            interval,
            100.0 * group.steering_above_2deg.mean,
            100.0 * group.steering_above_4deg.mean,
        );
    }
    text
}
