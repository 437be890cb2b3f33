//! `kufe friction fit`: mu over pressure from experiments, in the form of a model file.

use std::path::PathBuf;

use kufe::jobs::{Failure, runs::failure};
use kufe::results::PressureFit;
use kufe_sled::friction::{
    Longitudinal, LongitudinalKeys, MuFit, PressureLaw, Weighting, ZetaActsOn, fit_mu,
    read_experiments,
};

use crate::friction::open;
use crate::output::OutputDir;
use crate::terminal::Global;

/// Arguments of `kufe friction fit`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// Experiments: specimen, p_max_pa, p_max_sd_pa, mu, mu_sd
    pub experiments: PathBuf,
    /// Folder for fit.json, friction.toml and mu.png
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Weigh every specimen alike, as the paper does, instead of by both errors
    #[arg(long)]
    pub unweighted: bool,
    /// Probability that intervals and band are to cover
    #[arg(long, value_name = "P", default_value_t = 0.95)]
    pub confidence: f64,
}

/// Fits and writes.
///
/// # Errors
/// [`Failure::Usage`], [`Failure::BadInput`] for the table and the output,
/// [`Failure::NotConverged`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if !(args.confidence > 0.0 && args.confidence < 1.0) {
        let text = format!(
            "--confidence {}: expected above 0, below 1",
            args.confidence
        );
        return Err(Failure::Usage(text));
    }
    let name = args.experiments.display().to_string();
    let experiments = read_experiments(&name, open(&args.experiments)?).map_err(failure)?;
    let weighting = if args.unweighted {
        Weighting::None
    } else {
        Weighting::Both
    };
    let fit = fit_mu(&experiments, weighting, args.confidence)
        .map_err(|error| failure(error).within(&name))?;
    let law = fit.law(PressureLaw::PUBLISHED.mu_cap, 1.0, ZetaActsOn::Mu);
    law.check().map_err(|error| failure(error).within(&name))?;
    let result = PressureFit::new(&fit, &law, &experiments, args.confidence);
    let inputs = std::slice::from_ref(&args.experiments);
    let output = OutputDir::begin("friction fit", inputs, &args.out, global.force)?;
    let toml = model_form(&law).map_err(Failure::bad_input)?;
    output.text("friction.toml", &toml)?;
    output.picture(
        "mu.png",
        &kufe::charts::mu_picture(&experiments, &fit, &law),
    )?;
    output.json("fit.json", &result)?;
    output.commit()?;
    global.print(&result, || summary(&fit, args))
}

/// `[friction.longitudinal]` as a model file has it.
fn model_form(law: &PressureLaw) -> Result<String, toml::ser::Error> {
    let keys = LongitudinalKeys::from(Longitudinal::Pressure(*law));
    Ok(format!(
        "[friction.longitudinal]\n{}",
        toml::to_string(&keys)?
    ))
}

fn summary(fit: &MuFit, args: &Args) -> String {
    let sd = |k: usize| fit.covariance[(k, k)].sqrt();
    let mut text = format!(
        "mu = 1e-3 (b p^2 - c p + d), p in MPa, {}\n  b  {:8.4} +- {:.4}\n  c  {:8.3} +- {:.3}\n  d  {:8.2} +- {:.2}\n",
        match fit.weighting {
            Weighting::Both => "weighted by the errors of mu and p",
            Weighting::None => "unweighted",
        },
        fit.b,
        sd(0),
        fit.c,
        sd(1),
        fit.d,
        sd(2),
    );
    if let Some(p_value) = fit.p_value {
        text += &format!(
            "chi2 {:.2} on {} degrees of freedom, p = {:.3}: {}\n",
            fit.chi2,
            fit.freedom,
            p_value,
            if p_value < 0.05 {
                "a quadratic does not describe these data within their stated errors"
            } else {
                "a quadratic describes these data"
            }
        );
    }
    text += &match fit.least_friction() {
        Some(least) => format!(
            "least friction {:.2}e-3 at {:.2} MPa ({:.2} to {:.2})\n",
            1e3 * least.mu.value,
            1e-6 * least.p_pa.value,
            1e-6 * least.p_pa.low,
            1e-6 * least.p_pa.high,
        ),
        None => "the data show no minimum within their errors\n".to_string(),
    };
    let out = args.out.display();
    text + &format!("{out}: fit.json, friction.toml, mu.png\n")
}
