//! Drag of the air.

use crate::effects::*;

const AIR: Info = Info {
    acts_on: &[ActsOn::Along],
    ..Info::NEW
};

/// Drag of the air.
pub(super) const EFFECTS: &[Effect] = &[
    // The drag grows otherwise with the chassis slip beta: k is added to the 0.0694 a degree of
    // the base model.
    Info {
        name: "aero-yaw",
        summary: "the drag grows otherwise with the chassis slip",
        formula: "F_x - k |beta| rho A v^2/2, beta in degrees",
        signature: "chassis slip times v^2",
        parameters: &[amplitude("per_deg", "1/deg", -0.2, 2.0, 0.02)],
        needs: &[Column::Slip],
        looks_like: &["slip-drag"],
        decides: "a wind tunnel with the sled yawed",
        source: "G. Bello-Millan, T. Makela, L. Parras, C. del Pino, C. Ferrera, J. Wind Eng. \
            Ind. Aerodyn. 157 (2016) 140-144",
        example: "0.05: alpha_rad -0.017453292519943295, air_density_kgpm3 1.25, cda_m2 0.2, \
            v_mps 40 -> fx_n -10",
        ..AIR
    }
    .effect()
    .on_forces(|p, at, forces| {
        let c = &at.point;
        let yaw = p[0] * at.chassis_slip.abs().to_degrees();
        forces.body_along -= 0.5 * yaw * c.air_density * c.drag_area * c.v * c.v;
    }),
    // A relative error k of the air density; within one session exactly what another drag area
    // does.
    Info {
        name: "air-density",
        summary: "the air density is not the computed one",
        formula: "F_x - k rho A v^2/2",
        signature: "v^2, that of the drag area in one session",
        acts_on: &[ActsOn::Along, ActsOn::Friction],
        parameters: &[amplitude("factor", "", -0.5, 0.5, 0.02)],
        needs: &[Column::Speed],
        experiments: Experiments::Needs(&[Column::Speed, Column::Load]),
        looks_like: &["drag-area"],
        decides: "a barometer at the track",
        source: "ideal gas law with the specific gas constant of air, 287.05 J/(kg K)",
        example: "0.05: fx_n -80, air_density_kgpm3 1.25, cda_m2 0.2, v_mps 40 -> fx_n -90",
        ..AIR
    }
    .effect()
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
    // An error dA of the drag area C_x A_x. An apparent friction coefficient takes it for mu:
    // the force over the load.
    Info {
        name: "drag-area",
        summary: "the drag area is not the stated one",
        formula: "F_x - rho dA v^2/2",
        signature: "v^2",
        acts_on: &[ActsOn::Along, ActsOn::Friction],
        parameters: &[amplitude("cda_m2", "m2", -0.5, 0.5, 0.01)],
        needs: &[Column::Speed],
        experiments: Experiments::Needs(&[Column::Speed, Column::Load]),
        looks_like: &["air-density", "speed", "warm-up", "headwind"],
        decides: "a wind tunnel, or runs at one speed with a changed drag area",
        source: "S.F. Hoerner, Fluid-Dynamic Drag (1965)",
        example: "0.01: fx_n -80, air_density_kgpm3 1.25, v_mps 40 -> fx_n -90",
        ..AIR
    }
    .effect()
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
    // A wind w against the motion, A being the drag area.
    Info {
        name: "headwind",
        summary: "a wind along the track",
        formula: "F_x - rho A ((v+w)^2 - v^2)/2",
        signature: "v",
        acts_on: &[ActsOn::Along, ActsOn::Friction],
        parameters: &[amplitude("speed_mps", "m/s", -15.0, 15.0, 0.5)],
        needs: &[Column::Speed],
        experiments: Experiments::Needs(&[Column::Speed, Column::Load]),
        looks_like: &["drag-area", "speed"],
        decides: "an anemometer at the track, or runs in both directions",
        source: "S.F. Hoerner, Fluid-Dynamic Drag (1965)",
        example: "2: fx_n -80, air_density_kgpm3 1.25, cda_m2 0.2, v_mps 19 -> fx_n -90",
        ..AIR
    }
    .effect()
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
    // The twisted hull brakes: the drag area grows as the front part turns against the rear.
    Info {
        name: "roll-split-drag",
        summary: "the twisted hull brakes",
        formula: "F_x - k rho A v^2 |gamma|/2",
        signature: "roll-split angle times v^2",
        parameters: &[amplitude("coefficient_per_rad", "1/rad", -5.0, 50.0, 0.02)],
        needs: &[Column::RollSplit],
        looks_like: &["load", "slip-drag"],
        decides: "pressure taps or a tunnel with the front turned",
        source: "A. Sciacchitano, D. Faleo and others on the aerodynamics of bobsleds with a \
            roll split (2018), as cited by the bobsled friction model",
        example: "2: gamma_rad -0.025, air_density_kgpm3 1.25, cda_m2 0.2, v_mps 40 -> fx_n \
            -10",
        ..AIR
    }
    .effect()
    .on_forces(|p, at, forces| {
        let c = &at.point;
        forces.body_along -=
            0.5 * p[0] * c.air_density * c.drag_area * c.v * c.v * at.roll_split.abs();
    }),
];
