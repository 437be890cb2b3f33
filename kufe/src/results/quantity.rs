//! Numbers with an error, and the table of their keys and labels.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::de::{Deserialize, Deserializer, Error, MapAccess, Visitor};
use serde::ser::{Serialize, SerializeStruct, Serializer};

use crate::plot::{measured, shown_unit};

/// Keys and label of a quantity of a result.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Description {
    /// Key of the value; its ending is the SI unit.
    pub key: &'static str,
    /// Key of the error.
    pub error_key: &'static str,
    /// Name for readers.
    pub label: &'static str,
}

/// A quantity of a result, as a type.
pub trait ResultQuantity: Copy {
    /// Keys and label.
    const DESCRIPTION: Description;
    /// Keys of the value and of its error.
    const KEYS: &'static [&'static str] = &[Self::DESCRIPTION.key, Self::DESCRIPTION.error_key];
}

/// A value with its error, serialised as two keys of the enclosing object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured<Q> {
    /// The value, in SI units.
    pub value: f64,
    /// The error, in SI units; NaN if it is unknown.
    pub error: f64,
    quantity: PhantomData<Q>,
}

impl<Q: ResultQuantity> Measured<Q> {
    /// A value and its error, in SI units.
    pub fn new(value: f64, error: f64) -> Self {
        Measured {
            value,
            error,
            quantity: PhantomData,
        }
    }
}

impl<Q: ResultQuantity> From<kufe_contact::Measure> for Measured<Q> {
    fn from(measure: kufe_contact::Measure) -> Self {
        Measured::new(measure.value, measure.error)
    }
}

impl Description {
    /// The description of a quantity of a lookup table.
    ///
    /// # Panics
    /// If the quantity is not in [`QUANTITIES`].
    pub fn of(quantity: kufe_lut::Quantity) -> Description {
        let found = QUANTITIES.iter().find(|one| one.key == quantity.key());
        *found.expect("every quantity of a table is one of a result")
    }
}

impl<Q: ResultQuantity> fmt::Display for Measured<Q> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let unit = shown_unit(Q::DESCRIPTION.key);
        f.write_str(&measured(self.value, self.error, &unit))
    }
}

impl<Q: ResultQuantity> Serialize for Measured<Q> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut keys = serializer.serialize_struct("Measured", 2)?;
        keys.serialize_field(Q::DESCRIPTION.key, &self.value)?;
        keys.serialize_field(Q::DESCRIPTION.error_key, &self.error)?;
        keys.end()
    }
}

// `Keys` does not depend on the type `Q`, so that it is compiled once.
impl<'de, Q: ResultQuantity> Deserialize<'de> for Measured<Q> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let keys = Keys(Q::DESCRIPTION);
        let [value, error] = deserializer.deserialize_struct("Measured", Q::KEYS, keys)?;
        Ok(Measured::new(value, error))
    }
}

/// Reads a value and its error.
struct Keys(Description);

impl<'de> Visitor<'de> for Keys {
    type Value = [f64; 2];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Description { key, error_key, .. } = self.0;
        write!(f, "the keys {key} and {error_key}")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<[f64; 2], A::Error> {
        let Description { key, error_key, .. } = self.0;
        let (mut value, mut error) = (None, None);
        while let Some(found) = map.next_key::<Cow<'de, str>>()? {
            let place = match &*found {
                found if found == key => &mut value,
                found if found == error_key => &mut error,
                _ => {
                    map.next_value::<serde::de::IgnoredAny>()?;
                    continue;
                }
            };
            // JSON has null for an infinite number or NaN.
            let number = map.next_value::<Option<f64>>();
            let number = number.map_err(|error| A::Error::custom(format!("{found}: {error}")))?;
            *place = Some(number.unwrap_or(f64::NAN));
        }
        let missing = A::Error::missing_field;
        Ok([
            value.ok_or_else(|| missing(key))?,
            error.ok_or_else(|| missing(error_key))?,
        ])
    }
}

impl<Q: ResultQuantity> JsonSchema for Measured<Q> {
    fn inline_schema() -> bool {
        true
    }

    fn schema_name() -> Cow<'static, str> {
        Q::DESCRIPTION.key.into()
    }

    fn json_schema(_: &mut SchemaGenerator) -> Schema {
        schema_of(Q::DESCRIPTION)
    }
}

fn schema_of(quantity: Description) -> Schema {
    let Description {
        key,
        error_key,
        label,
        ..
    } = quantity;
    let unit = crate::plot::unit_of(key);
    let unit = if unit.is_empty() { "1".into() } else { unit };
    schemars::json_schema!({
        "type": "object",
        "properties": {
            key: { "type": "number", "description": format!("{label} [{unit}]") },
            error_key: { "type": ["number", "null"], "description": format!("error of the {label} [{unit}]") },
        },
        "required": [key, error_key],
    })
}

macro_rules! quantities {
    ($($name:ident: $key:literal, $error:literal, $label:literal;)*) => {
        $(
            #[doc = concat!("`", $key, "`: ", $label, ".")]
            #[derive(Clone, Copy, Debug, PartialEq)]
            pub struct $name;

            impl ResultQuantity for $name {
                const DESCRIPTION: Description = Description {
                    key: $key,
                    error_key: $error,
                    label: $label,
                };
            }
        )*

        /// Every number with an error in results.
        pub const QUANTITIES: &[Description] = &[$($name::DESCRIPTION),*];
    };
}

quantities! {
    PeakPressure: "p_max_pa", "p_max_error_pa", "peak pressure";
    MeanPressure: "p_mean_pa", "p_mean_error_pa", "mean pressure";
    Area: "area_m2", "area_error_m2", "contact area";
    Length: "length_m", "length_error_m", "contact length";
    Width: "width_m", "width_error_m", "contact width";
    Approach: "approach_m", "approach_error_m", "approach";
    Pitch: "pitch_rad", "pitch_error_rad", "pitch";
    Roll: "roll_rad", "roll_error_rad", "roll";
    CheckPeak: "check_p_max_pa", "check_p_max_error_pa", "peak pressure by boundary elements";
    CheckApproach: "check_approach_m", "check_approach_error_m", "approach by boundary elements";
    MaxShear: "max_shear_pa", "max_shear_error_pa", "largest shear stress";
    MaxShearDepth: "max_shear_depth_m", "max_shear_depth_error_m", "depth of the largest shear stress";
    ShearOverPeak: "max_shear_over_p_max", "max_shear_over_p_max_error", "largest shear stress over peak pressure";
    Mu: "mu", "mu_error", "coefficient of friction";
    MuPloughing: "mu_ploughing", "mu_ploughing_error", "friction of ploughing";
    MuViscous: "mu_viscous", "mu_viscous_error", "friction of the melt film";
    MuBoundary: "mu_boundary", "mu_boundary_error", "friction of boundary contact";
    BoundaryShare: "boundary_share", "boundary_share_error", "share of boundary contact";
    GrooveDepth: "groove_depth_m", "groove_depth_error_m", "depth of the groove";
    LoadAhead: "load_ahead_m", "load_ahead_error_m", "load ahead of the lowest point";
    Front: "front_m", "front_error_m", "front end of the patch";
    Back: "back_m", "back_error_m", "back end of the patch";
    FilmMean: "film_mean_m", "film_mean_error_m", "melt film, mean";
    FilmMax: "film_max_m", "film_max_error_m", "melt film, thickest";
    MeltRate: "melt_rate_kgps", "melt_rate_error_kgps", "ice melted";
    ContactTime: "contact_time_s", "contact_time_error_s", "time of the ice under the runner";
    ByHardness: "dlnmu_dlnhardness", "dlnmu_dlnhardness_error", "d ln mu / d ln hardness";
    BySpeed: "dlnmu_dlnv", "dlnmu_dlnv_error", "d ln mu / d ln speed";
    ByViscosity: "dlnmu_dlnviscosity", "dlnmu_dlnviscosity_error", "d ln mu / d ln viscosity";
    ByRoughness: "dlnmu_dlnroughness", "dlnmu_dlnroughness_error", "d ln mu / d ln roughness";
    ByBoundaryShear: "dlnmu_dlnboundary_shear", "dlnmu_dlnboundary_shear_error", "d ln mu / d ln boundary shear";
    ByTemperature: "dlnmu_dice_c", "dlnmu_dice_c_error", "d ln mu / d temperature of the ice";
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_measured_value_is_two_keys_that_read_back() {
        let width = Measured::<Width>::new(2.78e-4, 1.5e-6);
        let text = serde_json::to_string(&width).expect("JSON");
        assert_eq!(text, r#"{"width_m":0.000278,"width_error_m":1.5e-6}"#);
        assert_eq!(
            serde_json::from_str::<Measured<Width>>(&text).expect("a width"),
            width
        );
        assert_eq!(width.to_string(), "278.0 ± 1.5 µm");
        let unknown = Measured::<Width>::new(1.0, f64::INFINITY);
        let text = serde_json::to_string(&unknown).expect("JSON");
        let read: Measured<Width> = serde_json::from_str(&text).expect("a width");
        assert!(read.value == 1.0 && read.error.is_nan());
    }

    #[test]
    fn errors_name_the_key() {
        let read = serde_json::from_str::<Measured<Width>>;
        let of = |text| read(text).expect_err("broken").to_string();
        assert!(of(r#"{"width_m":"wide"}"#).contains("width_m: invalid type: string \"wide\""));
        assert!(of(r#"{"width_m":1.0}"#).contains("width_error_m"));
    }

    #[test]
    fn every_quantity_of_a_table_is_described() {
        for quantity in kufe_lut::Quantity::ALL {
            assert_eq!(Description::of(quantity).error_key, quantity.error_key());
        }
    }

    #[test]
    fn keys_are_unique_and_errors_have_the_unit_of_the_value() {
        let mut keys: Vec<&str> = QUANTITIES
            .iter()
            .flat_map(|q| [q.key, q.error_key])
            .collect();
        keys.sort_unstable();
        assert!(keys.windows(2).all(|pair| pair[0] != pair[1]));
        for quantity in QUANTITIES.iter().filter(|q| !q.key.starts_with("dlnmu_")) {
            let unit = crate::plot::unit_of(quantity.key);
            assert_eq!(
                unit,
                crate::plot::unit_of(quantity.error_key),
                "{}",
                quantity.key
            );
        }
    }
}
