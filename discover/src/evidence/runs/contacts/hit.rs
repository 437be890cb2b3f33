//! Places that several runs hit, among those at which runs differ.

use std::collections::BTreeSet;

use kufe_sled::effects::{Active, Effect};
use kufe_sled::{HARDEST, WallContact};
use rayon::prelude::*;

use crate::evidence::runs::contacts::MIN_HITS;
use crate::evidence::runs::contacts::find::stretches;
use crate::evidence::runs::contacts::model::at_stretch;
use crate::evidence::runs::contacts::run_contacts::set_contacts_of;
use crate::evidence::runs::recordings::frame::Frame;
use crate::procedure::rules::ContactRules;

/// Margin around known hits in the search of a place \[m\]. Chosen: lines differ by metres.
const SHIFT_M: f64 = 3.0;

/// Places that several runs hit.
pub struct HitPlaces {
    /// The places, each with the median force of its hits.
    pub places: Vec<Active>,
    /// The runs with their own contacts there.
    pub frames: Vec<Frame>,
    /// p-value of the place at which runs differ most.
    pub p_value: f64,
}

/// The places that several of these runs hit; `side_n`: lateral residuals at retained samples.
pub fn hit(
    effect: &'static Effect,
    runs: &[Frame],
    side_n: &[Vec<f64>],
    rules: &ContactRules,
    seed: u64,
) -> Option<HitPlaces> {
    let (mut places, mut p_values) = (Vec::new(), Vec::new());
    for s in stretches(runs, side_n, rules, Some(seed)) {
        places.push(at_stretch(effect, &s));
        p_values.push(s.p_value);
    }
    let mut frames = runs.to_vec();
    // First round: contacts on either side, one place per group of overlapping contacts. Second
    // round: each place with contacts on its side alone. Third round: without places that a single
    // run hits.
    for round in 0..3 {
        let both = frames.par_iter_mut().zip(side_n);
        both.for_each(|(frame, side_n)| set_contacts_of(frame, side_n, &places));
        let stretches = std::mem::take(&mut places).into_iter();
        let stretches = stretches.zip(std::mem::take(&mut p_values)).enumerate();
        for (k, (stretch, p_value)) in stretches {
            let own = frames.iter().flat_map(|f| &f.contacts);
            let of_place = own.filter(|own| own.place == k).map(|own| own.contact);
            let spots = spots(of_place.collect());
            let spots = spots.iter().filter(|s| s.len() >= MIN_HITS);
            let mut found: Vec<Active> = Vec::new();
            for contacts in spots.take(if round == 0 { usize::MAX } else { 1 }) {
                let place = at_spot(&stretch, contacts);
                if found.iter().all(|other| are_apart(&place, other)) {
                    found.push(place);
                    p_values.push(p_value);
                }
            }
            places.append(&mut found);
        }
    }
    let tracks: BTreeSet<&str> = runs.iter().map(|f| f.track.as_str()).collect();
    let smallest = p_values.into_iter().reduce(f64::min)?;
    Some(HitPlaces {
        places,
        frames,
        p_value: (smallest * tracks.len() as f64).min(1.0),
    })
}

/// The place of these contacts within an interval.
fn at_spot(stretch: &Active, contacts: &[WallContact]) -> Active {
    let mut place = stretch.clone();
    let from_m = contacts.iter().map(|c| c.s_m);
    let to_m = contacts.iter().map(|c| c.s_m + c.length_m);
    place.values[0] = middle(contacts);
    place.values[1] = from_m.fold(f64::INFINITY, f64::min) - SHIFT_M;
    place.values[2] = to_m.fold(f64::NEG_INFINITY, f64::max) + SHIFT_M;
    place
}

/// Whether two places are on different sides or do not overlap.
fn are_apart(place: &Active, other: &Active) -> bool {
    place.values[0] * other.values[0] < 0.0
        || place.values[2] < other.values[1]
        || other.values[2] < place.values[1]
}

/// Groups contacts by side and overlap, largest group first. A contact far weaker than two others
/// is taken for noise.
fn spots(mut contacts: Vec<WallContact>) -> Vec<Vec<WallContact>> {
    let mut sizes: Vec<f64> = contacts.iter().map(|c| c.force_n.abs()).collect();
    sizes.sort_by(|a, b| b.total_cmp(a));
    let second = sizes.get(1).copied().unwrap_or(0.0);
    contacts.retain(|c| HARDEST * c.force_n.abs() >= second);
    let (leftward, rightward) = contacts.into_iter().partition(|c| c.force_n > 0.0);
    let mut spots = spots_aside(leftward);
    spots.extend(spots_aside(rightward));
    spots.sort_by_key(|contacts| std::cmp::Reverse(contacts.len()));
    spots
}

/// Groups contacts of one side by overlap.
fn spots_aside(mut contacts: Vec<WallContact>) -> Vec<Vec<WallContact>> {
    let overlap = |a: &WallContact, b: &WallContact| {
        a.s_m <= b.s_m + b.length_m && b.s_m <= a.s_m + a.length_m
    };
    let mut spots = Vec::new();
    loop {
        let count = |spot: &WallContact| contacts.iter().filter(|c| overlap(c, spot)).count();
        let Some(spot) = contacts.iter().copied().max_by_key(count) else {
            return spots;
        };
        spots.push(contacts.extract_if(.., |c| overlap(c, &spot)).collect());
    }
}

/// The lower median of the forces, which a single outlier does not change.
fn middle(contacts: &[WallContact]) -> f64 {
    let mut forces: Vec<f64> = contacts.iter().map(|c| c.force_n).collect();
    forces.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
    let middle = forces.get(forces.len().saturating_sub(1) / 2);
    middle.copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn push(s_m: f64, force_n: f64) -> WallContact {
        WallContact {
            s_m,
            length_m: 10.0,
            force_n,
            x_m: 0.0,
        }
    }

    #[test]
    fn an_outlier_does_not_change_the_median() {
        let pushes = |forces: &[f64]| -> Vec<WallContact> {
            forces.iter().map(|f| push(100.0, *f)).collect()
        };
        assert_eq!(middle(&pushes(&[40.0, 55.0, 900.0, 38.0])), 40.0);
        assert_eq!(middle(&pushes(&[-40.0, -1100.0])), -40.0);
        assert_eq!(middle(&[]), 0.0);
    }

    #[test]
    fn pushes_elsewhere_to_the_other_side_or_far_weaker_are_not_hits() {
        let mut pushes = [140.0, 177.0, 180.0, 174.0, 200.0]
            .map(|s_m| push(s_m, 40.0))
            .to_vec();
        pushes.extend([push(178.0, -40.0), push(176.0, 7.0)]);
        let there = spots(pushes);
        let mut of_most: Vec<f64> = there[0].iter().map(|c| c.s_m).collect();
        of_most.sort_by(f64::total_cmp);
        assert_eq!(of_most, [174.0, 177.0, 180.0]);
        assert_eq!(there.len(), 4);
    }
}
