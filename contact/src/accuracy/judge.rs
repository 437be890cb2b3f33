//! Whether the meshes solved so far are enough, and else what comes next.

use crate::Solution;
use crate::accuracy::extrapolation::{LEAST_REFINEMENT, REFINEMENT, next_refinement};
use crate::accuracy::meshes::{Contact, FEWEST, Meshes, Plan, REGRADINGS};
use crate::accuracy::order::Limit;
use crate::accuracy::watched::Limits;
use crate::grid::discretise::expected;
use crate::grid::patch::COARSE;
use crate::result::elsewhere::Penetration;

/// Share of the error asked that a first mesh's rims may take: where the patch was guessed worse, the contact's own is meshed before any
/// other. The rest is for the cells.
const BY_RIMS: f64 = 0.5;

/// What is to be done after a mesh.
pub(crate) enum Verdict {
    /// The accuracy asked is reached, with this limit of fine meshes.
    Reached(Limits),
    /// Another mesh is needed.
    Refine(Plan),
    /// The runner touches where contact was not looked for.
    Widen(Vec<Penetration>),
    /// Another mesh is needed and would have too many unknowns, or finer cells than the runner's own; what the meshes tend to, where
    /// that is known.
    OutOfReach(Option<Limits>),
}

/// How far the best solution is from what was asked.
pub(crate) struct Estimate {
    /// Its relative error.
    pub relative: f64,
    /// Smallest cells that its pressure asks for somewhere, over those there.
    pub finest: f64,
}

impl Meshes<'_> {
    /// Whether the meshes solved so far are enough, and else what comes next.
    pub fn judge(&self, contact: &Contact) -> Verdict {
        let verdict = self.judge_accuracy(contact);
        // Uneven ice touches at many places: none is waited for until the others are solved finely.
        let early = self.solved.similar() <= 1 && self.problem.ice_surface.is_some();
        if matches!(verdict, Verdict::Refine(_)) && !early {
            return verdict;
        }
        let mut found = self.on(contact).elsewhere();
        // What was looked for late and stayed open is no place of contact, whatever a mesh says that no longer looks there.
        found.retain(|place| {
            let [x, y] = place.at;
            // Where contact is looked for it lies between the nodes.
            expected(&self.patch, x, y) || !self.widened.iter().any(|patch| expected(patch, x, y))
        });
        match found.is_empty() {
            true => verdict,
            false => Verdict::Widen(found),
        }
    }

    fn judge_accuracy(&self, contact: &Contact) -> Verdict {
        if self.options.cells.is_some() {
            return Verdict::Reached(self.unjudged(contact));
        }
        let limits = self.solved.limits();
        let tolerance = self.options.p_max_tolerance;
        let elsewhere = self.solved.similar() == 1 && self.solved.missed() > BY_RIMS * tolerance;
        let coarse = contact.pressure.patch.finest_over(&self.patch) < COARSE;
        let anew = self.regraded < REGRADINGS && (coarse || elsewhere);
        // That a finer grading changes nothing is as good as that no finer one is wanted.
        let graded = !anew || self.graded_anew;
        if let Some(limits) = limits.filter(|l| graded && l.relative <= tolerance) {
            // Meshes that agree say nothing of what all of them are too coarse for.
            return match coarse && !self.graded_anew {
                true => Verdict::OutOfReach(Some(limits)),
                false => Verdict::Reached(limits),
            };
        }
        let cells = match limits {
            _ if anew => self.cells,
            Some(limits) if self.solved.similar() >= 3 => {
                let room = (self.options.max_dofs as f64 / contact.dofs as f64).cbrt();
                let wished = next_refinement(limits.relative / tolerance);
                // Where that would have too many unknowns, what they allow.
                let finer = match wished <= room {
                    true => (self.cells * wished).round(),
                    false => (self.cells * room.max(LEAST_REFINEMENT)).floor(),
                };
                finer.max(self.cells + 1.0)
            }
            _ => {
                let planned = self.coarsest * REFINEMENT.powi(self.solved.similar() as i32);
                planned.round().max(self.cells + 1.0)
            }
        };
        let cells = match self.own.map(|own| own.ice_cells().floor()) {
            Some(own) if !anew && cells > own && own > self.cells => own,
            Some(own) if !anew && cells > own => return Verdict::OutOfReach(limits),
            _ => cells,
        };
        // A mesh that is graded anew may have some more than its cells say.
        let more = (cells / self.cells).powi(3).max(REFINEMENT);
        let room = self.options.max_dofs as f64 / contact.dofs as f64;
        if more <= room {
            return Verdict::Refine(Plan { anew, cells });
        }
        // Where only the grading is in doubt, a coarser mesh of the finer one tells too.
        let fewer = (self.cells * (room / REFINEMENT).cbrt()).floor();
        match limits.filter(|l| l.relative <= tolerance) {
            Some(_) if fewer >= FEWEST => Verdict::Refine(Plan { anew, cells: fewer }),
            _ => Verdict::OutOfReach(limits),
        }
    }

    /// The best solution there is, and how far it is from what was asked.
    pub fn out_of_reach(self, contact: Contact, limits: Option<Limits>) -> (Solution, Estimate) {
        let best = limits
            .or_else(|| self.solved.last())
            .unwrap_or_else(|| self.unjudged(&contact));
        let estimate = Estimate {
            relative: best.relative,
            finest: contact.pressure.patch.finest_over(&self.patch),
        };
        (self.solution(contact, best), estimate)
    }

    /// One mesh, nothing to tell its errors by.
    fn unjudged(&self, contact: &Contact) -> Limits {
        Limits {
            peak: Limit {
                value: contact.pressure.figures.p_max,
                error: f64::INFINITY,
            },
            approach: contact.mesh.contact.depth(&contact.state),
            area_error: f64::INFINITY,
            length_error: f64::INFINITY,
            relative: f64::INFINITY,
        }
    }
}
