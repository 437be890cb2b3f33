//! The best answer that there is for a point, and its figures.

use kufe_contact::{BoundaryElements, Options, Problem, Solution};
use kufe_lut::{Errors, Method, Point, Solved};

/// Largest estimated error of the peak pressure that a point short of its tolerance may keep, relative.
pub(crate) const LARGEST_ERROR: f64 = 0.2;

/// The solution at this tolerance or, where the largest mesh does not reach it, the best one that there is.
///
/// Its `p_max_error` tells which of the two it is: a table without such points would be no table.
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
pub(crate) fn figures(solution: &Solution) -> Solved {
    Solved {
        p_max: solution.p_max,
        p_max_error: solution.p_max_error,
        p_mean: solution.p_mean,
        area: solution.area,
        length: solution.length,
        width: solution.width,
        approach: solution.approach,
        errors: Some(Errors {
            p_mean: solution.p_mean_error,
            area: solution.area_error,
            length: solution.length_error,
            width: solution.width_error,
            approach: solution.approach_error,
        }),
        sliding: None,
        method: Method::FiniteElements,
    }
}

/// The figures of a contact by boundary elements.
pub(crate) fn by_boundary_elements(point: &Point, found: &BoundaryElements) -> Solved {
    Solved {
        p_max: found.p_max,
        p_max_error: found.p_max_error,
        p_mean: point.fz / found.area,
        area: found.area,
        length: found.length,
        width: found.width,
        approach: found.approach,
        errors: Some(Errors {
            p_mean: point.fz / found.area * found.area_error / found.area,
            area: found.area_error,
            length: found.length_error,
            width: found.width_error,
            approach: found.approach_error,
        }),
        sliding: None,
        method: Method::BoundaryElements,
    }
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
        let asked = 1e-4;
        let small = Options {
            max_dofs: 100_000,
            p_max_tolerance: asked,
            ..Options::default()
        };
        let solution = best(&paraboloid(), &small).expect("an answer");
        let error = solution.p_max_error / solution.p_max;
        assert!(error > asked && error < LARGEST_ERROR, "{error}");
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
