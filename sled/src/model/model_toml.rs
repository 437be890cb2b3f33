//! The sled and its friction as written in `model.toml`.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::friction::{LongitudinalKeys, MagicFormula};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::Error;
use crate::sled::{ModelConditions, Noise, Sled, Survey, Tolerances};

/// A model file, the basis of simulations, fits and evaluations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "model.toml")]
pub struct Model {
    /// Masses, lengths, sensor places and drag.
    pub sled: Sled,
    /// Ice friction of both runners.
    pub friction: Friction,
    /// Accuracy of the track survey.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub survey: Option<Survey>,
    /// Conditions that effects need, used if neither a run's file nor `runs.csv` states them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub conditions: Option<ModelConditions>,
    /// Standard deviations of the sensors; estimated from the data where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<Noise>,
    /// Standard deviations of the errors of the installation; defaults where absent.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerances: Option<Tolerances>,
    /// Effects in addition to the base model, by name; an absent one is off.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    #[schemars(schema_with = "crate::effects::schema")]
    pub effects: BTreeMap<String, toml::Table>,
    /// Folder that paths in the file are relative to.
    #[serde(skip)]
    pub folder: PathBuf,
    /// The file, as errors name it; empty for a model that was made in memory.
    #[serde(skip)]
    pub file: String,
}

/// `[friction]`: longitudinal for both runners, lateral for each.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Friction {
    /// Fixed coefficient, a quadratic in the pressure with its tables, or tables of the
    /// coefficient.
    pub longitudinal: LongitudinalKeys,
    /// Front runner, lateral.
    pub front: MagicFormula,
    /// Rear runner, lateral.
    pub rear: MagicFormula,
}

/// Largest size of a model file, which is a page of text [bytes].
const MAX_BYTES: u64 = 1 << 20;

/// The model of the published sled, commented.
pub const MODEL_EXAMPLE: &str = include_str!("../../assets/model.toml");

impl Model {
    /// Reads a model file and checks every number.
    ///
    /// # Errors
    /// [`Error::File`] (unknown or missing keys, too), [`Error::KeyRange`].
    pub fn load(path: &Path) -> Result<Model, Error> {
        let file = path.display().to_string();
        let text = kufe_files::text_of_regular(path, MAX_BYTES);
        let text = text.map_err(|error| Error::file(&file, error))?;
        let mut model = Model::from_toml(&text, &file)?;
        model.folder = path.parent().unwrap_or(Path::new("")).to_path_buf();
        model.file = file;
        Ok(model)
    }

    /// Name of the model in errors: its file, or `model`.
    pub(crate) fn name(&self) -> String {
        let name = if self.file.is_empty() {
            "model"
        } else {
            &self.file
        };
        name.to_string()
    }

    /// Parses the text of a model file; `file` names it in errors.
    ///
    /// # Errors
    /// [`Error::File`], [`Error::KeyRange`].
    pub fn from_toml(text: &str, file: &str) -> Result<Model, Error> {
        let model: Model = toml::from_str(text).map_err(|error| {
            let reason = kufe_files::broken_at(text, error.span(), error.message());
            Error::file(file, reason)
        })?;
        model.check(file)?;
        Ok(model)
    }

    /// The model as TOML with its effects. Paths of tables of a model from a file become absolute,
    /// so that the text can be saved elsewhere.
    pub fn to_toml(&self) -> String {
        let mut model = self.clone();
        let keys = &mut model.friction.longitudinal;
        for table in [&mut keys.front_table, &mut keys.rear_table] {
            if let (false, Some(path)) = (self.file.is_empty(), table)
                && let Ok(absolute) = std::path::absolute(self.folder.join(&*path))
            {
                *path = absolute.display().to_string();
            }
        }
        // Tables of numbers and strings always serialise.
        toml::to_string_pretty(&model).expect("a model is plain tables")
    }

    /// Checks the range of every number; `file` names the source in errors.
    ///
    /// # Errors
    /// [`Error::KeyRange`] with the key, [`Error::File`] from the friction laws.
    pub fn check(&self, file: &str) -> Result<(), Error> {
        let model = toml::Table::try_from(self).expect("a model is plain tables");
        for name in ["sled", "survey", "conditions", "noise", "tolerances"] {
            let table = model.get(name).and_then(toml::Value::as_table);
            for (key, value) in table.into_iter().flatten() {
                let key = format!("{name}.{key}");
                let value = value.as_float().unwrap_or(f64::NAN);
                let (low, high, expected) = range(&key);
                if !(low..=high).contains(&value) {
                    return Err(Error::KeyRange {
                        file: file.to_string(),
                        key,
                        value,
                        expected,
                    });
                }
            }
        }
        let Friction {
            longitudinal,
            front,
            rear,
        } = &self.friction;
        let law = || match longitudinal.film()?.or(longitudinal.tabled()?) {
            None => longitudinal.model().map(|_| ()),
            Some(_) => Ok(()),
        };
        let checks = [
            ("longitudinal", law()),
            ("front", front.check()),
            ("rear", rear.check()),
        ];
        for (table, checked) in checks {
            let within = |error| Error::file(file, format!("[friction.{table}] {error}"));
            checked.map_err(within)?;
        }
        Ok(())
    }

    /// The model of the published sled: parameters of the paper, a two-man sled's masses and
    /// lengths.
    ///
    /// ```
    /// let model = kufe_sled::Model::published();
    /// assert_eq!(model.friction.rear.k_n_per_rad, 49776.0);
    /// let again = kufe_sled::Model::from_toml(&model.to_toml(), "model.toml").unwrap();
    /// assert_eq!(again, model);
    /// ```
    pub fn published() -> Model {
        Model::from_toml(MODEL_EXAMPLE, "model.toml").expect("the example is a model")
    }
}

/// Smallest and largest value of a key, and the range in words.
pub(crate) fn range(key: &str) -> (f64, f64, &'static str) {
    match key {
        "sled.mass_kg" => (0.1, 1e5, "0.1 to 1e5 kg"),
        "sled.j_yy_kgm2" | "sled.j_zz_kgm2" => (1e-3, 1e6, "0.001 to 1e6 kg m2"),
        "sled.l_f_m" | "sled.l_r_m" => (1e-2, 10.0, "0.01 to 10 m"),
        "sled.accel_x_m" | "sled.accel_y_m" | "sled.accel_z_m" | "sled.slip_x_m" => {
            (-10.0, 10.0, "metres, within 10 m")
        }
        "conditions.humidity_pct" => (0.0, 100.0, "0 to 100"),
        "conditions.distance_m" => (0.0, 1e8, "0 to 1e8"),
        _ => (0.0, 1e3, "0 to 1000"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refused(change: impl Fn(String) -> String) -> String {
        let text = change(Model::published().to_toml());
        match Model::from_toml(&text, "m.toml") {
            Ok(_) => panic!("accepted:\n{text}"),
            Err(error) => error.to_string(),
        }
    }

    #[test]
    fn unknown_keys_are_refused_by_name_except_effects() {
        let message = refused(|text| text.replace("mass_kg", "mass_lb"));
        assert!(
            message.contains("m.toml") && message.contains("mass_lb"),
            "{message}"
        );
        let text =
            Model::published().to_toml() + "\n[effects.temperature-grip]\nslope_per_k = -0.01\n";
        let model = Model::from_toml(&text, "m.toml").unwrap();
        assert_eq!(
            model.effects["temperature-grip"]["slope_per_k"].as_float(),
            Some(-0.01)
        );
        assert_eq!(Model::from_toml(&model.to_toml(), "again").unwrap(), model);
    }

    #[test]
    fn numbers_out_of_range_are_refused_with_key_and_value() {
        let message = refused(|text| text.replace("mass_kg = 390.0", "mass_kg = -390.0"));
        assert!(message.contains("sled.mass_kg = -390"), "{message}");
        let message = refused(|text| text.replace("cda_m2 = 0.28", "cda_m2 = nan"));
        assert!(message.contains("sled.cda_m2"), "{message}");
        let message = refused(|text| text + "\n[tolerances]\ndelay_s = -0.001\n");
        assert!(message.contains("tolerances.delay_s = -0.001"), "{message}");
        for [key, value] in [
            ["mass_kg", "390000.0"],
            ["j_zz_kgm2", "1e7"],
            ["l_f_m", "820.0"],
            ["k_n_per_rad", "1e12"],
        ] {
            let own = |line: &str| {
                if line.starts_with(&format!("{key} = ")) {
                    format!("{key} = {value}\n")
                } else {
                    line.to_string() + "\n"
                }
            };
            let message = refused(|text| text.lines().map(own).collect());
            assert!(message.contains(key), "{message}");
        }
        let message = refused(|text| text.replace("mu = 0.004", "mu = 4.0"));
        assert!(message.contains("friction.longitudinal"), "{message}");
    }
}
