//! Lateral friction of recorded runs: fitted, and compared with what runs measured.

use std::collections::BTreeSet;
use std::path::Path;

use kufe_sled::friction::{LateralFit, MagicFormula};
use kufe_sled::{Model, Vehicle, by_track, fit, validate};

use crate::jobs::failure::{Failure, Located};
use crate::jobs::runs::{PreparedRuns, RunSelection};
use crate::jobs::watch::Watch;
use crate::results::{LateralFitDocument, Validation};

/// A fit of the lateral friction of both runners, and its runs.
pub struct FittedRuns {
    /// The runs, and the model before the fit.
    pub loaded: PreparedRuns,
    /// The fit, and what it rests on.
    pub document: LateralFitDocument,
    /// The model with the fitted laws, as its file's text.
    pub model: String,
}

/// Stated over estimated noise of the slip above which a fit warns: imported runs went through a low
/// pass, and a data sheet states the noise before it.
const TOO_NOISY: f64 = 1.5;

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
    let found = loaded.slip_noise_rad;
    if found > 0.0 && stated > TOO_NOISY * found {
        watch.warn(&format!(
            "{}: [noise] slip_rad = {stated:e} is {:.1} times the noise of the runs at their rate, {found:.1e} rad: K is raised by the difference; leave [noise] out, and it is estimated",
            selection.model.display(),
            stated / found
        ));
    }
    watch.progress("fitting");
    let fit = fit(&loaded.prepared, &loaded.vehicle, leave_out_contacts)?;
    let model = fit.applied_to(&loaded.model).to_toml();
    // The written model is valid.
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

/// Lateral laws of a fit, and the runs that it saw.
#[derive(Clone, Debug)]
pub struct FittedLaws {
    /// Law of the front runner.
    pub front: MagicFormula,
    /// Law of the rear runner.
    pub rear: MagicFormula,
    /// Names of the runs.
    pub runs: BTreeSet<String>,
}

impl FittedLaws {
    /// Those of a `fit.json`.
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

    /// Those of a fit.
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

/// Compares lateral forces as the selected runs measured them with those of the model. The laws of
/// a fit replace the model's, and the runs that it saw are excluded.
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
    let runs = validate(&loaded.prepared, &loaded.vehicle);
    Ok(Validation {
        tracks: by_track(&runs),
        runs,
        left_out_as_fitted: fitted,
        used: loaded.used.clone(),
    })
}
