//! What is written: runs, tracks, and the model as its owner states it.

use std::fmt::Write as _;

use super::recorder::{NOISE, Row};
use super::road::Road;
use super::runners::Sled;
use super::wrong::Wrong;
use crate::world::noise::Source;

/// Columns of a run.
const COLUMNS: &str = "ax_mps2,ay_mps2,az_mps2,roll_rate_radps,pitch_rate_radps,yaw_rate_radps,v_mps,alpha_rad,delta_rad,gamma_rad";

/// A run, as a file.
pub fn run_file(rows: &[Row]) -> String {
    let mut text = format!("t_s,{COLUMNS}\n");
    for (k, row) in rows.iter().enumerate() {
        let _ = write!(text, "{:.2}", k as f64 / 100.0);
        for value in row {
            let _ = write!(text, ",{value:.6}");
        }
        text.push('\n');
    }
    text
}

/// A track, as its name and its file.
pub fn track_file(road: &Road, wrong: &Wrong) -> (String, Vec<u8>) {
    let mut text = String::from("s_m,slope_rad,curvature_1pm,bank_rad\n");
    let sign = if wrong.uphill { -1.0 } else { 1.0 };
    for s in 0..=road.length_m as usize {
        let here = road.at(s as f64);
        let curvature = -here.turn[1] * wrong.curvature;
        let _ = writeln!(
            text,
            "{s},{:.6},{curvature:.6},{:.5}",
            sign * here.fall,
            here.bank
        );
    }
    (format!("track_{}.csv", road.name), text.into_bytes())
}

/// The model as its owner states it: the sled as it was weighed, friction three per cent off.
pub fn model_file(sled: &Sled, wrong: &Wrong, source: &mut Source) -> String {
    let mut off = |value: f64| value * (1.0 + (0.03 * source.normal()).clamp(-0.06, 0.06));
    let mut text = format!(
        "[sled]\nmass_kg = {:?}\nj_yy_kgm2 = {:?}\nj_zz_kgm2 = {:?}\nl_f_m = {:?}\nl_r_m = {:?}\naccel_x_m = {:?}\n\
         accel_y_m = {:?}\naccel_z_m = {:?}\nslip_x_m = {:?}\ncda_m2 = {:?}\nyaw_drag_per_deg = {:?}\n\n\
         [friction.longitudinal]\nmu = {:.6}\n\n",
        sled.mass_kg,
        sled.inertia_kgm2[0],
        sled.inertia_kgm2[1],
        sled.axle_m[0],
        sled.axle_m[1],
        sled.accel_m[0],
        sled.accel_m[1],
        sled.accel_m[2],
        sled.slip_m,
        sled.drag[0],
        sled.drag[1],
        off(sled.mu)
    );
    for (name, [peak, shape, bend, stiffness]) in [("front", sled.grip[0]), ("rear", sled.grip[1])]
    {
        let _ = write!(
            text,
            "[friction.{name}]\nmu_zeta = {:.5}\nc = {shape:?}\ne = {bend:?}\nk_n_per_rad = {:.2}\n\n",
            off(peak),
            off(stiffness)
        );
    }
    text.push_str("[survey]\nslope_sd_rad = 0.0008\n");
    let Some(stated) = wrong.stated.filter(|_| wrong.noise.is_none()) else {
        return text;
    };
    let noise_sd = |channel: usize| NOISE[channel] * stated;
    let _ = write!(
        text,
        "\n[noise]\naccel_mps2 = {:?}\nrate_radps = {:?}\nspeed_mps = {:?}\n\
         slip_rad = {:?}\nsteer_rad = {:?}\nroll_split_rad = {:?}\n",
        noise_sd(0),
        noise_sd(3),
        noise_sd(6),
        noise_sd(7),
        noise_sd(8),
        noise_sd(9)
    );
    text
}
