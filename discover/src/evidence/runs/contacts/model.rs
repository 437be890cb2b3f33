//! Contacts as a part of the model: their places, and each run's own force there.

use kufe_sled::effects::{Active, CATALOGUE, Effect, Kind};
use kufe_sled::{as_expected, as_of_run, hits_of};

use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::Interval;

/// Contacts at places of tracks, one effect.
#[derive(Clone, Debug)]
pub struct Contacts {
    /// The step that they were selected by; `None` where the given model has them.
    pub step: Option<usize>,
    /// Their places, each as the effect that the model states: mean and spread of the force over runs.
    pub places: Vec<Active>,
    /// How far before the centre of gravity the wall pushes \[m\].
    pub lever_m: Interval,
    /// Friction of the bumper.
    pub friction: Interval,
}

impl Contacts {
    /// Those of a given model: its effects that vary from run to run, which are taken out of `active`.
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

/// A contact at a place with these parameters, in the catalogue's order.
pub fn at_place(effect: &'static Effect, track: &str, values: [f64; 7]) -> Active {
    Active {
        name: effect.info.name.to_owned(),
        kind: Kind::Catalogue(effect),
        values: values.to_vec(),
        track: Some(track.to_owned()),
    }
}
