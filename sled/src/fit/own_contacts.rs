//! The contacts with walls that are a run's own: hit or missed, harder or softer.

use kufe_effect::Active;

use crate::model::vehicle::Vehicle;
use crate::motion::balance::Balance;
use crate::signals::prepare::Prepared;
use crate::simulate::dynamics::WallContact;

/// Lengths of contacts that are tried \[m\].
const LENGTHS_M: [f64; 9] = [4.0, 6.0, 8.0, 10.0, 13.0, 16.0, 20.0, 25.0, 32.0];
/// Standard errors by which the force must stand out of what the side balance scatters by elsewhere: in a stretch that is looked at in a
/// hundred independent ways noise reaches four in one run of a hundred.
const STANDS_OUT: f64 = 4.0;
/// Neighbouring samples that noise is shared by: the low pass before the balances leaves so many.
const CORRELATED: f64 = 2.0;

/// The half wave that leaves least of a side balance within a stretch \[m\], with its lever 0, and the standard error of its force \[N\];
/// `None` where none stands out of `scatter_n`, a standard deviation of a sample \[N\].
///
/// ```text
/// F = sum w y / sum w^2        w = sin^2(pi (s - s_0) / length)        error = scatter sqrt(2 / sum w^2)
/// ```
///
/// Place and length are those, on a grid of a metre, with which `F sum w y` is largest.
pub fn contact_within(
    s_m: &[f64],
    side_n: &[f64],
    stretch_m: [f64; 2],
    scatter_n: f64,
) -> Option<(WallContact, f64)> {
    let near = |s: f64| (stretch_m[0]..=stretch_m[1]).contains(&s);
    let here: Vec<(f64, f64)> = s_m
        .iter()
        .zip(side_n)
        .filter(|(s, y)| near(**s) && y.is_finite())
        .map(|(s, y)| (*s, *y))
        .collect();
    let mut best: Option<(f64, WallContact, f64)> = None;
    for length_m in LENGTHS_M {
        let starts = ((stretch_m[1] - stretch_m[0] - length_m).floor() as usize + 1).min(1000);
        if stretch_m[1] - stretch_m[0] < length_m {
            continue;
        }
        for start in 0..starts {
            let one = WallContact {
                s_m: stretch_m[0] + start as f64,
                length_m,
                force_n: 1.0,
                x_m: 0.0,
            };
            let (mut wy, mut ww) = (0.0, 0.0);
            for (s, y) in &here {
                let w = one.force_at(*s);
                (wy, ww) = (wy + w * y, ww + w * w);
            }
            // Fewer samples than that are no half wave.
            if ww < 1.0 {
                continue;
            }
            let (force_n, gain) = (wy / ww, wy * wy / ww);
            if best.as_ref().is_none_or(|(most, ..)| gain > *most) {
                let error = scatter_n * (CORRELATED / ww).sqrt();
                best = Some((gain, WallContact { force_n, ..one }, error));
            }
        }
    }
    best.filter(|(_, contact, error)| contact.force_n.abs() > STANDS_OUT * error)
        .map(|(_, contact, error)| (contact, error))
}

/// A robust standard deviation of one sample: 1.4826 times the median magnitude; 0 of nothing.
pub fn scatter(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values
        .iter()
        .filter(|x| x.is_finite())
        .map(|x| x.abs())
        .collect();
    if sizes.is_empty() {
        return 0.0;
    }
    let middle = sizes.len() / 2;
    1.4826 * *sizes.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// An effect that varies from run to run, as the contact of one run has it; off where the run missed.
pub fn as_of_run(effect: &Active, contact: Option<&WallContact>) -> Active {
    let mut own = effect.clone();
    own.values[0] = contact.map_or(0.0, |c| c.force_n);
    if let Some(c) = contact {
        (own.values[1], own.values[2]) = (c.s_m, c.s_m + c.length_m);
    }
    own
}

/// The stretch on which a run's own contact is looked for \[m\].
pub fn stretch_of(effect: &Active) -> [f64; 2] {
    let v = &effect.values;
    [v[1] - v[6], v[2] + v[6]]
}

/// The vehicle on a run, each effect that varies from run to run with the force and the stretch of this run.
///
/// The side balance of the run sets them ([`contact_within`]); what they leave along and about the vertical judges them.
pub fn with_own_contacts(run: &Prepared, vehicle: &Vehicle) -> Vehicle {
    let mut own = vehicle.on_run(&run.entry.track, &run.entry.conditions);
    if !own.effects.active.iter().any(Active::varies) {
        return own;
    }
    let mut without = own.clone();
    without.effects.active.retain(|effect| !effect.varies());
    let instants = run.states.iter().zip(&run.motions);
    let (s_m, side_n): (Vec<f64>, Vec<f64>) = instants
        .map(|(state, motion)| {
            let at = Balance::new(&without.sled, state, motion);
            let left = at.left(&at.forces(&without, &at.laws(&without)));
            (state.s_m, left.side_n)
        })
        .unzip();
    let scatter_n = scatter(&side_n);
    for effect in own.effects.active.iter_mut().filter(|e| e.varies()) {
        let found = contact_within(&s_m, &side_n, stretch_of(effect), scatter_n);
        *effect = as_of_run(effect, found.as_ref().map(|(contact, _)| contact));
    }
    own
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_half_wave_in_noise_is_found_where_it_is_and_noise_alone_is_none() {
        let s: Vec<f64> = (0..300).map(|i| 0.5 * f64::from(i)).collect();
        // Golden-ratio noise of a unit's standard deviation, evenly spread.
        let noise: Vec<f64> = (0..300)
            .map(|i| ((f64::from(i) * 0.618_034).fract() - 0.5) * 12.0_f64.sqrt())
            .collect();
        assert!(contact_within(&s, &noise, [40.0, 90.0], 1.0).is_none());
        let truth = WallContact {
            s_m: 57.0,
            length_m: 16.0,
            force_n: -40.0,
            x_m: 0.0,
        };
        let side: Vec<f64> = s
            .iter()
            .zip(&noise)
            .map(|(s, e)| truth.force_at(*s) + e)
            .collect();
        let (found, error) = contact_within(&s, &side, [40.0, 90.0], 1.0).expect("a contact");
        assert!(
            (found.s_m - 57.0).abs() <= 1.0 && (found.length_m - 16.0).abs() <= 4.0,
            "{found:?}"
        );
        assert!(
            (found.force_n + 40.0).abs() < 4.0 * error,
            "{found:?} {error}"
        );
    }
}
