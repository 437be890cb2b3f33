//! `kufe icehouse`: the coefficient of friction by specimen from gliding runs.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, Located};
use kufe::results::IceHouseResult;
use kufe_sled::friction::{
    GlideEntry, GlideRun, IceHouse, SHARE_LEFT_OUT, evaluate_glide, evaluate_ice_house, read_glide,
    read_glide_index, write_experiments,
};

use crate::friction::open;
use crate::output::OutputDir;
use crate::terminal::{Global, warn_if_cut};
use crate::text::table_text;

/// Arguments of `kufe icehouse`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Index of the runs
    pub glides: PathBuf,
    /// Folder for icehouse.json, experiments.csv and a picture of each run
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
}

/// Evaluates and writes.
///
/// # Errors
/// [`Failure::BadInput`] naming file, row, column, value and what was expected.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let index = args.glides.display().to_string();
    let entries = read_glide_index(&index, open(&args.glides)?)?;
    warn_if_cut(&args.glides);
    let folder = args.glides.parent().unwrap_or(Path::new(""));
    let runs = entries
        .iter()
        .map(|entry| read_run(&index, folder, entry))
        .collect::<Result<Vec<GlideRun>, Failure>>()?;
    let house = evaluate_ice_house(runs).in_file(&args.glides)?;
    let result = IceHouseResult::new(&house, picture);
    let mut inputs: Vec<PathBuf> = entries.iter().map(|e| folder.join(&e.file)).collect();
    inputs.push(args.glides.clone());
    let output = OutputDir::begin("icehouse", &inputs, &args.out, global.force)?;
    output.write("experiments.csv", |file| {
        write_experiments(&house.experiments(), file)
    })?;
    for (i, run) in house.runs.iter().enumerate() {
        let name = picture(i, &run.entry.run);
        output.picture(&name, &kufe::charts::glide_picture(&house, run))?;
    }
    let columns = ["specimen", "pairs", "mu", "mu_se", "v_mps"];
    let specimens = table_text(&result.specimens, &columns)?;
    output.finish("icehouse.json", &result, global, || {
        specimens + &summary(&house)
    })
}

fn read_run(index: &str, folder: &Path, entry: &GlideEntry) -> Result<GlideRun, Failure> {
    let path = folder.join(&entry.file);
    let reader =
        open(&path).map_err(|failure| failure.within(format!("{index}, run {}", entry.run)))?;
    let name = path.display().to_string();
    let trace = read_glide(&name, reader)?;
    warn_if_cut(&path);
    evaluate_glide(entry, &trace).in_file(&path)
}

/// File name of a picture. The number of the run distinguishes names that differ only in characters
/// that are invalid in file names.
fn picture(number: usize, run: &str) -> String {
    let is_plain = |c: char| c.is_alphanumeric() || c == '-';
    let run: String = run.chars().take(60).collect();
    format!(
        "energy_{:03}_{}.png",
        number + 1,
        run.replace(|c| !is_plain(c), "_")
    )
}

/// Largest plausible speed of a sled that is pushed in a hall [m/s]; above it the unit is probably
/// km/h, which cannot be proved without a measured distance.
const MAX_SPEED: f64 = 15.0;

fn summary(house: &IceHouse) -> String {
    let slope = &house.slope_rad;
    let [slope, low, high] = [slope.value, slope.low, slope.high].map(f64::to_degrees);
    let (uphill, central) = (&house.directions[0], 100.0 - 200.0 * SHARE_LEFT_OUT);
    let mut text = format!(
        "rink: {slope:.4} degrees ({low:.4} to {high:.4}), positive where \"{uphill}\" climbs\n\
         section: from the greatest speed on, the central {central:.0} % of the distance glided\n"
    );
    if !house.unpaired.is_empty() {
        let unpaired = house.unpaired.join(", ");
        text += &format!("not used, no run in the other direction: {unpaired}\n");
    }
    for s in house.specimens.iter().filter(|s| s.v_mps > MAX_SPEED) {
        let (name, speed, mu) = (&s.specimen, s.v_mps, 1e3 * s.mu.value / 3.6);
        text += &format!(
            "{name}: v_mps has a mean of {speed:.1} m/s, expected up to {MAX_SPEED} in a hall: km/h? (mu would be {mu:.3}e-3)\n"
        );
    }
    if house.experiments().iter().any(|e| !e.p_max_pa.is_finite()) {
        text += "experiments.csv: fill in p_max_pa and p_max_sd_pa (kufe press) before kufe friction fit\n";
    }
    text
}
