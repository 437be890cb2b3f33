//! Energy of the contact forces in the history: it decreases with every contact set, to minus the
//! total potential energy.

use kufe_contact::{Foundation, Iterate, Load, Options, Problem, Solution, Tilt, hertz, solve};
use kufe_mesh::{BobRunner, Paraboloid};
use kufe_tests::contact::{contact_modulus, on_half_space};

fn paraboloid() -> Problem {
    on_half_space(Paraboloid::new(30.0, 0.005).unwrap(), 1000.0)
}

fn bob(track_radius: f64) -> Problem {
    Problem {
        track_curvature: 1.0 / track_radius,
        ..on_half_space(BobRunner::default().swept().unwrap(), 1000.0)
    }
}

fn solved(problem: &Problem, cells: usize) -> Solution {
    let options = Options {
        cells: Some(cells),
        ..Options::default()
    };
    solve(problem, &options).unwrap()
}

/// Asserts that energies decrease, that every iterate has accelerations, and that the residual is
/// small.
fn assert_energy_decreases(name: &str, problem: &Problem, cells: usize) -> Solution {
    let s = solved(problem, cells);
    let line = |i: &Iterate| {
        let (sweeps, accelerations) = (i.sweeps, i.accelerations);
        format!(
            "{} nodes, {sweeps} sweeps, {accelerations} accelerations, {} iterations, {:.12e} J",
            i.contact_nodes, i.iterations, i.energy
        )
    };
    let lines: Vec<String> = s.history.iter().map(line).collect();
    println!(
        "{name}: p_max {:.15e} Pa\n  {}",
        s.p_max,
        lines.join("\n  ")
    );
    assert!(!s.history.is_empty());
    for pair in s.history.windows(2) {
        assert!(
            pair[1].energy <= pair[0].energy,
            "{name}:\n{}",
            lines.join("\n")
        );
    }
    assert!(
        s.history
            .iter()
            .all(|i| i.energy > 0.0 && i.accelerations > 0)
    );
    assert!(s.history[0].sweeps > 0);
    assert!(s.kkt_residual < 1e-6, "{name}: {}", s.kkt_residual);
    let last = s.history[s.history.len() - 1];
    assert!(last.contact_nodes > 0 && last.residual < 1e-9);
    s
}

#[test]
fn energy_decreases_in_smooth_conformal_two_ended_and_offset_contacts() {
    assert_energy_decreases("hertz", &paraboloid(), 8);
    assert_energy_decreases("conformal", &bob(30.0), 5);
    assert_energy_decreases("two-ended", &bob(15.0), 5);
    let mut offset = paraboloid();
    offset.ice.foundation = Foundation::RigidBed { thickness: 0.03 };
    offset.load = Load::Force {
        fz: 800.0,
        offset_x: 0.004,
        offset_y: 1e-5,
        tilt: Tilt::Free,
    };
    assert_energy_decreases("offset", &offset, 6);
    let mut offset = bob(30.0);
    offset.load = Load::Force {
        fz: 1000.0,
        offset_x: 0.1,
        offset_y: 0.0,
        tilt: Tilt::Free,
    };
    assert_energy_decreases("conformal under an offset load", &offset, 5);
}

#[test]
fn energy_decreases_on_partly_and_fully_yielding_ice() {
    for (name, hardness) in [
        ("partly plastic", 100e6),
        ("mostly plastic", 40e6),
        ("plastic", 15e6),
    ] {
        let mut problem = paraboloid();
        problem.ice.hardness = Some(hardness);
        let s = assert_energy_decreases(name, &problem, 8);
        assert!(
            (s.p_max / hardness - 1.0).abs() < 1e-9,
            "{name}: {}",
            s.p_max
        );
    }
}

/// With F ~ d^(3/2), d the approach, the potential energy is 2/5 F d - F d.
#[test]
fn energy_of_a_point_contact_is_three_fifths_of_force_times_approach() {
    let exact = hertz(30.0, 0.005, contact_modulus(), 1000.0).unwrap();
    let s = solved(&paraboloid(), 12);
    let energy = s.history[s.history.len() - 1].energy;
    let expected = 0.6 * 1000.0 * exact.approach;
    assert!(
        (energy / expected - 1.0).abs() < 0.01,
        "{energy} {expected}"
    );
}
