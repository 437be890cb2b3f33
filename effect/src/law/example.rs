//! Examples: what an effect makes of stated values.

use crate::law::effect::Effect;
use crate::motion::{Conditions, Constants, Forces, Sensor, Signals, State};

/// Parameters, values and the number that the effect must give, by the names that the formulas use.
///
/// `mu` asks for the friction coefficient, `slope_rad` for the track's slope, the column of a sensor for what it reads,
/// `mass_kg` and its like for a constant of the sled; `fx_f_n`, `fx_r_n`, `fy_f_n`, `fy_r_n` are the forces on the
/// runners, `fx_n`, `fy_n`, `mz_nm` those on the body. A name with `_rate` is a derivative by time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Example {
    /// Parameters, as in [`Info::parameters`](crate::Info::parameters).
    pub parameters: &'static [f64],
    /// What is known before; everything else is 0.
    pub given: &'static [(&'static str, f64)],
    /// What must come out.
    pub gives: (&'static str, f64),
}

impl Example {
    /// No example.
    pub(crate) const NEW: Example = Example {
        parameters: &[],
        given: &[],
        gives: ("", f64::NAN),
    };

    /// The number that the effect gives; NaN where a name is none that an effect knows.
    pub fn outcome(&self, effect: &Effect) -> f64 {
        let (mut mu, mut slope) = (0.0, 0.0);
        let (mut state, mut forces) = (State::default(), Forces::default());
        let mut signals = Signals::default();
        for (name, value) in self.given {
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
        let wanted = self.gives.0;
        if wanted == "mu" {
            return effect.coefficient(self.parameters, mu, &state.conditions);
        }
        if wanted == "slope_rad" {
            return slope + effect.slope(self.parameters, state.conditions.s);
        }
        effect.act(self.parameters, &state, &mut forces);
        effect.disturb(self.parameters, &mut signals);
        effect.find_constants(self.parameters, &mut signals.sled);
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
