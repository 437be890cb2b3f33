//! The sled of the generator: geometry, runner forces by the magic formula, and hidden effects
//! inside them.

use std::sync::Arc;

use crate::world::film::Glide;
use crate::world::hidden::{Hidden, Kind};

/// Geometry and inertia; positions are from the centre of gravity.
#[derive(Debug, Clone)]
pub struct Sled {
    /// Mass of sled and crew [kg].
    pub mass_kg: f64,
    /// Pitch moment of inertia [kg m2].
    pub j_yy_kgm2: f64,
    /// Yaw moment of inertia [kg m2].
    pub j_zz_kgm2: f64,
    /// Front axle ahead of the centre of gravity [m].
    pub l_f_m: f64,
    /// Rear axle behind the centre of gravity [m].
    pub l_r_m: f64,
    /// Accelerometer's position [m].
    pub accel_m: [f64; 3],
    /// Slip sensor's x position [m].
    pub slip_x_m: f64,
    /// Drag area [m2].
    pub cda_m2: f64,
    /// Relative growth of the drag area per degree of body slip.
    pub yaw_drag_per_deg: f64,
    /// Longitudinal friction coefficient.
    pub mu: f64,
    /// Front lateral law.
    pub front: Lateral,
    /// Rear lateral law.
    pub rear: Lateral,
}

impl Sled {
    /// States the centre of gravity so far behind where it is [m]: axles and sensors stand further
    /// ahead of it.
    pub fn say_centre_back(&mut self, by: f64) {
        self.l_f_m += by;
        self.l_r_m -= by;
        self.accel_m[0] += by;
        self.slip_x_m += by;
    }
}

/// Parameters of the lateral magic formula.
#[derive(Debug, Clone, Copy)]
pub struct Lateral {
    /// Product of friction coefficient and asperity factor.
    pub mu_zeta: f64,
    /// Shape factor C.
    pub c: f64,
    /// Curvature factor E.
    pub e: f64,
    /// Cornering stiffness [N/rad].
    pub k_n_per_rad: f64,
}

impl Lateral {
    /// `F_y = D sin(C atan(Bx - E (Bx - atan Bx)))`, `D = mu zeta F_z`, `B = K / (C D)`, x = slip.
    pub fn force(&self, slip_rad: f64, load_n: f64) -> f64 {
        let peak = self.mu_zeta * load_n.max(1.0);
        let bx = self.k_n_per_rad / (self.c * peak) * slip_rad;
        let bent = bx - self.e * (bx - bx.atan());
        peak * (self.c * bent.atan()).sin()
    }
}

impl Default for Sled {
    fn default() -> Self {
        Self {
            mass_kg: 390.0,
            j_yy_kgm2: 145.0,
            j_zz_kgm2: 150.0,
            l_f_m: 0.82,
            l_r_m: 0.88,
            accel_m: [-0.35, 0.0, 0.12],
            slip_x_m: -0.60,
            cda_m2: 0.28,
            yaw_drag_per_deg: 0.0694,
            mu: 0.004,
            front: Lateral {
                mu_zeta: 2.577,
                c: 0.024,
                e: 0.99,
                k_n_per_rad: 10522.0,
            },
            rear: Lateral {
                mu_zeta: 3.288,
                c: 0.076,
                e: 0.99,
                k_n_per_rad: 49776.0,
            },
        }
    }
}

/// Ice and air of a run.
#[derive(Debug, Clone, Default)]
pub struct Conditions {
    /// Name of the track.
    pub track: String,
    /// Ice temperature [deg C].
    pub ice_c: f64,
    /// Air temperature [deg C].
    pub air_c: f64,
    /// Air pressure [Pa].
    pub air_pa: f64,
    /// Relative humidity [%].
    pub humidity_pct: f64,
    /// Distance run since the runners were last polished [m].
    pub worn_m: f64,
    /// Unexplained factor on the longitudinal friction of the session (1: none).
    pub session_mu: f64,
    /// Unexplained factor on the lateral grip of the session (1: none).
    pub session_grip: f64,
    /// Friction of groove and melt film in place of the sled's coefficient, where the world has
    /// that.
    pub glide: Option<Arc<Glide>>,
}

impl Conditions {
    /// Density of air with the specific gas constant of air, 287.05 J/(kg K) [kg/m3].
    pub fn air_density(&self) -> f64 {
        self.air_pa / (287.05 * (self.air_c + 273.15))
    }
}

/// The motion at an instant, as the forces see it.
#[derive(Debug, Clone, Copy, Default)]
pub struct Motion {
    /// Time since the start [s].
    pub t_s: f64,
    /// Distance along the track [m].
    pub s_m: f64,
    /// Speed [m/s].
    pub v_mps: f64,
    /// Angle of the velocity at the centre of gravity, left positive [rad].
    pub beta_rad: f64,
    /// Slip angle the front runner has [rad].
    pub slip_f_rad: f64,
    /// Slip angle the rear runner has [rad].
    pub slip_r_rad: f64,
    /// Steering angle [rad].
    pub delta_rad: f64,
    /// Roll-split angle [rad].
    pub gamma_rad: f64,
    /// Front normal load in body axes [N].
    pub fz_f0_n: f64,
    /// Rear normal load [N].
    pub fz_r_n: f64,
    /// Roll rate [rad/s].
    pub roll_rate_radps: f64,
    /// Roll acceleration [rad/s2].
    pub roll_acc_radps2: f64,
    /// Pitch rate [rad/s].
    pub pitch_rate_radps: f64,
    /// A recorded extra channel, which only effects outside the catalogue use.
    pub extra: f64,
}

/// Forces on the body in its own axes.
#[derive(Debug, Clone, Copy, Default)]
pub struct Forces {
    /// Sum along x [N].
    pub x_n: f64,
    /// Sum along y [N].
    pub y_n: f64,
    /// Yaw moment [N m].
    pub yaw_nm: f64,
}

/// Forces of the ice and the air on the sled, hidden effects included.
///
/// The air holds against the velocity. Front: `F_f0 = R_x(gamma) R_z(delta) F_f`, solved for the
/// runner's own normal load.
pub fn forces(sled: &Sled, at: &Conditions, m: &Motion, hidden: &[Hidden]) -> Forces {
    let mut factor = at.session_mu;
    let (mut add, mut add_front, mut grip, mut drag, mut wind) =
        (0.0, 0.0, at.session_grip, 1.0, 0.0);
    let mut yaw_drag = sled.yaw_drag_per_deg;
    let (mut more_area, mut split_drag) = (0.0, 0.0);
    let (mut external_y, mut camber, mut slip_drag, mut transfer) = (0.0, 0.0, 0.0, 0.0);
    let (mut load_grip, mut saturation, mut combined, mut load_power, mut plow) =
        (0.0, 0.0, 0.0, 0.0, 0.0);
    for effect in hidden {
        let k = effect.size;
        match effect.kind {
            Kind::Temperature => factor *= 1.0 + k * (at.ice_c + 5.0),
            Kind::Speed => factor *= (m.v_mps / 20.0).powf(k),
            Kind::Load => load_power = k,
            Kind::Plowing => plow = k,
            Kind::Humidity => factor *= 1.0 + k * (at.humidity_pct - 70.0),
            Kind::Wear => factor *= 1.0 + k * at.worn_m / 1000.0,
            Kind::WarmUp => factor *= 1.0 + k * (-m.t_s / 10.0).exp(),
            Kind::Asperities => {
                let inside = effect.inside(&at.track, m.s_m);
                factor *= 1.0 + k * inside;
            }
            Kind::GripPatch => grip *= 1.0 + k * effect.inside(&at.track, m.s_m),
            Kind::DragArea => more_area += k,
            Kind::AirDensity => drag *= 1.0 + k,
            Kind::Headwind => wind = k,
            Kind::AeroYaw => yaw_drag += k,
            Kind::SlipDrag => slip_drag = k,
            Kind::SteerDrag => add_front += k * m.delta_rad.abs(),
            Kind::RollSplitDrag => split_drag = k * m.gamma_rad.abs(),
            Kind::WallContact => external_y += k * effect.inside(&at.track, m.s_m),
            Kind::LoadTransfer => transfer = k,
            Kind::SpeedGrip => grip *= 1.0 + k * (m.v_mps - 25.0),
            Kind::TemperatureGrip => grip *= 1.0 + k * (at.ice_c + 5.0),
            Kind::LoadSensitivity => load_grip = k,
            Kind::CamberThrust => camber = k,
            Kind::Saturation => saturation = k,
            Kind::CombinedSlip => combined = k,
            Kind::BeyondRollRate => add += k * m.roll_rate_radps.abs(),
            Kind::BeyondExtra => add += k * m.extra,
            Kind::BeyondSpeedHump => grip *= 1.0 + k * (-((m.v_mps - 22.0) / 3.0).powi(2)).exp(),
            Kind::BeyondProduct => grip *= 1.0 + k * m.v_mps * m.gamma_rad,
            Kind::BeyondPitchGrip => grip *= 1.0 + k * m.pitch_rate_radps.abs(),
            _ => {}
        }
    }
    let reference = 0.5 * sled.mass_kg * 9.81;
    // ice hardness by Poirier, Lozowski and Thompson (2011): (14.7 - 0.6 T) MPa
    let hardness = 14.7 / (14.7 - 0.6 * at.ice_c);
    let mu_at = |load: f64, extra: f64| {
        let relative = (load / reference).max(0.05);
        let mu = match &at.glide {
            None => sled.mu,
            Some(glide) => glide.mu(load, m.v_mps, -m.pitch_rate_radps / m.v_mps),
        };
        mu * factor * relative.powf(load_power)
            + add
            + extra
            + plow * (load / 1000.0 * hardness).max(0.0).sqrt()
    };
    let area = (sled.cda_m2 * (1.0 + yaw_drag * m.beta_rad.to_degrees().abs() + split_drag)
        + more_area)
        * drag;
    let air = 0.5 * at.air_density() * area * (m.v_mps + wind) * (m.v_mps + wind).abs();
    let total = (m.fz_f0_n + m.fz_r_n).max(1.0);
    let along = air + sled.mu * total;
    let lateral = |law: &Lateral, slip: f64, load: f64| {
        let relative = (load / 2000.0).max(0.05);
        let force = grip * law.force(slip, load) * relative.powf(load_grip);
        let bend = (1.0 + saturation * (force / load).powi(2)).max(0.1).sqrt();
        let lost = (1.0 + transfer * m.roll_acc_radps2.powi(2))
            * (1.0 + combined * (along / total).powi(2));
        force / (bend * lost)
    };

    let mu_r = mu_at(m.fz_r_n, 0.0);
    let rear_x = -mu_r * m.fz_r_n * m.slip_r_rad.cos();
    let rear_y = lateral(&sled.rear, m.slip_r_rad, m.fz_r_n);

    let (sin_g, cos_g) = m.gamma_rad.sin_cos();
    let (sin_d, cos_d) = m.delta_rad.sin_cos();
    let mut load = m.fz_f0_n;
    let (mut front_x, mut front_y) = (0.0, 0.0);
    for _ in 0..4 {
        let mu_f = mu_at(load, add_front);
        front_x = -mu_f * load * m.slip_f_rad.cos();
        front_y = lateral(&sled.front, m.slip_f_rad, load) + camber * load * m.gamma_rad;
        load = (m.fz_f0_n - sin_g * (sin_d * front_x + cos_d * front_y)) / cos_g;
    }
    let f0_x = cos_d * front_x - sin_d * front_y;
    let f0_y = cos_g * (sin_d * front_x + cos_d * front_y) - sin_g * load;

    let scrub = slip_drag * ((front_y * m.slip_f_rad).abs() + (rear_y * m.slip_r_rad).abs());
    Forces {
        x_n: f0_x + rear_x - air * m.beta_rad.cos() - scrub,
        y_n: f0_y + rear_y + external_y - air * m.beta_rad.sin(),
        yaw_nm: sled.l_f_m * f0_y - sled.l_r_m * rear_y,
    }
}
