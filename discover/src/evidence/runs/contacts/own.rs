//! Each run's own contacts, set by its side balance alone; what the runs say beneath them is no evidence of anything else.

use std::borrow::Cow;

use kufe_sled::effects::Active;
use kufe_sled::{Push, hits_of, push_within, scatter, stretch_of};
use rayon::prelude::*;

use crate::evidence::runs::contacts::of_run::OwnContact;
use crate::evidence::runs::model::residual_model::{ChannelRows, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// How far outside a contact its run says nothing of anything else \[m\].
const MARGIN_M: f64 = 2.0;

/// What the balances leave of each run at every retained sample, without contacts.
pub fn residuals_without(model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    let bare = ResidualModel {
        contacts: None,
        ..model.clone()
    };
    frames.par_iter().map(|frame| bare.raw(frame)).collect()
}

/// What pushed a run at these places, by the place.
fn pushes_of(frame: &Frame, side_n: &[f64], places: &[Active]) -> Vec<(usize, Push)> {
    let samples: Vec<usize> = frame.samples().collect();
    let [s, y] =
        [&frame.s[..], side_n].map(|x| -> Vec<f64> { samples.iter().map(|i| x[*i]).collect() });
    let scatter_n = scatter(&y);
    let there = |(_, place): &(usize, &Active)| place.acts_on(&frame.track);
    let pushes = places.iter().enumerate().filter(there);
    pushes
        .filter_map(|(place, effect)| {
            let (_, hit_n) = hits_of(effect);
            let push = push_within(&s, &y, stretch_of(effect), hit_n, scatter_n)?;
            Some((place, push))
        })
        .collect()
}

/// The contacts of a run at these places, each to the side that its place pushes to.
pub fn own_contacts(frame: &Frame, side_n: &[f64], places: &[Active]) -> Vec<OwnContact> {
    let hits = pushes_of(frame, side_n, places);
    let hits = hits.into_iter().filter(|(_, push)| push.is_hit);
    hits.map(|(place, push)| OwnContact {
        place,
        contact: push.contact,
        error_n: push.error_n,
    })
    .collect()
}

/// Sets the contacts of a run at these places; what pushed it far harder there is marked as a push of its own.
pub fn set_own_of(frame: &mut Frame, side_n: &[f64], places: &[Active]) {
    for (_, push) in pushes_of(frame, side_n, places) {
        let c = &push.contact;
        let stretch = [c.s_m - MARGIN_M, c.s_m + c.length_m + MARGIN_M];
        if !push.is_hit && !frame.pushed.contains(&stretch) {
            frame.pushed.push(stretch);
        }
    }
    frame.contacts = own_contacts(frame, side_n, places);
}

/// Sets the contacts of every run at these places, each by its own side balance.
pub fn set_own(frames: &mut [Frame], model: &ResidualModel, places: &[Active]) {
    let residual = residuals_without(model, frames);
    let both = frames.par_iter_mut().zip(&residual);
    both.for_each(|(frame, residual)| set_own_of(frame, &residual[1], places));
}

/// Whether a place of a run lies beneath one of its contacts.
pub fn beneath(frame: &Frame, s: f64) -> bool {
    frame.contacts.iter().any(|own| {
        let c = &own.contact;
        (c.s_m - MARGIN_M..=c.s_m + c.length_m + MARGIN_M).contains(&s)
    })
}

/// Rows of a run that lie beneath its contacts.
pub fn rows_beneath(frame: &Frame) -> Vec<bool> {
    let s = frame.rows(&frame.s);
    s.iter().map(|s| beneath(frame, *s)).collect()
}

/// The run without what it says beneath its contacts and where something pushed it alone: as next to a gap, no row is made of it.
pub fn without_contacts(frame: &Frame) -> Frame {
    without(frame, |s| pushed(frame, s) || beneath(frame, s))
}

/// The run without what it says where something pushed it alone.
pub fn without_pushes(frame: &Frame) -> Cow<'_, Frame> {
    match frame.pushed.is_empty() {
        true => Cow::Borrowed(frame),
        false => Cow::Owned(without(frame, |s| pushed(frame, s))),
    }
}

fn pushed(frame: &Frame, s: f64) -> bool {
    let mut stretches = frame.pushed.iter();
    stretches.any(|[from, to]| (*from..=*to).contains(&s))
}

/// The run without the places that are out.
fn without(frame: &Frame, out: impl Fn(f64) -> bool) -> Frame {
    let mut reduced = frame.clone();
    for (part, s) in reduced.taking_part.iter_mut().zip(&frame.s) {
        *part &= !out(*s);
    }
    reduced.centres = reduced.sieve.clear_centres(&reduced.taking_part);
    reduced
}
