//! A hull's smooth underside, and the noise of its vertices.

use std::path::Path;
use std::sync::Arc;

use kufe_mesh::{
    Axis, Filled, FittedUnderside, Hull, HullOptions, HullReport, HullWarning, MeshError,
    load_hull, noise_of_hull,
};

use crate::table::{FileAxis, RunnerTable};

/// The fitted underside of a hull, or of a mesh, and what that is like.
#[derive(Clone)]
pub struct FittedHull {
    /// The smooth surface that is pressed on the ice.
    pub underside: Arc<FittedUnderside>,
    /// Size, holes and warnings.
    pub report: HullReport,
    /// Standard deviation of its vertices that the fit was made with, found where none is stated [m].
    pub noise: f64,
    /// Its triangles, where there is noise.
    pub scan: Option<Arc<Hull>>,
}

/// Reads the runner's hull and fits its underside; with what fills it where the runner deforms.
pub(crate) fn fitted_hull(
    runner: &RunnerTable,
    path: &Path,
) -> Result<(FittedHull, Option<Filled>), MeshError> {
    let options = HullOptions {
        scale: runner.scale.unwrap_or(1.0),
        up: runner.up.map(FileAxis::axis),
        forward: runner.forward.map_or(Axis::X, FileAxis::axis),
    };
    let (hull, mut report) = load_hull(path, &options)?;
    let noise = runner.noise(&mut report, || noise_of_hull(&hull));
    let underside = FittedUnderside::new(&hull, noise)?;
    let fill = || Filled::of(&hull, &report, &underside, runner.height_m);
    let filled = runner.elastic.then(fill).transpose();
    let filled = filled.map_err(|error| error.in_file(path))?;
    let fitted = FittedHull {
        underside: Arc::new(underside),
        report,
        noise,
        scan: (noise > 0.0).then(|| Arc::new(hull)),
    };
    Ok((fitted, filled))
}

impl RunnerTable {
    /// The noise of the runner's vertices that is stated, or else what is `found`, which the report then tells [m].
    pub(crate) fn noise(&self, report: &mut HullReport, found: impl Fn() -> Option<f64>) -> f64 {
        let noise = self.noise_m.or_else(&found).unwrap_or(0.0);
        if self.noise_m.is_none() && noise > 0.0 {
            report.warnings.push(HullWarning::Noisy { noise });
        }
        noise
    }
}

impl FileAxis {
    fn axis(self) -> Axis {
        let (index, negative) = match self {
            FileAxis::X => (0, false),
            FileAxis::MinusX => (0, true),
            FileAxis::Y => (1, false),
            FileAxis::MinusY => (1, true),
            FileAxis::Z => (2, false),
            FileAxis::MinusZ => (2, true),
        };
        Axis { index, negative }
    }
}
