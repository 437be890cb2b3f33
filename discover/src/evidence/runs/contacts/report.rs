//! Report of contacts by place, run and driver.

use std::collections::BTreeSet;

use crate::evidence::runs::campaign::{Campaign, RunFit};
use crate::evidence::runs::contacts::model::Contacts;
use crate::evidence::runs::recordings::frame::Frame;
use crate::finding::{
    ContactForces, ContactPlace, DriverContacts, Fitted, Picture, Plot, RunContact, Scatter,
    Series, Step,
};

/// Smallest number of contacts of a picture.
const MIN_CONTACTS: usize = 3;

impl Campaign<'_> {
    /// Lever and friction of the step that selected contacts.
    pub fn contact_parameters(&self, last: &RunFit, parameters: &mut [Vec<Fitted>]) {
        let Some(contacts) = &last.residual_model.contacts else {
            return;
        };
        let Some(of_step) = contacts.step.and_then(|step| parameters.get_mut(step)) else {
            return;
        };
        let fitted = |name: &str, unit: &str, x: &crate::finding::Interval| Fitted {
            name: name.to_owned(),
            value: x.value,
            low: x.low,
            high: x.high,
            unit: unit.to_owned(),
        };
        of_step.push(fitted("lever_m", "m", &contacts.lever_m));
        if contacts.friction.value > 0.0 {
            of_step.push(fitted("friction", "", &contacts.friction));
        }
    }

    /// Adds the places with the contacts of all runs, held-out ones included, to their step.
    pub fn describe_contacts(&self, last: &RunFit, steps: &mut [Step]) {
        let Some(contacts) = &last.residual_model.contacts else {
            return;
        };
        let step = contacts.step.and_then(|step| steps.get_mut(step));
        if let Some(step) = step {
            let frames: Vec<&Frame> = self.whole().iter().chain(&self.held_out).collect();
            step.contacts = contact_places(contacts, &frames);
            step.contact_forces = ContactForces::of(&step.contacts);
        }
    }

    /// One picture per track: the force of every contact over distance.
    pub fn contact_pictures(&self, last: &RunFit) -> Vec<Picture> {
        let Some(contacts) = &last.residual_model.contacts else {
            return Vec::new();
        };
        let frames: Vec<&Frame> = self.whole().iter().chain(&self.held_out).collect();
        let places = contact_places(contacts, &frames);
        let mut tracks: Vec<&str> = places.iter().map(|p| p.track.as_str()).collect();
        tracks.dedup();
        let picture = |track: &str| {
            let own = places.iter().filter(|p| p.track == track);
            let mut own: Vec<&RunContact> = own.flat_map(|p| &p.contacts).collect();
            own.sort_by(|a, b| (a.from_m + a.to_m).total_cmp(&(b.from_m + b.to_m)));
            (own.len() >= MIN_CONTACTS).then(|| Picture {
                title: format!("wall-contact by run on track {track}"),
                caption: "The force of every contact, estimated from the side balance of its own run. Bars are standard errors where they exceed the dot.".to_owned(),
                plot: Plot::Scatter(Scatter {
                    label: format!("force of each run's contacts on track {track}"),
                    x_name: "distance along the track [m]".to_owned(),
                    y_name: "force [N]".to_owned(),
                    x: own.iter().map(|c| 0.5 * (c.from_m + c.to_m)).collect(),
                    series: vec![Series {
                        name: "a run's contact".to_owned(),
                        y: own.iter().map(|c| c.force_n).collect(),
                        sd: own.iter().map(|c| c.error_n).collect(),
                    }],
                    curve: None,
                }),
            })
        };
        tracks.into_iter().filter_map(picture).collect()
    }
}

fn contact_places(contacts: &Contacts, frames: &[&Frame]) -> Vec<ContactPlace> {
    let place = |(k, place): (usize, &kufe_sled::effects::Active)| {
        let track = place.track.clone().unwrap_or_default();
        let there: Vec<&&Frame> = frames.iter().filter(|f| place.acts_on(&f.track)).collect();
        let own: Vec<RunContact> = there
            .iter()
            .filter_map(|frame| {
                let own = frame.contacts.iter().find(|own| own.place == k)?;
                let c = own.contact;
                Some(RunContact {
                    run: frame.name.clone(),
                    driver: frame.driver.clone(),
                    from_m: c.s_m,
                    to_m: c.s_m + c.length_m,
                    force_n: c.force_n,
                    error_n: own.error_n,
                })
            })
            .collect();
        let names: BTreeSet<&str> = there.iter().map(|f| f.driver.as_str()).collect();
        let drivers = names.into_iter().map(|driver| {
            let mine: Vec<&RunContact> = own.iter().filter(|c| c.driver == driver).collect();
            let [force_n, _] = mean_and_spread(&mine);
            DriverContacts {
                driver: driver.to_owned(),
                runs: there.iter().filter(|f| f.driver == driver).count(),
                hit: mine.len(),
                force_n,
            }
        });
        let drivers = drivers.collect();
        let [force_n, spread_n] = mean_and_spread(&own.iter().collect::<Vec<_>>());
        ContactPlace {
            track,
            from_m: place.values[1],
            to_m: place.values[2],
            force_n,
            spread_n,
            runs: there.len(),
            hit: own.len(),
            drivers,
            contacts: own,
        }
    };
    contacts.places.iter().enumerate().map(place).collect()
}

/// Mean and standard deviation of the force over the runs that hit; 0 if no run hit.
fn mean_and_spread(own: &[&RunContact]) -> [f64; 2] {
    let n = own.len() as f64;
    if own.is_empty() {
        return [0.0; 2];
    }
    let mean = own.iter().map(|c| c.force_n).sum::<f64>() / n;
    let squares: f64 = own.iter().map(|c| (c.force_n - mean).powi(2)).sum();
    [mean, (squares / (n - 1.0).max(1.0)).sqrt()]
}
