//! `kufe evaluate`: losses of drivers over a straight glide.

use kufe::charts::{angle_picture, energy_picture, force_picture, losses_picture};
use kufe::jobs::Failure;
use kufe::jobs::lateral::warn_of_slip_offsets;
use kufe::jobs::runs::named_run;
use kufe::jobs::view_runs::ViewOptions;
use kufe::results::{Evaluation, write_evaluation_csv};
use kufe_sled::{
    DriverLosses, Group, RunEvaluation, Summary, distinct, evaluate, file_stem, table_samples,
};

use crate::output::OutputDir;
use crate::runs::{RunArgs, all_runs, draw_tables, write_view};
use crate::terminal::Global;
use crate::text::aligned;

/// Arguments of `kufe evaluate`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    runs: RunArgs,
    /// Run whose forces are drawn (default: first run)
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
    let loaded = global.watched(|watch| {
        let loaded = selection.load(watch, |_| true)?;
        warn_of_slip_offsets(&loaded, watch);
        Ok::<_, Failure>(loaded)
    })?;
    let runs = evaluate(&loaded.prepared, &loaded.vehicle);
    let document = Evaluation::new(runs, loaded.used.clone(), args.seed);
    let runs = &document.runs;
    let drawn = match &args.run {
        None => &runs[0],
        Some(name) => named_run(runs, name, |run| &run.run)?,
    };
    output.write("evaluation.csv", |file| write_evaluation_csv(file, runs))?;
    draw(&output, runs, &document.drivers, drawn)?;
    let samples = table_samples(loaded.prepared.iter().flat_map(|run| &run.states));
    draw_tables(&output, &loaded.vehicle, &samples)?;
    let viewed = args.view.then(|| ViewOptions {
        model: Some(args.runs.model.clone()),
        only: runs.iter().map(|run| run.run.clone()).collect(),
        ..all_runs(args.runs.runs.clone())
    });
    write_view(&output, viewed, global)?;
    output.finish("evaluation.json", &document, global, || {
        summary(&document.groups) + &places(&document.drivers)
    })
}

/// Draws the losses on each track and by track, the angles, and the forces of one run.
fn draw(
    output: &OutputDir,
    runs: &[RunEvaluation],
    drivers: &[DriverLosses],
    drawn: &RunEvaluation,
) -> Result<(), Failure> {
    let tracks = distinct(runs.iter().map(|run| run.track.as_str()));
    for track in &tracks {
        let here = runs.iter().filter(|run| run.track == *track);
        let here: Vec<RunEvaluation> = here.cloned().collect();
        let drivers = drivers.iter().filter(|one| one.track == *track);
        let drivers: Vec<&DriverLosses> = drivers.collect();
        let (stem, title) = (file_stem(track), format!("Drivers on {track}"));
        let energy = energy_picture(&title, &here, |run| &run.driver);
        output.picture(&format!("energy_{stem}.png"), &energy)?;
        let losses = losses_picture(track, &drivers);
        output.picture(&format!("losses_{stem}.png"), &losses)?;
    }
    if tracks.len() > 1 {
        let energy = energy_picture("Tracks, every driver", runs, |run| &run.track);
        output.picture("energy_tracks.png", &energy)?;
    }
    output.picture("angles.png", &angle_picture(runs))?;
    let forces = format!("forces_{}.png", file_stem(&drawn.run));
    output.picture(&forces, &force_picture(drawn))
}

/// The stretches on which each driver loses most time.
fn places(drivers: &[DriverLosses]) -> String {
    const MAX_STRETCHES: usize = 3;
    let row = |one: &DriverLosses| {
        let mut worst: Vec<_> = one.stretches.iter().collect();
        worst.sort_by(|a, b| b.lost_s.total_cmp(&a.lost_s));
        let worst = worst.iter().take(MAX_STRETCHES);
        let worst =
            worst.map(|at| format!("{:.3} s at {:.0} to {:.0} m", at.lost_s, at.from_m, at.to_m));
        let worst = worst.collect::<Vec<_>>().join(", ");
        let lost = format!("{:7.3} s, of them {worst}", one.lost_s);
        [one.driver.clone(), one.track.clone(), lost]
    };
    let rows: Vec<_> = drivers.iter().map(row).collect();
    format!(
        "time lost over a straight glide, mean of runs\n{}",
        aligned(&rows, "")
    )
}

fn summary(groups: &[Group]) -> String {
    let heading = [
        "by",
        "name",
        "track",
        "runs",
        " front",
        "  rear",
        "   air",
        " total",
        "",
        "steering > 2°",
        "> 4°",
    ];
    let row = |group: &Group| {
        let total = &group.increase_total;
        let interval = match (total.low, total.high) {
            (Some(low), Some(high)) => format!("({:.2} to {:.2})", 100.0 * low, 100.0 * high),
            _ => "(one run)".to_owned(),
        };
        let track = group.track.as_deref().unwrap_or("all");
        let share = |share: &Summary| format!("{:6.2}", 100.0 * share.mean);
        [
            group.by.clone(),
            group.name.clone(),
            track.to_owned(),
            group.runs.to_string(),
            share(&group.increase_front),
            share(&group.increase_rear),
            share(&group.increase_aero),
            share(total),
            interval,
            share(&group.steering_above_2deg),
            share(&group.steering_above_4deg),
        ]
    };
    let rows = groups.iter().map(row);
    let rows: Vec<_> = [heading.map(str::to_owned)]
        .into_iter()
        .chain(rows)
        .collect();
    format!(
        "loss increase over a straight glide [%], mean with 95 % interval over runs\n{}",
        aligned(&rows, "")
    )
}
