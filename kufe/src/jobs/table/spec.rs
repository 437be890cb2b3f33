//! `table.toml`: the axes and the accuracy of a table.

use std::fmt::Display;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};

use kufe_files::text_of_regular;
use kufe_lut::{AxisKind, Error, Mode, Outside, Plan, Spacing};
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::Deserialize;

use crate::jobs::failure::{Failure, Located};

/// A table file is a page of text; a longer file is something else [bytes].
const LONGEST: u64 = 1 << 20;

/// Relative errors of the interpolation that can be requested: finer ones would chase the solver's
/// own error.
const INTERPOLATIONS: RangeInclusive<f64> = 5e-4..=0.5;

/// A table file, key by key.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "table.toml")]
struct TableToml {
    /// The case's file; its load and track, and its speed and temperature of the ice, are replaced
    /// by the axes.
    case: PathBuf,
    /// The axes.
    axes: AxesToml,
    /// The accuracy.
    #[serde(default)]
    accuracy: AccuracyToml,
}

/// Normal force, and the track as a curvature or as a radius; further axes as the runner has them.
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

/// Given values, or a range that the sweep fills.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AxisToml {
    /// The values, and no others.
    values: Option<Vec<f64>>,
    /// Where the range begins.
    from: Option<f64>,
    /// Where it ends.
    to: Option<f64>,
    /// Rule for inputs outside: the end of the axis takes the input's place, the interpolant
    /// continues straight, or there is no value; `hold` where absent.
    #[schemars(with = "Option<String>", extend("enum" = Outside::ALL.map(Outside::name)))]
    outside: Option<Outside>,
    /// Of curvatures alone: where the runner lies flush on the track. The table is made over
    /// reduced curvatures then.
    flush: Option<FlushToml>,
}

/// What reduced curvatures are made of.
#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct FlushToml {
    /// The rocker's curvature [1/m].
    curvature_1pm: f64,
    /// Width of the peak pressure's minimum over the load, about 10 / (E* L^3) for a half-length L
    /// [1/(m N)].
    scale_1pm_per_n: f64,
}

/// How accurate the table must be.
#[derive(Clone, Debug, Default, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct AccuracyToml {
    /// Relative error requested of the peak pressure, or of the friction of a case that slides,
    /// between nodes of axes given as ranges.
    interpolation: Option<f64>,
    /// Which modes must be that good; both where absent.
    evaluation: Option<Evaluation>,
    /// Tolerance of the solver; the case's, and at most half of `interpolation`, where absent.
    p_max: Option<f64>,
    /// Solves spread over the table that measure the interpolation.
    checks: Option<usize>,
    /// Where refinement gives up.
    max_nodes: Option<usize>,
    /// Part of an axis below which nothing is halved.
    smallest_interval: Option<f64>,
}

#[derive(Clone, Copy, Debug, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
enum Evaluation {
    Both,
    Smooth,
    Bilinear,
}

/// The table file as a JSON schema.
pub fn schema(generator: &mut SchemaGenerator) -> Schema {
    generator.root_schema_for::<TableToml>()
}

/// The content of a table file.
#[derive(Clone, Debug)]
pub struct TableSpec {
    /// The file.
    pub path: PathBuf,
    /// The case's file.
    pub case: PathBuf,
    /// The points and their accuracy.
    pub plan: Plan,
    /// Solver tolerance of the peak pressure, where the file states one.
    pub p_max: Option<f64>,
    /// Rule for inputs outside, for the axes of which the file states it.
    pub outside: Vec<(AxisKind, Outside)>,
}

impl TableSpec {
    /// Reads a table file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] naming the file, the key, what was found and what was expected.
    pub fn read(path: &Path) -> Result<TableSpec, Failure> {
        let text = text_of_regular(path, LONGEST).in_file(path)?;
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
    /// The axis of a kind, where there is one: its key and what is stated of it. Curvatures may be
    /// given as radii.
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

    /// The rules of the axes that state one.
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

/// The line of the axis that an error is about.
fn line_of(text: &str, error: &Error) -> Option<usize> {
    let Error::Axis { axis, .. } = error else {
        return None;
    };
    // Curvatures may be given as radii.
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
        // An eighth of the grooves, as of the nodes of a table of contacts at rest.
        let kinds = [AxisKind::Fz, AxisKind::Curvature, AxisKind::IceTemperature];
        let count = |kind| plan.get(kind).map_or(1, |spacing| spacing.ends().len());
        let grooves: usize = kinds.into_iter().map(count).product();
        plan.checks = grooves.div_ceil(8).max(4);
    }
    let checks = within("accuracy.checks", "a number", accuracy.checks, 0..=100_000)?;
    plan.checks = checks.unwrap_or(plan.checks);
    let most = 0..=kufe_lut::MAX_NODES;
    let nodes = within("accuracy.max_nodes", "a number", accuracy.max_nodes, most)?;
    plan.max_nodes = nodes.unwrap_or(plan.max_nodes);
    let (key, smallest) = ("accuracy.smallest_interval", accuracy.smallest_interval);
    let smallest = within(key, "a part of an axis", smallest, 1e-6..=0.25)?;
    plan.smallest_interval = smallest.unwrap_or(plan.smallest_interval);
    Ok(plan)
}

/// A stated value, which must be in its range.
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

/// Radii as curvatures, increasing: `inf` is 0, a straight, and a range from a crest to a valley
/// passes it.
fn as_curvature(radii: Spacing) -> Result<Spacing, String> {
    let invert = |radius: f64| {
        if radius == 0.0 || radius.is_nan() {
            return Err(format!(
                "axes.radius_m: found {radius}, expected a radius other than 0, or inf"
            ));
        }
        // Adding 0 makes the curvature of -inf a plain 0.
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
