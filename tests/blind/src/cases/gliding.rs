//! Runs whose friction is a groove and its melt film.

use std::sync::Arc;

use crate::cases::answer::Hides;
use crate::residuals::signature::{Channels, Gauge};
use crate::world::campaign::Campaign;
use crate::world::film::{Glide, Shape, friction};
use crate::world::hidden::{Hidden, Kind};
use crate::world::sled::Sled;

/// The runners whose groove and film are the friction: so short a rocker lies flush on no track
/// there is.
const GLIDING: Shape = Shape {
    rocker_m: 10.0,
    section_m: 0.004,
};

/// Gives every run the friction of groove and film, and states which parts of it the catalogue names
/// for: the power of the speed and the slope over the temperature that it amounts to in the middle
/// of what is driven; signatures of a cosine of `same` are one class.
pub fn glide(campaign: &mut Campaign, sled: &mut Sled, gauge: &Gauge, same: f64) -> Vec<Hides> {
    let mu = |speed: f64, ice_c: f64| -> f64 {
        let half_sled = 0.5 * sled.mass_kg * 9.81;
        friction(GLIDING, half_sled, speed, ice_c).iter().sum()
    };
    let exponent = (mu(30.0, -6.0) / mu(15.0, -6.0)).ln() / 2f64.ln();
    let middle = mu(22.0, -6.0);
    let slope = (mu(22.0, -3.0) - mu(22.0, -9.0)) / 6.0 / middle;
    for run in &mut campaign.runs {
        run.at.glide = Some(Arc::new(Glide::new(GLIDING, run.at.ice_c)));
    }
    sled.mu = middle;
    let named = [(Kind::Speed, exponent), (Kind::Temperature, slope)];
    let answers = named.into_iter().map(|(kind, size)| {
        let (entry, effect) = (kind.entry(), Hidden::new(kind, size));
        let rivals = gauge.rivals(&effect, Channels::Longitudinal, same);
        Hides {
            effect: entry.name.to_owned(),
            class: rivals
                .into_iter()
                .map(|(name, _)| name.to_owned())
                .collect(),
            key: entry.key.to_owned(),
            size,
            unit: entry.unit.to_owned(),
            share: gauge.share(&gauge.signature(&effect, Channels::Longitudinal)),
            places: Vec::new(),
        }
    });
    answers.collect()
}
