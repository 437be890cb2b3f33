//! Arguments of `kufe press`.

use std::path::PathBuf;

use crate::press::series::lists::Lists;

/// Arguments of `kufe press`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The case; a built-in bobsled runner on flat ice where none is given
    pub case: Option<PathBuf>,
    /// Folder for result.json, pressure.exr, pressure.png, field.vtu, contact.vtp and hull.glb (runner.vtu and stress.png too where the runner deforms, groove.exr, groove.png and
    /// film.csv where it slides)
    #[arg(long, short, value_name = "FOLDER", default_value = "out")]
    pub out: PathBuf,
    /// Stress on the line under the peak too: subsurface.csv and subsurface.png, figures in result.json, maximum shear in
    /// the VTU files
    #[arg(long)]
    pub subsurface: bool,
    /// Figures, errors and maps for MATLAB too: result.mat
    #[arg(long)]
    pub mat: bool,
    #[command(flatten)]
    pub lists: Lists,
}
