//! Cases made of pressure measurements: maps solved on the half-space, seen through a film.

use std::fmt::Write as _;

use crate::cases::answer::{Answer, Case, CaseError, Hides};
use crate::cases::film::{SECTION_M, World, encode, measure};
use crate::cases::label::Label;
use crate::contact::half_space::Elastic;
use crate::world::noise::Source;

/// What the measurements hide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Recipe {
    Null,
    Hardness,
    IceModulus,
    RunnerCompliance,
    RollTilt,
    PitchOffset,
    RockerRadius,
    SectionWear,
    Waviness,
    IceThickness,
    SensorBlur,
    SensorGain,
}

/// Names of the hidden cases.
pub const HIDDEN: &[(&str, Recipe)] = &[
    ("hardness", Recipe::Hardness),
    ("ice-modulus", Recipe::IceModulus),
    ("runner-compliance", Recipe::RunnerCompliance),
    ("roll-tilt", Recipe::RollTilt),
    ("pitch-offset", Recipe::PitchOffset),
    ("rocker-radius", Recipe::RockerRadius),
    ("section-wear", Recipe::SectionWear),
    ("waviness", Recipe::Waviness),
    ("ice-thickness", Recipe::IceThickness),
    ("sensor-blur", Recipe::SensorBlur),
    ("sensor-gain", Recipe::SensorGain),
];

const ROCKER_M: f64 = 30.0;
const MODULUS_PA: f64 = 9.0e9;
const POISSON: f64 = 0.33;
const THICKNESS_M: f64 = 0.05;
/// Loads [N] and track radii [m] of the measurements.
const TESTS: [(f64, f64); 4] = [
    (250.0, f64::INFINITY),
    (500.0, f64::INFINITY),
    (1200.0, f64::INFINITY),
    (800.0, 75.0),
];
/// Relative standard deviation of a film's pixel, and of its largest reading.
const PIXEL_SD: f64 = 0.03;
const PEAK_SD: f64 = 0.02;

/// Builds a set of measurements with what the recipe hides, and its answer.
pub fn build(label: &Label, recipe: Recipe, seed: u64) -> Result<Case, CaseError> {
    let source = &mut Source::new(seed, &label.id());
    let mut world = World {
        body: Elastic {
            youngs_modulus_pa: MODULUS_PA,
            poissons_ratio: POISSON,
            other_compliance_1ppa: 0.0,
            thickness_m: THICKNESS_M,
        },
        hardness_pa: f64::INFINITY,
        roll_rad: 0.0,
        pitch_rad: 0.0,
        rocker_m: ROCKER_M,
        worn_m: 0.0,
        wave_m: 0.0,
        blur_m: 0.0,
        gain: 1.0,
    };
    let (size, key, unit, class): (f64, &str, &str, &[&str]) = match recipe {
        Recipe::Null => (0.0, "", "", &[]),
        Recipe::Hardness => {
            world.hardness_pa = source.uniform(65e6, 90e6);
            (1.0 / world.hardness_pa, "inverse_per_pa", "1/Pa", &[])
        }
        Recipe::IceModulus => {
            let factor = if source.sign() > 0.0 {
                source.uniform(1.35, 1.6)
            } else {
                source.uniform(0.55, 0.75)
            };
            world.body.youngs_modulus_pa *= factor;
            (
                world.body.youngs_modulus_pa / MODULUS_PA - 1.0,
                "factor",
                "",
                &["runner-compliance"],
            )
        }
        Recipe::RunnerCompliance => {
            let modulus = source.uniform(20e9, 40e9);
            world.body.other_compliance_1ppa = (1.0 - 0.3 * 0.3) / modulus;
            let ice = (1.0 - POISSON * POISSON) / MODULUS_PA;
            let factor = world.body.other_compliance_1ppa / ice;
            (factor, "factor", "", &["ice-modulus"])
        }
        Recipe::RollTilt => {
            world.roll_rad = source.sign() * source.uniform(0.012, 0.03);
            (world.roll_rad, "angle_rad", "rad", &[])
        }
        Recipe::PitchOffset => {
            world.pitch_rad = source.sign() * source.uniform(0.0002, 0.0006);
            (world.pitch_rad, "angle_rad", "rad", &[])
        }
        Recipe::RockerRadius => {
            world.rocker_m *= if source.sign() > 0.0 {
                source.uniform(1.4, 1.8)
            } else {
                source.uniform(0.55, 0.7)
            };
            (
                1.0 / world.rocker_m - 1.0 / ROCKER_M,
                "curvature_1pm",
                "1/m",
                &[],
            )
        }
        Recipe::SectionWear => {
            world.worn_m = source.uniform(1.2e-6, 2.5e-6);
            (world.worn_m, "depth_m", "m", &[])
        }
        Recipe::Waviness => {
            world.wave_m = source.sign() * source.uniform(0.8e-6, 2.0e-6);
            (world.wave_m, "amplitude_m", "m", &[])
        }
        Recipe::IceThickness => {
            world.body.thickness_m = source.uniform(0.0008, 0.0015);
            (
                1.0 / world.body.thickness_m - 1.0 / THICKNESS_M,
                "inverse_per_m",
                "1/m",
                &[],
            )
        }
        Recipe::SensorBlur => {
            world.blur_m = source.uniform(40e-6, 80e-6);
            (world.blur_m, "width_m", "m", &[])
        }
        Recipe::SensorGain => {
            world.gain = 1.0 + source.sign() * source.uniform(0.12, 0.25);
            (world.gain - 1.0, "factor", "", &[])
        }
    };
    // The maps are exactly in the frame of the runner.
    let mut table = String::from(
        "case,fz_n,radius_m,p_max_pa,p_max_sd_pa,map,map_shift_sd_m,map_rotation_sd_rad\n",
    );
    let mut files = vec![("case.toml".to_owned(), case_file().into_bytes())];
    for (k, (fz_n, radius_m)) in TESTS.into_iter().enumerate() {
        let (grid, film) = measure(&world, fz_n, radius_m, source)?;
        let peak = film.iter().copied().fold(0.0, f64::max);
        // the film's own peak reading, before the noise of single pixels
        let read = peak * (1.0 + PEAK_SD * source.normal());
        let noisy: Vec<f64> = film
            .iter()
            .map(|p| (p * (1.0 + PIXEL_SD * source.normal()) + 0.3e6 * source.normal()).max(0.0))
            .collect();
        let name = format!("map_{}.exr", k + 1);
        files.push((name.clone(), encode(&name, &grid, &noisy, fz_n, radius_m)?));
        let radius = if radius_m.is_finite() {
            radius_m.to_string()
        } else {
            "inf".to_owned()
        };
        let _ = writeln!(
            table,
            "case.toml,{fz_n},{radius},{read:.0},{:.0},{name},0,0",
            PEAK_SD * peak
        );
    }
    files.push(("pressures.csv".to_owned(), table.into_bytes()));
    let hides = if recipe == Recipe::Null {
        Vec::new()
    } else {
        vec![Hides {
            effect: label.name.clone(),
            class: class.iter().map(|name| (*name).to_owned()).collect(),
            key: key.to_owned(),
            size,
            unit: unit.to_owned(),
            share: f64::NAN,
            places: Vec::new(),
        }]
    };
    Ok(Case {
        files,
        fresh: Vec::new(),
        answer: Answer {
            family: label.family.to_owned(),
            name: label.name.clone(),
            wanted_share: None,
            seed,
            data: "pressures.csv".to_owned(),
            model: Some("case.toml".to_owned()),
            hides,
            tolerated: Vec::new(),
            too_little_to_name: false,
            base: Vec::new(),
        },
    })
}

fn case_file() -> String {
    format!(
        "[runner]\nshape = {{ kind = \"paraboloid\", rocker_radius_m = {ROCKER_M:?}, section_radius_m = {SECTION_M:?} }}\n\
         elastic = false\nyoungs_modulus_pa = 210e9\npoissons_ratio = 0.30\n\n\
         [ice]\nyoungs_modulus_pa = {MODULUS_PA:?}\npoissons_ratio = {POISSON:?}\nthickness_m = {THICKNESS_M:?}\n\n\
         [track]\nradius_m = inf\n\n\
         [load]\nfz_n = 1000.0\noffset_x_m = 0.0\noffset_y_m = 0.0\ntilt = \"fixed\"\npitch_rad = 0.0\nroll_rad = 0.0\n\n\
         [accuracy]\np_max = 0.01\n"
    )
}
