//! A pressure film between runner and ice: what it shows, and its map as a file.

use exr::prelude::{
    AnyChannel, AnyChannels, AttributeValue, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    SmallVec, Text, WritableImage,
};

use crate::cases::answer::CaseError;
use crate::contact::half_space::{Elastic, Grid};
use crate::world::noise::Source;

/// Radius of the runner's section.
pub const SECTION_M: f64 = 0.005;
/// Length of the waves, where there are any.
const WAVE_LENGTH_M: f64 = 0.05;

/// The world as it is, against the case file.
#[derive(Debug, Clone, Copy)]
pub struct World {
    /// The bodies.
    pub body: Elastic,
    /// Hardness of the ice; infinite where it does not yield.
    pub hardness_pa: f64,
    /// Roll of the runner.
    pub roll_rad: f64,
    /// Pitch of the runner.
    pub pitch_rad: f64,
    /// Rocker radius.
    pub rocker_m: f64,
    /// Depth that wear has taken off.
    pub worn_m: f64,
    /// Amplitude of the waves.
    pub wave_m: f64,
    /// Standard deviation of the blur.
    pub blur_m: f64,
    /// Factor of the readings.
    pub gain: f64,
}

/// The film's pressures under a load on a track.
///
/// Gap of the stated frame: `x^2/(2R) - x^2/(2 r) + section(y) + pitch x - roll y`, with waves
/// `a cos(2 pi x / L)` on the ice or the runner where there are any; a positive pitch lowers the
/// nose (x > 0), a positive roll raises the left (y > 0) side of the runner.
pub fn measure(
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

/// Half axes and approach of Hertz's ellipse for curvatures `along < across`, by bisection on the
/// axes' ratio.
fn hertz_axes(along: f64, across: f64, fz_n: f64, body: &Elastic) -> (f64, f64, f64) {
    let modulus = 1.0
        / ((1.0 - body.poissons_ratio.powi(2)) / body.youngs_modulus_pa
            + body.other_compliance_1ppa);
    // A = 3F/(2 pi E* a^3) I(1), B the same with I(3); I(n) = integral of sin^2 / (k^2 sin^2 +
    // cos^2)^(n/2)
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

/// A map as `pressures.csv` names it: an EXR file with its place, load and track.
///
/// # Errors
/// [`CaseError::Map`] where it cannot be encoded.
pub fn encode(
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
