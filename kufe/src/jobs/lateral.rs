//! Lateral friction laws: fit to recorded runs, and comparison with the forces that runs measured.

use std::collections::BTreeSet;
use std::path::Path;

use kufe_sled::friction::{LateralFit, MagicFormula};
use kufe_sled::{Model, Vehicle, by_track, fit, slip_offsets, slip_offsets_text, validate};

use crate::jobs::failure::{Failure, Located};
use crate::jobs::runs::{PreparedRuns, RunSelection};
use crate::jobs::watch::Watch;
use crate::results::{LateralFitDocument, Validation};

/// A fit of the lateral friction of both runners, and its runs.
pub struct FittedRuns {
    /// The runs, and the model before the fit.
    pub loaded: PreparedRuns,
    /// The fit, and the runs that it used.
    pub document: LateralFitDocument,
    /// Text of a model file with the fitted laws.
    pub model: String,
}

/// Ratio of stated to estimated slip noise above which a fit warns. Imported runs are low-pass
/// filtered, and a data sheet states the noise before filtering.
const MAX_NOISE_RATIO: f64 = 1.5;

/// Fits the lateral friction of both runners to the selected runs; `leave_out_contacts` excludes
/// samples with an external force.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, and where the runs do not determine the stiffness of
/// a runner; [`Failure::NotConverged`].
pub fn fit_lateral(
    selection: &RunSelection,
    leave_out_contacts: bool,
    watch: &Watch,
) -> Result<FittedRuns, Failure> {
    let loaded = selection.load(watch, |_| true)?;
    let stated = loaded.model.noise.map_or(0.0, |noise| noise.slip_rad);
    let estimated = loaded.slip_noise_rad;
    if estimated > 0.0 && stated > MAX_NOISE_RATIO * estimated {
        watch.warn(&format!(
            "{}: [noise] slip_rad = {stated:e} is {:.1} times the noise of the runs at their rate, {estimated:.1e} rad: the correction for noise then overestimates K; omit [noise] to have it estimated",
            selection.model.display(),
            stated / estimated
        ));
    }
    watch.progress("fitting");
    let fit = fit(&loaded.prepared, &loaded.vehicle, leave_out_contacts)?;
    if !fit.slip_offsets.is_empty() {
        let offsets = slip_offsets_text(&fit.slip_offsets);
        watch.warn(&format!(
            "slip angles have zero offsets, which the fit subtracts: {offsets}; calibrate the slip and the steering sensor"
        ));
    }
    let model = fit.applied_to(&loaded.model).to_toml();
    // The written model must be readable.
    Model::from_toml(&model, "model.fit.toml").and_then(|model| Vehicle::with_effects(&model))?;
    let document = LateralFitDocument {
        fit,
        used: loaded.used.clone(),
    };
    Ok(FittedRuns {
        loaded,
        document,
        model,
    })
}

/// Lateral laws of a fit, and the runs that it used.
#[derive(Clone, Debug)]
pub struct FittedLaws {
    /// Law of the front runner.
    pub front: MagicFormula,
    /// Law of the rear runner.
    pub rear: MagicFormula,
    /// Names of the runs that the fit used.
    pub runs: BTreeSet<String>,
}

impl FittedLaws {
    /// The laws of a file `fit.json`.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the file and the key.
    pub fn read(path: &Path) -> Result<FittedLaws, Failure> {
        let read = || {
            let text = kufe_files::text_of_regular(path, 1 << 24).bad_input()?;
            FittedLaws::of(&serde_json::from_str(&text)?)
        };
        read()
            .map_err(|found| format!("{found}; expected what kufe fit lateral writes"))
            .in_file(path)
    }

    /// The laws of a fit.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a value of a law that is out of range.
    pub fn of(document: &LateralFitDocument) -> Result<FittedLaws, Failure> {
        let law = |name: &str, runner: &LateralFit| {
            let law = runner.law();
            let checked = law.check().bad_input();
            checked
                .map(|()| law)
                .map_err(|failure| failure.within(name))
        };
        Ok(FittedLaws {
            front: law("front", &document.fit.front)?,
            rear: law("rear", &document.fit.rear)?,
            runs: document.fit.runs.iter().cloned().collect(),
        })
    }
}

/// Warns of zero offsets of slip angles, which a validation or an evaluation does not subtract.
pub fn warn_of_slip_offsets(loaded: &PreparedRuns, watch: &Watch) {
    let offsets = slip_offsets(&loaded.prepared, &loaded.vehicle);
    if !offsets.is_empty() {
        let offsets = slip_offsets_text(&offsets);
        watch.warn(&format!(
            "with these laws, slip angles have zero offsets, which add to forces and losses: {offsets}; subtract the rear's from alpha_rad and the front's excess over it from delta_rad, by zero in the mapping, or session by session by [effects.slip-offset] and [effects.steer-offset] in the model"
        ));
    }
}

/// Compares the lateral forces that the selected runs measured with those of the model. With
/// `laws`, these replace the model's laws, and the runs of their fit are excluded.
///
/// # Errors
/// [`Failure::BadInput`] with file and place, and where no run remains.
pub fn validate_runs(
    selection: &RunSelection,
    laws: Option<&FittedLaws>,
    watch: &Watch,
) -> Result<Validation, Failure> {
    let fitted = laws.map_or_else(BTreeSet::new, |laws| laws.runs.clone());
    let mut loaded = selection.load(watch, |run| !fitted.contains(&run.entry.run))?;
    if let Some(laws) = laws {
        loaded.vehicle = loaded.vehicle.with_lateral(laws.front, laws.rear);
    }
    warn_of_slip_offsets(&loaded, watch);
    let runs = validate(&loaded.prepared, &loaded.vehicle);
    Ok(Validation {
        tracks: by_track(&runs),
        runs,
        left_out_as_fitted: fitted,
        used: loaded.used.clone(),
    })
}
