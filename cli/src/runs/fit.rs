//! `kufe fit`: friction from recorded runs.

use kufe::charts::fit_picture;
use kufe::jobs::lateral::{FittedRuns, fit_lateral};
use kufe::jobs::{Failure, runs::Loaded};
use kufe_sled::friction::{LateralFit, MagicFormula};
use kufe_sled::{FitOptions, find_contacts, lateral_samples};

use crate::output::OutputDir;
use crate::runs::arguments::RunArgs;
use crate::terminal::Global;

/// Arguments of `kufe fit`.
#[derive(clap::Args, Debug)]
pub struct Args {
    #[command(subcommand)]
    what: What,
}

#[derive(clap::Subcommand, Debug)]
enum What {
    /// Lateral friction of both runners
    Lateral(LateralArgs),
}

/// Arguments of `kufe fit lateral`.
#[derive(clap::Args, Debug)]
pub struct LateralArgs {
    #[command(flatten)]
    runs: RunArgs,
    /// Retain samples with an external force, such as that of a wall
    #[arg(long)]
    keep_contacts: bool,
}

/// Fits and writes.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, [`Failure::NotConverged`], [`Failure::Usage`].
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let What::Lateral(args) = &args.what;
    let options = FitOptions {
        leave_out_contacts: !args.keep_contacts,
        ..FitOptions::default()
    };
    let inputs = args.runs.inputs();
    let output = OutputDir::begin("fit lateral", &inputs, &args.runs.out, global.force)?;
    let selection = args.runs.selection();
    let fitted = global.watched(|watch| fit_lateral(&selection, &options, watch))?;
    let FittedRuns {
        loaded,
        fit,
        document,
        model: written,
    } = fitted;
    let Loaded {
        model,
        vehicle,
        prepared,
        ..
    } = loaded;
    output.text("model.fit.toml", &written)?;
    let marked = if options.leave_out_contacts {
        find_contacts(
            &prepared,
            &vehicle.with_lateral(fit.front.model, fit.rear.model),
        )
    } else {
        Vec::new()
    };
    let ([front, rear], _) = lateral_samples(&prepared, &vehicle, &marked, &options);
    for (name, runner, samples, law) in [
        ("fit_front.png", "front", &front, &fit.front.model),
        ("fit_rear.png", "rear", &rear, &fit.rear.model),
    ] {
        output.picture(name, &fit_picture(runner, samples, law))?;
    }
    output.json("fit.json", &document)?;
    output.commit()?;
    global.print(&document, || {
        let mut text = format!(
            "{} runs, {} samples, {} excluded for roll acceleration, {} for an external force\n",
            fit.runs.len(),
            fit.total,
            fit.excluded,
            fit.contacts
        );
        text += &line("front", &fit.front, &model.friction.front);
        text += &line("rear", &fit.rear, &model.friction.rear);
        text += "mu_y and zeta_y act only as their product mu_zeta; at the slips driven, mu_zeta and c almost only as mu_zeta c\n";
        text + &format!(
            "{}: fit.json, model.fit.toml, fit_front.png, fit_rear.png\n",
            args.runs.out.display()
        )
    })
}

fn line(runner: &str, fit: &LateralFit, before: &MagicFormula) -> String {
    let k = &fit.k_n_per_rad;
    let p = &fit.mu_zeta_c;
    let product = if fit.product_determined {
        format!("{:.4} ({:.4} to {:.4})", p.value, p.low, p.high)
    } else {
        "not determined: the slips are too small for the curve to bend".to_string()
    };
    format!(
        "{runner:5}  K {:.0} N/rad ({:.0} to {:.0}; model {:.0})   mu_zeta c {product} (model {:.4})   residual {:.0} N\n       c {}; plain least squares gives {:.2} % of K (slip noise {:.2e} rad)\n",
        k.value,
        k.low,
        k.high,
        before.k_n_per_rad,
        before.mu_zeta_c(),
        fit.residual_rms,
        if fit.c_held {
            format!(
                "fixed at the model's {:.4}: the data do not determine it",
                fit.c.value
            )
        } else {
            format!("{:.4} ({:.4} to {:.4})", fit.c.value, fit.c.low, fit.c.high)
        },
        100.0 * fit.attenuation,
        fit.slip_sd,
    )
}
