//! Effects that a model switches on, applied to a state.

use crate::state::{forces, state};
use crate::tables::effects;

#[test]
fn local_effects_act_only_in_their_window_and_on_their_track() {
    let text =
        "[effects.\"wall-contact@1\"]\nforce_n = 500.0\nfrom_m = 10.0\nto_m = 30.0\ntrack = \"a\"";
    let effects = effects(text).unwrap();
    assert_eq!(effects.active[0].effect_name(), "wall-contact");
    let mut f = forces();
    effects.on_track("a").act(&state(), &mut f);
    assert_eq!(f.body_across, 500.0);
    effects.act(&state(), &mut f);
    effects.on_track("b").act(&state(), &mut f);
    assert_eq!(f.body_across, 500.0);
    let mut later = state();
    later.point.s = 31.0;
    effects.on_track("a").act(&later, &mut f);
    assert_eq!(f.body_across, 500.0);
    assert!(effects.on_track("b").is_empty());
    assert_eq!(effects.on_track("a").active[0].track, None);
}

#[test]
fn a_varying_wall_contact_has_a_half_sine_force_and_its_moment() {
    let text = "[effects.wall-contact]\nforce_n = 500.0\nfrom_m = 10.0\nto_m = 30.0\nlever_m = 0.2\nspread_n = 100.0";
    let effects = effects(text).unwrap();
    assert!(effects.active[0].varies());
    for (s, share) in [
        (10.0, 0.0),
        (15.0, 0.5),
        (20.0, 1.0),
        (25.0, 0.5),
        (30.0, 0.0),
    ] {
        let (mut at, mut f) = (state(), forces());
        at.point.s = s;
        effects.act(&at, &mut f);
        assert!((f.body_across - 500.0 * share).abs() < 1e-9, "{s}: {f:?}");
        assert!((f.body_yaw - 100.0 * share).abs() < 1e-9, "{s}: {f:?}");
    }
}

#[test]
fn an_effect_on_friction_acts_on_both_runners() {
    let effects = effects("[effects.warm-up]\nexcess = 1.0\ntime_s = 3.0").unwrap();
    let mut f = forces();
    effects.act(&state(), &mut f);
    let factor = 1.0 + (-1.0_f64).exp();
    for (with, without) in f.along.iter().zip(forces().along) {
        assert!((with - factor * without).abs() < 1e-12, "{with}");
    }
    // The slope is not a force. It enters the equation of motion of the speed.
    let slope = crate::tables::effects("[effects.slope]\noffset_rad = 0.01").unwrap();
    let mut f = forces();
    slope.act(&state(), &mut f);
    assert_eq!(f, forces());
    assert_eq!(slope.slope(3.0), 0.01);
}
