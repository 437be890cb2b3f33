//! Walls at places of two roads that some runs hit and others miss.

use super::hidden::Chance;
use super::road::Road;
use crate::world::noise::Source;

/// A bumper pressed against a wall: half a sine of force over a stretch, with the friction of
/// rubber on ice.
#[derive(Debug, Clone, Copy)]
pub struct Bumper {
    /// Where it begins [m].
    pub from_m: f64,
    /// How long it lasts [m].
    pub length_m: f64,
    /// Its peak, left positive [N].
    pub force_n: f64,
    /// The bumper ahead of the centre of gravity [m].
    pub lever_m: f64,
}

impl Bumper {
    /// Friction of the bumper.
    const RUBBER: f64 = 0.12;

    /// Forward, to the left [N], and about the vertical [N m].
    pub fn push(&self, s: f64) -> [f64; 3] {
        let along = (s - self.from_m) / self.length_m;
        if !(0.0..=1.0).contains(&along) {
            return [0.0; 3];
        }
        let force = self.force_n * (std::f64::consts::PI * along).sin();
        [-Self::RUBBER * force.abs(), force, self.lever_m * force]
    }
}

/// A place where a line leads to the wall.
#[derive(Debug, Clone)]
struct Spot {
    road: usize,
    from_m: f64,
    side: f64,
}

/// One to six places, and how often and how hard they are hit.
#[derive(Debug, Clone)]
pub struct Walls {
    spots: Vec<Spot>,
    hits: Chance,
    /// Share of runs that hit.
    share: f64,
    /// Median of the peak [N].
    force_n: f64,
}

impl Walls {
    /// Draws places far enough apart to be reported apart.
    pub fn draw(hits: Chance, roads: &[Road; 2], source: &mut Source) -> Walls {
        let count = 1 + source.uniform(0.0, 6.0).min(5.0) as usize;
        let spots = (0..count).map(|k| {
            let road = k % 2;
            let length_m = roads[road].length_m;
            // Each in a third of its own of the road's middle.
            let third = 0.2 * length_m;
            let from_m =
                0.2 * length_m + third * (k / 2) as f64 + source.uniform(0.0, third - 40.0);
            Spot {
                road,
                from_m,
                side: source.sign(),
            }
        });
        Walls {
            spots: spots.collect(),
            hits,
            share: source.uniform(0.2, 0.8),
            force_n: source.uniform(300.0, 600.0),
        }
    }

    /// What one run meets: missed or hit, a few metres earlier or later, strengths lognormal.
    pub fn of_run(
        &self,
        road: usize,
        driver: usize,
        lever_m: f64,
        source: &mut Source,
    ) -> Vec<Bumper> {
        let (often, hard) = match (self.hits, driver) {
            (Chance::ByRun, _) => (self.share, 1.0),
            (Chance::ByDriver, 0) => (0.9, 1.5),
            (Chance::ByDriver, 1) => (0.2, 0.5),
            (Chance::ByDriver, _) => (0.5, 1.0),
        };
        let mut bumps = Vec::new();
        for spot in self.spots.iter().filter(|spot| spot.road == road) {
            let bump = Bumper {
                from_m: spot.from_m + source.uniform(-3.0, 3.0),
                length_m: source.uniform(7.0, 16.0),
                force_n: spot.side * hard * self.force_n * (0.4 * source.normal().min(1.5)).exp(),
                lever_m,
            };
            if source.uniform(0.0, 1.0) < often {
                bumps.push(bump);
            }
        }
        bumps
    }

    /// Where walls are: road, from, to [m].
    pub fn stretches(&self, roads: &[Road; 2]) -> Vec<(String, f64, f64)> {
        let of = |s: &Spot| (roads[s.road].name.to_owned(), s.from_m, s.from_m + 11.5);
        self.spots.iter().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn drivers_differ_where_they_are_said_to_and_runs_where_they_are_not() {
        let source = &mut Source::new(5, "walls");
        let roads = ["a", "b"].map(|name| Road::draw(name, source));
        for (hits, differ) in [(Chance::ByRun, false), (Chance::ByDriver, true)] {
            let walls = Walls::draw(hits, &roads, source);
            let count = |driver: usize, source: &mut Source| -> usize {
                (0..400)
                    .map(|_| walls.of_run(0, driver, 0.3, source).len())
                    .sum()
            };
            let [often, seldom] = [0, 1].map(|driver| count(driver, source) as f64);
            // 400 runs scatter by 20; nine in ten against two in ten differ by more than a factor
            // of three.
            assert_eq!(often > 3.0 * seldom, differ, "{often} {seldom}");
        }
    }
}
