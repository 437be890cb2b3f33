//! Every solve so far, as nodes of the grid and checks between them.

use std::collections::{HashMap, HashSet};

use crate::sweep::grid::{Grid, Place};
use crate::sweep::plan::{AXES, SolveBatch};
use crate::table::nodes::Check;
use crate::table::solved::{Point, Solved};

type Key = [u64; AXES];

/// Every solve so far, in the order they were asked for.
#[derive(Default)]
pub(crate) struct Known {
    solved: HashMap<Key, Solved>,
    order: Vec<Place>,
}

impl Known {
    pub fn solve<E>(
        &mut self,
        grid: &Grid,
        places: &[Place],
        solve: &mut SolveBatch<E>,
    ) -> Result<(), E> {
        let mut asked = HashSet::new();
        let unknown =
            |place: &&Place| !self.solved.contains_key(&key(place)) && asked.insert(key(place));
        let new: Vec<Place> = places.iter().filter(unknown).copied().collect();
        if new.is_empty() {
            return Ok(());
        }
        let points: Vec<Point> = new.iter().map(|&place| grid.point(place)).collect();
        for (place, solved) in new.into_iter().zip(solve(&points)?) {
            self.solved.insert(key(&place), solved);
            self.order.push(place);
        }
        Ok(())
    }

    /// The grid's nodes, and everything else as checks with their places.
    pub fn split(&self, grid: &Grid) -> (Vec<Solved>, Vec<(Place, Check)>) {
        let places = grid.nodes();
        let nodes = places
            .iter()
            .map(|place| self.solved[&key(place)])
            .collect();
        let taken: HashSet<Key> = places.iter().map(key).collect();
        let others = self
            .order
            .iter()
            .filter(|place| !taken.contains(&key(place)));
        let checks = others
            .map(|&place| {
                let (point, solved) = (grid.point(place), self.solved[&key(&place)]);
                (place, Check { point, solved })
            })
            .collect();
        (nodes, checks)
    }
}

/// One zero, whatever its sign.
fn key(place: &Place) -> Key {
    place.map(|value| (value + 0.0).to_bits())
}
