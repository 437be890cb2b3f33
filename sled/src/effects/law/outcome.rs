//! Examples tried: the values that they state, by name, and the number that comes out.

use crate::effects::law::effect::Effect;
use crate::effects::motion::{Conditions, Constants, Forces, Sensor, Signals, State};

impl Effect {
    /// The number that its example gives; NaN where a name in it is none that an effect knows.
    pub fn example_outcome(&self) -> f64 {
        let example = &self.example;
        let (mut mu, mut slope) = (0.0, 0.0);
        let (mut state, mut forces) = (State::default(), Forces::default());
        let mut signals = Signals::default();
        for (name, value) in example.given {
            let mut known = false;
            let mut set = |place: Option<&mut f64>| {
                if let Some(place) = place {
                    *place = *value;
                    known = true;
                }
            };
            set((*name == "mu").then_some(&mut mu));
            set((*name == "slope_rad").then_some(&mut slope));
            set(condition(&mut state.conditions, name));
            set(instant(&mut state, name));
            set(force(&mut forces, name));
            set(signal(&mut signals, name));
            set(constant(&mut signals.sled, name));
            if !known {
                return f64::NAN;
            }
        }
        let wanted = example.gives.0;
        if wanted == "mu" {
            return self.coefficient(example.parameters, mu, &state.conditions);
        }
        if wanted == "slope_rad" {
            return slope + self.slope(example.parameters, state.conditions.s);
        }
        self.act(example.parameters, &state, &mut forces);
        self.disturb(example.parameters, &mut signals);
        self.find_constants(example.parameters, &mut signals.sled);
        force(&mut forces, wanted)
            .copied()
            .or_else(|| constant(&mut signals.sled, wanted).copied())
            .or_else(|| signal(&mut signals, wanted).copied())
            .unwrap_or(f64::NAN)
    }
}

fn condition<'a>(c: &'a mut Conditions, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "t_s" => &mut c.t,
        "s_m" => &mut c.s,
        "v_mps" => &mut c.v,
        "fz_n" => &mut c.fz,
        "ice_c" => &mut c.ice_c,
        "air_c" => &mut c.air_c,
        "air_pa" => &mut c.air_pa,
        "humidity_pct" => &mut c.humidity_pct,
        "distance_m" => &mut c.distance,
        "air_density_kgpm3" => &mut c.air_density,
        "cda_m2" => &mut c.drag_area,
        "film" => &mut c.film,
        _ => return None,
    })
}

fn instant<'a>(state: &'a mut State, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "fz_f_n" => &mut state.load[0],
        "fz_r_n" => &mut state.load[1],
        "alpha_rad" => &mut state.chassis_slip,
        "alpha_f_rad" => &mut state.slip[0],
        "alpha_r_rad" => &mut state.slip[1],
        "alpha_f_rad_rate" => &mut state.slip_rate[0],
        "alpha_r_rad_rate" => &mut state.slip_rate[1],
        "delta_rad" => &mut state.steering,
        "gamma_rad" => &mut state.roll_split,
        "roll_rate_radps_rate" => &mut state.roll_acceleration,
        "ax_mps2" => &mut state.acceleration[0],
        "az_mps2" => &mut state.acceleration[2],
        _ => return None,
    })
}

fn force<'a>(forces: &'a mut Forces, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "fx_f_n" => &mut forces.along[0],
        "fx_r_n" => &mut forces.along[1],
        "fy_f_n" => &mut forces.across[0],
        "fy_r_n" => &mut forces.across[1],
        "fy_f_n_per_rad" => &mut forces.stiffness[0],
        "fy_r_n_per_rad" => &mut forces.stiffness[1],
        "fx_n" => &mut forces.body_along,
        "fy_n" => &mut forces.body_across,
        "mz_nm" => &mut forces.body_yaw,
        _ => return None,
    })
}

fn signal<'a>(signals: &'a mut Signals, name: &str) -> Option<&'a mut f64> {
    if let Some(of) = Sensor::named(name) {
        return Some(&mut signals.value[of as usize]);
    }
    let of = Sensor::named(name.strip_suffix("_rate")?)?;
    Some(&mut signals.rate[of as usize])
}

fn constant<'a>(sled: &'a mut Constants, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "mass_kg" => &mut sled.mass,
        "j_yy_kgm2" => &mut sled.pitch_inertia,
        "j_zz_kgm2" => &mut sled.yaw_inertia,
        "l_f_m" => &mut sled.axles[0],
        "l_r_m" => &mut sled.axles[1],
        "accel_x_m" => &mut sled.accelerometer[0],
        "accel_y_m" => &mut sled.accelerometer[1],
        "accel_z_m" => &mut sled.accelerometer[2],
        "slip_x_m" => &mut sled.slip_sensor,
        _ => return None,
    })
}
