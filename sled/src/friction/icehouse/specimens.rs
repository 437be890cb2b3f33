//! The ice house: mu by specimen and the slope of the rink, from pairs of gliding runs.

use crate::friction::error::Error;
use crate::friction::estimate::{Estimate, student_quantile};
use crate::friction::icehouse::glide_run::{GRAVITY, GlideRun};
use crate::friction::icehouse::glides::GlideEntry;
use crate::friction::tables::experiments::Experiment;

/// An uphill and a downhill run of one specimen.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
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
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SpecimenFriction {
    /// The specimen.
    pub specimen: String,
    /// Coefficient of friction, mean over the pairs, with its 95 % interval.
    pub mu: Estimate,
    /// Standard error of the mean: the larger of the lines' and that of the scatter between pairs.
    pub mu_se: f64,
    /// Standard error from the lines alone.
    pub mu_se_lines: f64,
    /// Standard error from the scatter between pairs; none with one pair.
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
/// [`Error::TooFew`] where no specimen has a run in each direction, [`Error::SameSamples`] where a run stands there twice.
pub fn evaluate_ice_house(runs: Vec<GlideRun>) -> Result<IceHouse, Error> {
    for (i, run) in runs.iter().enumerate() {
        let copy = |before: &&GlideRun| before.s == run.s && before.kinetic == run.kinetic;
        if let Some(before) = runs[..i].iter().find(copy) {
            return Err(Error::SameSamples {
                first: before.entry.run.clone(),
                second: run.entry.run.clone(),
            });
        }
    }
    let directions = directions(&runs);
    let mut names: Vec<String> = Vec::new();
    for run in &runs {
        if !names.contains(&run.entry.specimen) {
            names.push(run.entry.specimen.clone());
        }
    }
    let (mut pairs, mut specimens, mut unpaired) = (Vec::new(), Vec::new(), Vec::new());
    for name in &names {
        let of = |direction: &String| -> Vec<&GlideRun> {
            runs.iter()
                .filter(|r| r.entry.specimen == *name && r.entry.direction == *direction)
                .collect()
        };
        let (up, down) = (of(&directions[0]), of(&directions[1]));
        let count = up.len().min(down.len());
        for run in up[count..].iter().chain(&down[count..]) {
            unpaired.push(run.entry.run.clone());
        }
        if count == 0 {
            continue;
        }
        let own: Vec<GlidePair> = up.iter().zip(&down).map(|(u, d)| pair(u, d)).collect();
        let used = || up[..count].iter().chain(&down[..count]);
        specimens.push(specimen(name, &own, used().copied()));
        pairs.extend(own);
    }
    if pairs.is_empty() {
        return Err(Error::TooFew {
            what: "pairs of runs of one specimen in both directions".into(),
            have: 0,
            need: 1,
        });
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
    /// Rows of `experiments.csv`; where the index has no peak pressure, it is NaN and left empty in the file.
    pub fn experiments(&self) -> Vec<Experiment> {
        self.specimens
            .iter()
            .map(|specimen| {
                let entries: Vec<&GlideEntry> = self
                    .runs
                    .iter()
                    .map(|run| &run.entry)
                    .filter(|entry| entry.specimen == specimen.specimen)
                    .collect();
                let average = |value: &dyn Fn(&GlideEntry) -> Option<f64>| {
                    let known: Vec<f64> = entries.iter().filter_map(|e| value(e)).collect();
                    (!known.is_empty()).then(|| known.iter().sum::<f64>() / known.len() as f64)
                };
                let session = entries[0].session.clone();
                Experiment {
                    specimen: specimen.specimen.clone(),
                    p_max_pa: average(&|e| e.p_max_pa).unwrap_or(f64::NAN),
                    p_max_sd_pa: average(&|e| e.p_max_sd_pa).unwrap_or(f64::NAN),
                    mu: specimen.mu.value,
                    mu_sd: specimen.mu_se,
                    session: session
                        .filter(|s| entries.iter().all(|e| e.session.as_ref() == Some(s))),
                    fz_n: Some(specimen.fz_n),
                    v_mps: Some(specimen.v_mps),
                    ice_c: average(&|e| e.ice_c),
                    air_c: average(&|e| Some(e.air_c)),
                    humidity_pct: average(&|e| e.humidity_pct),
                    air_pa: average(&|e| Some(e.air_pa)),
                    rocker_radius_m: average(&|e| e.rocker_radius_m),
                    ..Default::default()
                }
            })
            .collect()
    }

    /// Potential energy of a run over its distance [J], from the estimated slope.
    pub fn potential(&self, run: &GlideRun) -> Vec<f64> {
        let climbs = if run.entry.direction == self.directions[0] {
            1.0
        } else {
            -1.0
        };
        let per_metre = climbs * run.entry.mass_kg * GRAVITY * self.slope_rad.value.sin();
        run.s.iter().map(|s| per_metre * s).collect()
    }
}

/// The label that says uphill first; otherwise in order of appearance.
fn directions(runs: &[GlideRun]) -> [String; 2] {
    let mut labels: Vec<String> = Vec::new();
    for run in runs {
        if !labels.contains(&run.entry.direction) {
            labels.push(run.entry.direction.clone());
        }
    }
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
        load += run.entry.mass_kg * GRAVITY * cosine;
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

/// Mean with 95 % interval, its standard error from the single errors, and that from the scatter.
///
/// The interval takes the larger error; with the scatter's, Student's quantile for one less than the number of values.
fn mean(values: &[f64], errors: &[f64]) -> (Estimate, f64, Option<f64>) {
    const NORMAL: f64 = 1.959_963_984_540_054;
    let n = values.len() as f64;
    let value = values.iter().sum::<f64>() / n;
    let propagated = errors.iter().map(|e| e * e).sum::<f64>().sqrt() / n;
    let scatter = (values.len() > 1).then(|| {
        let squares: f64 = values.iter().map(|v| (v - value).powi(2)).sum();
        (squares / (n - 1.0) / n).sqrt()
    });
    let half = match scatter {
        Some(scatter) => {
            let by_scatter = student_quantile(0.95, values.len() - 1) * scatter;
            by_scatter.max(NORMAL * propagated)
        }
        None => NORMAL * propagated,
    };
    let estimate = Estimate {
        value,
        low: value - half,
        high: value + half,
    };
    (estimate, propagated, scatter)
}
