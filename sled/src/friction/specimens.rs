//! From gliding runs in an ice house to coefficients of friction by specimen.

use std::io::Read;

use crate::columns::table::{Table, TableColumns};
use crate::conditions::Conditions;
use crate::error::Error;
use crate::friction::estimate::{Estimate, student_quantile};
use crate::friction::experiments::Experiment;
use crate::friction::glide_run::{GRAVITY, GlideRun};
use crate::series::{distinct, median};

/// One row of `glides.csv`.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideEntry {
    /// Name of the run.
    pub run: String,
    /// File of the run, relative to the index.
    pub file: String,
    /// Specimen on the sled.
    pub specimen: String,
    /// Direction of travel, one of two labels.
    pub direction: String,
    /// Ice, air, and the mass of sled and athlete.
    pub conditions: Conditions,
    /// Drag area [m2].
    pub cda_m2: f64,
    /// Session of the measurement.
    pub session: Option<String>,
    /// Rocker radius of the specimen [m].
    pub rocker_radius_m: Option<f64>,
    /// Peak pressure of the specimen [Pa].
    pub p_max_pa: Option<f64>,
    /// Standard deviation of the peak pressure [Pa].
    pub p_max_sd_pa: Option<f64>,
}

/// Speed over time of one run.
#[derive(Clone, Debug, PartialEq)]
pub struct GlideTrace {
    /// Time [s], increasing.
    pub t: Vec<f64>,
    /// Speed [m/s].
    pub v: Vec<f64>,
    /// Distance [m]; measured, or integrated from the speed.
    pub s: Vec<f64>,
    /// Whether the distance was measured.
    pub s_measured: bool,
}

const INDEX: TableColumns = TableColumns {
    required: &[
        "run",
        "file",
        "specimen",
        "direction",
        "mass_kg",
        "cda_m2",
        "air_c",
        "air_pa",
    ],
    optional: &[
        "session",
        "ice_c",
        "humidity_pct",
        "rocker_radius_m",
        "p_max_pa",
        "p_max_sd_pa",
    ],
    further: |_| false,
    further_names: "",
};

const TRACE: TableColumns = TableColumns {
    required: &["t_s", "v_mps"],
    optional: &["s_m"],
    further: |_| true,
    further_names: "",
};

/// Largest ratio of the integral of the speed to the measured distance, and of its inverse: twice
/// the worst error of a wheel or a radar, and far below the factors of knots (1.9), mph (2.2) and
/// km/h (3.6).
const MAX_DISTANCE_RATIO: f64 = 1.25;

/// Reads the index `glides.csv`; `file` is the name that errors carry.
///
/// # Errors
/// [`Error::MissingColumn`], [`Error::Column`], [`Error::Cell`]; two runs of one name or
/// one file, more than two directions and an empty table count as bad values.
pub fn read_glide_index(file: &str, reader: impl Read) -> Result<Vec<GlideEntry>, Error> {
    let table = Table::read(file, reader, &INDEX)?;
    let mut entries: Vec<GlideEntry> = Vec::new();
    for row in 0..table.rows() {
        let run = table.name(row, "run")?;
        if entries.iter().any(|entry| entry.run == run) {
            return Err(table.bad(row, "run", &run, "a name that no run before has"));
        }
        let path = table.name(row, "file")?;
        if let Some(before) = entries.iter().find(|entry| entry.file == path) {
            let expected = format!(
                "a different file for each run: run {} has this one",
                before.run
            );
            return Err(table.bad(row, "file", &path, &expected));
        }
        let direction = table.name(row, "direction")?;
        let before = entries.iter().map(|entry| entry.direction.as_str());
        if let [one, other, _] = distinct(before.chain([direction.as_str()]))[..] {
            let two = format!("{one} or {other}");
            return Err(table.bad(row, "direction", &direction, &two));
        }
        entries.push(GlideEntry {
            run,
            file: path,
            specimen: table.name(row, "specimen")?,
            direction,
            conditions: table.conditions(row)?,
            cda_m2: table.number(row, "cda_m2")?,
            session: table.nonempty_text(row, "session"),
            rocker_radius_m: table.optional(row, "rocker_radius_m")?,
            p_max_pa: table.optional(row, "p_max_pa")?,
            p_max_sd_pa: table.optional(row, "p_max_sd_pa")?,
        });
    }
    if entries.is_empty() {
        return Err(Error::too_few(format!("{file}: runs"), 0, 2));
    }
    Ok(entries)
}

/// Reads the speed of one run; the distance is integrated by the trapezoidal rule where `s_m` is
/// absent.
///
/// # Errors
/// [`Error::MissingColumn`]; [`Error::Cell`] for cells that are no numbers, time that does not
/// increase, a gap of more than ten median steps, speeds above 60 m/s, or an integral of the speed
/// that is not `s_m`; [`Error::TooFew`] below thirty samples.
pub fn read_glide(file: &str, reader: impl Read) -> Result<GlideTrace, Error> {
    const MIN_SAMPLES: usize = 30;
    let table = Table::read(file, reader, &TRACE)?;
    if table.rows() < MIN_SAMPLES {
        return Err(Error::too_few(
            format!("{file}: samples"),
            table.rows(),
            MIN_SAMPLES,
        ));
    }
    let column = |name: &'static str, range: (f64, f64), expected: &'static str| {
        (0..table.rows())
            .map(|row| table.number_within(row, name, range, expected))
            .collect::<Result<Vec<f64>, Error>>()
    };
    let finite = (f64::MIN, f64::MAX);
    let t = column("t_s", finite, "a time in s")?;
    let v = column("v_mps", (-2.0, 60.0), "a speed in m/s, up to 60")?;
    let steps: Vec<f64> = t.windows(2).map(|pair| pair[1] - pair[0]).collect();
    if let Some(at) = steps.iter().position(|step| *step <= 0.0) {
        let before = format!("a time after {} s", t[at]);
        return Err(table.bad(at + 1, "t_s", &t[at + 1].to_string(), &before));
    }
    let median_step = median(steps.iter().copied()).unwrap_or(0.0);
    if let Some(at) = steps.iter().position(|step| *step > 10.0 * median_step) {
        let expected = format!(
            "no gap: steps are usually {median_step:.4} s, this is {:.4} s",
            steps[at]
        );
        return Err(table.bad(at + 1, "t_s", &t[at + 1].to_string(), &expected));
    }
    let s_measured = table.text(0, "s_m").is_some();
    let s = if s_measured {
        let s = column("s_m", finite, "a distance in m")?;
        if let Some(at) = s.windows(2).position(|pair| pair[1] < pair[0] - 0.05) {
            let expected = format!("a distance not below {} m", s[at]);
            return Err(table.bad(at + 1, "s_m", &s[at + 1].to_string(), &expected));
        }
        let (way, of_speed) = (s[s.len() - 1] - s[0], integrate(&t, &v)[t.len() - 1]);
        if !(1.0 / MAX_DISTANCE_RATIO..=MAX_DISTANCE_RATIO).contains(&(of_speed / way)) {
            let expected = format!(
                "speeds in m/s: their integral is {of_speed:.1} m, s_m grows by {way:.1} m, ratio {:.2} (3.6 for km/h)",
                of_speed / way
            );
            return Err(table.bad(0, "v_mps", &v[0].to_string(), &expected));
        }
        s
    } else {
        integrate(&t, &v)
    };
    Ok(GlideTrace {
        t,
        v,
        s,
        s_measured,
    })
}

/// Running integral of `y` over `x` by the trapezoidal rule, starting at 0.
pub(crate) fn integrate(x: &[f64], y: &[f64]) -> Vec<f64> {
    let mut sum = 0.0;
    let mut out = vec![0.0];
    for i in 1..x.len() {
        sum += 0.5 * (y[i] + y[i - 1]) * (x[i] - x[i - 1]);
        out.push(sum);
    }
    out
}

/// An uphill and a downhill run of one specimen.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct GlidePair {
    /// The specimen.
    pub specimen: String,
    /// Run in the first direction.
    pub up: String,
    /// Run in the second direction.
    pub down: String,
    /// Coefficient of friction.
    pub mu: f64,
    /// Its standard error, from both runs' lines.
    pub mu_se: f64,
    /// Slope of the rink, positive where the first direction climbs [rad].
    pub slope_rad: f64,
    /// Its standard error [rad].
    pub slope_se_rad: f64,
}

/// Coefficient of friction of one specimen.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct SpecimenFriction {
    /// The specimen.
    pub specimen: String,
    /// Coefficient of friction, mean over the pairs, with its 95 % interval.
    pub mu: Estimate,
    /// Standard error of the mean: the larger of `mu_se_lines` and `mu_se_scatter`.
    pub mu_se: f64,
    /// Standard error from the lines alone.
    pub mu_se_lines: f64,
    /// Standard error from the scatter between pairs; `None` with one pair.
    pub mu_se_scatter: Option<f64>,
    /// Number of pairs.
    pub pairs: usize,
    /// Mean normal force [N].
    pub fz_n: f64,
    /// Mean speed [m/s].
    pub v_mps: f64,
}

/// The evaluated ice house.
#[derive(Clone, Debug, PartialEq)]
pub struct IceHouse {
    /// The runs, in the index's order.
    pub runs: Vec<GlideRun>,
    /// Label of the direction counted as uphill, and of the other.
    pub directions: [String; 2],
    /// The pairs.
    pub pairs: Vec<GlidePair>,
    /// Friction by specimen, in the index's order.
    pub specimens: Vec<SpecimenFriction>,
    /// Slope of the rink in the first direction [rad], with its 95 % interval.
    pub slope_rad: Estimate,
    /// Runs without a partner, not used.
    pub unpaired: Vec<String>,
}

/// Pairs the runs and averages by specimen.
///
/// ```text
/// mu cos(kappa) = (R_up + R_down)/2,   sin(kappa) = (R_up - R_down)/2,   R = F / (m g)
/// ```
///
/// The n-th run of a specimen in one direction is paired with its n-th in the other.
///
/// # Errors
/// [`Error::TooFew`] where no specimen has a run in each direction, [`Error::DuplicateContent`] where a
/// run is listed twice, [`Error::File`] for a specimen without friction.
pub fn evaluate_ice_house(runs: Vec<GlideRun>) -> Result<IceHouse, Error> {
    for (i, run) in runs.iter().enumerate() {
        let copy = |before: &&GlideRun| before.s == run.s && before.kinetic == run.kinetic;
        if let Some(before) = runs[..i].iter().find(copy) {
            return Err(Error::DuplicateContent {
                first: before.entry.run.clone(),
                second: run.entry.run.clone(),
            });
        }
    }
    let directions = directions(&runs);
    let names = distinct(runs.iter().map(|run| run.entry.specimen.clone()));
    let (mut pairs, mut specimens, mut unpaired) = (Vec::new(), Vec::new(), Vec::new());
    for name in &names {
        let runs_in = |direction: &String| -> Vec<&GlideRun> {
            runs.iter()
                .filter(|r| r.entry.specimen == *name && r.entry.direction == *direction)
                .collect()
        };
        let (up, down) = (runs_in(&directions[0]), runs_in(&directions[1]));
        let count = up.len().min(down.len());
        for run in up[count..].iter().chain(&down[count..]) {
            unpaired.push(run.entry.run.clone());
        }
        if count == 0 {
            continue;
        }
        let specimen_pairs: Vec<GlidePair> =
            up.iter().zip(&down).map(|(u, d)| pair(u, d)).collect();
        let used = || up[..count].iter().chain(&down[..count]);
        specimens.push(specimen(name, &specimen_pairs, used().copied()));
        pairs.extend(specimen_pairs);
    }
    if pairs.is_empty() {
        let what = "pairs of runs of one specimen in both directions";
        return Err(Error::too_few(what, 0, 1));
    }
    if let Some(bad) = specimens.iter().find(|s| s.mu.value <= 0.0) {
        let (mu, expected) = (
            bad.mu.value,
            "expected above 0; v_mps in m/s (km/h: divide by 3.6)",
        );
        let specimen = format!("specimen {}", bad.specimen);
        return Err(Error::file(specimen, format!("mu = {mu:.4}, {expected}")));
    }
    let slopes: Vec<f64> = pairs.iter().map(|p| p.slope_rad).collect();
    let errors: Vec<f64> = pairs.iter().map(|p| p.slope_se_rad).collect();
    Ok(IceHouse {
        slope_rad: mean(&slopes, &errors).0,
        runs,
        directions,
        pairs,
        specimens,
        unpaired,
    })
}

impl IceHouse {
    /// Rows of `experiments.csv`; where the index has no peak pressure, it is NaN and empty in the
    /// file.
    pub fn experiments(&self) -> Vec<Experiment> {
        let row = |specimen: &SpecimenFriction| {
            let entries = self.runs.iter().map(|run| &run.entry);
            let entries = entries.filter(|entry| entry.specimen == specimen.specimen);
            let entries: Vec<&GlideEntry> = entries.collect();
            let average = |value: &dyn Fn(&GlideEntry) -> Option<f64>| {
                let known: Vec<f64> = entries.iter().filter_map(|e| value(e)).collect();
                (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
            };
            let condition = |place: usize| {
                let stated = |value: &f64| !value.is_nan();
                let values = |e: &GlideEntry| Some(e.conditions.values()[place]).filter(stated);
                average(&values).unwrap_or(f64::NAN)
            };
            let session = &entries[0].session;
            Experiment {
                specimen: specimen.specimen.clone(),
                p_max_pa: average(&|e| e.p_max_pa).unwrap_or(f64::NAN),
                p_max_sd_pa: average(&|e| e.p_max_sd_pa).unwrap_or(f64::NAN),
                mu: specimen.mu.value,
                mu_sd: specimen.mu_se,
                session: session
                    .clone()
                    .filter(|_| entries.iter().all(|e| e.session == *session)),
                conditions: Conditions::from_values(std::array::from_fn(condition)),
                fz_n: Some(specimen.fz_n),
                v_mps: Some(specimen.v_mps),
                rocker_radius_m: average(&|e| e.rocker_radius_m),
            }
        };
        self.specimens.iter().map(row).collect()
    }

    /// Potential energy of a run over its distance [J], from the estimated slope.
    pub fn potential(&self, run: &GlideRun) -> Vec<f64> {
        let up = run.entry.direction == self.directions[0];
        let climbs = if up { 1.0 } else { -1.0 };
        let per_metre =
            climbs * run.entry.conditions.mass_kg * GRAVITY * self.slope_rad.value.sin();
        run.s.iter().map(|s| per_metre * s).collect()
    }
}

/// The label of uphill first; otherwise in order of appearance.
fn directions(runs: &[GlideRun]) -> [String; 2] {
    let mut labels = distinct(runs.iter().map(|run| run.entry.direction.clone()));
    labels.sort_by_key(|label| match label.to_lowercase() {
        l if l.starts_with("up") => 0,
        l if l.starts_with("down") => 2,
        _ => 1,
    });
    labels.resize(2, String::new());
    [labels[0].clone(), labels[1].clone()]
}

fn pair(up: &GlideRun, down: &GlideRun) -> GlidePair {
    let sine = 0.5 * (up.resistance() - down.resistance());
    let cosine = (1.0 - sine * sine).max(0.0).sqrt();
    let error = 0.5 * up.resistance_se().hypot(down.resistance_se());
    GlidePair {
        specimen: up.entry.specimen.clone(),
        up: up.entry.run.clone(),
        down: down.entry.run.clone(),
        mu: 0.5 * (up.resistance() + down.resistance()) / cosine,
        mu_se: error / cosine,
        slope_rad: sine.asin(),
        slope_se_rad: error / cosine,
    }
}

fn specimen<'a>(
    name: &str,
    pairs: &[GlidePair],
    runs: impl Iterator<Item = &'a GlideRun>,
) -> SpecimenFriction {
    let mus: Vec<f64> = pairs.iter().map(|p| p.mu).collect();
    let errors: Vec<f64> = pairs.iter().map(|p| p.mu_se).collect();
    let (mu, lines, scatter) = mean(&mus, &errors);
    let cosine = pairs[0].slope_rad.cos();
    let (mut load, mut speed, mut count) = (0.0, 0.0, 0.0);
    for run in runs {
        load += run.entry.conditions.mass_kg * GRAVITY * cosine;
        speed += run.v_mean;
        count += 1.0;
    }
    SpecimenFriction {
        specimen: name.to_string(),
        mu,
        mu_se: scatter.map_or(lines, |scatter| scatter.max(lines)),
        mu_se_lines: lines,
        mu_se_scatter: scatter,
        pairs: pairs.len(),
        fz_n: load / count,
        v_mps: speed / count,
    }
}

/// Mean with 95 % interval, its standard error propagated from `errors`, and its standard error
/// from the scatter (`None` for one value).
///
/// The half width is the larger of the normal quantile times the propagated error and Student's
/// quantile times the error from the scatter.
fn mean(values: &[f64], errors: &[f64]) -> (Estimate, f64, Option<f64>) {
    const NORMAL: f64 = 1.959_963_984_540_054;
    let n = values.len() as f64;
    let value = values.iter().sum::<f64>() / n;
    let propagated = errors.iter().map(|e| e * e).sum::<f64>().sqrt() / n;
    let scatter = (values.len() > 1).then(|| {
        let squares: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        (squares / (n - 1.0) / n).sqrt()
    });
    let by_scatter = scatter.map(|sd| student_quantile(0.95, values.len() - 1) * sd);
    let half = by_scatter.unwrap_or(0.0).max(NORMAL * propagated);
    (Estimate::about(value, half), propagated, scatter)
}
