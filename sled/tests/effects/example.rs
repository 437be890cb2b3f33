//! Examples of the catalogue, read and evaluated: `0.5, 1000: mu 0.004, fz_n 2250 -> mu 0.006`.
//!
//! `mu` is the friction coefficient, `slope_rad` the track's slope, the column of a sensor its
//! reading, `mass_kg` and the like a constant of the sled; `fx_f_n`, `fx_r_n`, `fy_f_n`, `fy_r_n`
//! are the forces on the runners, `fx_n`, `fy_n`, `mz_nm` those on the body. A name with `_rate` is
//! a derivative by time.

use kufe_sled::Conditions;
use kufe_sled::Sled;
use kufe_sled::effects::{Effect, Forces, OperatingPoint, Sensor, Signals, State};

/// An example of an effect.
pub struct Example {
    pub parameters: Vec<f64>,
    given: Vec<(String, f64)>,
    of: String,
    pub gives: f64,
}

impl Example {
    pub fn read(text: &str) -> Example {
        let number = |text: &str| text.trim().parse::<f64>().expect(text);
        let named = |text: &str| {
            let (name, value) = text.trim().split_once(' ').expect(text);
            (name.to_owned(), number(value))
        };
        let (parameters, rest) = text.split_once(':').expect(text);
        let (given, gives) = rest.split_once("->").expect(text);
        let (of, gives) = named(gives);
        Example {
            parameters: parameters.split(',').map(number).collect(),
            given: given.split(',').map(named).collect(),
            of,
            gives,
        }
    }

    /// The value of the quantity after the effect.
    pub fn outcome(&self, effect: &Effect) -> f64 {
        let mut known = Quantities::default();
        for (name, value) in &self.given {
            let places = known.named(name);
            assert!(!places.is_empty(), "{}: {name}", effect.info.name);
            places.into_iter().for_each(|place| *place = *value);
        }
        let Quantities {
            mu,
            slope,
            state,
            mut forces,
            mut signals,
        } = known;
        let p = &self.parameters;
        effect.act(p, &state, &mut forces);
        effect.disturb(p, &mut signals);
        effect.find_constants(p, &mut signals.sled);
        let mut found = Quantities {
            mu: effect.coefficient(p, mu, &state.point),
            slope: slope + effect.slope(p, state.point.s),
            state: State::default(),
            forces,
            signals,
        };
        *found.named(&self.of).pop().expect(&self.of)
    }
}

/// All quantities that an example may name; 0 unless the example sets them.
struct Quantities {
    mu: f64,
    slope: f64,
    state: State,
    forces: Forces,
    signals: Signals,
}

impl Default for Quantities {
    fn default() -> Self {
        let point = OperatingPoint {
            conditions: Conditions::from_values([0.0; 6]),
            ..OperatingPoint::default()
        };
        Quantities {
            mu: 0.0,
            slope: 0.0,
            state: State {
                point,
                ..State::default()
            },
            forces: Forces::default(),
            signals: Signals::default(),
        }
    }
}

impl Quantities {
    /// All fields with this name; the ones that an effect changes come last.
    fn named(&mut self, name: &str) -> Vec<&mut f64> {
        let own = match name {
            "mu" => Some(&mut self.mu),
            "slope_rad" => Some(&mut self.slope),
            _ => None,
        };
        let State {
            point,
            load,
            slip,
            slip_rate,
            chassis_slip,
            steering,
            roll_split,
            roll_acceleration,
            acceleration,
            ..
        } = &mut self.state;
        let at_point = match name {
            "t_s" => Some(&mut point.t),
            "s_m" => Some(&mut point.s),
            "v_mps" => Some(&mut point.v),
            "fz_n" => Some(&mut point.fz),
            "ice_c" => Some(&mut point.conditions.ice_c),
            "humidity_pct" => Some(&mut point.conditions.humidity_pct),
            "distance_m" => Some(&mut point.conditions.distance_m),
            "air_density_kgpm3" => Some(&mut point.air_density),
            "cda_m2" => Some(&mut point.drag_area),
            "film" => Some(&mut point.film),
            "contact_length_m" => Some(&mut point.patch.length),
            "contact_width_m" => Some(&mut point.patch.width),
            "roughness_m" => Some(&mut point.patch.roughness),
            _ => None,
        };
        let of_state = match name {
            "fz_f_n" => Some(&mut load[0]),
            "fz_r_n" => Some(&mut load[1]),
            "alpha_rad" => Some(chassis_slip),
            "alpha_f_rad" => Some(&mut slip[0]),
            "alpha_f_rad_rate" => Some(&mut slip_rate[0]),
            "delta_rad" => Some(steering),
            "gamma_rad" => Some(roll_split),
            "roll_rate_radps_rate" => Some(roll_acceleration),
            "ax_mps2" => Some(&mut acceleration[0]),
            "az_mps2" => Some(&mut acceleration[2]),
            _ => None,
        };
        let places = [
            own,
            at_point,
            of_state,
            force(&mut self.forces, name),
            constant(&mut self.signals.sled, name),
            signal(&mut self.signals.value, &mut self.signals.rate, name),
        ];
        places.into_iter().flatten().collect()
    }
}

fn force<'a>(forces: &'a mut Forces, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "fx_f_n" => &mut forces.along[0],
        "fy_f_n" => &mut forces.across[0],
        "fy_r_n" => &mut forces.across[1],
        "fy_f_n_per_rad" => &mut forces.stiffness[0],
        "fx_n" => &mut forces.body_along,
        _ => return None,
    })
}

fn constant<'a>(sled: &'a mut Sled, name: &str) -> Option<&'a mut f64> {
    Some(match name {
        "mass_kg" => &mut sled.mass_kg,
        "j_zz_kgm2" => &mut sled.j_zz_kgm2,
        "l_r_m" => &mut sled.l_r_m,
        "accel_x_m" => &mut sled.accel_x_m,
        _ => return None,
    })
}

fn signal<'a>(values: &'a mut [f64], rates: &'a mut [f64], name: &str) -> Option<&'a mut f64> {
    if let Some(of) = Sensor::named(name) {
        return Some(&mut values[of as usize]);
    }
    let of = Sensor::named(name.strip_suffix("_rate")?)?;
    Some(&mut rates[of as usize])
}
