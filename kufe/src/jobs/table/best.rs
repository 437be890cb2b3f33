//! The best available solution of a point, and its figures.

use kufe_contact::{BoundaryElements, Options, Problem, Solution};
use kufe_lut::{Figures, Method, Point, Quantity};

/// Largest estimated error of the peak pressure of a point short of its tolerance, relative.
pub(crate) const LARGEST_ERROR: f64 = 0.2;

/// The solution at this tolerance or, where the largest mesh does not reach it, the best available
/// one.
///
/// Its `p_max_error` shows which of the two it is. Refusing such a point would refuse the whole
/// table.
pub(crate) fn best(problem: &Problem, options: &Options) -> Result<Solution, kufe_contact::Error> {
    match kufe_contact::solve(problem, options) {
        Err(kufe_contact::Error::AccuracyNotReached { best, estimate, .. })
            if estimate < LARGEST_ERROR =>
        {
            Ok(*best)
        }
        other => other,
    }
}

/// The figures of a contact.
pub(crate) fn figures(solution: &Solution) -> Figures {
    Figures::at_rest([
        solution.p_max,
        solution.p_mean,
        solution.area,
        solution.length,
        solution.width,
        solution.approach,
    ])
    .with_error(Quantity::PMax, solution.p_max_error)
    .with_error(Quantity::PMean, solution.p_mean_error)
    .with_error(Quantity::Area, solution.area_error)
    .with_error(Quantity::Length, solution.length_error)
    .with_error(Quantity::Width, solution.width_error)
    .with_error(Quantity::Approach, solution.approach_error)
}

/// The figures of a contact by boundary elements.
pub(crate) fn by_boundary_elements(point: &Point, found: &BoundaryElements) -> Figures {
    let p_mean = point.fz / found.area;
    Figures::at_rest([
        found.p_max,
        p_mean,
        found.area,
        found.length,
        found.width,
        found.approach,
    ])
    .with_error(Quantity::PMax, found.p_max_error)
    .with_error(Quantity::PMean, p_mean * found.area_error / found.area)
    .with_error(Quantity::Area, found.area_error)
    .with_error(Quantity::Length, found.length_error)
    .with_error(Quantity::Width, found.width_error)
    .with_error(Quantity::Approach, found.approach_error)
    .by(Method::BoundaryElements)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::Case;
    use std::path::Path;

    fn paraboloid() -> Problem {
        let text = "[runner]\nshape = { kind = \"paraboloid\", rocker_radius_m = 30, section_radius_m = 0.005 }\n\
                    [ice]\nyoungs_modulus_pa = 9e9\npoissons_ratio = 0.33\nthickness_m = \"half-space\"\n[load]\nfz_n = 1000";
        let case = Case::parse(text).unwrap_or_else(|error| panic!("{error}"));
        case.problem(Path::new(""))
            .unwrap_or_else(|error| panic!("{error}"))
    }

    #[test]
    fn a_point_short_of_its_tolerance_keeps_the_best_answer_with_its_error() {
        let tolerance = 1e-4;
        let small = Options {
            max_dofs: 100_000,
            p_max_tolerance: tolerance,
            ..Options::default()
        };
        let solution = best(&paraboloid(), &small).expect("an answer");
        let error = solution.p_max_error / solution.p_max;
        assert!(error > tolerance && error < LARGEST_ERROR, "{error}");
        // Hertz's peak of this contact.
        assert!((solution.p_max / 138.52e6 - 1.0).abs() < error);
    }

    #[test]
    fn a_point_that_no_mesh_comes_near_is_an_error() {
        let tiny = Options {
            max_dofs: 100,
            p_max_tolerance: 1e-4,
            ..Options::default()
        };
        assert!(matches!(
            best(&paraboloid(), &tiny),
            Err(kufe_contact::Error::AccuracyNotReached { .. })
        ));
    }
}
