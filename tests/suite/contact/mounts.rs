//! Elastic runners on their mounts, against exact responses, beams on an elastic foundation and the
//! balance of forces.

use std::f64::consts::PI;
use std::sync::Arc;

use kufe_contact::{
    ElasticRunner, Foundation, Ice, Load, LoadedPlace, Mount, Options, Place, Problem, Runner,
    Solution, Tilt, solve,
};
use kufe_fem::{Body, ElementKind, Material, assemble};
use kufe_mesh::{BobRunner, LugeSteel, Underside};
use kufe_tests::contact::{Formula, ICE_E, ICE_NU};
use kufe_tests::exact_response::by_exact_responses;

const STEEL: (f64, f64) = (210e9, 0.3);

fn pressed(underside: Arc<dyn Underside>, elastic: ElasticRunner, ice: Ice, load: Load) -> Problem {
    let runner = Runner {
        underside,
        elastic: Some(elastic),
    };
    Problem::new(runner, ice, load)
}

fn steel(top: f64, mount: Mount) -> ElasticRunner {
    ElasticRunner {
        mount,
        ..ElasticRunner::fixed_at_top(STEEL.0, STEEL.1, top)
    }
}

fn ice(foundation: Foundation) -> Ice {
    Ice {
        foundation,
        ..Ice::half_space(ICE_E, ICE_NU)
    }
}

fn force(fz: f64, offset_x: f64, tilt: Tilt) -> Load {
    Load::Force {
        fz,
        offset_x,
        offset_y: 0.0,
        tilt,
    }
}

fn fixed(places: &[(f64, f64)]) -> Mount {
    Mount::Places(
        places
            .iter()
            .map(|&(x, length)| Place { x, length })
            .collect(),
    )
}

fn carried(places: &[(f64, f64, f64)]) -> Mount {
    Mount::Loads(
        places
            .iter()
            .map(|&(x, length, share)| LoadedPlace {
                place: Place { x, length },
                share,
            })
            .collect(),
    )
}

fn at(cells: usize) -> Options {
    Options {
        cells: Some(cells),
        residual: 1e-11,
        ..Options::default()
    }
}

/// A short runner, which limits the time of the exact responses.
fn short_bob() -> (Arc<dyn Underside>, f64) {
    let bob = BobRunner {
        length: 0.3,
        rocker_radius: 8.0,
        height: 0.02,
        ..BobRunner::default()
    };
    (Arc::new(bob.swept().unwrap()), bob.height)
}

#[test]
fn forces_of_every_mount_agree_with_exact_responses_to_1e_6() {
    let (hull, top) = short_bob();
    let mounts = [
        (Mount::Top, 0.0, Tilt::LEVEL),
        (fixed(&[(-0.08, 0.02), (0.08, 0.02)]), 0.0, Tilt::LEVEL),
        (fixed(&[(-0.08, 0.02), (0.03, 0.01)]), 0.0, Tilt::Free),
        (
            carried(&[(-0.08, 0.02, 0.5), (0.08, 0.02, 0.5)]),
            0.0,
            Tilt::Free,
        ),
        (
            carried(&[(-0.1, 0.02, 0.4), (0.05, 0.02, 0.6)]),
            -0.01,
            Tilt::Free,
        ),
    ];
    for (mount, offset, tilt) in mounts {
        let load = force(800.0, offset, tilt);
        let foundation = Foundation::RigidBed { thickness: 0.02 };
        let problem = pressed(
            hull.clone(),
            steel(top, mount.clone()),
            ice(foundation),
            load,
        );
        println!("{mount:?}");
        let found = by_exact_responses(&problem, 3);
        assert!(found.force < 1e-6 && found.motion < 1e-6, "{mount:?}");
    }
}

/// A flat steel 20 mm x 8 mm on a soft layer 0.5 mm thick, bonded to a rigid bed.
///
/// The columns of the layer are independent, with the foundation modulus k = M w / t per length and
/// M = lambda + 2 mu, and the steel is a beam. Under a load in its middle it lifts off at
/// x = pi / (2 l), l = (k / 4 E I)^(1/4), and the pressure in the middle is
///
/// p = F l / (2 w) (cosh pi + cos pi + 2) / sinh pi
///
/// (M. Hetenyi, Beams on Elastic Foundation, 1946, section 22: the free beam of length pi / l,
/// whose ends have zero pressure). The shear of the beam, the load's length of 4 mm and the
/// deformation of the layer next to the steel change the result by one or two percent each.
#[test]
fn loaded_steel_has_pressure_and_length_of_a_beam_on_a_winkler_foundation() {
    let (width, height, thickness, load) = (0.02, 0.008, 0.0005, 200.0);
    let (soft, ratio) = (2.5e6, 0.0);
    let flat = Formula {
        height: move |x: f64, y: f64| {
            if x.abs() <= 0.3 && y.abs() <= 0.5 * width {
                0.0
            } else {
                f64::INFINITY
            }
        },
        extent: [-0.3, 0.3, -0.5 * width, 0.5 * width],
        symmetric: [true; 2],
    };
    let foundation = Foundation::RigidBed { thickness };
    let layer = Ice {
        foundation,
        ..Ice::half_space(soft, ratio)
    };
    let mount = carried(&[(0.0, 0.004, 1.0)]);
    let problem = pressed(
        Arc::new(flat),
        steel(height, mount),
        layer,
        force(load, 0.0, Tilt::Free),
    );
    let s = solve(&problem, &at(10)).unwrap();
    let k = soft * width / thickness;
    let l = (k / (4.0 * STEEL.0 * width * height.powi(3) / 12.0)).powf(0.25);
    let expected = load * l / (2.0 * width) * (PI.cosh() + PI.cos() + 2.0) / PI.sinh();
    let (nx, middle) = (s.surface.x.len(), s.surface.y.len() / 2);
    let line = &s.surface.pressure[middle * nx..(middle + 1) * nx];
    let found = line.iter().copied().fold(0.0, f64::max);
    println!(
        "over beam theory: pressure {:.4}, length {:.4}; {} iterations",
        found / expected,
        s.length * l / PI,
        s.iterations
    );
    assert!((found / expected - 1.0).abs() < 0.04, "{found} {expected}");
    assert!((s.length * l / PI - 1.0).abs() < 0.06, "{}", s.length);
    assert!((s.fz / load - 1.0).abs() < 1e-8);
}

/// Vertical force of the mount on the top of the steel, from K u [N].
fn force_on_top(s: &Solution, kind: ElementKind) -> f64 {
    let field = s.runner_volume.as_ref().unwrap();
    let material = Material::new(STEEL.0, STEEL.1).unwrap();
    let body = Body::uniform(field.mesh.clone(), material, kind).unwrap();
    let u: Vec<f64> = field.displacement.iter().flatten().copied().collect();
    let mut forces = vec![0.0; u.len()];
    assemble(&body).apply(&u, &mut forces);
    let top = field.mesh.points.iter().map(|p| p[2]).fold(0.0, f64::max);
    let on_top = (0..field.mesh.points.len()).filter(|&n| field.mesh.points[n][2] > top - 1e-12);
    -on_top.map(|n| forces[3 * n + 2]).sum::<f64>()
}

/// Vertical force of the ice on its bed, from K u [N].
fn force_on_bed(s: &Solution) -> f64 {
    let material = Material::new(ICE_E, ICE_NU).unwrap();
    let ice = s.volume.as_ref().unwrap();
    let mesh = ice.grid.hex_mesh();
    let [nx, ny, _] = ice.grid.shape();
    let body = Body::uniform(mesh, material, ElementKind::Hex8).unwrap();
    let u: Vec<f64> = ice.displacement.iter().flatten().copied().collect();
    let mut forces = vec![0.0; u.len()];
    assemble(&body).apply(&u, &mut forces);
    // The outer sides are fixed as well.
    let fixed = (0..body.node_count()).filter(|&n| {
        let (i, j, k) = (n % nx, n / nx % ny, n / nx / ny);
        k == 0
            || i == nx - 1
            || j == ny - 1
            || (!s.symmetry[0] && i == 0)
            || (!s.symmetry[1] && j == 0)
    });
    fixed.map(|n| forces[3 * n + 2]).sum()
}

#[test]
fn action_equals_reaction_through_both_bodies() {
    let (hull, top) = short_bob();
    let mounts = [
        (Mount::Top, ElementKind::Hex8, Tilt::LEVEL),
        (
            fixed(&[(-0.08, 0.02), (0.08, 0.02)]),
            ElementKind::Hex8Axial,
            Tilt::LEVEL,
        ),
        (
            carried(&[(0.0, 0.02, 1.0)]),
            ElementKind::Hex8Axial,
            Tilt::Free,
        ),
    ];
    for (mount, kind, tilt) in mounts {
        let foundation = Foundation::RigidBed { thickness: 0.02 };
        let problem = pressed(
            hull.clone(),
            steel(top, mount.clone()),
            ice(foundation),
            force(800.0, 0.0, tilt),
        );
        let s = solve(&problem, &at(4)).unwrap();
        let copies: f64 = s
            .symmetry
            .iter()
            .map(|&m| if m { 2.0 } else { 1.0 })
            .product();
        let (from_top, on_bed) = (copies * force_on_top(&s, kind), copies * force_on_bed(&s));
        println!("{mount:?}: {from_top:.9} N from the top, {on_bed:.9} N on the bed");
        assert!(
            (from_top / 800.0 - 1.0).abs() < 1e-8,
            "{mount:?}: {from_top}"
        );
        assert!((on_bed / 800.0 - 1.0).abs() < 1e-8, "{mount:?}: {on_bed}");
    }
}

/// A curved steel on flat ice has the peak of a curved ice on flat steel.
#[test]
fn exchanging_the_materials_changes_the_peak_by_less_than_0_5_percent() {
    let hull = Arc::new(kufe_mesh::Paraboloid::new(30.0, 0.005).unwrap());
    let options = Options {
        p_max_tolerance: 0.003,
        ..Options::default()
    };
    let peak = |above: (f64, f64), below: (f64, f64)| {
        let runner = ElasticRunner::fixed_at_top(above.0, above.1, f64::INFINITY);
        let half_space = Ice::half_space(below.0, below.1);
        let load = force(1000.0, 0.0, Tilt::Free);
        let problem = pressed(hull.clone(), runner, half_space, load);
        solve(&problem, &options).unwrap().p_max
    };
    let (one, other) = (peak(STEEL, (ICE_E, ICE_NU)), peak((ICE_E, ICE_NU), STEEL));
    println!("{one:.5e} {other:.5e}");
    assert!((one / other - 1.0).abs() < 0.005, "{one} {other}");
}

/// The mesh of the solid has a limited slope on steep flanks, outside the contact. The gap is that of
/// the hull.
#[test]
fn limit_of_the_flank_slope_changes_the_peak_by_less_than_1e_4() {
    let bob = BobRunner::default();
    let luge = LugeSteel::default();
    let hulls: [(Arc<dyn Underside>, f64); 2] = [
        (Arc::new(bob.swept().unwrap()), bob.height),
        (Arc::new(luge.swept().unwrap()), luge.height),
    ];
    for (hull, top) in hulls {
        let peak = |flank: f64| {
            let mut runner = steel(top, Mount::Top);
            runner.flank = Some(flank);
            let half_space = ice(Foundation::HalfSpace);
            let problem = pressed(
                hull.clone(),
                runner,
                half_space,
                force(1000.0, 0.0, Tilt::LEVEL),
            );
            let s = solve(&problem, &at(4)).unwrap();
            (s.p_max, s.iterations)
        };
        let ((gentle, few), (steep, many)) = (peak(Mount::Top.flank()), peak(2.0));
        println!("{gentle:.6e} in {few} iterations, {steep:.6e} in {many}");
        assert!((gentle / steep - 1.0).abs() < 1e-4, "{gentle} {steep}");
        assert!(few <= 45 && few < many, "{few} {many}");
    }
}

/// The deflection of a thin steel under loads at two places exceeds its approach, so that the
/// undeformed bodies do not touch.
#[test]
fn steel_with_a_deflection_above_its_approach_agrees_with_exact_responses() {
    let luge = LugeSteel::default();
    let problem = pressed(
        Arc::new(luge.swept().unwrap()),
        steel(
            luge.height,
            carried(&[(-0.15, 0.012, 0.5), (0.15, 0.012, 0.5)]),
        ),
        ice(Foundation::RigidBed { thickness: 0.05 }),
        force(1000.0, 0.0, Tilt::Free),
    );
    let found = by_exact_responses(&problem, 2);
    assert!(found.force < 1e-6 && found.motion < 1e-6);
    assert!(found.solution.kkt_residual < 1e-6);
}
