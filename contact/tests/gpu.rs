//! Contacts solved on a graphics processor beside those solved on this processor.
//!
//! Any Vulkan, Metal or Direct3D 12 adapter will do, software too (Mesa's lavapipe). Without one the tests say that they skip,
//! unless `KUFE_GPU=1` demands one.

use std::sync::Arc;

use kufe_contact::{
    Bed, ElasticRunner, Error, Foundation, Ice, Load, Method, Options, Problem, Runner, Solution,
    Tilt, hertz, solve,
};
use kufe_fem::gpu::Device;
use kufe_mesh::{BobRunner, Paraboloid, Underside};

fn device() -> Option<Arc<Device>> {
    match Device::open() {
        Ok(device) => Some(Arc::new(device)),
        Err(kufe_fem::Error::NoAdapter) if std::env::var_os("KUFE_GPU").is_none() => {
            kufe_outside::missing("there is no Vulkan/Metal/DX12 adapter");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

fn on_half_space(underside: impl Underside + 'static) -> Problem {
    let runner = Runner::rigid(Arc::new(underside));
    let ice = Ice::half_space(9e9, 0.33);
    Problem::new(runner, ice, Load::central(1000.0, Tilt::Free))
}

fn paraboloid() -> Problem {
    on_half_space(Paraboloid::new(30.0, 0.005).unwrap())
}

fn bob(track_radius: f64) -> Problem {
    Problem {
        track_curvature: 1.0 / track_radius,
        ..on_half_space(BobRunner::default().swept().unwrap())
    }
}

fn with(device: &Arc<Device>, options: &Options) -> Options {
    Options {
        device: Some(device.clone()),
        ..options.clone()
    }
}

/// Where pressures are on both maps, how far they are apart in parts of the peak.
fn apart(a: &Solution, b: &Solution) -> f64 {
    let pairs = a.surface.pressure.iter().zip(&b.surface.pressure);
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / a.p_max
}

/// Solves both ways; returns the device's solution.
fn agree(device: &Arc<Device>, problem: &Problem, options: &Options) -> Solution {
    let host = solve(problem, options).unwrap();
    let found = solve(problem, &with(device, options)).unwrap();
    let close = |a: f64, b: f64, size: f64| {
        let limit = 1e3 * options.residual * size;
        assert!((a - b).abs() <= limit, "{a} {b}");
    };
    close(host.p_max, found.p_max, host.p_max);
    close(host.fz, found.fz, host.fz);
    close(host.approach, found.approach, host.approach);
    close(host.area, found.area, host.area);
    close(host.length, found.length, host.length);
    let [arm, arm_y] = [host.length, host.width];
    close(host.pitch * arm, found.pitch * arm, host.approach);
    close(host.roll * arm_y, found.roll * arm_y, host.approach);
    assert!(found.kkt_residual < 1e-6, "{}", found.kkt_residual);
    assert_eq!(host.dofs, found.dofs);
    let touches =
        |s: &Solution| -> Vec<bool> { s.surface.pressure.iter().map(|p| *p > 0.0).collect() };
    assert_eq!(touches(&host), touches(&found));
    let apart = apart(&host, &found);
    println!(
        "{} unknowns, p_max {:.3} MPa, maps {apart:.1e} apart, p_max {:.1e}, approach {:.1e}, {} and {} iterations",
        host.dofs,
        host.p_max / 1e6,
        found.p_max / host.p_max - 1.0,
        found.approach / host.approach - 1.0,
        host.iterations,
        found.iterations
    );
    assert!(apart < 1e3 * options.residual, "{apart:e}");
    found
}

fn one_mesh(cells: usize, residual: f64) -> Options {
    Options {
        cells: Some(cells),
        residual,
        ..Options::default()
    }
}

#[test]
fn contact_of_a_paraboloid_is_that_of_double_precision_and_of_hertz() {
    let Some(device) = device() else { return };
    let exact = hertz(30.0, 0.005, 9e9 / (1.0 - 0.33 * 0.33), 1000.0).unwrap();
    // Meshes graded until the error asked is reached, and the value they tend to.
    let s = agree(&device, &paraboloid(), &Options::default());
    assert!((s.p_max / exact.p_max - 1.0).abs() < 0.01, "{}", s.p_max);
    // Equations solved nearly to rounding.
    agree(&device, &paraboloid(), &one_mesh(6, 1e-12));
}

#[test]
fn contact_on_ice_at_its_hardness_is_that_of_double_precision() {
    let Some(device) = device() else { return };
    let mut problem = paraboloid();
    problem.ice.hardness = Some(60e6);
    let s = agree(&device, &problem, &one_mesh(6, 1e-9));
    assert!((s.p_max / 60e6 - 1.0).abs() < 1e-6, "{}", s.p_max);
}

#[test]
fn conformal_contact_and_contact_at_both_ends_are_those_of_double_precision() {
    let Some(device) = device() else { return };
    let conformal = agree(&device, &bob(30.0), &one_mesh(5, 1e-9));
    assert!(conformal.length > 0.9, "{}", conformal.length);
    let ends = agree(&device, &bob(15.0), &one_mesh(5, 1e-9));
    assert!(ends.p_max > 200e6, "{}", ends.p_max);
}

/// Two materials, no plane of symmetry, and a force that follows from the approach.
#[test]
fn pitched_contact_on_an_elastic_bed_is_that_of_double_precision() {
    let Some(device) = device() else { return };
    let mut problem = paraboloid();
    problem.ice.foundation = Foundation::ElasticBed {
        thickness: 0.03,
        bed: Bed {
            thickness: 0.2,
            youngs_modulus: 30e9,
            poissons_ratio: 0.2,
        },
    };
    problem.load = Load::Force {
        fz: 800.0,
        offset_x: 0.004,
        offset_y: 1e-5,
        tilt: Tilt::Free,
    };
    agree(&device, &problem, &one_mesh(5, 1e-10));
    problem.load = Load::Approach {
        approach: 4e-5,
        pitch: 1e-4,
        roll: 0.0,
    };
    agree(&device, &problem, &one_mesh(5, 1e-10));
}

#[test]
fn what_is_no_rigid_contact_is_refused_by_name() {
    let Some(device) = device() else { return };
    let mut problem = paraboloid();
    let checking = Options {
        method: Method::PlainSor,
        ..one_mesh(2, 1e-9)
    };
    let found = "a checking method";
    assert_eq!(
        solve(&problem, &with(&device, &checking)).err(),
        Some(Error::NotOnDevice { found })
    );
    problem.runner.elastic = Some(ElasticRunner::held_at_top(210e9, 0.3, 0.05));
    let found = "an elastic runner";
    assert_eq!(
        solve(&problem, &with(&device, &one_mesh(2, 1e-9))).err(),
        Some(Error::NotOnDevice { found })
    );
}
