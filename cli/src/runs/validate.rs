//! `kufe validate`: the friction model against runs that it was not fitted to.

use std::path::PathBuf;

use kufe::charts::{lateral_force_picture, rmse_picture};
use kufe::jobs::lateral::{FittedLaws, validate_runs};
use kufe::jobs::{Failure, force_series};
use kufe::results::Validation;
use kufe_sled::RunValidation;

use crate::output::OutputDir;
use crate::runs::arguments::RunArgs;
use crate::runs::files::write_mat;
use crate::terminal::Global;

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

/// Compares and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place.
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
        let worst = runs
            .iter()
            .filter(|run| run.track == track.track)
            .max_by(|a, b| a.rmse_n.total_cmp(&b.rmse_n));
        drawn.extend(worst);
    }
    for name in &args.run {
        let run = runs.iter().find(|run| run.run == *name).ok_or_else(|| {
            let names: Vec<&str> = runs.iter().map(|run| run.run.as_str()).collect();
            let names = names.join(", ");
            Failure::BadInput(format!("--run {name}: the runs compared are {names}"))
        })?;
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
    output.json("validation.json", &document)?;
    output.commit()?;
    global.print(&document, || text(args, &document, &drawn))
}

fn text(args: &Args, document: &Validation, drawn: &[&RunValidation]) -> String {
    let mut text = String::from("track          runs  RMSE [N]  Braghin [N]\n");
    for track in &document.tracks {
        text += &format!(
            "{:14} {:4}  {:8.1}  {:11.1}\n",
            track.track, track.runs, track.rmse_n, track.rmse_braghin_n
        );
    }
    for run in drawn.iter().filter(|run| !run.largest.is_empty()) {
        let places = run.largest.iter();
        let places: Vec<String> = places
            .map(|d| format!("{:.0} m ({:.0} N)", d.s_m, d.rms_n))
            .collect();
        text += &format!(
            "{}: largest disagreements, root mean square over half a second, at {}\n",
            run.run,
            places.join(", ")
        );
    }
    text += &match &args.fit {
        Some(path) => format!(
            "laws of {}; the {} runs of the fit are excluded\n",
            path.display(),
            document.left_out_as_fitted.len()
        ),
        None => "laws of the model; give --fit to exclude the runs of a fit\n".to_string(),
    };
    text + &format!(
        "{}: validation.json, rmse.png, {} force pictures\n",
        args.runs.out.display(),
        drawn.len()
    )
}
