//! All effects on friction, forces, sensors, sled and track.
//!
//! A new effect is an entry of `catalogue.toml` with an example and the number that it must give,
//! and its law in a table here; a fault of a sensor needs the entry alone.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::effects::effect::{Effect, ForceLaw, FrictionLaw, SledLaw, SlopeLaw};
use crate::effects::{Forces, Info, OperatingPoint};

/// All effects, family by family.
pub static CATALOGUE: LazyLock<Vec<&'static Effect>> = LazyLock::new(|| {
    let effects: Vec<Info> = read_catalogue(include_str!("catalogue.toml"));
    let with_laws = |info| &*Box::leak(Box::new(Effect::new(info)));
    effects.into_iter().map(with_laws).collect()
});

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    let mut all = CATALOGUE.iter().copied();
    all.find(|effect| effect.info.name == name)
}

/// Entries of a built-in catalogue.
///
/// # Panics
/// Panics with line and key if an entry is invalid.
pub fn read_catalogue<T: Deserialize<'static>>(text: &'static str) -> Vec<T> {
    #[derive(Deserialize)]
    #[serde(deny_unknown_fields)]
    struct Catalogue<T> {
        effect: Vec<T>,
    }
    match toml::from_str::<Catalogue<T>>(text) {
        Ok(catalogue) => catalogue.effect,
        Err(error) => panic!("the catalogue of effects: {error}"),
    }
}

/// Additional air drag [N] as a function of the amplitude.
type Drag = fn(f64, &OperatingPoint) -> f64;

const AIR_DENSITY: Drag = |k, c| 0.5 * k * c.air_density * c.drag_area * c.v * c.v;
const DRAG_AREA: Drag = |k, c| 0.5 * c.air_density * k * c.v * c.v;
const HEADWIND: Drag = |w, c| 0.5 * c.air_density * c.drag_area * (2.0 * c.v + w) * w;

/// The coefficient plus the ratio of a drag to the load; without an amplitude neither weather nor
/// drag area are needed.
fn with_drag(drag: Drag, k: f64, mu: f64, at: &OperatingPoint) -> f64 {
    if k == 0.0 {
        return mu;
    }
    mu + drag(k, at) / at.fz.max(1.0)
}

/// Laws for the friction coefficient, by effect name.
pub(super) const ON_FRICTION: &[(&str, FrictionLaw)] = &[
    ("air-density", |p, mu, at| {
        with_drag(AIR_DENSITY, p[0], mu, at)
    }),
    ("asperities", |p, mu, at| {
        let rough = (p[2]..p[3]).contains(&at.s);
        if rough { mu * (1.0 + p[0]) } else { mu }
    }),
    ("boundary", |p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        let film = |shear| {
            let film = at.patch.friction(at.fz, at.v, at.conditions.ice_c, shear);
            film.unwrap_or(f64::NAN)
        };
        mu * film(p[0]) / film(0.0)
    }),
    ("drag-area", |p, mu, at| with_drag(DRAG_AREA, p[0], mu, at)),
    ("film", |p, mu, at| mu * (1.0 + p[0] * (at.film - 1.0))),
    ("headwind", |p, mu, at| with_drag(HEADWIND, p[0], mu, at)),
    ("humidity", |p, mu, at| {
        mu * (1.0 + p[0] * (at.conditions.humidity_pct - p[1]))
    }),
    ("load", |p, mu, at| mu * (at.fz.max(1.0) / p[1]).powf(p[0])),
    ("plowing", |p, mu, at| {
        if p[0] == 0.0 {
            return mu;
        }
        let softness = 14.7 / (14.7 - 0.6 * at.conditions.ice_c.min(0.0));
        mu + p[0] * (at.fz.max(0.0) / 1000.0 * softness).sqrt()
    }),
    ("slope", |p, mu, _| mu - p[0]),
    ("speed", |p, mu, at| mu * (at.v.max(0.1) / p[1]).powf(p[0])),
    ("temperature", |p, mu, at| {
        mu * (1.0 + p[0] * (at.conditions.ice_c - p[1]))
    }),
    ("warm-up", |p, mu, at| {
        mu * (1.0 + p[0] * (-at.t / p[1]).exp())
    }),
    ("wear", |p, mu, at| {
        mu * (1.0 + p[0] * at.conditions.distance_m / 1000.0)
    }),
];

/// Laws for the forces, by effect name.
pub(super) const ON_FORCES: &[(&str, ForceLaw)] = &[
    ("aero-yaw", |p, at, forces| {
        let yaw = p[0] * at.chassis_slip.abs().to_degrees();
        forces.body_along -= AIR_DENSITY(yaw, &at.point);
    }),
    ("air-density", |p, at, forces| {
        forces.body_along -= AIR_DENSITY(p[0], &at.point);
    }),
    ("asperities", |p, at, forces| {
        if (p[2]..p[3]).contains(&at.point.s) {
            for runner in 0..2 {
                forces.along[runner] *= 1.0 + p[0];
                forces.across[runner] *= 1.0 + p[1];
            }
        }
    }),
    ("camber-thrust", |p, at, forces| {
        forces.across[0] += p[0] * at.roll_split * at.load[0];
    }),
    ("combined-slip", |p, at, forces| {
        let ratio = at.acceleration[0] / at.acceleration[2].max(1.0);
        scale_across(forces, 1.0 / (1.0 + p[0] * ratio * ratio).max(0.05));
    }),
    ("drag-area", |p, at, forces| {
        forces.body_along -= DRAG_AREA(p[0], &at.point);
    }),
    ("headwind", |p, at, forces| {
        forces.body_along -= HEADWIND(p[0], &at.point);
    }),
    ("load-sensitivity", |p, at, forces| {
        for runner in 0..2 {
            forces.across[runner] *= (at.load[runner].max(1.0) / p[1]).powf(p[0]);
        }
    }),
    ("load-transfer", |p, at, forces| {
        let square = p[0] * at.roll_acceleration * at.roll_acceleration;
        scale_across(forces, 1.0 / (1.0 + square).max(0.05));
    }),
    ("relaxation-length", |p, at, forces| {
        for runner in 0..2 {
            let lag = p[0] / at.point.v.max(1.0);
            forces.across[runner] -= lag * forces.stiffness[runner] * at.slip_rate[runner];
        }
    }),
    ("roll-split-drag", |p, at, forces| {
        forces.body_along -= AIR_DENSITY(p[0], &at.point) * at.roll_split.abs();
    }),
    ("saturation", |p, at, forces| {
        for runner in 0..2 {
            let ratio = forces.across[runner] / at.load[runner].max(1.0);
            let kappa = p[runner] + p[2];
            forces.across[runner] /= (1.0 + kappa * ratio * ratio).max(0.05).sqrt();
        }
    }),
    ("slip-drag", |p, at, forces| {
        for runner in 0..2 {
            forces.along[runner] -= p[0] * (forces.across[runner] * at.slip[runner]).abs();
        }
    }),
    ("speed-grip", |p, at, forces| {
        scale_across(forces, 1.0 + p[0] * (at.point.v - p[1]));
    }),
    ("steer-drag", |p, at, forces| {
        forces.along[0] -= p[0] * at.load[0].max(0.0) * at.steering.abs();
    }),
    ("temperature-grip", |p, at, forces| {
        scale_across(forces, 1.0 + p[0] * (at.point.conditions.ice_c - p[1]));
    }),
    ("wall-contact", |p, at, forces| {
        let along = (at.point.s - p[1]) / (p[2] - p[1]);
        if !(0.0..1.0).contains(&along) {
            return;
        }
        let half_wave = (std::f64::consts::PI * along).sin().powi(2);
        let force = if p[5] > 0.0 { p[0] * half_wave } else { p[0] };
        forces.body_across += force;
        forces.body_yaw += p[4] * force;
        forces.body_along -= p[3] * force.abs();
    }),
];

/// Laws for the constants of the sled, by effect name.
pub(super) const ON_SLED: &[(&str, SledLaw)] = &[
    ("cg-place", |p, sled| {
        sled.l_f_m -= p[0];
        sled.l_r_m += p[0];
        sled.accel_x_m -= p[0];
        sled.slip_x_m -= p[0];
    }),
    ("lever-arm", |p, sled| {
        sled.accel_x_m += p[0];
        sled.accel_z_m += p[1];
    }),
    ("mass", |p, sled| sled.mass_kg += p[0]),
    ("yaw-inertia", |p, sled| sled.j_zz_kgm2 *= 1.0 + p[0]),
];

/// Laws for the track's slope, by effect name.
pub(super) const ON_SLOPE: &[(&str, SlopeLaw)] = &[
    ("slope", |p, _| p[0]),
    ("track-profile", |p, s| {
        if (p[1]..p[2]).contains(&s) { p[0] } else { 0.0 }
    }),
];

fn scale_across(forces: &mut Forces, factor: f64) {
    forces.across = forces.across.map(|across| across * factor);
}
