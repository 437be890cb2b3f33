//! Claims on accelerations whose energy rises.

use std::cell::RefCell;
use std::sync::Arc;

use kufe_mesh::Paraboloid;

use crate::accuracy::one_mesh::MeshProblem;
use crate::active_set::constrained_cg::SetProblem;
use crate::active_set::contact_set::{Control, Counts, SetUpdate};
use crate::green::matrix::StorageLimit;
use crate::mesh::contact_mesh::{Sets, State};
use crate::{Foundation, Ice, Load, Options, Problem, Runner, Tilt};

/// Share of the touching nodes that the bad acceleration keeps.
const KEPT: f64 = 0.3;

#[test]
fn an_acceleration_that_raises_the_energy_is_put_back_and_the_contact_found_all_the_same()
-> Result<(), Box<dyn std::error::Error>> {
    let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
    let ice = Ice {
        foundation: Foundation::RigidBed { thickness: 0.005 },
        ..Ice::half_space(9e9, 0.33)
    };
    let problem = Problem::new(runner, ice, Load::central(1000.0, Tilt::Free));
    let options = Options::default();
    let MeshProblem { mesh, patch, .. } = MeshProblem::new(problem, 5.0)?;
    let contact = &mesh.contact;
    let greens = contact.greens(StorageLimit::USUAL);
    // Energies and sweeps as the callback reports them after every update of the set; the bad
    // acceleration is compared with the update before it.
    let solve = |disturbed: Option<usize>| {
        let found = contact.plane_contact_from_rest(&greens[1], patch.motion);
        let mut state = contact.state_of(&found.force, found.motion);
        state.displacement = vec![0.0; contact.len()];
        let reported = RefCell::new(Vec::new());
        let report = |update: &SetUpdate, _: &State| {
            reported
                .borrow_mut()
                .push((update.energy, update.counts.sweeps));
        };
        let control = Control {
            iterations: 1000,
            options: &options,
            report: &report,
        };
        let mut work = contact.workspace();
        let (mut number, mut before, mut risen) = (0, None, None);
        let progress = contact.solve_by(
            &mut state,
            &greens,
            Counts::default(),
            &control,
            |set, state, progress| {
                number += 1;
                let Some(at) = disturbed.filter(|at| number <= *at) else {
                    return Ok::<_, std::convert::Infallible>(
                        contact.iterate(set, state, &mut work, progress),
                    );
                };
                if number < at {
                    contact.iterate(set, state, &mut work, progress);
                    before = Some(contact.feasible(state, &greens[1], None));
                    return Ok(false);
                }
                let mut inside = set.sets.inside.clone();
                let force = |i: &usize| state.force[contact.candidates[*i]];
                inside.sort_by(|a, b| force(b).total_cmp(&force(a)));
                inside.truncate((KEPT * inside.len() as f64) as usize);
                inside.sort_unstable();
                let sets = Sets {
                    inside,
                    full: Vec::new(),
                };
                let constraint = contact.constrain(&sets, &greens[0]).expect("independent");
                let bad = SetProblem {
                    sets: &sets,
                    constraint: &constraint,
                    ..*set
                };
                contact.iterate(&bad, state, &mut work, progress);
                let last = before.as_ref().expect("one before");
                let now = contact.feasible(state, &greens[1], Some(last));
                risen = Some([last.energy, now.energy]);
                Ok(false)
            },
        );
        let Ok(progress) = progress;
        (progress, state, reported.into_inner(), risen)
    };
    let (straight, expected, ..) = solve(None);
    let (progress, state, reported, risen) = solve(Some(2));
    assert!(straight.converged && progress.converged);
    let [last, bad] = risen.expect("a second update");
    assert!(bad > last + 1e-3 * last.abs(), "{last} {bad}");
    assert!(
        reported.windows(2).all(|pair| pair[1].0 <= pair[0].0),
        "{reported:?}"
    );
    // After an accepted acceleration, sweeps search for the next set; after a rejected one, it is that
    // of the forces accepted last.
    assert!(reported[1].1 > 0 && reported[2].1 == 0, "{reported:?}");
    let largest = expected.force.iter().copied().fold(0.0, f64::max);
    for (a, b) in state.force.iter().zip(&expected.force) {
        assert!((a - b).abs() < 1e-6 * largest, "{a} {b}");
    }
    Ok(())
}
