//! What a mesh may be: lines of nodes that increase, and no more than memory takes.

use crate::Error;

/// Most nodes of a line.
pub(crate) const MOST_ON_A_LINE: usize = 100_000;
/// Most nodes of the ice: 12 million unknowns, some 4 GB.
const MOST_NODES: usize = 4_000_000;
/// Least distance of neighbours over the sum of their places.
const APART: f64 = 1e-12;

/// Passes a line on whose nodes increase, each by more than rounding.
pub(crate) fn increasing(nodes: Vec<f64>) -> Result<Vec<f64>, Error> {
    let least = |w: &[f64]| APART * (w[0].abs() + w[1].abs());
    let apart = |w: &&[f64]| w[1] - w[0] > least(w);
    match nodes.windows(2).find(|w| !apart(w)) {
        None if nodes.len() > 1 => Ok(nodes),
        found => Err(Error::TooFine {
            from: nodes.first().copied().unwrap_or(f64::NAN),
            to: nodes.last().copied().unwrap_or(f64::NAN),
            spacing: found.map_or(0.0, least),
        }),
    }
}

/// Checks that a grid of this many nodes along each axis can be had.
pub(crate) fn storable(shape: [usize; 3]) -> Result<(), Error> {
    let nodes = shape.iter().fold(1usize, |n, &k| n.saturating_mul(k));
    if nodes > MOST_NODES {
        return Err(Error::MeshTooLarge {
            shape,
            limit: MOST_NODES,
        });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_that_do_not_increase_are_refused() {
        assert!(increasing(vec![-1.0, 0.0, 1e-9]).is_ok());
        for nodes in [
            vec![0.0, 1.0, 1.0],
            vec![0.0, f64::NAN, 1.0],
            vec![1.0],
            vec![1.0, 1.0 + 1e-15],
        ] {
            assert!(increasing(nodes).is_err());
        }
    }

    #[test]
    fn what_is_refused_says_the_size_that_rounding_still_tells()
    -> Result<(), Box<dyn std::error::Error>> {
        let told = |nodes| increasing(nodes).map_err(|error| error.to_string());
        let Err(text) = told(vec![0.0, 1.0, 1.0]) else {
            return Err("equal nodes pass".into());
        };
        assert!(text.contains("cells of 2.000e-12 m or less"), "{text}");
        let Err(text) = told(vec![0.0, 0.0]) else {
            return Err("nodes at one place pass".into());
        };
        assert!(text.contains("cells of no size"), "{text}");
        Ok(())
    }

    #[test]
    fn sizes_are_bounded_without_overflow() {
        assert!(storable([100, 100, 100]).is_ok());
        assert!(storable([usize::MAX, 3, 1]).is_err());
    }
}
