//! A state with its groove, and where another mesh's solve begins.

use crate::grid::contact_mesh::State;
use crate::grid::discretise::Discretisation;
use crate::groove::memory::{Kind, MemoryState};

/// The state on one mesh with its groove.
#[derive(Clone)]
pub(crate) struct Slid {
    pub state: State,
    /// On the candidates.
    pub grooved: MemoryState,
    /// Plastic depth on the whole plane, x fastest [m].
    pub depth: Vec<f64>,
    /// Conjugate-gradient iterations.
    pub iterations: usize,
    /// Corrections of the plane's response by the bodies.
    pub corrections: usize,
    /// What the last correction changed: the sum of the forces' changes over the load.
    pub residual: f64,
}

/// Where a mesh's solve begins.
pub(crate) enum Start {
    /// At the indentation at rest, looked for near this motion [m].
    AtRest(f64),
    /// At what another mesh found.
    From(Known),
}

/// What nodes do, and the motion, as another mesh found them.
pub(crate) struct Known {
    x: Vec<f64>,
    y: Vec<f64>,
    kinds: Vec<Kind>,
    pub motion: [f64; 3],
}

impl Known {
    /// The states of a mesh.
    pub fn of(mesh: &Discretisation, slid: &Slid) -> Self {
        let (x, y) = (mesh.grid.x.clone(), mesh.grid.y.clone());
        let mut kinds = vec![Kind::Open; x.len() * y.len()];
        for (&node, &kind) in mesh.contact.candidates.iter().zip(&slid.grooved.kinds) {
            kinds[node] = kind;
        }
        let motion = slid.grooved.motion;
        Known {
            x,
            y,
            kinds,
            motion,
        }
    }

    /// Those of the nearest nodes, for another mesh's candidates.
    pub fn on(&self, mesh: &Discretisation) -> Vec<Kind> {
        let nearest = |places: &[f64], at: f64| {
            let next = places
                .partition_point(|&p| p < at)
                .clamp(1, places.len() - 1);
            if at - places[next - 1] < places[next] - at {
                next - 1
            } else {
                next
            }
        };
        let columns: Vec<usize> = mesh.grid.x.iter().map(|&x| nearest(&self.x, x)).collect();
        let rows: Vec<usize> = mesh.grid.y.iter().map(|&y| nearest(&self.y, y)).collect();
        let nodes = mesh.contact.candidates.iter();
        let nx = mesh.grid.x.len();
        nodes
            .map(|n| self.kinds[rows[n / nx] * self.x.len() + columns[n % nx]])
            .collect()
    }
}
