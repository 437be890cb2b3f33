//! What is known of a sled at one instant, and the forces on it.

use crate::effects::{Conditions, Relaxed};

/// One instant of a sled, measured or simulated: all that friction and air depend on.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct State {
    /// Time [s].
    pub t_s: f64,
    /// Distance along the track [m].
    pub s_m: f64,
    /// Speed [m/s].
    pub v_mps: f64,
    /// Slip angle at the centre of gravity [rad]; the chassis slip angle is its negative.
    pub alpha_cog_rad: f64,
    /// Slip angle at the front runner, steering included [rad].
    pub alpha_f_rad: f64,
    /// Slip angle at the rear runner [rad].
    pub alpha_r_rad: f64,
    /// Steering angle, positive to the left [rad].
    pub delta_rad: f64,
    /// Roll-split angle, positive turns the front part about +x [rad].
    pub gamma_rad: f64,
    /// Roll rate [rad/s].
    pub roll_rate_radps: f64,
    /// Pitch rate [rad/s].
    pub pitch_rate_radps: f64,
    /// Yaw rate [rad/s].
    pub yaw_rate_radps: f64,
    /// Roll acceleration [rad/s2].
    pub roll_accel_radps2: f64,
    /// Curvature of the track in the vertical plane, `-pitch_rate / v` [1/m].
    pub curvature_1pm: f64,
    /// Normal force at the front axle in the body frame [N].
    pub fz_f0_n: f64,
    /// Normal force at the rear runner [N].
    pub fz_r_n: f64,
    /// Air density [kg/m3].
    pub air_density_kgpm3: f64,
    /// Ice temperature [degrees Celsius].
    pub ice_c: f64,
    /// Air temperature [degrees Celsius].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Relative humidity [%]; only effects ask for it, NaN where nothing states it.
    pub humidity_pct: f64,
    /// Distance run on this finish of the runners before the run [m]; only effects ask for it, NaN where nothing states it.
    pub distance_before_m: f64,
    /// Rates of the slip angles, front and rear [rad/s], or of those that forces follow late; only effects ask for them.
    pub slip_rate_radps: [f64; 2],
    /// Specific force at the centre of gravity [m/s2]; only effects ask for it.
    pub accel_mps2: [f64; 3],
}

impl State {
    /// Rates of the slips that forces follow after a distance [m], `dt_s` [s] after the state before [rad/s]; below 1 m/s as at 1 m/s.
    pub fn followed_rates(&self, relaxed: &mut Relaxed, dt_s: f64, distance: f64) -> [f64; 2] {
        let slip = [self.alpha_f_rad, self.alpha_r_rad];
        relaxed.rates(
            slip,
            self.slip_rate_radps,
            self.v_mps.max(1.0),
            dt_s,
            distance,
        )
    }

    /// Time, place, speed and weather, as effects see them; the normal force and the drag area are left open.
    pub fn conditions(&self) -> Conditions {
        Conditions {
            t: self.t_s,
            s: self.s_m,
            v: self.v_mps,
            fz: f64::NAN,
            ice_c: self.ice_c,
            air_c: self.air_c,
            air_pa: self.air_pa,
            humidity_pct: self.humidity_pct,
            distance: self.distance_before_m,
            air_density: self.air_density_kgpm3,
            drag_area: f64::NAN,
            film: f64::NAN,
        }
    }
}

/// What accelerometers and differentiated gyroscopes tell about one instant, at the centre of gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Motion {
    /// Specific force (x, y, z) [m/s2].
    pub accel_mps2: [f64; 3],
    /// Pitch acceleration [rad/s2].
    pub pitch_accel_radps2: f64,
    /// Yaw acceleration [rad/s2].
    pub yaw_accel_radps2: f64,
}

/// Forces of the ice on both runners.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct AxleForces {
    /// On the front runner in its own frame (x, y, z) [N].
    pub front: [f64; 3],
    /// The same force in the body frame [N].
    pub front_body: [f64; 3],
    /// On the rear runner; its frame is the body's [N].
    pub rear: [f64; 3],
    /// On the body besides runners and base drag: what effects add along x and y, a headwind or a wall [N], and about z [N m].
    pub body: [f64; 3],
}

/// Sums of what acts in the plane of the sled.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Resultant {
    /// Force along x at the centre of gravity [N].
    pub fx_n: f64,
    /// Force along y at the centre of gravity [N].
    pub fy_n: f64,
    /// Moment about z [N m].
    pub mz_nm: f64,
}
