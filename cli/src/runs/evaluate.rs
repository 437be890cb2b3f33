//! `kufe evaluate`: what drivers lose beyond a straight glide.

use kufe::charts::{angle_picture, energy_picture, force_picture};
use kufe::jobs::Failure;
use kufe::plot::Figure;
use kufe::results::{Evaluation, RunsUsed};
use kufe_sled::{Group, RunEvaluation, distinct, evaluate, groups, table_samples};

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::say::say;
use crate::runs::arguments::RunArgs;
use crate::runs::tables::draw_tables;

const EXAMPLES: &str = "\
Example:
  kufe evaluate runs.csv --model model.toml -o evaluation/

Writes evaluation.json, evaluation.csv (one row a run), box plots of the loss increases by driver on each track and
by track, steering and slip angles by driver, and the force along the motion over one run. Where the model has tables,
table_front.png and table_rear.png show where the samples lie on them.";

/// Arguments of `kufe evaluate`.
#[derive(clap::Args, Debug)]
#[command(after_help = EXAMPLES)]
pub struct Args {
    #[command(flatten)]
    runs: RunArgs,
    /// Run whose forces are drawn (default: the first)
    #[arg(long, value_name = "NAME")]
    run: Option<String>,
    /// Compare tracks by the runs of this driver class only (default: every run)
    #[arg(long, value_name = "CLASS")]
    track_class: Option<String>,
    /// Seed of the random choices behind the intervals
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

/// Evaluates and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let inputs = args.runs.inputs();
    let output = OutputDir::begin("evaluate", &inputs, &args.runs.out, global.force)?;
    let loaded = args.runs.load(global, |_| true)?;
    let runs = evaluate(&loaded.prepared, &loaded.vehicle);
    let groups = groups(&runs, args.seed);
    let document = Evaluation {
        runs,
        groups,
        interval: "95 % of the mean, bootstrap over runs".to_owned(),
        used: RunsUsed::new(&loaded),
    };
    let runs = &document.runs;
    let drawn = match &args.run {
        None => &runs[0],
        Some(name) => runs.iter().find(|run| run.run == *name).ok_or_else(|| {
            let known: Vec<&str> = runs.iter().map(|run| run.run.as_str()).collect();
            Failure::BadInput(format!("--run {name}: the runs are {}", known.join(", ")))
        })?,
    };
    output.write("evaluation.csv", |file| write_table(file, runs))?;
    let mut drawn_files = draw(args, &output, runs, drawn)?;
    let states = loaded.prepared.iter().flat_map(|run| &run.states);
    let samples = table_samples(states);
    drawn_files.extend(draw_tables(&output, &loaded.vehicle, &samples)?);
    let json = output.json("evaluation.json", &document)?;
    output.commit()?;
    if global.json {
        say(&json);
    } else if !global.quiet {
        say(&summary(&document.groups));
        say(&format!(
            "{}: evaluation.json, evaluation.csv, {}\n",
            args.runs.out.display(),
            drawn_files.join(", ")
        ));
    }
    Ok(())
}

fn draw(
    args: &Args,
    output: &OutputDir,
    runs: &[RunEvaluation],
    drawn: &RunEvaluation,
) -> Result<Vec<String>, Failure> {
    let mut files = Vec::new();
    let mut picture = |name: String, figure: Figure| -> Result<(), Failure> {
        output.picture(&name, &figure)?;
        files.push(name);
        Ok(())
    };
    let tracks = distinct(runs, |run| &run.track);
    for track in &tracks {
        let here: Vec<RunEvaluation> = runs
            .iter()
            .filter(|run| run.track == *track)
            .cloned()
            .collect();
        picture(
            format!("energy_{}.png", kufe_sled::file_stem(track)),
            energy_picture(&format!("Drivers on {track}"), &here, |run| &run.driver),
        )?;
    }
    if tracks.len() > 1 {
        let class = args.track_class.as_deref();
        let of: Vec<RunEvaluation> = runs
            .iter()
            .filter(|run| class.is_none_or(|class| run.driver_class == class))
            .cloned()
            .collect();
        if of.is_empty() {
            let classes = distinct(runs, |run| &run.driver_class).join(", ");
            return Err(Failure::BadInput(format!(
                "--track-class {}: the classes are {classes}",
                class.unwrap_or_default()
            )));
        }
        let title = match class {
            Some(class) => format!("Tracks, drivers of class {class}"),
            None => "Tracks, every driver".to_string(),
        };
        picture(
            "energy_tracks.png".to_string(),
            energy_picture(&title, &of, |run| &run.track),
        )?;
    }
    picture("angles.png".to_string(), angle_picture(runs))?;
    picture(
        format!("forces_{}.png", kufe_sled::file_stem(&drawn.run)),
        force_picture(drawn),
    )?;
    Ok(files)
}

fn write_table(file: &std::fs::File, runs: &[RunEvaluation]) -> Result<(), csv::Error> {
    let mut table = csv::Writer::from_writer(file);
    table.write_record([
        "run",
        "track",
        "driver",
        "driver_class",
        "session",
        "time_s",
        "e_tot_loss_j",
        "increase_front",
        "increase_rear",
        "increase_aero",
        "increase_total",
        "steering_above_2deg",
        "steering_above_4deg",
        "slip_front_above_2deg",
        "slip_front_above_4deg",
        "slip_rear_above_2deg",
        "slip_rear_above_4deg",
    ])?;
    for run in runs {
        let names = [
            &run.run,
            &run.track,
            &run.driver,
            &run.driver_class,
            &run.session,
        ];
        let numbers = [
            run.time_s,
            run.e_tot_loss_j,
            run.increase_front,
            run.increase_rear,
            run.increase_aero,
            run.increase_total,
            run.steering.share_above_2deg,
            run.steering.share_above_4deg,
            run.slip_front.share_above_2deg,
            run.slip_front.share_above_4deg,
            run.slip_rear.share_above_2deg,
            run.slip_rear.share_above_4deg,
        ];
        let cells = names
            .into_iter()
            .cloned()
            .chain(numbers.iter().map(ToString::to_string));
        table.write_record(cells)?;
    }
    table.flush()?;
    Ok(())
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
