//! Cases made of pressure measurements: maps solved on the half-space, seen through a film.

use std::fmt::Write as _;

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    SmallVec, Text, WritableImage,
};

use crate::answer::{Answer, Case, CaseError, Hides};
use crate::catalogue::Spec;
use crate::half_space::{Elastic, Grid};
use crate::noise::Source;

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
const SECTION_M: f64 = 0.005;
const MODULUS_PA: f64 = 9.0e9;
const POISSON: f64 = 0.33;
const THICKNESS_M: f64 = 0.05;
/// Length of the waves, where there are any.
const WAVE_LENGTH_M: f64 = 0.05;
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

/// The world as it is, against the case file.
#[derive(Debug, Clone, Copy)]
struct World {
    body: Elastic,
    hardness_pa: f64,
    roll_rad: f64,
    pitch_rad: f64,
    rocker_m: f64,
    worn_m: f64,
    wave_m: f64,
    blur_m: f64,
    gain: f64,
}

/// Builds a set of measurements with what the recipe hides, and its answer.
pub fn build(spec: &Spec, recipe: Recipe, seed: u64) -> Result<Case, CaseError> {
    let source = &mut Source::new(seed, &spec.id());
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
    let mut table = String::from("case,fz_n,radius_m,p_max_pa,p_max_sd_pa,map\n");
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
            "case.toml,{fz_n},{radius},{read:.0},{:.0},{name}",
            PEAK_SD * peak
        );
    }
    files.push(("pressures.csv".to_owned(), table.into_bytes()));
    let hides = if recipe == Recipe::Null {
        Vec::new()
    } else {
        vec![Hides {
            effect: spec.name.clone(),
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
        answer: Answer {
            family: spec.family.to_owned(),
            name: spec.name.clone(),
            wanted_share: None,
            seed,
            data: "pressures.csv".to_owned(),
            model: "case.toml".to_owned(),
            hides,
            tolerated: Vec::new(),
            too_little_to_name: false,
            base: Vec::new(),
        },
    })
}

/// The film's pressures under a load on a track.
///
/// Gap of the stated frame: `x^2/(2R) - x^2/(2 r) + section(y) + pitch x - roll y`, with waves
/// `a cos(2 pi x / L)` on the ice or the runner where there are any; a positive pitch lowers the nose (x > 0), a positive roll raises the left (y > 0) side of the runner.
fn measure(
    world: &World,
    fz_n: f64,
    radius_m: f64,
    source: &mut Source,
) -> Result<(Grid, Vec<f64>), CaseError> {
    let along = 1.0 / world.rocker_m - 1.0 / radius_m;
    let contact_x = world.pitch_rad / along;
    let contact_y = -world.roll_rad * SECTION_M;
    let (a, b, approach) = hertz_axes(along, 1.0 / SECTION_M, fz_n, &world.body);
    let cap = if world.hardness_pa.is_finite() {
        1.5
    } else {
        1.0
    };
    let (mut width, mut height) = (3.0 * a * cap, 3.2 * b * cap);
    if world.body.thickness_m < 0.01 {
        width *= 0.9;
        height *= 1.15;
    }
    if world.worn_m > 0.0 {
        height += 2.0 * (2.0 * SECTION_M * world.worn_m).sqrt();
    }
    if world.wave_m != 0.0 {
        width *= 1.5;
    }
    height += 6.0 * world.blur_m;
    let jitter = (source.uniform(-0.4, 0.4), source.uniform(-0.4, 0.4));
    let (nx, ny) = (64, 64);
    let grid = Grid::around(
        contact_x + jitter.0 * width / nx as f64,
        contact_y + jitter.1 * height / ny as f64,
        width,
        height,
        nx,
        ny,
    );
    let gap: Vec<f64> = grid
        .centres()
        .map(|(x, y)| {
            let section = (SECTION_M - (SECTION_M.powi(2) - y * y).sqrt() + world.roll_rad * y)
                .max(world.worn_m + worn_floor(world.roll_rad));
            let wave = world.wave_m * (std::f64::consts::TAU * x / WAVE_LENGTH_M).cos();
            0.5 * along * x * x - world.pitch_rad * x + section + wave
        })
        .collect();
    let mut p = grid.press(
        &grid.kernel(&world.body),
        &gap,
        fz_n,
        world.hardness_pa,
        approach,
    )?;
    if world.blur_m > 0.0 {
        p = blur(&grid, &p, world.blur_m);
    }
    p.iter_mut().for_each(|p| *p *= world.gain);
    Ok((grid, p))
}

/// Height of the lowest point of a tilted round section, which wear flattens from below.
fn worn_floor(roll_rad: f64) -> f64 {
    SECTION_M * (1.0 - (1.0 + roll_rad * roll_rad).sqrt())
}

/// Half axes and approach of Hertz's ellipse for curvatures `along < across`, by bisection on the axes' ratio.
fn hertz_axes(along: f64, across: f64, fz_n: f64, body: &Elastic) -> (f64, f64, f64) {
    let modulus = 1.0
        / ((1.0 - body.poissons_ratio.powi(2)) / body.youngs_modulus_pa
            + body.other_compliance_1ppa);
    // A = 3F/(2 pi E* a^3) I(1), B the same with I(3); I(n) = integral of sin^2 / (k^2 sin^2 + cos^2)^(n/2)
    let integral = |k: f64, power: i32| {
        let n = 4000;
        let h = std::f64::consts::FRAC_PI_2 / f64::from(n);
        (0..n)
            .map(|i| {
                let (s, c) = ((f64::from(i) + 0.5) * h).sin_cos();
                h * s * s / (k * k * s * s + c * c).sqrt().powi(power)
            })
            .sum::<f64>()
    };
    let ratio = |k: f64| integral(k, 1) / integral(k, 3);
    let (mut low, mut high) = (1e-3, 1.0);
    let wanted = along / across;
    for _ in 0..40 {
        let middle: f64 = f64::sqrt(low * high);
        if ratio(middle) < wanted {
            low = middle
        } else {
            high = middle
        }
    }
    let k: f64 = f64::sqrt(low * high);
    let a = (3.0 * fz_n * integral(k, 1) / (std::f64::consts::PI * modulus * along)).cbrt();
    // approach = 3F/(2 pi E* a) times the integral of 1 / sqrt(k^2 sin^2 + cos^2)
    let n = 4000;
    let h = std::f64::consts::FRAC_PI_2 / f64::from(n);
    let around: f64 = (0..n)
        .map(|i| {
            let (s, c) = ((f64::from(i) + 0.5) * h).sin_cos();
            h / (k * k * s * s + c * c).sqrt()
        })
        .sum();
    (
        a,
        k * a,
        1.5 * fz_n * around / (std::f64::consts::PI * modulus * a),
    )
}

/// A film's blur: Gaussian along both axes.
fn blur(grid: &Grid, p: &[f64], sigma_m: f64) -> Vec<f64> {
    let pass = |field: &[f64],
                cell: f64,
                count: usize,
                stride: usize,
                others: usize,
                other_stride: usize| {
        let reach = (4.0 * sigma_m / cell).ceil() as isize;
        let weights: Vec<f64> = (-reach..=reach)
            .map(|d| (-0.5 * (d as f64 * cell / sigma_m).powi(2)).exp())
            .collect();
        let total: f64 = weights.iter().sum();
        let mut out = vec![0.0; field.len()];
        for o in 0..others {
            for i in 0..count {
                let mut sum = 0.0;
                for (w, d) in weights.iter().zip(-reach..=reach) {
                    let j = i as isize + d;
                    if (0..count as isize).contains(&j) {
                        sum += w * field[j as usize * stride + o * other_stride];
                    }
                }
                out[i * stride + o * other_stride] = sum / total;
            }
        }
        out
    };
    let along = pass(p, grid.dx_m, grid.nx, 1, grid.ny, grid.nx);
    pass(&along, grid.dy_m, grid.ny, grid.nx, grid.nx, 1)
}

fn encode(
    name: &str,
    grid: &Grid,
    p: &[f64],
    fz_n: f64,
    radius_m: f64,
) -> Result<Vec<u8>, CaseError> {
    let mut attributes = LayerAttributes::default();
    for (key, value) in [
        ("origin_x_m", grid.x0_m),
        ("origin_y_m", grid.y0_m),
        ("pixel_x_m", grid.dx_m),
        ("pixel_y_m", grid.dy_m),
        ("fz_n", fz_n),
        ("radius_m", radius_m),
        ("curvature_1pm", 1.0 / radius_m),
    ] {
        attributes
            .other
            .insert(Text::from(key), AttributeValue::F64(value));
    }
    let samples: Vec<f32> = p.iter().map(|p| *p as f32).collect();
    let channels = AnyChannels::sort(smallvec_one(AnyChannel::new(
        "p",
        FlatSamples::F32(samples),
    )));
    let layer = Layer::new(
        (grid.nx, grid.ny),
        attributes,
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|source| CaseError::Map {
            name: name.to_owned(),
            source,
        })?;
    Ok(bytes.into_inner())
}

fn smallvec_one<T>(item: T) -> SmallVec<[T; 4]> {
    let mut items = SmallVec::new();
    items.push(item);
    items
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
