//! Which points of a table boundary elements may solve: what finite elements say of them at the
//! ends of the axes.

use kufe_contact::{BoundaryElements, Problem, Solution, VerifiedBem, boundary_elements};
use kufe_lut::{Figures, Point, each};

use crate::jobs::table::best::figures;

/// The points at the ends of a plan's axes, solved by finite elements, and what these say of
/// boundary elements.
#[derive(Debug)]
pub(crate) struct Anchors {
    solved: Vec<(Point, Figures)>,
    anchored: Option<VerifiedBem>,
}

impl Anchors {
    /// Points that are each solved by itself.
    pub fn none() -> Self {
        Anchors {
            solved: Vec::new(),
            anchored: None,
        }
    }

    /// The contacts at `points`, by `solve` where boundary elements have an answer for each of
    /// them.
    pub fn at<E: Send>(
        points: Vec<(Point, Problem)>,
        tolerance: f64,
        solve: impl Fn(&Problem) -> Result<Solution, E> + Sync,
    ) -> Result<Self, (Point, E)> {
        if points
            .iter()
            .any(|(_, problem)| boundary_elements(problem).is_err())
        {
            return Ok(Anchors::none());
        }
        let solutions = each(&points, |(point, problem)| {
            solve(problem).map_err(|error| (*point, error))
        });
        let solutions = solutions.into_iter().collect::<Result<Vec<_>, _>>()?;
        let solved = points.iter().zip(&solutions);
        let solved = solved.map(|((point, _), solution)| (*point, figures(solution)));
        let solved = solved.collect();
        let problems = points.into_iter().map(|(_, problem)| problem);
        let pairs: Vec<(Problem, Solution)> = problems.zip(solutions).collect();
        Ok(Anchors {
            solved,
            anchored: VerifiedBem::at(&pairs, tolerance),
        })
    }

    /// The figures at an anchor.
    pub fn figures(&self, point: &Point) -> Option<Figures> {
        let same = self.solved.iter().find(|(anchor, _)| anchor == point);
        same.map(|(_, solved)| *solved)
    }

    /// The contact by boundary elements, where these are anchored and good enough.
    pub fn answer(&self, problem: &Problem) -> Option<BoundaryElements> {
        self.anchored?.answer(problem)
    }
}
