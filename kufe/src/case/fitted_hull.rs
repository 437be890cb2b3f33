//! The smooth underside fitted to a hull, and the noise of its vertices.

use std::path::Path;
use std::sync::Arc;
use std::time::Instant;

use kufe_mesh::{
    Axis, Filled, FittedUnderside, Hull, HullOptions, HullReport, MeshError, Noise, ScanFrame,
    Underside, check_hull, load_hull, noise_of_hull, strips_of_hull, strips_warning, unlike_runner,
};

use crate::case::{FileAxis, RunnerTable};

/// The fitted underside of a hull or a mesh, with its noise and its report.
#[derive(Clone)]
pub struct FittedHull {
    /// The smooth surface that is pressed on the ice.
    pub underside: Arc<FittedUnderside>,
    /// Size, holes and warnings.
    pub report: HullReport,
    /// Standard deviation of the vertices' noise, stated or estimated, which the fit assumes, and
    /// the largest noise that the estimate would not detect [m].
    pub noise: Noise,
    /// Length of its triangles along the runner where they are long strips [m].
    pub strips: Option<f64>,
    /// Wall time of reading the file and of fitting the surface [s].
    pub seconds: [f64; 2],
    /// The triangles of the hull, if it has noise or may have undetected noise.
    pub scan: Option<Arc<Hull>>,
}

impl FittedHull {
    /// A fitted underside; `strips` is the length of the hull's triangles if they are long strips
    /// [m].
    pub(crate) fn new(
        underside: FittedUnderside,
        hull: Hull,
        report: HullReport,
        noise: Noise,
        strips: Option<f64>,
    ) -> Self {
        FittedHull {
            underside: Arc::new(underside),
            report,
            noise,
            strips,
            seconds: [0.0; 2],
            scan: (noise.found.max(noise.unseen) > 0.0).then(|| Arc::new(hull)),
        }
    }
}

/// Fits the underside of the runner's hull: of `hull` in runner axes, or else of the file at
/// `path`. For an elastic runner also returns the solid that fills the hull.
pub(crate) fn fit_hull(
    runner: &RunnerTable,
    path: &Path,
    hull: Option<&Hull>,
) -> Result<(FittedHull, Option<Filled>), MeshError> {
    let options = HullOptions {
        scale: runner.scale.unwrap_or(1.0),
        up: runner.up.map(FileAxis::axis),
        forward: runner.forward.map_or(Axis::X, FileAxis::axis),
        rotation: [runner.roll_rad, runner.pitch_rad, runner.yaw_rad]
            .map(|angle| angle.unwrap_or(0.0)),
    };
    let started = Instant::now();
    let (hull, mut report) = match hull {
        Some(hull) => {
            let report = check_hull(hull).map_err(|error| error.in_file(path))?;
            (hull.clone(), report)
        }
        None => load_hull(path, &options)?,
    };
    let read = Instant::now();
    let unlike = unlike_runner(&hull, ScanFrame::of(&hull)?.as_ref());
    let strips = strips_of_hull(&hull);
    let warning = strips.map(strips_warning).or(unlike);
    report.warnings.extend(warning);
    let noise = runner.noise(&mut report, || noise_of_hull(&hull));
    let mut underside = FittedUnderside::new(&hull, noise.found)?;
    let outliers = underside.quality().outliers_warning();
    report.warnings.extend(outliers);
    if runner.elastic && report.open_edges > 0 {
        let whole = underside.extent();
        underside = underside.within_outline();
        let extent = underside.extent();
        let [long, wide] = [0, 2].map(|k| (extent[k + 1] - extent[k]) / (whole[k + 1] - whole[k]));
        if long * wide < 0.99 {
            let [x0, x1, y0, y1] = extent.map(|end| 1e3 * end);
            report.warnings.push(format!(
                "the elastic body fills x = {x0:.1} to {x1:.1} mm, y = {y0:.2} to {y1:.2} mm: the \
                 rims outside are ragged"
            ));
        }
    }
    let fill = || Filled::of(&hull, &report, &underside, runner.height_m);
    let filled = runner.elastic.then(fill).transpose();
    let filled = filled.map_err(|error| error.in_file(path))?;
    let fitted = FittedHull {
        seconds: [read - started, read.elapsed()].map(|time| time.as_secs_f64()),
        ..FittedHull::new(underside, hull, report, noise, strips)
    };
    Ok((fitted, filled))
}

impl RunnerTable {
    /// The stated noise of the runner's vertices, or else the estimate of `found`, which is added
    /// to the warnings of the report.
    pub(crate) fn noise(
        &self,
        report: &mut HullReport,
        found: impl Fn() -> Option<Noise>,
    ) -> Noise {
        if let Some(found) = self.noise_m {
            return Noise { found, unseen: 0.0 };
        }
        let noise = found().unwrap_or_default();
        if noise.found > 0.0 {
            report.warnings.push(format!(
                "the underside's vertices scatter by {:.3} µm about a smooth surface: taken for noise \
                 and smoothed; noise_m states another",
                1e6 * noise.found
            ));
        }
        noise
    }
}
