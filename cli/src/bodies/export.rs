//! `kufe export`: a contact problem for another solver.

use std::path::PathBuf;

use kufe::jobs::export::{AssembledStiffness, CalculixDeck};
use kufe::jobs::{Failure, case_file::LoadedCase};

use crate::output::{OutputFiles, case_inputs};
use crate::terminal::Global;

/// Arguments of `kufe export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case
    pub case: PathBuf,
    /// Write an input deck of CalculiX, of an elastic runner mounted at its top or at places,
    /// level, on ice on a rigid bed
    #[arg(long, value_name = "FILE", conflicts_with = "stiffness")]
    pub calculix: Option<PathBuf>,
    /// Write the assembled stiffness of its bodies on the mesh that it is solved on, in Matrix
    /// Market form
    #[arg(long, value_name = "FILE")]
    pub stiffness: Option<PathBuf>,
    /// Cells across half the contact patch, instead of the accuracy that the case requests
    #[arg(long, value_name = "N")]
    pub cells: Option<usize>,
}

/// Solves the case, whose mesh the deck or the matrix is of, and writes it.
///
/// # Errors
/// Those of `kufe press`, and [`Failure::BadInput`] for a problem that the deck cannot state.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if let Some(cells) = args.cells.filter(|cells| !(2..=64).contains(cells)) {
        return Err(Failure::Usage(format!("--cells {cells}: expected 2 to 64")));
    }
    let Some(out) = args.calculix.as_ref().or(args.stiffness.as_ref()) else {
        return Err(Failure::Usage(
            "expected --calculix or --stiffness with the file to write".into(),
        ));
    };
    let loaded = LoadedCase::read(&args.case)?;
    let inputs = case_inputs(Some(&args.case), &loaded)?;
    let outputs = std::slice::from_ref(out);
    let files = OutputFiles::begin("export", &inputs, outputs, global.force)?;
    let message = "solving, for the mesh";
    if args.calculix.is_some() {
        let deck = global.during(message, || CalculixDeck::solve(&loaded, args.cells))?;
        files.write(out, |file| deck.write(file))?;
        files.commit()?;
        let result = deck.result(out)?;
        let (approach, fz, peak) = (1e6 * result.approach_m, result.fz_n, 1e-6 * result.p_max_pa);
        return global.print(&result, || {
            let (deck, dofs) = (&result.deck, result.dofs);
            format!(
                "{deck}: {dofs} unknowns; pressed in by {approach:.4} µm they bear {fz:.3} N at a peak of {peak:.4} MPa here\n"
            )
        });
    }
    let matrix = global.during(message, || AssembledStiffness::solve(&loaded, args.cells))?;
    files.write(out, |file| matrix.write(file))?;
    files.commit()?;
    let result = matrix.result(out);
    global.print(&result, || {
        format!(
            "{}: {} displacements, {} of them fixed; {} entries, of which one triangle is written\n",
            result.stiffness, result.displacements, result.fixed, result.entries
        )
    })
}
