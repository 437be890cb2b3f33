//! `kufe friction fit`: fit of mu against pressure to experiments, as part of a model file.

use std::path::PathBuf;

use kufe::charts::mu_picture;
use kufe::jobs::{Failure, Located};
use kufe::plot::measured;
use kufe::results::PressureFit;
use kufe_sled::friction::{
    LongitudinalKeys, MuFit, PressureLaw, Weighting, ZetaActsOn, fit_mu, read_experiments,
};

use crate::friction::open;
use crate::output::OutputDir;
use crate::terminal::{Global, warn_if_cut};

/// Arguments of `kufe friction fit`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Experiments: specimen, p_max_pa, p_max_sd_pa, mu, mu_sd
    pub experiments: PathBuf,
    /// Folder for fit.json, friction.toml and mu.png
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Weight every specimen equally, as the paper does, instead of by both errors
    #[arg(long)]
    pub unweighted: bool,
    /// Confidence level of intervals and band
    #[arg(long, value_name = "P", default_value_t = 0.95)]
    pub confidence: f64,
}

/// Fits and writes.
///
/// # Errors
/// [`Failure::Usage`], [`Failure::BadInput`] for the table and the output,
/// [`Failure::NotConverged`], also where the fit is not a valid law of a model.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if !(args.confidence > 0.0 && args.confidence < 1.0) {
        let expected = "above 0, below 1";
        return Err(Failure::option("confidence", args.confidence, expected));
    }
    let name = args.experiments.display().to_string();
    let experiments = read_experiments(&name, open(&args.experiments)?)?;
    warn_if_cut(&args.experiments);
    let weighting = if args.unweighted {
        Weighting::None
    } else {
        Weighting::Both
    };
    let fit = fit_mu(&experiments, weighting, args.confidence)
        .map_err(|error| Failure::from(error).within(&name))?;
    let law = fit.law(PressureLaw::PUBLISHED.mu_cap, 1.0, ZetaActsOn::Mu);
    let result = PressureFit::new(&fit, &law, &experiments, args.confidence);
    let inputs = std::slice::from_ref(&args.experiments);
    let output = OutputDir::begin("friction fit", inputs, &args.out, global.force)?;
    let checked = law.check();
    if checked.is_ok() {
        let toml = model_form(&law).bad_input()?;
        output.bytes("friction.toml", &toml)?;
    }
    output.picture("mu.png", &mu_picture(&experiments, &fit, &law))?;
    output.finish("fit.json", &result, global, || summary(&fit))?;
    let unusable = |error| {
        Failure::NotConverged(format!(
            "{name}: the fitted quadratic is not a valid law of friction ({error}): friction.toml is not written"
        ))
    };
    checked.map_err(unusable)
}

/// The table `[friction.longitudinal]` of a model file.
fn model_form(law: &PressureLaw) -> Result<String, toml::ser::Error> {
    let keys = toml::to_string(&LongitudinalKeys::from(*law))?;
    Ok(format!("[friction.longitudinal]\n{keys}"))
}

fn summary(fit: &MuFit) -> String {
    let values = [fit.b, fit.c, fit.d].into_iter().enumerate();
    let values = values.map(|(k, value)| measured(value, fit.covariance[(k, k)].sqrt(), ""));
    let letters = ["b", "c", "d"].into_iter();
    let lines: String = letters
        .zip(values)
        .map(|(name, value)| format!("  {name}  {value}\n"))
        .collect();
    let weighting = match fit.weighting {
        Weighting::Both => "weighted by the errors of mu and p",
        Weighting::None => "unweighted",
    };
    let mut text = format!("mu = 1e-3 (b p^2 - c p + d), p in MPa, {weighting}\n{lines}");
    if let Some(p) = fit.p_value {
        let verdict = if p < 0.05 {
            "a quadratic does not describe these data within their stated errors"
        } else {
            "a quadratic describes these data"
        };
        let (chi2, freedom) = (fit.chi2, fit.freedom);
        text += &format!("chi2 {chi2:.2} on {freedom} degrees of freedom, p = {p:.3}: {verdict}\n");
    }
    text + &match fit.least_friction() {
        Some(least) => {
            let (mu, at) = (1e3 * least.mu.value, &least.p_pa);
            let [p, low, high] = [at.value, at.low, at.high].map(|p| 1e-6 * p);
            format!("least friction {mu:.2}e-3 at {p:.2} MPa ({low:.2} to {high:.2})\n")
        }
        None => "the data show no minimum within their errors\n".to_owned(),
    }
}
