//! `kufe discover`: what the model lacks, by data.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_discover::{CampaignFile, Error, Options, Report, Rules};

use crate::output::folder::OutputDir;
use crate::output::global::Global;
use crate::output::say::{say, warn};

/// Find the effect that a model lacks, name it and add it
#[derive(clap::Args, Debug)]
pub struct Args {
    /// runs.csv, experiments.csv or pressures.csv; or a campaign.toml that names several of them and their model
    data: PathBuf,
    /// Model of the sled and its friction, or for pressures the case.toml; a campaign.toml names its own
    #[arg(long, short, value_name = "MODEL.toml")]
    model: Option<PathBuf>,
    /// Folder for report.json, report.html and model.next.toml, and case.next.toml for pressures in a campaign
    #[arg(short, long, value_name = "FOLDER", default_value = "out")]
    out: PathBuf,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Simulated copies of the data with nothing hidden in them that each finding is compared with (at least 10)
    #[arg(long, default_value_t = 40)]
    twins: u64,
    /// Effects to look for and no others, with commas between them; `unknown` stands for all that is beyond the catalogue
    #[arg(long, value_name = "EFFECTS", value_delimiter = ',')]
    only: Vec<String>,
    /// Refuse runs that miss files, values or rows, have uneven times or stand still, instead of leaving them out
    #[arg(long)]
    strict: bool,
    /// Which channels of runs to use
    #[arg(long, value_enum, default_value_t = Channels::All)]
    channels: Channels,
    /// Rules of judgement that differ from the usual ones
    #[arg(long, value_name = "TOML")]
    rules: Option<PathBuf>,
}

/// Channels of runs.
#[derive(clap::ValueEnum, Clone, Copy, Debug, PartialEq, Eq)]
enum Channels {
    /// Longitudinal and lateral
    All,
    /// Side force and yaw moment
    Lateral,
    /// Along the sled
    Longitudinal,
}

/// Runs the command.
///
/// # Errors
/// [`Failure::Usage`] for too few twins, [`Failure::BadInput`] for data and model.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if !(10..=1000).contains(&args.twins) {
        return Err(Failure::Usage(format!(
            "--twins {}: expected 10 to 1000",
            args.twins
        )));
    }
    let rules = match &args.rules {
        Some(path) => rules(path)?,
        None => Rules::default(),
    };
    let options = Options {
        seed: args.seed,
        twins: args.twins,
        longitudinal: args.channels != Channels::Lateral,
        lateral: args.channels != Channels::Longitudinal,
        strict: args.strict,
        only: args.only.clone(),
        rules,
        ..Options::default()
    };
    let campaign = args.data.extension().is_some_and(|ending| ending == "toml");
    if campaign == args.model.is_some() {
        return Err(Failure::Usage(match campaign {
            true => "--model: a campaign.toml names its model itself".to_owned(),
            false => format!(
                "--model is missing: expected the model that {} is held against (a campaign.toml names its own)",
                args.data.display()
            ),
        }));
    }
    let mut inputs: Vec<PathBuf> = [Some(&args.data), args.model.as_ref(), args.rules.as_ref()]
        .into_iter()
        .flatten()
        .cloned()
        .collect();
    if campaign {
        inputs.extend(CampaignFile::read(&args.data).map_err(failure)?.inputs());
    }
    let output = OutputDir::begin("discover", &inputs, &args.out, global.force)?;
    let bar = global.progress();
    let progress = |what: &str| bar.set_message(what.to_owned());
    let found = kufe_discover::discover(&args.data, args.model.as_deref(), &options, &progress)
        .map_err(failure)?;
    let (report, next, case) = (found.report, found.next_model, found.next_case);
    bar.finish_and_clear();
    if !report.gaps.is_empty() {
        warn(&kufe_sled::gaps_line(&report.gaps));
    }
    output.text("report.html", &kufe::report::discovery_page(&report))?;
    output.text("model.next.toml", &next)?;
    if let Some(case) = case {
        output.text("case.next.toml", &case)?;
    }
    let json = output.json("report.json", &report)?;
    output.commit()?;
    if global.json {
        say(&json);
    } else if !global.quiet {
        tell(&report, &args.out);
    }
    Ok(())
}

fn rules(path: &Path) -> Result<Rules, Failure> {
    let told = |reason: String| Failure::BadInput(format!("{}: {reason}", path.display()));
    let text =
        kufe_files::text_of_regular(path, 1 << 20).map_err(|error| told(error.to_string()))?;
    Rules::from_toml(&text).map_err(|error| told(error.to_string()))
}

fn tell(report: &Report, output: &Path) {
    say(&format!("{}\n", report.sentence));
    if !report.explained.is_empty() {
        say(&format!("{}\n", report.explained));
    }
    say(&format!(
        "written: {}\n",
        output.join("report.html").display()
    ));
}

fn failure(error: Error) -> Failure {
    match error {
        Error::BaseFit { .. } => Failure::NotConverged(error.to_string()),
        other => Failure::BadInput(other.to_string()),
    }
}
