//! `kufe fit`: friction from recorded runs.

use kufe::charts::fit_picture;
use kufe::jobs::lateral::fit_lateral;
use kufe::jobs::{Failure, runs::PreparedRuns};
use kufe_sled::friction::{Interval, LateralFit, MagicFormula};
use kufe_sled::{find_contacts, lateral_samples, without_slip_offsets};

use crate::output::OutputDir;
use crate::runs::RunArgs;
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
    let leave_out_contacts = !args.keep_contacts;
    let inputs = args.runs.inputs();
    let output = OutputDir::begin("fit lateral", &inputs, &args.runs.out, global.force)?;
    let selection = args.runs.selection();
    let fitted = global.watched(|watch| fit_lateral(&selection, leave_out_contacts, watch))?;
    let (document, written) = (&fitted.document, &fitted.model);
    let fit = &document.fit;
    let PreparedRuns {
        model,
        vehicle,
        prepared,
        ..
    } = &fitted.loaded;
    output.bytes("model.fit.toml", written)?;
    let [front_law, rear_law] = [&fit.front, &fit.rear].map(LateralFit::law);
    let fitted = vehicle.with_lateral(front_law, rear_law);
    let prepared = &without_slip_offsets(prepared, &fit.slip_offsets);
    let marked = if leave_out_contacts {
        find_contacts(prepared, &fitted)
    } else {
        Vec::new()
    };
    let ([front, rear], _) = lateral_samples(prepared, vehicle, &marked);
    let pictures = [("front", &front, &front_law), ("rear", &rear, &rear_law)];
    for (runner, samples, law) in pictures {
        let name = format!("fit_{runner}.png");
        output.picture(&name, &fit_picture(runner, samples, law))?;
    }
    output.finish("fit.json", document, global, || {
        let [front, rear] = [
            line("front", &fit.front, &model.friction.front),
            line("rear", &fit.rear, &model.friction.rear),
        ];
        let (runs, total) = (fit.runs.len(), fit.samples);
        let (excluded, contacts) = (fit.excluded_roll_acceleration, fit.excluded_contacts);
        format!(
            "{runs} runs, {total} samples, {excluded} excluded for roll acceleration, {contacts} for an external force\n\
             {front}{rear}\
             mu_y and zeta_y act only as their product mu_zeta; at the slips driven, mu_zeta and c almost only as mu_zeta c\n"
        )
    })
}

fn line(runner: &str, fit: &LateralFit, before: &MagicFormula) -> String {
    let ends = |of: &Interval| [of.low, of.high].map(|end| end.unwrap_or(f64::INFINITY));
    let (k, p, c) = (&fit.k_n_per_rad, &fit.mu_zeta_c, &fit.c);
    let product = if fit.mu_zeta_c_determined {
        let [low, high] = ends(p);
        format!("{:.4} ({low:.4} to {high:.4})", p.value)
    } else {
        "not determined: the slips are too small for the curve to bend".to_owned()
    };
    let shape = if fit.c_held {
        format!(
            "fixed at the model's {:.4}: the data do not determine it",
            c.value
        )
    } else {
        let [low, high] = ends(c);
        format!("{:.4} ({low:.4} to {high:.4})", c.value)
    };
    let (k_before, product_before) = (before.k_n_per_rad, before.mu_zeta_c());
    let plain = 100.0 * fit.attenuation_of_plain_least_squares;
    let (residual, noise) = (fit.residual_rms_n, fit.slip_sd_rad);
    let (k, [low, high]) = (k.value, ends(k));
    format!(
        "{runner:5}  K {k:.0} N/rad ({low:.0} to {high:.0}; model {k_before:.0})   mu_zeta c {product} (model {product_before:.4})   residual {residual:.0} N\n       \
         c {shape}; plain least squares gives {plain:.2} % of K (slip noise {noise:.2e} rad)\n"
    )
}
