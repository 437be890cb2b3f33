//! One look at all effects: which of them, at its best size, leaves least.

use std::collections::BTreeMap;

use kufe_case::effects::{CATALOGUE, Effect};

use crate::evidence::maps::line::Line;
use crate::evidence::maps::simulate::{Active, Bench};

/// Drop of chi2 below which nothing is claimed.
pub const LEAST_DROP: f64 = 30.0;
/// Lines that are followed at a time.
const FOLLOWED: usize = 4;
/// Rounds in which they are.
const ROUNDS: usize = 10;

/// Effects that are far from linear on their way from nothing to a usual size: a flat grows with the root of its depth, a
/// layer acts once it is as thin as the contact is wide.
const MARCHED: [&str; 2] = ["section-wear", "ice-thickness"];

/// First steps by effect's name, kept from look to look.
pub type Steps = BTreeMap<&'static str, f64>;

/// Effects that need a map: a peak pressure alone says next to nothing of them.
pub const NEED_MAPS: [&str; 5] = [
    "roll-tilt",
    "pitch-offset",
    "section-wear",
    "waviness",
    "sensor-blur",
];

/// Follows every effect that is not switched on to its best size, the promising ones first.
///
/// Bounds on the pressure and worn sections are far from linear: what their first step promises means little, and they
/// are followed for some rounds whatever it is.
pub fn look(
    bench: &Bench,
    active: &Active,
    steps: &mut Steps,
    progress: &dyn Fn(&str),
) -> Vec<Line> {
    let chi2 = match bench.misfit(active, crate::evidence::maps::simulate::SEARCHING) {
        Ok(misfit) => misfit.chi2,
        Err(_) => return Vec::new(),
    };
    let mapped = bench.rows.iter().any(|r| r.map.is_some());
    let mut lines = Vec::new();
    for effect in CATALOGUE {
        let name = effect.info().name;
        let on = active.iter().any(|(e, _)| e.info().name == name);
        if on || (!mapped && NEED_MAPS.contains(&name)) {
            continue;
        }
        progress(name);
        let line = Line::start(bench, active, *effect, steps.get(name).copied());
        if let Some(mut line) = line {
            steps.insert(name, line.first_step());
            if MARCHED.contains(&name) {
                line.march(bench, active);
            }
            lines.push(line);
        }
    }
    for round in 0..ROUNDS {
        lines.sort_by(|a, b| a.promise().total_cmp(&b.promise()));
        let mut moved = false;
        for (place, line) in lines.iter_mut().enumerate() {
            let near = place < FOLLOWED || round < 2;
            let promising = chi2 - line.promise() >= LEAST_DROP && near;
            let bent = is_bent(line.effect) && round < 3;
            if line.settled || !(promising || bent) {
                continue;
            }
            progress(line.effect.info().name);
            line.advance(bench, active);
            moved = true;
        }
        if !moved {
            break;
        }
    }
    lines.sort_by(|a, b| a.chi2().total_cmp(&b.chi2()));
    lines
}

fn is_bent(effect: &'static dyn Effect) -> bool {
    effect.info().name == "hardness" || MARCHED.contains(&effect.info().name)
}

/// Cosine between two effects' changes of the maps.
pub fn correlation(a: &Line, b: &Line) -> f64 {
    let (a, b) = (a.signature(), b.signature());
    let dot = |x: &[f64], y: &[f64]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    dot(&a, &b) / (dot(&a, &a) * dot(&b, &b)).sqrt().max(1e-300)
}
