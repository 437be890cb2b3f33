//! Contacts as a part of the model: their places, and each run's own force there.

use kufe_sled::effects::{Active, CATALOGUE, Effect, Kind};
use kufe_sled::{as_expected, as_of_run, hits_of};

use crate::evidence::runs::contacts::find::Stretch;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::Interval;

/// Contacts at places of tracks, one effect.
#[derive(Clone, Debug)]
pub struct Contacts {
    /// The step that selected them; `None` for the given model.
    pub step: Option<usize>,
    /// Their places as effects, with mean and standard deviation of the force over runs.
    pub places: Vec<Active>,
    /// Distance of the contact in front of the centre of gravity \[m\].
    pub lever_m: Interval,
    /// Friction of the bumper.
    pub friction: Interval,
}

impl Contacts {
    /// Takes the contacts of a given model, which vary from run to run, out of `active`.
    pub fn given(active: &mut Vec<Active>) -> Option<Self> {
        let places: Vec<Active> = active.extract_if(.., |e| e.varies()).collect();
        (!places.is_empty()).then(|| Self {
            step: None,
            places,
            lever_m: Interval::default(),
            friction: Interval::default(),
        })
    }

    /// The contacts of a run as effects.
    pub fn of_run(&self, frame: &Frame) -> impl Iterator<Item = Active> {
        let own = frame.contacts.iter();
        own.filter_map(|own| {
            let place = self.places.get(own.place)?;
            let (_, hit_n) = hits_of(place);
            Some(Active {
                track: None,
                ..as_of_run(place, Some(&as_expected(own.contact, own.error_n, hit_n)))
            })
        })
    }
}

/// The effect in the catalogue.
pub fn wall() -> Option<&'static Effect> {
    CATALOGUE
        .iter()
        .copied()
        .find(|e| e.info.name == "wall-contact")
}

/// The effect on an interval of a track, without a force yet.
pub fn at_stretch(effect: &'static Effect, stretch: &Stretch) -> Active {
    Active {
        name: effect.info.name.to_owned(),
        kind: Kind::Catalogue(effect),
        values: vec![0.0, stretch.from_m, stretch.to_m, 0.0, 0.0, 1.0, 0.0],
        track: Some(stretch.track.clone()),
    }
}
