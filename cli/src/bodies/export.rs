//! `kufe export`: a contact problem for another solver.

use std::path::PathBuf;

use kufe::jobs::export::{AssembledStiffness, CalculixDeck};
use kufe::jobs::{Failure, case_file::LoadedCase};

use crate::output::{OutputFiles, case_inputs};
use crate::terminal::Global;
use crate::text::print_document;

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

/// Solves the case, and writes the deck or the matrix on its mesh.
///
/// # Errors
/// Those of `kufe press`, and [`Failure::BadInput`] for a problem that cannot be exported.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if let Some(cells) = args.cells.filter(|cells| !(2..=64).contains(cells)) {
        return Err(Failure::option("cells", cells, "2 to 64"));
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
        return print_document(&deck.result(out)?, global);
    }
    let matrix = global.during(message, || AssembledStiffness::solve(&loaded, args.cells))?;
    files.write(out, |file| matrix.write(file))?;
    files.commit()?;
    print_document(&matrix.result(out), global)
}
