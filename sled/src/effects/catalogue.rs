//! All effects on friction, forces, sensors, sled and track.
//!
//! A new effect is an entry of `catalogue.toml` with an example and the number that it must give,
//! and its law here; a fault of a sensor needs the entry alone.

use std::sync::LazyLock;

use serde::Deserialize;

use crate::effects::effect::{Effect, Fault};
use crate::effects::{Forces, Info};

/// All effects, family by family.
pub static CATALOGUE: LazyLock<Vec<&'static Effect>> = LazyLock::new(|| {
    let effects: Vec<Info> = read_catalogue(include_str!("catalogue.toml"));
    let with_law = |info| &*Box::leak(Box::new(law(Effect::new(info))));
    effects.into_iter().map(with_law).collect()
});

/// The effect of this name.
pub fn find(name: &str) -> Option<&'static Effect> {
    let mut all = CATALOGUE.iter().copied();
    all.find(|effect| effect.info.name == name)
}

/// The entries of a built-in catalogue.
///
/// # Panics
/// Panics with line and key where an entry is none.
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

/// An effect with its law; a fault of a sensor has none but its entry's.
fn law(effect: Effect) -> Effect {
    match effect.info.name {
        "aero-yaw" => effect.on_forces(|p, at, forces| {
            let c = &at.point;
            let yaw = p[0] * at.chassis_slip.abs().to_degrees();
            forces.body_along -= 0.5 * yaw * c.air_density * c.drag_area * c.v * c.v;
        }),
        "air-density" => effect
            .on_friction(|p, mu, at| {
                if p[0] == 0.0 {
                    return mu;
                }
                mu + 0.5 * p[0] * at.air_density * at.drag_area * at.v * at.v / at.fz.max(1.0)
            })
            .on_forces(|p, at, forces| {
                let c = &at.point;
                forces.body_along -= 0.5 * p[0] * c.air_density * c.drag_area * c.v * c.v;
            }),
        "drag-area" => effect
            .on_friction(|p, mu, at| {
                if p[0] == 0.0 {
                    return mu;
                }
                mu + 0.5 * at.air_density * p[0] * at.v * at.v / at.fz.max(1.0)
            })
            .on_forces(|p, at, forces| {
                let c = &at.point;
                forces.body_along -= 0.5 * c.air_density * p[0] * c.v * c.v;
            }),
        "headwind" => effect
            .on_friction(|p, mu, at| {
                if p[0] == 0.0 {
                    return mu;
                }
                let w = p[0];
                mu + 0.5 * at.air_density * at.drag_area * (2.0 * at.v + w) * w / at.fz.max(1.0)
            })
            .on_forces(|p, at, forces| {
                let c = &at.point;
                let w = p[0];
                forces.body_along -= 0.5 * c.air_density * c.drag_area * (2.0 * c.v + w) * w;
            }),
        "roll-split-drag" => effect.on_forces(|p, at, forces| {
            let c = &at.point;
            forces.body_along -=
                0.5 * p[0] * c.air_density * c.drag_area * c.v * c.v * at.roll_split.abs();
        }),
        "asperities" => effect
            .on_friction(|p, mu, at| {
                if (p[2]..p[3]).contains(&at.s) {
                    mu * (1.0 + p[0])
                } else {
                    mu
                }
            })
            .on_forces(|p, at, forces| {
                if (p[2]..p[3]).contains(&at.point.s) {
                    for runner in 0..2 {
                        forces.along[runner] *= 1.0 + p[0];
                        forces.across[runner] *= 1.0 + p[1];
                    }
                }
            }),
        "boundary" => effect.on_friction(|p, mu, at| {
            if p[0] == 0.0 {
                return mu;
            }
            let film = |shear| {
                let film = at.patch.friction(at.fz, at.v, at.conditions.ice_c, shear);
                film.unwrap_or(f64::NAN)
            };
            mu * film(p[0]) / film(0.0)
        }),
        "film" => effect.on_friction(|p, mu, at| mu * (1.0 + p[0] * (at.film - 1.0))),
        "humidity" => {
            effect.on_friction(|p, mu, at| mu * (1.0 + p[0] * (at.conditions.humidity_pct - p[1])))
        }
        "load" => effect.on_friction(|p, mu, at| mu * (at.fz.max(1.0) / p[1]).powf(p[0])),
        "plowing" => effect.on_friction(|p, mu, at| {
            if p[0] == 0.0 {
                return mu;
            }
            let softness = 14.7 / (14.7 - 0.6 * at.conditions.ice_c.min(0.0));
            mu + p[0] * (at.fz.max(0.0) / 1000.0 * softness).sqrt()
        }),
        "slip-drag" => effect.on_forces(|p, at, forces| {
            for runner in 0..2 {
                forces.along[runner] -= p[0] * (forces.across[runner] * at.slip[runner]).abs();
            }
        }),
        "speed" => effect.on_friction(|p, mu, at| mu * (at.v.max(0.1) / p[1]).powf(p[0])),
        "steer-drag" => effect.on_forces(|p, at, forces| {
            forces.along[0] -= p[0] * at.load[0].max(0.0) * at.steering.abs();
        }),
        "temperature" => {
            effect.on_friction(|p, mu, at| mu * (1.0 + p[0] * (at.conditions.ice_c - p[1])))
        }
        "warm-up" => effect.on_friction(|p, mu, at| mu * (1.0 + p[0] * (-at.t / p[1]).exp())),
        "wear" => {
            effect.on_friction(|p, mu, at| mu * (1.0 + p[0] * at.conditions.distance_m / 1000.0))
        }
        "camber-thrust" => effect.on_forces(|p, at, forces| {
            forces.across[0] += p[0] * at.roll_split * at.load[0];
        }),
        "combined-slip" => effect.on_forces(|p, at, forces| {
            let ratio = at.acceleration[0] / at.acceleration[2].max(1.0);
            let factor = 1.0 / (1.0 + p[0] * ratio * ratio).max(0.05);
            scale_across(forces, factor);
        }),
        "load-sensitivity" => effect.on_forces(|p, at, forces| {
            for runner in 0..2 {
                forces.across[runner] *= (at.load[runner].max(1.0) / p[1]).powf(p[0]);
            }
        }),
        "load-transfer" => effect.on_forces(|p, at, forces| {
            let factor = 1.0 / (1.0 + p[0] * at.roll_acceleration * at.roll_acceleration).max(0.05);
            scale_across(forces, factor);
        }),
        "relaxation-length" => effect
            .on_forces(|p, at, forces| {
                for runner in 0..2 {
                    let lag = p[0] / at.point.v.max(1.0);
                    forces.across[runner] -= lag * forces.stiffness[runner] * at.slip_rate[runner];
                }
            })
            .relaxes_after(0),
        "saturation" => effect.on_forces(|p, at, forces| {
            for runner in 0..2 {
                let ratio = forces.across[runner] / at.load[runner].max(1.0);
                let kappa = p[runner] + p[2];
                forces.across[runner] /= (1.0 + kappa * ratio * ratio).max(0.05).sqrt();
            }
        }),
        "speed-grip" => effect.on_forces(|p, at, forces| {
            let factor = 1.0 + p[0] * (at.point.v - p[1]);
            scale_across(forces, factor);
        }),
        "temperature-grip" => effect.on_forces(|p, at, forces| {
            let factor = 1.0 + p[0] * (at.point.conditions.ice_c - p[1]);
            scale_across(forces, factor);
        }),
        "imu-misalignment" => effect.on_sensors(Fault::MISALIGNED.as_flattened()),
        "cg-place" => effect.on_sled(|p, sled| {
            sled.axles[0] -= p[0];
            sled.axles[1] += p[0];
            sled.accelerometer[0] -= p[0];
            sled.slip_sensor -= p[0];
        }),
        "lever-arm" => effect.on_sled(|p, sled| {
            sled.accelerometer[0] += p[0];
            sled.accelerometer[2] += p[1];
        }),
        "mass" => effect.on_sled(|p, sled| sled.mass += p[0]),
        "yaw-inertia" => effect.on_sled(|p, sled| sled.yaw_inertia *= 1.0 + p[0]),
        "slope" => effect
            .on_friction(|p, mu, _| mu - p[0])
            .on_slope(|p, _| p[0]),
        "track-profile" => {
            effect.on_slope(|p, s| if (p[1]..p[2]).contains(&s) { p[0] } else { 0.0 })
        }
        "wall-contact" => effect.on_forces(|p, at, forces| {
            let along = (at.point.s - p[1]) / (p[2] - p[1]);
            if !(0.0..1.0).contains(&along) {
                return;
            }
            let force = match p[5] > 0.0 {
                true => p[0] * (std::f64::consts::PI * along).sin().powi(2),
                false => p[0],
            };
            forces.body_across += force;
            forces.body_yaw += p[4] * force;
            forces.body_along -= p[3] * force.abs();
        }),
        _ => effect,
    }
}

fn scale_across(forces: &mut Forces, factor: f64) {
    forces.across = forces.across.map(|across| across * factor);
}
