//! Mounts of an elastic runner.

use kufe_fem::ElementKind;

/// A stretch of the runner's top.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Its middle along the runner [m].
    pub x: f64,
    /// Its length [m].
    pub length: f64,
}

impl Place {
    fn ends(&self) -> [f64; 2] {
        [self.x - 0.5 * self.length, self.x + 0.5 * self.length]
    }
}

/// A stretch of the runner's top that carries a share of the normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoadedPlace {
    /// The stretch.
    pub place: Place,
    /// Fraction of the normal force that it carries.
    pub share: f64,
}

/// Mount of an elastic runner: the fixed or loaded part of its top, which moves with its rigid
/// motion.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Mount {
    /// The whole flat top.
    #[default]
    Top,
    /// The top's full width at some places along it, as a luge steel on its bridges or a runner in
    /// its carriers.
    Places(Vec<Place>),
    /// No fixed nodes: places along the top apply the load, distributed evenly along each place on
    /// the line of action. The shares sum to 1, and their line of action is the load's, so that the
    /// body is in balance for any support.
    Loads(Vec<LoadedPlace>),
}

/// Smallest number of cells along a mounted runner per cell over half the patch, so that its
/// bending is resolved and converges with the contact.
const CELLS_ALONG: f64 = 10.0;
/// Number of cells over a place per cell over half the patch.
const CELLS_A_PLACE: f64 = 1.0;

impl Mount {
    /// Default limit of the slope of the meshed underside.
    ///
    /// A runner that is fixed all over its top does not bend, and a gentle flank does no harm.
    /// Where the runner bends, the limit adds steel: 0.35 adds 4.1 per cent to the bending
    /// stiffness of a runner with a half circle for its section, 10 mm x 30 mm, and 0.5 takes up to
    /// a fifth more iterations.
    pub fn flank(&self) -> f64 {
        match self {
            Mount::Top => 0.25,
            Mount::Places(_) | Mount::Loads(_) => 0.35,
        }
    }

    /// Element of a runner on the ice's columns: a runner that is fixed all over its top cannot
    /// bend, and has the element of a block.
    pub fn element(&self, poissons_ratio: f64) -> ElementKind {
        match self {
            Mount::Top => ElementKind::of_block(poissons_ratio),
            Mount::Places(_) | Mount::Loads(_) => ElementKind::Hex8Axial,
        }
    }

    /// The fixed or loaded places; none for the whole top.
    pub fn places(&self) -> Vec<Place> {
        match self {
            Mount::Top => Vec::new(),
            Mount::Places(places) => places.clone(),
            Mount::Loads(loads) => loads.iter().map(|load| load.place).collect(),
        }
    }

    /// Whether it is symmetric about x = 0.
    pub fn mirror_symmetric(&self) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * (a.abs() + b.abs());
        let same = |a: &Place, b: &Place| close(a.x, -b.x) && close(a.length, b.length);
        match self {
            Mount::Top => true,
            Mount::Places(places) => places.iter().all(|a| places.iter().any(|b| same(a, b))),
            Mount::Loads(loads) => loads.iter().all(|a| {
                let mirrored =
                    |b: &LoadedPlace| same(&a.place, &b.place) && close(a.share, b.share);
                loads.iter().any(mirrored)
            }),
        }
    }

    /// Puts nodes at the places' ends and divides cells that are too long for bending, from `low`
    /// to `high` of the hull, in a mesh of `cells` over half the patch.
    pub(crate) fn refine(&self, nodes: &mut Vec<f64>, [low, high]: [f64; 2], cells: f64) {
        let places = self.places();
        if places.is_empty() {
            return;
        }
        let ends: Vec<[f64; 2]> = places.iter().map(Place::ends).collect();
        for (place, ends) in places.iter().zip(&ends) {
            for &end in ends {
                let [first, last] = [nodes[0], nodes[nodes.len() - 1]];
                if first < end && end < last {
                    // Nodes too near an end of a place are removed, except the runner's own ends.
                    let fixed = [low, high, first, last];
                    let near = 0.2 * place.length;
                    nodes.retain(|x| (x - end).abs() > near || fixed.contains(x));
                    let at = nodes.partition_point(|&x| x < end);
                    if nodes[at] != end {
                        nodes.insert(at, end);
                    }
                }
            }
        }
        let longest = |middle: f64| {
            let over = places
                .iter()
                .zip(&ends)
                .filter(|(_, end)| (end[0]..=end[1]).contains(&middle));
            let of_place = over.map(|(place, _)| place.length / (CELLS_A_PLACE * cells));
            of_place.fold((high - low) / (CELLS_ALONG * cells), f64::min)
        };
        // Adjacent cells that are too long are divided as one, so that the size of cells of finer
        // meshes is in inverse proportion to their number.
        let limit = |pair: &[f64]| {
            let middle = 0.5 * (pair[0] + pair[1]);
            let on_runner = (low..=high).contains(&middle);
            let limit = longest(middle);
            (on_runner && pair[1] - pair[0] > limit * (1.0 + 1e-9)).then_some(limit)
        };
        let stays = |x: f64| x == low || x == high || ends.as_flattened().contains(&x);
        let mut divided = vec![nodes[0]];
        let mut next = 1;
        while next < nodes.len() {
            let (from, most) = (nodes[next - 1], limit(&nodes[next - 1..=next]));
            while most.is_some()
                && next + 1 < nodes.len()
                && !stays(nodes[next])
                && limit(&nodes[next..=next + 1]) == most
            {
                next += 1;
            }
            let to = nodes[next];
            let parts = most.map_or(1.0, |most| ((to - from) / most - 1e-9).ceil()) as usize;
            divided.extend((1..=parts).map(|i| from + (to - from) * i as f64 / parts as f64));
            next += 1;
        }
        *nodes = divided;
    }

    /// Whether a place lies over `x` [m].
    pub fn over(&self, x: f64) -> bool {
        let slack = 1e-9 * (1.0 + x.abs());
        self.places().iter().any(|place| {
            let [low, high] = place.ends();
            (low - slack..=high + slack).contains(&x)
        })
    }
}

/// Integrals of the hat functions of `nodes` over a place, divided by its length: they sum to the
/// fraction of the place that the nodes span.
pub(crate) fn spread_along(nodes: &[f64], place: &Place) -> Vec<f64> {
    let [low, high] = place.ends();
    let mut share = vec![0.0; nodes.len()];
    for (e, pair) in nodes.windows(2).enumerate() {
        let (from, to) = (pair[0].max(low), pair[1].min(high));
        if from < to {
            let middle = (0.5 * (from + to) - pair[0]) / (pair[1] - pair[0]);
            let part = (to - from) / place.length;
            share[e] += part * (1.0 - middle);
            share[e + 1] += part * middle;
        }
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_load_keeps_its_force_and_its_moment() {
        let nodes = [0.0, 0.1, 0.25, 0.3, 0.7, 1.0];
        let place = Place {
            x: 0.4,
            length: 0.43,
        };
        let share = spread_along(&nodes, &place);
        let moment: f64 = nodes.iter().zip(&share).map(|(x, s)| x * s).sum();
        assert!((share.iter().sum::<f64>() - 1.0).abs() < 1e-14);
        assert!((moment - 0.4).abs() < 1e-14);
        // Half of a stretch over a mirror plane.
        let half = spread_along(
            &nodes,
            &Place {
                x: 0.0,
                length: 0.4,
            },
        );
        assert!((half.iter().sum::<f64>() - 0.5).abs() < 1e-14);
    }

    #[test]
    fn a_refined_axis_has_the_places_ends_and_no_cell_too_long_for_them() {
        let mut nodes: Vec<f64> = vec![0.0, 0.01, 0.05, 0.2, 0.5, 0.9];
        let mount = Mount::Places(vec![
            Place {
                x: 0.25,
                length: 0.012,
            },
            Place {
                x: -0.25,
                length: 0.012,
            },
        ]);
        assert!(mount.mirror_symmetric());
        mount.refine(&mut nodes, [-0.5, 0.5], 4.0);
        for end in [0.244, 0.256] {
            assert!(nodes.iter().any(|x| (x - end).abs() < 1e-15), "{nodes:?}");
        }
        assert!(nodes.windows(2).all(|w| w[1] > w[0]));
        let longest = |from: f64, to: f64| {
            let inside = nodes
                .windows(2)
                .filter(|w| w[0] >= from - 1e-12 && w[1] <= to + 1e-12);
            inside.map(|w| w[1] - w[0]).fold(0.0, f64::max)
        };
        assert!(
            longest(0.0, 0.5) <= 0.025 * (1.0 + 1e-9)
                && longest(0.244, 0.256) <= 0.003 * (1.0 + 1e-9)
        );
        assert_eq!(longest(0.5, 0.9), 0.4);
    }
}
