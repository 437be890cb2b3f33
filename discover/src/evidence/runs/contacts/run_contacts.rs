//! Contacts of each run, estimated from its lateral residual alone. Samples during contacts are no
//! evidence of other effects.

use std::borrow::Cow;

use kufe_sled::effects::Active;
use kufe_sled::{Push, WallContact, hits_of, push_within, scatter, stretch_of};
use rayon::prelude::*;

use crate::evidence::runs::model::residual_model::{ChannelRows, ResidualModel};
use crate::evidence::runs::recordings::frame::Frame;

/// Margin around a contact within which samples are excluded \[m\].
const MARGIN_M: f64 = 2.0;

/// The contact of a run at one of the places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnContact {
    /// Index of the place.
    pub place: usize,
    pub contact: WallContact,
    /// Standard error of the force \[N\].
    pub error_n: f64,
}

/// Residuals of the balances at every retained sample, without contacts.
pub fn residuals_without(model: &ResidualModel, frames: &[Frame]) -> Vec<ChannelRows> {
    let bare = ResidualModel {
        contacts: None,
        ..model.clone()
    };
    frames
        .par_iter()
        .map(|frame| bare.sample_residuals(frame))
        .collect()
}

/// Contacts of a run at these places, by place.
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

/// The contacts of a run at these places, each on the side of its place.
pub fn contacts_of(frame: &Frame, side_n: &[f64], places: &[Active]) -> Vec<OwnContact> {
    let hits = pushes_of(frame, side_n, places);
    let hits = hits.into_iter().filter(|(_, push)| push.is_hit);
    hits.map(|(place, push)| OwnContact {
        place,
        contact: push.contact,
        error_n: push.error_n,
    })
    .collect()
}

/// Sets the contacts of a run at these places; a far harder push is marked as a push of this run
/// alone.
pub fn set_contacts_of(frame: &mut Frame, side_n: &[f64], places: &[Active]) {
    for (_, push) in pushes_of(frame, side_n, places) {
        let c = &push.contact;
        let stretch = [c.s_m - MARGIN_M, c.s_m + c.length_m + MARGIN_M];
        if !push.is_hit && !frame.pushed.contains(&stretch) {
            frame.pushed.push(stretch);
        }
    }
    frame.contacts = contacts_of(frame, side_n, places);
}

/// Sets the contacts of every run at these places, each from its own lateral residual.
pub fn set_contacts(frames: &mut [Frame], model: &ResidualModel, places: &[Active]) {
    let residual = residuals_without(model, frames);
    let both = frames.par_iter_mut().zip(&residual);
    both.for_each(|(frame, residual)| set_contacts_of(frame, &residual[1], places));
}

/// Whether a place of a run is during one of its contacts.
pub fn is_in_contact(frame: &Frame, s: f64) -> bool {
    frame.contacts.iter().any(|own| {
        let c = &own.contact;
        (c.s_m - MARGIN_M..=c.s_m + c.length_m + MARGIN_M).contains(&s)
    })
}

/// Rows of a run during its contacts.
pub fn rows_in_contact(frame: &Frame) -> Vec<bool> {
    let s = frame.rows(&frame.s);
    s.iter().map(|s| is_in_contact(frame, *s)).collect()
}

/// The run without its contacts and its own pushes: no row is made of these samples.
pub fn without_contacts(frame: &Frame) -> Frame {
    without(frame, |s| pushed(frame, s) || is_in_contact(frame, s))
}

/// The run without the samples at which it alone was pushed.
pub fn without_pushes(frame: &Frame) -> Cow<'_, Frame> {
    if frame.pushed.is_empty() {
        Cow::Borrowed(frame)
    } else {
        Cow::Owned(without(frame, |s| pushed(frame, s)))
    }
}

fn pushed(frame: &Frame, s: f64) -> bool {
    let mut stretches = frame.pushed.iter();
    stretches.any(|[from, to]| (*from..=*to).contains(&s))
}

/// The run without the excluded places.
fn without(frame: &Frame, is_excluded: impl Fn(f64) -> bool) -> Frame {
    let mut reduced = frame.clone();
    for (part, s) in reduced.is_used.iter_mut().zip(&frame.s) {
        *part &= !is_excluded(*s);
    }
    reduced.centres = reduced.row_kernel.clear_centres(&reduced.is_used);
    reduced
}
