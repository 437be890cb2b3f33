//! Claims on the equations of a closed set: they are met, in iterations that hardly grow with the
//! mesh.

use std::sync::Arc;

use super::*;
use kufe_mesh::Paraboloid;

use crate::accuracy::one_mesh::MeshProblem;
use crate::green::matrix::{Green, StorageLimit};
use crate::{Ice, Load, Problem, Runner, Tilt};

/// Four times the nodes and four times again: the same few dozen iterations are enough.
#[test]
fn sets_are_closed_in_iterations_that_hardly_grow_with_the_mesh()
-> Result<(), Box<dyn std::error::Error>> {
    let runner = Runner::rigid(Arc::new(Paraboloid::new(30.0, 0.005)?));
    let load = Load::central(1000.0, Tilt::Free);
    let problem = Problem::new(runner, Ice::half_space(9e9, 0.33), load);
    for cells in [5.0, 10.0, 20.0] {
        let MeshProblem { mesh, patch, .. } = MeshProblem::new(problem.clone(), cells)?;
        let contact = &mesh.contact;
        let [Green::Modal(green), _] = contact.greens(StorageLimit {
            faces: 0,
            mounted: 0,
        }) else {
            return Err("a stored matrix above the limit".into());
        };
        let near = |&i: &usize| contact.gap[contact.candidates[i]] < patch.motion;
        let inside: Vec<usize> = (0..contact.candidates.len()).filter(near).collect();
        let nodes = || inside.iter().map(|&i| contact.candidates[i]);
        let rows: Vec<[f64; 3]> = nodes().map(|node| contact.rows[node]).collect();
        let gap: Vec<f64> = nodes().map(|node| contact.gap[node]).collect();
        let set = ClosedSet::new(&green, &inside, &rows, contact.motion.free);
        let balance = contact.motion.balance;
        let none = vec![0.0; inside.len()];
        let count = (1..ITERATIONS).find(|&most| {
            set.solve_within(most, &gap, [balance, [0.0; 3]], &none)
                .is_some()
        });
        println!("{} nodes: {count:?} iterations", inside.len());
        let (force, motion) = set
            .solve_within(40, &gap, [balance, [0.0; 3]], &none)
            .ok_or("more than 40 iterations")?;
        let moved = set.times(&force);
        for k in 0..inside.len() {
            let open = gap[k] + moved[k] - dot(rows[k], motion);
            assert!(open.abs() < 1e-9 * motion[0].abs(), "{cells}: {open:e}");
        }
        let carried: f64 = force.iter().sum();
        assert!((carried / balance[0] - 1.0).abs() < 1e-12, "{carried}");
    }
    Ok(())
}
