//! `table.toml`: the axes and the accuracy of a table.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use kufe_files::text_of_regular;
use kufe_lut::{AxisKind, Error, Mode, Outside, Plan, Spacing};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;

use crate::jobs::failure::{Failure, Located};

/// Maximum size of a table file [bytes]: it is about a page of text, so a larger file is something
/// else.
const MAX_BYTES: u64 = 1 << 20;

/// Relative errors of the interpolation that can be requested; with a smaller one, nodes would be
/// added because of the solver's error.
const INTERPOLATIONS: RangeInclusive<f64> = 5e-4..=0.5;

/// The keys of a table file.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "table.toml")]
struct TableToml {
    /// The case file. The axes replace its load and track, and its speed and ice temperature.
    case: PathBuf,
    /// The axes of the table.
    axes: AxesToml,
    /// The requested accuracy.
    #[serde(default)]
    accuracy: AccuracyToml,
}

/// Axes: the normal force, the track as a curvature or as a radius, and optional further ones.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxesToml {
    /// Normal force [N].
    fz_n: AxisToml,
    /// Track curvature, positive in a valley, 0 on a straight [1/m].
    curvature_1pm: Option<AxisToml>,
    /// Track radius instead, positive in a valley, inf on a straight [m].
    radius_m: Option<AxisToml>,
    /// Rocker radius of a parametric runner [m].
    rocker_radius_m: Option<AxisToml>,
    /// Speed of a case with `[sliding]` [m/s].
    v_mps: Option<AxisToml>,
    /// Temperature of the ice of a case with `[sliding]` [C].
    ice_c: Option<AxisToml>,
}

/// An axis: given values, or a range in which the sweep chooses the values.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxisToml {
    /// The only values of the axis.
    values: Option<Vec<f64>>,
    /// Start of the range.
    from: Option<f64>,
    /// End of the range.
    to: Option<f64>,
    /// Rule for inputs outside the axis: the end of the axis is used, the interpolant is continued
    /// linearly, or the input is an error. Without this key: `hold`.
    #[schemars(with = "Option<String>", extend("enum" = Outside::ALL.map(Outside::name)))]
    outside: Option<Outside>,
    /// Only for `curvature_1pm`: the curvature at which the runner lies flush on the track. The
    /// table then uses reduced curvatures.
    flush: Option<FlushToml>,
}

/// Parameters of reduced curvatures.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FlushToml {
    /// The rocker's curvature [1/m].
    curvature_1pm: f64,
    /// Width, in curvature, of the minimum of the peak pressure, per newton of load; about
    /// 10 / (E* L^3) for a half-length L [1/(m N)].
    scale_1pm_per_n: f64,
}

/// The requested accuracy of the table.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AccuracyToml {
    /// Requested relative error of the interpolation between the nodes of axes given as ranges: of
    /// the peak pressure, or of the coefficient of friction for a case with `[sliding]`.
    interpolation: Option<f64>,
    /// Evaluation modes that must be this accurate. Without this key: both.
    evaluation: Option<Evaluation>,
    /// Tolerance of the solver. Without this key: that of the case, and at most half of
    /// `interpolation`.
    p_max: Option<f64>,
    /// Number of contacts, spread over the table, that are solved to measure the interpolation
    /// error.
    checks: Option<usize>,
    /// Maximum number of nodes; refinement stops there.
    max_nodes: Option<usize>,
    /// Smallest interval between nodes, as a part of the axis.
    smallest_interval: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Evaluation {
    Both,
    Smooth,
    Bilinear,
}

/// The JSON schema of a table file.
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    generator.root_schema_for::<TableToml>()
}

/// The content of a table file.
#[derive(Clone, Debug)]
pub struct TableSpec {
    /// The table file.
    pub path: PathBuf,
    /// The case file.
    pub case: PathBuf,
    /// The axes and the requested accuracy.
    pub plan: Plan,
    /// Solver tolerance of the peak pressure, if the file states one.
    pub p_max: Option<f64>,
    /// Rules for inputs outside, for the axes for which the file states one.
    pub outside: Vec<(AxisKind, Outside)>,
}

impl TableSpec {
    /// Reads a table file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the file, the key, what was found and what was expected.
    pub fn read(path: &Path) -> Result<TableSpec, Failure> {
        let text = text_of_regular(path, MAX_BYTES).in_file(path)?;
        TableSpec::parse(path, &text).in_file(path)
    }

    fn parse(path: &Path, text: &str) -> Result<TableSpec, String> {
        let file: TableToml = toml::from_str(text)
            .map_err(|error| kufe_files::broken_at(text, error.span(), error.message()))?;
        let plan = plan(&file)?;
        let outside = file.axes.outside()?;
        plan.check().map_err(|error| match line_of(text, &error) {
            Some(line) => format!("line {line}: {error}"),
            None => error.to_string(),
        })?;
        let p_max = file.accuracy.p_max;
        within("accuracy.p_max", "a relative error", p_max, 1e-5..=0.5)?;
        Ok(TableSpec {
            path: path.to_path_buf(),
            case: path.with_file_name(&file.case),
            plan,
            p_max,
            outside,
        })
    }
}

impl AxesToml {
    /// The key and the content of the axis of a kind, if there is one. The curvature may be given
    /// as a radius.
    fn get(&self, kind: AxisKind) -> Option<(&'static str, &AxisToml)> {
        let (key, axis) = match kind {
            AxisKind::Fz => ("fz_n", Some(&self.fz_n)),
            AxisKind::Curvature if self.radius_m.is_some() => ("radius_m", self.radius_m.as_ref()),
            AxisKind::Curvature => ("curvature_1pm", self.curvature_1pm.as_ref()),
            AxisKind::RockerRadius => ("rocker_radius_m", self.rocker_radius_m.as_ref()),
            AxisKind::Speed => ("v_mps", self.v_mps.as_ref()),
            AxisKind::IceTemperature => ("ice_c", self.ice_c.as_ref()),
        };
        Some((key, axis?))
    }

    /// The rules for inputs outside, for the axes that state one.
    fn outside(&self) -> Result<Vec<(AxisKind, Outside)>, String> {
        let mut rules = Vec::new();
        for kind in AxisKind::ALL {
            let Some((key, axis)) = self.get(kind) else {
                continue;
            };
            if kind == AxisKind::RockerRadius && axis.outside.is_some() {
                return Err(format!(
                    "axes.{key}.outside: expected no such key: a radius outside is refused"
                ));
            }
            if axis.flush.is_some() && key != "curvature_1pm" {
                return Err(format!("axes.{key}.flush: belongs to axes.curvature_1pm"));
            }
            rules.extend(axis.outside.map(|rule| (kind, rule)));
        }
        Ok(rules)
    }
}

/// The line number of the axis that an error is about.
fn line_of(text: &str, error: &Error) -> Option<usize> {
    let Error::Axis { axis, .. } = error else {
        return None;
    };
    // The curvature may be given as a radius.
    let keys = match *axis {
        "curvature_1pm" => ["curvature_1pm", "radius_m"],
        axis => [axis; 2],
    };
    let starts = |line: &str| keys.iter().any(|key| line.trim_start().starts_with(key));
    text.lines().position(starts).map(|index| index + 1)
}

fn plan(file: &TableToml) -> Result<Plan, String> {
    let axes = &file.axes;
    let curvature = match (&axes.curvature_1pm, &axes.radius_m) {
        (Some(axis), None) => spacing("curvature_1pm", axis)?,
        (None, Some(axis)) => as_curvature(spacing("radius_m", axis)?)?,
        _ => return Err("axes: expected either curvature_1pm or radius_m".into()),
    };
    let mut plan = Plan::new(spacing("fz_n", &axes.fz_n)?, curvature);
    let flush = axes.curvature_1pm.as_ref().and_then(|axis| axis.flush);
    plan.flush = flush.map(|flush| [flush.curvature_1pm, flush.scale_1pm_per_n]);
    for kind in [
        AxisKind::RockerRadius,
        AxisKind::Speed,
        AxisKind::IceTemperature,
    ] {
        if let Some((key, axis)) = axes.get(kind) {
            plan = plan.with(kind, spacing(key, axis)?);
        }
    }
    let accuracy = &file.accuracy;
    let what = "a relative error, of which contacts are solved to half,";
    let requested = accuracy.interpolation;
    let requested = within("accuracy.interpolation", what, requested, INTERPOLATIONS)?;
    plan.interpolation = requested.unwrap_or(plan.interpolation);
    plan.modes = match accuracy.evaluation.unwrap_or(Evaluation::Both) {
        Evaluation::Both => Mode::ALL.to_vec(),
        Evaluation::Smooth => vec![Mode::Smooth],
        Evaluation::Bilinear => vec![Mode::Bilinear],
    };
    if plan.is_sliding() && plan.is_fixed() {
        // An eighth of the number of grooves, as for a table of contacts at rest an eighth of the
        // number of nodes.
        let kinds = [AxisKind::Fz, AxisKind::Curvature, AxisKind::IceTemperature];
        let count = |kind| plan.get(kind).map_or(1, |spacing| spacing.ends().len());
        let grooves: usize = kinds.into_iter().map(count).product();
        plan.checks = grooves.div_ceil(8).max(4);
    }
    let checks = within("accuracy.checks", "a number", accuracy.checks, 0..=100_000)?;
    plan.checks = checks.unwrap_or(plan.checks);
    let allowed = 0..=kufe_lut::MAX_NODES;
    let nodes = within(
        "accuracy.max_nodes",
        "a number",
        accuracy.max_nodes,
        allowed,
    )?;
    plan.max_nodes = nodes.unwrap_or(plan.max_nodes);
    let (key, smallest) = ("accuracy.smallest_interval", accuracy.smallest_interval);
    let smallest = within(key, "a part of an axis", smallest, 1e-6..=0.25)?;
    plan.smallest_interval = smallest.unwrap_or(plan.smallest_interval);
    Ok(plan)
}

/// Checks that a value, if stated, lies in a range.
fn within<T: Display + PartialOrd>(
    key: &str,
    what: &str,
    found: Option<T>,
    range: RangeInclusive<T>,
) -> Result<Option<T>, String> {
    match found {
        Some(found) if !range.contains(&found) => Err(format!(
            "{key} = {found}: expected {what} between {} and {}",
            range.start(),
            range.end()
        )),
        found => Ok(found),
    }
}

fn spacing(key: &str, axis: &AxisToml) -> Result<Spacing, String> {
    match (&axis.values, axis.from, axis.to) {
        (Some(values), None, None) => Ok(Spacing::Values(values.clone())),
        (None, Some(from), Some(to)) => Ok(Spacing::Range { from, to }),
        _ => Err(format!(
            "axes.{key}: expected either values = [...], or from and to"
        )),
    }
}

/// Converts radii to curvatures in increasing order. The radius `inf`, a straight, is the curvature
/// 0; a range from a crest to a valley contains it.
fn as_curvature(radii: Spacing) -> Result<Spacing, String> {
    let invert = |radius: f64| {
        if radius == 0.0 || radius.is_nan() {
            return Err(format!(
                "axes.radius_m: found {radius}, expected a radius other than 0, or inf"
            ));
        }
        // Adding 0 turns the -0 of a radius of -inf into 0.
        Ok(1.0 / radius + 0.0)
    };
    Ok(match radii {
        Spacing::Values(radii) => {
            let mut curvatures = radii
                .into_iter()
                .map(invert)
                .collect::<Result<Vec<_>, _>>()?;
            curvatures.sort_by(f64::total_cmp);
            Spacing::Values(curvatures)
        }
        Spacing::Range { from, to } => {
            let (a, b) = (invert(from)?, invert(to)?);
            Spacing::Range {
                from: a.min(b),
                to: a.max(b),
            }
        }
    })
}
