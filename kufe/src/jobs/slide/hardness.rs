//! The pressure at which the ice under a sliding runner yields, and which law says so.

use crate::case::SlidingTable;
use kufe_contact::{ice_hardness, ice_melting_pressure};
use kufe_sled::friction::film::{IceHardness, Properties};

use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::Failure;
use crate::jobs::slide::film::film_failure;

/// What says at which pressure the ice yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HardnessFrom {
    /// The case states it.
    Given,
    /// [`ice_hardness`] of its temperature.
    TemperatureLaw,
    /// [`IceHardness`] of its temperature and of the time that it is under the runner.
    TimeLaw,
    /// It would melt before it yields.
    Melting,
}

impl HardnessFrom {
    /// As `result.json` has it.
    pub fn name(self) -> &'static str {
        match self {
            HardnessFrom::Given => "given",
            HardnessFrom::TemperatureLaw => "temperature-law",
            HardnessFrom::TimeLaw => "time-law",
            HardnessFrom::Melting => "melting",
        }
    }

    /// The same for people.
    pub fn in_words(self) -> &'static str {
        match self {
            HardnessFrom::Given => "as stated",
            HardnessFrom::TemperatureLaw => "by its temperature",
            HardnessFrom::TimeLaw => "by its temperature and the time under load",
            HardnessFrom::Melting => "at which the ice melts",
        }
    }
}

/// The law that a case states.
#[derive(Clone, Copy, Debug)]
pub(crate) enum HardnessLaw {
    Given(f64),
    OfTemperature,
    OfTime(IceHardness),
}

impl HardnessLaw {
    /// Of a case with the hardness `stated` in its table of the ice [Pa], the word
    /// "from-temperature" being none.
    pub fn of(loaded: &LoadedCase, sliding: &SlidingTable) -> Result<Self, Failure> {
        use crate::case::Hardness;
        Ok(match (loaded.case.ice.hardness_pa, &sliding.hardness) {
            (Some(Hardness::Stated(pressure)), _) => HardnessLaw::Given(pressure),
            (_, Some(anchor)) => HardnessLaw::OfTime(
                IceHardness::new(anchor.pressure_pa, anchor.ice_c, anchor.contact_time_s)
                    .map_err(|error| film_failure(loaded, &error))?,
            ),
            _ => HardnessLaw::OfTemperature,
        })
    }

    /// Whether the time under the runner counts.
    pub fn of_time(&self) -> bool {
        matches!(self, HardnessLaw::OfTime(_))
    }

    /// Hardness [Pa] of ice at `ice_c` [C] that is `contact_time` [s] under the runner, and what
    /// says so.
    ///
    /// # Errors
    /// [`kufe_sled::Error::OutOfRange`] for a time that is not positive.
    pub fn at(
        &self,
        ice_c: f64,
        contact_time: f64,
    ) -> Result<(f64, HardnessFrom), kufe_sled::Error> {
        let (own, from) = match self {
            HardnessLaw::Given(pressure) => (*pressure, HardnessFrom::Given),
            HardnessLaw::OfTemperature => (ice_hardness(ice_c), HardnessFrom::TemperatureLaw),
            HardnessLaw::OfTime(law) => {
                let own = law.at(ice_c, contact_time, &Properties::WATER_AND_ICE)?;
                (own, HardnessFrom::TimeLaw)
            }
        };
        // The law of creep has the melting pressure in it already.
        let melting = ice_melting_pressure(ice_c);
        Ok(if own < melting {
            (own, from)
        } else {
            (melting, HardnessFrom::Melting)
        })
    }
}
