//! `kufe mesh`: hexahedral meshes of the ice and the runner of a case.

use std::path::PathBuf;

use kufe::jobs::{CaseMeshes, Failure, case_file::LoadedCase, write_mesh_quality};
use kufe::results::{HexQuality, MeshQuality};

use crate::output::{OutputDir, case_inputs};
use crate::terminal::Global;
use crate::text::document_text;

/// Arguments of `kufe mesh`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case
    pub case: PathBuf,
    /// Folder for ice.vtu, runner.vtu and quality.json
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
}

/// Solves the case, since the grid is graded to its contact, and writes the meshes with their
/// quality.
///
/// # Errors
/// Those of `kufe press`, and [`Failure::BadInput`] if no hexahedra fit into the hull.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let loaded = LoadedCase::read(&args.case)?;
    let inputs = case_inputs(Some(&args.case), &loaded)?;
    let output = OutputDir::begin("mesh", &inputs, &args.out, global.force)?;
    let CaseMeshes { ice, runner } = global.watched(|watch| CaseMeshes::of(&loaded, watch))?;
    output.write("ice.vtu", |file| write_mesh_quality(&ice, file))?;
    if let Some(runner) = &runner {
        output.write("runner.vtu", |file| write_mesh_quality(runner, file))?;
    }
    let quality = MeshQuality {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        ice: HexQuality::from(&ice),
        runner: runner.as_ref().map(HexQuality::from),
    };
    let text = document_text(&quality)?;
    output.finish("quality.json", &quality, global, || text)
}
