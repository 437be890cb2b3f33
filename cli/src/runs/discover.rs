//! `kufe discover`: search for effects that are missing in a model.

use std::path::{Path, PathBuf};

use kufe::jobs::runs::run_inputs;
use kufe::jobs::view_runs::ViewOptions;
use kufe::jobs::{Failure, Located};
use kufe::report::discovery_page;
use kufe_discover::{CampaignFile, Options, Rules};
use kufe_sled::read_index;

use crate::output::OutputDir;
use crate::runs::{all_runs, write_view};
use crate::terminal::{Global, warn, warn_if_cut};

/// Find the effect that is missing in a model, name it and add it
#[derive(clap::Args, Debug)]
pub struct Args {
    /// runs.csv, experiments.csv or pressures.csv; or a campaign.toml that names several of them
    /// and their model
    data: PathBuf,
    /// Model of the sled and its friction, or for pressures the case.toml; a campaign.toml names
    /// its own
    #[arg(long, short, value_name = "MODEL.toml")]
    model: Option<PathBuf>,
    /// Folder for report.json, report.html and model.next.toml, and case.next.toml for pressures in
    /// a campaign
    #[arg(short, long, value_name = "FOLDER", default_value = "out")]
    out: PathBuf,
    /// Seed of all random numbers
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Simulated copies of the data with nothing hidden in them that each finding is compared with
    /// (at least 10)
    #[arg(long, default_value_t = 40)]
    twins: u64,
    /// Search only for these effects (several with commas); `unknown` is every effect outside the
    /// catalogue
    #[arg(long, value_name = "EFFECTS", value_delimiter = ',')]
    only: Vec<String>,
    /// Fit the base and screen the effects once, without a model to write
    #[arg(long)]
    quick: bool,
    /// Refuse runs with missing files, values or rows, uneven times or standstill, instead of
    /// excluding them
    #[arg(long)]
    strict: bool,
    /// Write view.html too, the page of kufe runs view with the runs: report.html links into it
    #[arg(long)]
    view: bool,
    /// File with thresholds of the search that differ from the defaults
    #[arg(long, value_name = "TOML")]
    rules: Option<PathBuf>,
}

/// Runs the command.
///
/// # Errors
/// [`Failure::Usage`] for too few twins, [`Failure::BadInput`] for data and model.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let twins = args.twins;
    if !(10..=1000).contains(&twins) {
        return Err(Failure::option("twins", twins, "10 to 1000"));
    }
    let rules = args.rules.as_deref().map(rules).transpose()?;
    let options = Options {
        seed: args.seed,
        twins,
        strict: args.strict,
        only: args.only.clone(),
        quick: args.quick,
        rules: rules.unwrap_or_default(),
        ..Options::default()
    };
    let is_campaign = args.data.extension().is_some_and(|ending| ending == "toml");
    let data = args.data.display();
    if is_campaign == args.model.is_some() {
        return Err(Failure::Usage(if is_campaign {
            "--model: a campaign.toml names its model itself".to_owned()
        } else {
            format!(
                "--model is missing: expected the model that {data} is compared with (a campaign.toml names its own)"
            )
        }));
    }
    let mut inputs = run_inputs(&args.data);
    inputs.extend([&args.model, &args.rules].into_iter().flatten().cloned());
    let (recorded, model) = if is_campaign {
        let file = CampaignFile::read(&args.data)?;
        inputs.extend(file.inputs());
        (file.runs, file.model)
    } else {
        let recorded = args.view && read_index(&args.data).is_ok();
        (recorded.then(|| args.data.clone()), args.model.clone())
    };
    let recorded = recorded.filter(|_| args.view);
    if args.view && recorded.is_none() {
        return Err(Failure::Usage(format!(
            "--view: {data} has no recorded runs"
        )));
    }
    warn_if_cut(&args.data);
    let output = OutputDir::begin("discover", &inputs, &args.out, global.force)?;
    let found = global.watched(|watch| {
        let progress = |what: &str| watch.progress(what);
        kufe_discover::discover(&args.data, args.model.as_deref(), &options, &progress)
    })?;
    let report = &found.report;
    if !report.gaps.is_empty() {
        warn(&kufe_sled::gaps_line(&report.gaps));
    }
    let viewed = recorded.map(|runs| ViewOptions {
        model,
        ..all_runs(runs)
    });
    let viewer = write_view(&output, viewed, global)?;
    output.bytes("report.html", discovery_page(report, viewer))?;
    if let Some(model) = &found.next_model {
        output.bytes("model.next.toml", model)?;
    }
    if let Some(case) = &found.next_case {
        output.bytes("case.next.toml", case)?;
    }
    output.finish("report.json", report, global, || {
        let texts = [&report.sentence, &report.explained].into_iter();
        let texts = texts.filter(|text| !text.is_empty());
        texts.map(|text| format!("{text}\n")).collect()
    })
}

fn rules(path: &Path) -> Result<Rules, Failure> {
    let text = kufe_files::text_of_regular(path, 1 << 20).in_file(path)?;
    Rules::from_toml(&text).in_file(path)
}
