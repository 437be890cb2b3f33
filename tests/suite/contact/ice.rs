//! Ice as it is: on concrete, wavy, or measured.

use std::f64::consts::PI;
use std::process::Command;
use std::sync::Arc;

use kufe_contact::{
    Bed, Foundation, Load, Options, PressureMap, Problem, Solution, Tilt, hertz, solve,
};
use kufe_mesh::{BobRunner, HeightMap, IceSurface, Paraboloid, Underside, Waviness};
use kufe_tests::contact::{ICE_E, ICE_NU, contact_modulus, on_half_space};
use kufe_tests::exact_response::by_exact_responses;

const CONCRETE: Bed = Bed {
    youngs_modulus: 30e9,
    poissons_ratio: 0.2,
    thickness: 0.020,
};

fn on_bed(radius: f64, thickness: f64, bed: Bed) -> Problem {
    let mut problem = on_half_space(Paraboloid::new(radius, radius).unwrap(), 1000.0);
    problem.ice.foundation = Foundation::ElasticBed { thickness, bed };
    problem
}

fn solved(problem: &Problem, p_max_tolerance: f64) -> Solution {
    let options = Options {
        p_max_tolerance,
        ..Options::default()
    };
    solve(problem, &options).unwrap()
}

/// Contact radius [m], approach [m] and peak pressure [Pa] by Hankel transforms, where SciPy is at
/// hand.
fn by_transforms(thickness: f64, bed: Bed) -> Option<[f64; 3]> {
    let interpreter = kufe_outside::python("scipy")?;
    let numbers = [
        1.0,
        1000.0,
        ICE_E,
        ICE_NU,
        thickness,
        bed.youngs_modulus,
        bed.poissons_ratio,
        bed.thickness,
    ];
    let output = Command::new(interpreter)
        .arg(concat!(env!("CARGO_MANIFEST_DIR"), "/data/layered.py"))
        .args(numbers.map(|n| n.to_string()))
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    let words: Vec<f64> = said
        .split_whitespace()
        .map(|w| w.parse().unwrap())
        .collect();
    Some([words[0], words[1], words[2]])
}

/// The truth is a sum of Bessel functions over wave numbers, no mesh: tests/data/layered.py.
#[test]
fn ice_on_concrete_agrees_with_hankel_transforms_within_three_tenths_of_a_percent() {
    let soft = Bed {
        youngs_modulus: 3e9,
        poissons_ratio: 0.45,
        thickness: 0.010,
    };
    for (thickness, bed) in [(0.004, CONCRETE), (0.001, CONCRETE), (0.004, soft)] {
        let Some([radius, approach, p_max]) = by_transforms(thickness, bed) else {
            return;
        };
        let s = solved(&on_bed(1.0, thickness, bed), 0.003);
        // The rim is found on the parabola of p^2, which a contact wider than the layer leaves by a
        // third of a cell.
        for (found, expected, tolerance) in [
            (s.p_max, p_max, 0.003),
            (s.approach, approach, 0.003),
            (0.5 * s.length, radius, 0.03),
        ] {
            assert!(
                (found / expected - 1.0).abs() < tolerance,
                "{found:.5e} against {expected:.5e}, ice {thickness} m on {bed:?}"
            );
        }
        assert!(s.iterations <= 60, "{} iterations", s.iterations);
    }
}

#[test]
fn ice_on_a_bed_of_ice_is_one_layer() {
    let own = Bed {
        youngs_modulus: ICE_E,
        poissons_ratio: ICE_NU,
        thickness: 0.006,
    };
    let two = solved(&on_bed(1.0, 0.004, own), 0.003);
    let mut problem = on_bed(1.0, 0.004, own);
    problem.ice.foundation = Foundation::RigidBed { thickness: 0.010 };
    let one = solved(&problem, 0.003);
    assert!((two.p_max / one.p_max - 1.0).abs() < 0.002);
    assert!((two.approach / one.approach - 1.0).abs() < 0.002);
}

#[test]
fn layers_have_the_forces_of_exact_responses_by_cholesky() {
    let found = by_exact_responses(&on_bed(1.0, 0.004, CONCRETE), 4);
    assert!(found.force < 1e-6 && found.motion < 1e-6);
}

/// Waves that press with their crests alone (H. M. Westergaard, J. Appl. Mech. 6 (1939) 49-53; K.
/// L. Johnson, Contact Mechanics, section 13.2): with the mean pressure p over a wave and p* = pi
/// E* amplitude / wavelength, sin^2(pi c / wavelength) = p / p* for the half-length c of each
/// contact, and p_max = 2 sqrt(p p*).
#[test]
fn wavy_ice_meets_westergaards_partial_contact() {
    let (wavelength, amplitude, radius, force) = (1e-3, 2.5e-6, 1.0, 1000.0);
    let mut problem = on_half_space(Paraboloid::new(radius, radius).unwrap(), force);
    problem.ice_surface = Some(Arc::new(Waviness::new(amplitude, wavelength).unwrap()));
    let options = Options {
        cells: Some(16),
        ..Options::default()
    };
    let s = solve(&problem, &options).unwrap();
    let (x, nx) = (&s.surface.x, s.surface.x.len());
    let row = s.surface.y.iter().position(|y| *y == 0.0).unwrap() * nx;
    let pressure = &s.surface.pressure[row..row + nx];
    let touching: Vec<f64> = (0..nx)
        .filter(|&i| x[i].abs() < 0.5 * wavelength && pressure[i] > 0.0)
        .map(|i| x[i])
        .collect();
    let mean = (1..nx)
        .filter(|&i| x[i].max(-x[i - 1]) <= 0.5 * wavelength)
        .map(|i| 0.5 * (pressure[i] + pressure[i - 1]) * (x[i] - x[i - 1]))
        .sum::<f64>()
        / wavelength;
    let full = PI * contact_modulus() * amplitude / wavelength;
    let half_length = wavelength / PI * (mean / full).sqrt().asin();
    let found = touching[touching.len() - 1];
    assert!((s.p_max / (2.0 * (mean * full).sqrt()) - 1.0).abs() < 0.01);
    // Told by the outermost node, so to the spacing of nodes.
    assert!((found / half_length - 1.0).abs() < 0.08);
}

/// A measured surface that holds the same waves gives the same contact.
#[test]
fn waves_as_a_height_map_press_like_waves_as_a_formula() {
    let waves = Waviness::new(2e-6, 0.04).unwrap();
    let shape = [401, 3];
    let (origin, spacing) = ([-0.2, -0.01], [1e-3, 0.01]);
    let heights = (0..shape[0] * shape[1])
        .map(|k| waves.height(origin[0] + spacing[0] * (k % shape[0]) as f64, 0.0))
        .collect();
    let map = HeightMap::new(origin, spacing, shape, heights).unwrap();
    let pressed = |surface: Arc<dyn IceSurface>| {
        let mut problem = on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1000.0);
        problem.ice_surface = Some(surface);
        solved(&problem, 0.005)
    };
    let (formula, measured) = (pressed(Arc::new(waves)), pressed(Arc::new(map)));
    assert!(
        (measured.p_max / formula.p_max - 1.0).abs() < 0.002,
        "{} {}",
        measured.p_max,
        formula.p_max
    );
    // A crest under the load: more curvature, more pressure than on even ice.
    let even = hertz(30.0, 0.005, contact_modulus(), 1000.0).unwrap().p_max;
    assert!(formula.p_max > 1.02 * even, "{} {even}", formula.p_max);
}

/// Height of a hull's ends of 1 m radius beyond 80 mm [m].
fn ends(x: f64) -> f64 {
    0.5 * (x.abs() - 0.08).max(0.0).powi(2)
}

/// A straight keel with ends of 1 m radius, section radius 5 mm.
struct Straight;

impl Underside for Straight {
    fn height(&self, x: f64, y: f64) -> f64 {
        y * y / 0.01 + ends(x)
    }
    fn extent(&self) -> [f64; 4] {
        [-0.3, 0.3, -0.005, 0.005]
    }
    fn mirror_symmetric(&self) -> [bool; 2] {
        [true, true]
    }
}

/// Ice that falls off where that hull's ends rise.
struct Falling;

impl IceSurface for Falling {
    fn height(&self, x: f64, _: f64) -> f64 {
        -ends(x)
    }
    fn mirror_symmetric(&self) -> [bool; 2] {
        [true, true]
    }
}

#[test]
fn a_corner_of_the_ice_is_heeded_like_one_of_the_hull() {
    let hull = solved(&on_half_space(Straight, 1000.0), 0.003);
    let mut problem = on_half_space(Paraboloid::new(f64::INFINITY, 0.005).unwrap(), 1000.0);
    problem.ice_surface = Some(Arc::new(Falling));
    let ice = solved(&problem, 0.003);
    let stated = hull.p_max_error + ice.p_max_error;
    assert!(
        (hull.p_max - ice.p_max).abs() <= stated,
        "{} {} {stated}",
        hull.p_max,
        ice.p_max
    );
}

/// The root of a rising function between two places.
fn root(rising: impl Fn(f64) -> f64, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if rising(middle) < 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// A runner as bent as its track on 17 crests of ice, loaded off its middle: each crest is Hertz's
/// contact under its part of approach and pitch, and those balance force and moment. Scouting sees
/// some of the crests, and those late are more than can be taken up one a solve.
#[test]
fn a_runner_on_many_crests_presses_each_by_its_part_of_approach_and_pitch() {
    let (fz, offset_x, amplitude, wavelength) = (500.0, 0.02, 5e-5, 0.03);
    let bob = BobRunner {
        length: 0.6,
        ..BobRunner::default()
    };
    let mut problem = on_half_space(bob.swept().unwrap(), fz);
    problem.track_curvature = 1.0 / bob.rocker_radius;
    problem.ice_surface = Some(Arc::new(Waviness::new(amplitude, wavelength).unwrap()));
    problem.load = Load::Force {
        fz,
        offset_x,
        offset_y: 0.0,
        tilt: Tilt::Free,
    };
    let s = solved(&problem, 0.05);

    let crest = (wavelength / (2.0 * PI)).powi(2) / amplitude;
    let of = |force: f64| hertz(crest, bob.section_radius, contact_modulus(), force).unwrap();
    let stiffness = of(1.0).approach.powf(-1.5);
    let crests: Vec<f64> = (-8..=8).map(|k| wavelength * f64::from(k)).collect();
    let force = |x: f64, [d, pitch]: [f64; 2]| stiffness * (d + pitch * x).max(0.0).powf(1.5);
    let sum = |motion: [f64; 2], lever: &dyn Fn(f64) -> f64| -> f64 {
        crests.iter().map(|&x| lever(x) * force(x, motion)).sum()
    };
    let depth = |pitch: f64| root(|d| sum([d, pitch], &|_| 1.0) - fz, [0.0, 1e-4]);
    let pitch = root(
        |pitch| sum([depth(pitch), pitch], &|x| x - offset_x),
        [0.0, 1e-4],
    );
    let peak = of(force(crests[16], [depth(pitch), pitch])).p_max;
    println!(
        "{:e} +- {:e}, Hertz {peak:e}; pitch {} {pitch}",
        s.p_max, s.p_max_error, s.pitch
    );
    // What crests sink by one another's loads is left out: 30 mm beside each other under contacts
    // of 2 mm, half a per cent.
    assert!((s.p_max - peak).abs() < s.p_max_error + 0.005 * peak);
    assert!((s.pitch / pitch - 1.0).abs() < 0.03, "{} {pitch}", s.pitch);
    // Every crest is pressed, and nothing between them.
    let touched = |x: f64| {
        let near = s
            .surface
            .x
            .iter()
            .enumerate()
            .filter(|(_, at)| (*at - x).abs() < 1e-3);
        let nx = s.surface.x.len();
        near.flat_map(|(i, _)| s.surface.pressure.iter().skip(i).step_by(nx))
            .any(|p| *p > 0.0)
    };
    for x in &crests {
        assert!(touched(*x), "nothing at {x}");
        assert!(
            !touched(x + 0.5 * wavelength),
            "contact at {}",
            x + 0.5 * wavelength
        );
    }
}

/// Width where ice yields all across, by its force: a strip of the plane bears H times its width,
/// whatever nodes lie beside the rim. Over an ellipse of this length all strips give that of the
/// middle one; a single strip has it to a cell.
fn width_by_strips(s: &Solution) -> f64 {
    let f = &s.surface;
    let nx = f.x.len();
    let part = |j: usize| 0.5 * (f.y[j + 1] - f.y[j - 1]);
    let strips: Vec<f64> = (0..nx)
        .filter(|&i| f.x[i].abs() < 0.25 * s.length)
        .map(|i| {
            let force = (1..f.y.len() - 1).map(|j| f.pressure[j * nx + i] * part(j));
            let width = force.sum::<f64>() / s.bound();
            width / (1.0 - (2.0 * f.x[i] / s.length).powi(2)).sqrt()
        })
        .collect();
    strips.iter().sum::<f64>() / strips.len() as f64
}

/// A rim half-way between nodes is off by up to half a cell at either side, one in nine to one in
/// fifteen of these widths.
#[test]
fn the_width_of_ice_that_yields_is_that_of_its_force_and_of_the_map() {
    for (section, hardness) in [(0.005, 20e6), (0.005, 40e6), (0.004, 30e6), (0.01, 15e6)] {
        let mut problem = on_half_space(Paraboloid::new(30.0, section).unwrap(), 1000.0);
        problem.ice.hardness = Some(hardness);
        let fine = Options {
            cells: Some(28),
            ..Options::default()
        };
        let width = width_by_strips(&solve(&problem, &fine).unwrap());
        for tolerance in [0.02, 0.005] {
            let s = solved(&problem, tolerance);
            let map = PressureMap::of(&s);
            let touches = |j: &usize| {
                let row = &map.pressure[j * map.nx..(j + 1) * map.nx];
                row.iter().any(|p| *p > 0.0)
            };
            let by_map = (0..map.ny).filter(touches).count() as f64 * map.dy;
            let said = format!(
                "{section} {hardness:e} {tolerance}: {:.4e} +- {:.1e}, {width:.4e} by its force, {by_map:.4e} by the map",
                s.width, s.width_error
            );
            let off = (s.width - width).abs();
            assert!(off < 0.03 * width && off < s.width_error, "{said}");
            assert!(s.width_error < 0.07 * width, "{said}");
            assert!((by_map - s.width).abs() < s.width_error, "{said}");
        }
    }
}
