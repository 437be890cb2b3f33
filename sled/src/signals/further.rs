//! What laws and effects may ask of a run beyond its sensors: humidity, the distance run on this finish, the ice's temperature.

use crate::effects::{Conditions, Effects};

use crate::error::Error;
use crate::model::refuse::refuse_effects;
use crate::model::vehicle::Vehicle;
use crate::record::check::needs::{Needs, refuse_drag_without_air};
use crate::record::run::{COLUMNS, Run};

/// Columns that no run states: the slope of the track enters no balance of forces.
const NEVER: [&str; 1] = ["slope_rad"];

/// What a run's file may state sample by sample, `runs.csv` once.
const FURTHER: [&str; 3] = ["humidity_pct", "distance_m", "ice_c"];

/// Place of `ice_c` in [`FURTHER`].
const ICE: usize = 2;

/// Values of [`FURTHER`]: from the run's file, else from `runs.csv`, else from the model's `[conditions]`.
pub struct Further {
    values: [Stated; 3],
}

enum Stated {
    Nowhere,
    Once(f64),
    /// By the place: [`Entry::ice_at`](crate::Entry::ice_at) of the run.
    ByPlace,
    BySample(Vec<f64>),
}

impl Stated {
    fn at(&self, i: usize, by_place: Option<f64>) -> f64 {
        match self {
            Stated::Nowhere => f64::NAN,
            Stated::Once(value) => *value,
            Stated::ByPlace => by_place.unwrap_or(f64::NAN),
            Stated::BySample(values) => values[i],
        }
    }
}

impl Further {
    /// Looks the values up and refuses effects, and what else `needs` ice and air, that ask for what is stated nowhere.
    ///
    /// # Errors
    /// [`Error::Keys`] with the run's file, the effect and the column.
    pub fn of(
        run: &Run,
        vehicle: &Vehicle,
        effects: &Effects,
        needs: &Needs,
    ) -> Result<Further, Error> {
        let (own, model) = (&run.entry.conditions, &vehicle.conditions);
        let once = [
            own.humidity_pct.or(model.humidity_pct),
            own.distance_m.or(model.distance_m),
            Some(own.ice_c).filter(|ice| ice.is_finite()),
        ];
        let mut values = once.map(|value| value.map_or(Stated::Nowhere, Stated::Once));
        if run.entry.ice_at(0.0).is_some() {
            values[ICE] = Stated::ByPlace;
        }
        for (name, value) in FURTHER.iter().zip(&mut values) {
            if let Some(column) = run.columns.get(*name)
                && run.gaps.within(column).flatten().all(|x| x.is_finite())
            {
                *value = Stated::BySample(column.clone());
            }
        }
        let further = Further { values };
        let nowhere = FURTHER
            .iter()
            .zip(&further.values)
            .filter(|(_, value)| matches!(value, Stated::Nowhere))
            .map(|(name, _)| *name);
        let weather = own
            .absent()
            .into_iter()
            .filter(|name| name.starts_with("air"));
        let sensors = COLUMNS
            .into_iter()
            .filter(|name| !run.columns.contains_key(*name));
        let absent: Vec<&str> = nowhere.chain(NEVER).chain(weather).chain(sensors).collect();
        let file = run.entry.file.display().to_string();
        refuse_effects(effects, &absent, &file)?;
        if needs.forces {
            vehicle.refuse_unstated_ice(!absent.contains(&"ice_c"), &file)?;
            refuse_drag_without_air(&vehicle.sled, own, &file)?;
        }
        Ok(further)
    }

    /// The same for the states of one stretch; `resampled` brings a column of the file to their rate.
    pub fn piece(&self, resampled: impl Fn(&[f64]) -> Vec<f64>) -> Further {
        let values = self.values.each_ref().map(|value| match value {
            Stated::Nowhere => Stated::Nowhere,
            Stated::Once(value) => Stated::Once(*value),
            Stated::ByPlace => Stated::ByPlace,
            Stated::BySample(column) => Stated::BySample(resampled(column)),
        });
        Further { values }
    }

    /// Time [s], place [m], speed [m/s] and weather of sample `i`.
    pub fn conditions(&self, run: &Run, i: usize, t: f64, s: f64, v: f64) -> Conditions {
        let weather = &run.entry.conditions;
        Conditions {
            t,
            s,
            v,
            fz: f64::NAN,
            ice_c: self.values[ICE].at(i, run.entry.ice_at(s)),
            air_c: weather.air_c,
            air_pa: weather.air_pa,
            humidity_pct: self.values[0].at(i, None),
            distance: self.values[1].at(i, None),
            air_density: weather.air_density(),
            drag_area: f64::NAN,
            film: f64::NAN,
        }
    }
}
