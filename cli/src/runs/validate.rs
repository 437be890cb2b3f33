//! `kufe validate`: compares the friction model with runs to which it was not fitted.

use std::path::{Path, PathBuf};

use kufe::charts::{lateral_force_picture, rmse_picture};
use kufe::jobs::lateral::{FittedLaws, validate_runs};
use kufe::jobs::runs::named_run;
use kufe::jobs::{Failure, force_series};
use kufe::results::Validation;
use kufe_sled::RunValidation;

use crate::output::OutputDir;
use crate::runs::{RunArgs, write_mat};
use crate::terminal::Global;
use crate::text::document_text;

/// Arguments of `kufe validate`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(flatten)]
    runs: RunArgs,
    /// A fit.json: its lateral laws replace the model's, and the runs of the fit are excluded
    #[arg(long, value_name = "FIT.json")]
    fit: Option<PathBuf>,
    /// Draw these runs besides each track's worst (several with commas)
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    run: Vec<String>,
    /// Errors and lateral forces over time for MATLAB too: validation.mat
    #[arg(long)]
    mat: bool,
}

/// Compares the model with the runs and writes the results.
///
/// # Errors
/// [`Failure::BadInput`] with the file and the place in it.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let mut inputs = args.runs.inputs();
    inputs.extend(args.fit.clone());
    let output = OutputDir::begin("validate", &inputs, &args.runs.out, global.force)?;
    let laws = args.fit.as_deref().map(FittedLaws::read).transpose()?;
    let selection = args.runs.selection();
    let document = global.watched(|watch| validate_runs(&selection, laws.as_ref(), watch))?;
    let (runs, tracks) = (&document.runs, &document.tracks);
    let mut drawn: Vec<&RunValidation> = Vec::new();
    for track in tracks {
        let on_track = runs.iter().filter(|run| run.track == track.track);
        drawn.extend(on_track.max_by(|a, b| a.rmse_n.total_cmp(&b.rmse_n)));
    }
    for name in &args.run {
        let run = named_run(runs, name, |run| &run.run)?;
        if !drawn.iter().any(|drawn| drawn.run == run.run) {
            drawn.push(run);
        }
    }
    output.picture("rmse.png", &rmse_picture(runs))?;
    for run in &drawn {
        let name = format!("force_{}.png", kufe_sled::file_stem(&run.run));
        output.picture(&name, &lateral_force_picture(run))?;
    }
    if args.mat {
        write_mat(&output, "validation.mat", &document, force_series(runs))?;
    }
    let tracks = document_text(&document.tracks)?;
    output.finish("validation.json", &document, global, || {
        tracks + &text(args.fit.as_deref(), &document, &drawn)
    })
}

fn text(fit: Option<&Path>, document: &Validation, drawn: &[&RunValidation]) -> String {
    let mut text = String::new();
    for run in drawn.iter().filter(|run| !run.largest.is_empty()) {
        let places = run.largest.iter();
        let places = places.map(|d| format!("{:.0} m ({:.0} N)", d.s_m, d.rms_n));
        let (name, places) = (&run.run, places.collect::<Vec<_>>().join(", "));
        text += &format!(
            "{name}: largest disagreements, root mean square over half a second, at {places}\n"
        );
    }
    text + &match fit {
        Some(path) => {
            let (path, count) = (path.display(), document.left_out_as_fitted.len());
            format!("laws of {path}; the {count} runs of the fit are excluded\n")
        }
        None => "laws of the model; give --fit to exclude the runs of a fit\n".to_owned(),
    }
}
