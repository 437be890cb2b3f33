//! The groove of a bob runner as a strip, from its dimensions.

use super::patches::{WATER, solved};
use kufe_sled::friction::film::{FilmConditions, Strip};

/// Ice that yields at `h` [Pa] ahead of the lowest point and recovers elastically behind it. Ahead,
/// the width is the chord of a section of radius `r` at the depth of the groove. Behind, the width
/// is the full width and the pressure decreases as in a Hertzian contact.
pub fn groove(front: f64, back: f64, depth: f64, r: f64, h: f64) -> Strip {
    let n = 60;
    let widest = (8.0 * r * depth).sqrt();
    let ellipse = |share: f64| (1.0 - share * share).max(0.0).sqrt();
    let (mut xi, mut width, mut pressure) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..=n {
        let x = 1.0 - k as f64 / n as f64;
        xi.push(front * (1.0 - x));
        width.push(widest * ellipse(x));
        pressure.push(h);
    }
    for k in 1..=n {
        let x = (0.5 * std::f64::consts::PI * k as f64 / n as f64).sin();
        xi.push(front + back * x);
        width.push(widest);
        pressure.push(if k == n { 0.0 } else { h * ellipse(x) });
    }
    Strip::new(xi, width, pressure).expect("a strip")
}

#[test]
fn strip_carries_the_load_and_has_the_friction_of_a_bob() {
    // Rocker 30 m, section 4 mm, 950 N, ice of 17.7 MPa: 48.7 mm ahead of and 16.7 mm behind the
    // lowest point, 34.8 µm deep.
    let strip = groove(48.7e-3, 16.7e-3, 34.8e-6, 4.0e-3, 17.7e6);
    let mut last = 0.0;
    for (v, low, high) in [
        (5.0, 1.6e-3, 2.1e-3),
        (20.0, 3.0e-3, 3.7e-3),
        (30.0, 3.6e-3, 4.5e-3),
    ] {
        let film = solved(&strip, &FilmConditions::new(v, -5.0), &WATER);
        let totals = film.totals;
        println!(
            "{v} m/s: load {:.1} N, friction {:.3e}, mean film {:.3e} m",
            totals.load, totals.friction, totals.mean_thickness
        );
        assert!((totals.load / 950.0 - 1.0).abs() < 0.02);
        assert!((low..high).contains(&totals.friction), "{v}: {totals:?}");
        assert!(totals.friction > last);
        last = totals.friction;
        let thickest = film.totals.max_thickness;
        assert!((0.2e-6..1.2e-6).contains(&totals.mean_thickness) && thickest < 1.5e-6);
        let sampling = film.sampling.expect("stations enough");
        assert!(sampling.friction < 5e-3 * totals.friction, "{sampling:?}");
    }
}
