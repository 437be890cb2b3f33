//! Contacts much smaller than the hull, on measured surfaces.

use std::sync::Arc;

use kufe_contact::{
    BoundaryElements, CheckUnavailable, Load, Options, Problem, Solution, Tilt, boundary_elements,
    hertz, solve,
};
use kufe_mesh::{FittedUnderside, HeightMap, Hull, Paraboloid, Rocker, Section, Swept, Underside};
use kufe_tests::contact::{contact_modulus, on_half_space};

const ROCKER: f64 = 30.0;
const SECTION: f64 = 0.005;
/// Radius at which the bell of a wart or grain falls to 1 / e [m].
const WIDTH: f64 = 0.3e-3;

/// Points from `low` to `high` with a spacing of a tenth of [`WIDTH`] at `at`, increasing with the
/// distance from it.
fn line(low: f64, high: f64, at: f64) -> Vec<f64> {
    let away = |end: f64| {
        let mut places = vec![0.0];
        while places[places.len() - 1] < end {
            let last = places[places.len() - 1];
            let step = (0.3 * (last - 4.0 * WIDTH)).clamp(0.1 * WIDTH, 0.005);
            places.push(last + step);
        }
        places
    };
    let before = away(at - low).into_iter().rev().map(|d| at - d);
    before
        .chain(away(high - at).into_iter().skip(1).map(|d| at + d))
        .collect()
}

/// A triangulated paraboloid with a bell at (x, y), whose tip is `deeper` [m] below the lowest point
/// of the paraboloid.
fn with_wart([x, y]: [f64; 2], deeper: f64) -> Hull {
    let smooth = |x: f64, y: f64| x * x / (2.0 * ROCKER) + y * y / (2.0 * SECTION);
    let height = smooth(x, y) + deeper;
    let (xs, ys) = (line(-0.5, 0.52, x), line(-0.004, 0.0042, y));
    let (nx, ny) = (xs.len(), ys.len());
    let positions = (0..nx * ny).map(|k| {
        let [px, py] = [xs[k % nx], ys[k / nx]];
        let away = ((px - x).powi(2) + (py - y).powi(2)) / (WIDTH * WIDTH);
        [px, py, smooth(px, py) - height * (-away).exp()]
    });
    let cell = |k: usize| {
        let [a, b, c, d] = [k, k + 1, k + 1 + nx, k + nx].map(|n| n as u32);
        [[a, c, b], [a, d, c]]
    };
    Hull {
        positions: positions.collect(),
        triangles: (0..nx * (ny - 1))
            .filter(|k| k % nx + 1 < nx)
            .flat_map(cell)
            .collect(),
    }
}

fn level(underside: impl Underside + 'static) -> Problem {
    let mut problem = on_half_space(underside, 1000.0);
    problem.load = Load::central(1000.0, Tilt::LEVEL);
    problem
}

fn solved(problem: &Problem) -> (Solution, Result<BoundaryElements, CheckUnavailable>) {
    let options = Options {
        p_max_tolerance: 0.02,
        ..Options::default()
    };
    (
        solve(problem, &options).unwrap(),
        boundary_elements(problem),
    )
}

/// Approach of the second of two Hertz contacts with these radii, and both peaks. The second is
/// `deeper` [m] than the first; together they carry 1000 N.
fn two_contacts(radii: [[f64; 2]; 2], deeper: f64) -> (f64, [f64; 2]) {
    let stiffness = radii.map(|[a, b]| {
        let one = hertz(a.max(b), a.min(b), contact_modulus(), 1.0).unwrap();
        one.approach.powf(-1.5)
    });
    let forces = |depth: f64| {
        let depths = [(depth - deeper).max(0.0), depth];
        [0, 1].map(|k| stiffness[k] * depths[k].powf(1.5))
    };
    let (mut low, mut high) = (0.0, 1e-3);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if forces(middle).iter().sum::<f64>() < 1000.0 {
            low = middle
        } else {
            high = middle
        }
    }
    let peaks = [0, 1].map(|k| {
        let [a, b] = radii[k];
        let force = forces(high)[k].max(1e-12);
        hertz(a.max(b), a.min(b), contact_modulus(), force)
            .unwrap()
            .p_max
    });
    (high, peaks)
}

/// A wart of 0.6 mm next to the keel of a hull 1 m long, missed by equidistant lines. Reference: two
/// Hertz contacts; the bell differs from a sphere of its curvature by 2 % of the peak.
#[test]
fn wart_next_to_the_keel_within_2_percent_of_two_hertz_contacts() {
    let at = [0.1013, 0.0008];
    let hull = FittedUnderside::new(&with_wart(at, 3e-6), 0.0).unwrap();
    let (s, second) = solved(&level(hull));
    let height = at[0] * at[0] / (2.0 * ROCKER) + at[1] * at[1] / (2.0 * SECTION) + 3e-6;
    let round = 0.5 * WIDTH * WIDTH / height;
    // The slope of the paraboloid shifts the lowest point of the wart and lowers it.
    let slopes = (at[0] / ROCKER).powi(2) + (at[1] / SECTION).powi(2);
    let (approach, [_, peak]) = two_contacts(
        [[ROCKER, SECTION], [round, round]],
        3e-6 + 0.5 * round * slopes,
    );
    assert!(
        (s.p_max / peak - 1.0).abs() < 0.02,
        "{:e} {peak:e}",
        s.p_max
    );
    assert!(
        (s.approach / approach - 1.0).abs() < 0.02,
        "{:e} {approach:e}",
        s.approach
    );
    // The wart is outside the grid of the boundary elements.
    assert_eq!(second, Err(CheckUnavailable::Elsewhere));
}

/// A grain of 0.6 mm in a height map of the ice.
#[test]
fn grain_on_measured_ice_within_2_percent_of_two_hertz_contacts() {
    let (at, step) = ([0.1013, 0.0], [0.1 * WIDTH, 0.1 * WIDTH]);
    let height = at[0] * at[0] / (2.0 * ROCKER) + 3e-6;
    let shape = [81, 81];
    let origin = [0, 1].map(|axis| at[axis] - 40.0 * step[axis]);
    let heights = (0..shape[0] * shape[1]).map(|k| {
        let [x, y] = [k % 81, k / 81].map(|i| (i as f64 - 40.0) * step[0]);
        height * (-(x * x + y * y) / (WIDTH * WIDTH)).exp()
    });
    let map = HeightMap::new(origin, step, shape, heights.collect());
    let mut problem = level(
        Swept::new(
            Rocker::arc(ROCKER).unwrap(),
            Section::arc(SECTION, 0.008).unwrap(),
            None,
            1.0,
            0.03,
        )
        .unwrap(),
    );
    problem.ice_surface = Some(Arc::new(map.unwrap()));
    let (s, second) = solved(&problem);
    let top = 2.0 * height / (WIDTH * WIDTH);
    let grain = [1.0 / (top + 1.0 / ROCKER), 1.0 / (top + 1.0 / SECTION)];
    let slopes = (at[0] / ROCKER).powi(2);
    let (_, [_, peak]) = two_contacts([[ROCKER, SECTION], grain], 3e-6 + 0.5 * grain[0] * slopes);
    assert!(
        (s.p_max / peak - 1.0).abs() < 0.02,
        "{:e} {peak:e}",
        s.p_max
    );
    assert_eq!(second, Err(CheckUnavailable::Elsewhere));
    // Also under an unbounded hull, which has no lines to search.
    problem.runner = level(Paraboloid::new(ROCKER, SECTION).unwrap()).runner;
    let (unbounded, _) = solved(&problem);
    let off = (unbounded.p_max / s.p_max - 1.0).abs();
    assert!(off < 0.02, "{:e} {:e}", unbounded.p_max, s.p_max);
}

/// A burr of 0.06 mm along the whole runner, 2.5 mm from the middle and 3 µm deeper.
#[test]
fn burr_along_a_measured_section_carries_load() {
    let (at, width) = (2.525e-3, 0.03e-3);
    let height = at * at / (2.0 * SECTION) + 3e-6;
    let bell = |y: f64| height * (-((y - at) / width).powi(2)).exp();
    let mut ys: Vec<f64> = (-80..=80).map(|i| 5e-5 * f64::from(i)).collect();
    ys.extend((-60..=60).map(|i| at + 0.1 * width * f64::from(i)));
    ys.sort_by(f64::total_cmp);
    ys.dedup_by(|b, a| *b - *a < 1e-7);
    let points: Vec<[f64; 2]> = ys
        .iter()
        .map(|&y| [y, y * y / (2.0 * SECTION) - bell(y)])
        .collect();
    let runner = Swept::new(
        Rocker::arc(ROCKER).unwrap(),
        Section::points(&points).unwrap(),
        None,
        1.0,
        0.03,
    );
    let (s, second) = solved(&level(runner.unwrap()));
    // Hertz peak if the burr carried the whole load; the keel carries a part of it.
    let round = 0.5 * width * width / height;
    let alone = hertz(ROCKER, round, contact_modulus(), 1000.0)
        .unwrap()
        .p_max;
    assert!(
        (0.5..1.0).contains(&(s.p_max / alone)),
        "{:e} {alone:e}",
        s.p_max
    );
    assert!(s.width > 2.5e-3, "{}", s.width);
    assert_eq!(second, Err(CheckUnavailable::Elsewhere));
}
