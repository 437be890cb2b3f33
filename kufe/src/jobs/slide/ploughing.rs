//! The groove of a case, and the hardness of its ice.

use std::path::Path;

use kufe_contact::{
    Error, GrooveProfile, Measure, Options, Problem, SlidingSolution, ice_hardness,
    ice_melting_pressure, slide,
};
use kufe_mesh::ExrImage;
use kufe_sled::friction::film::{IceHardness, Properties};

use crate::case::{self, GROOVE_FILE, SlidingTable};
use crate::jobs::case_file::LoadedCase;
use crate::jobs::failure::{Failure, Located};
use crate::jobs::slide::sliding::film_failure;

/// The source of the pressure at which the ice yields.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum HardnessFrom {
    /// The case states it.
    Given,
    /// [`ice_hardness`] of its temperature.
    TemperatureLaw,
    /// [`IceHardness`] of its temperature and its contact time under the runner.
    TimeLaw,
    /// The melting pressure, which is below the hardness.
    Melting,
}

impl HardnessFrom {
    /// The value of `hardness_from` in `result.json`.
    pub fn name(self) -> &'static str {
        match self {
            HardnessFrom::Given => "given",
            HardnessFrom::TemperatureLaw => "temperature-law",
            HardnessFrom::TimeLaw => "time-law",
            HardnessFrom::Melting => "melting",
        }
    }
}

/// The hardness law of a case.
#[derive(Clone, Copy, Debug)]
pub(crate) enum HardnessLaw {
    Given(f64),
    OfTemperature,
    OfTime(IceHardness),
}

impl HardnessLaw {
    /// The law of a case. The word "from-temperature" in `ice.hardness_pa` is not a stated
    /// hardness.
    pub fn of(loaded: &LoadedCase, sliding: &SlidingTable) -> Result<Self, Failure> {
        Ok(match (loaded.case.ice.hardness_pa, &sliding.hardness) {
            (Some(case::Hardness::Stated(pressure)), _) => HardnessLaw::Given(pressure),
            (_, Some(anchor)) => HardnessLaw::OfTime(
                IceHardness::new(anchor.pressure_pa, anchor.ice_c, anchor.contact_time_s)
                    .map_err(film_failure(loaded))?,
            ),
            _ => HardnessLaw::OfTemperature,
        })
    }

    /// Whether the hardness depends on the contact time.
    pub fn of_time(&self) -> bool {
        matches!(self, HardnessLaw::OfTime(_))
    }

    /// Hardness [Pa] of ice at `ice_c` [C] after `contact_time` [s] under the runner, bounded by
    /// the melting pressure, and its source.
    ///
    /// # Errors
    /// [`kufe_sled::Error::OutOfRange`] for a time that is not positive.
    pub fn at(
        &self,
        ice_c: f64,
        contact_time: f64,
    ) -> Result<(f64, HardnessFrom), kufe_sled::Error> {
        let (hardness, from) = match self {
            HardnessLaw::Given(pressure) => (*pressure, HardnessFrom::Given),
            HardnessLaw::OfTemperature => (ice_hardness(ice_c), HardnessFrom::TemperatureLaw),
            HardnessLaw::OfTime(law) => {
                let hardness = law.at(ice_c, contact_time, &Properties::WATER_AND_ICE)?;
                (hardness, HardnessFrom::TimeLaw)
            }
        };
        // The law of creep includes the melting pressure already.
        let melting = ice_melting_pressure(ice_c);
        Ok(if hardness < melting {
            (hardness, from)
        } else {
            (melting, HardnessFrom::Melting)
        })
    }
}

/// A groove and the hardness of the ice that it was ploughed in.
#[derive(Clone, Debug, PartialEq)]
pub struct SolvedGroove {
    /// The groove and its contact.
    pub solution: SlidingSolution,
    /// Pressure at which the ice yields.
    pub hardness: Hardness,
    /// Why the requested accuracy was not reached; `None` if it was reached.
    pub short: Option<Failure>,
}

/// The pressure at which the ice yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hardness {
    /// The pressure [Pa].
    pub value: f64,
    /// Its source.
    pub from: HardnessFrom,
    /// Contact time of the ice under the runner: ratio of the patch's length to the speed [s].
    pub contact_time: Measure,
}

/// A case whose runner ploughs.
pub(crate) struct Ploughing<'a> {
    pub loaded: &'a LoadedCase,
    pub sliding: &'a SlidingTable,
    problem: &'a Problem,
    before: Option<GrooveProfile>,
    pub law: HardnessLaw,
}

/// Largest number of fixed-point iterations between hardness and contact time.
const MAX_ITERATIONS: usize = 8;
/// Relative tolerance of the hardness on coarse grooves.
const COARSE_RTOL: f64 = 1e-2;
/// Ratio of the relative tolerance of the hardness on the last grooves to the requested accuracy:
/// patch lengths on two meshes scatter by about the accuracy, and the hardness by a third of that.
const RTOL_FACTOR: f64 = 0.25;
/// Feedback of a change of ln H through the contact time: 1/3 times 1/2, since H ~ t^(-1/3) and the
/// patch length l ~ H^(-1/2).
const FEEDBACK: f64 = 1.0 / 6.0;
/// Number of cells across half the patch of a coarse groove.
const COARSE_CELLS: usize = 6;
/// Patch length of a bob runner, with which the iteration starts [m].
const INITIAL_LENGTH: f64 = 0.05;

impl<'a> Ploughing<'a> {
    /// The ploughing of a case, with the groove of a previous runner where the case names one.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for the previous groove and for an anchor of the law of creep.
    pub fn new(
        loaded: &'a LoadedCase,
        sliding: &'a SlidingTable,
        problem: &'a Problem,
    ) -> Result<Self, Failure> {
        let profile = |folder: &std::path::PathBuf| previous_groove(&loaded.base.join(folder));
        let before = sliding.previous.as_ref().map(profile).transpose();
        Ok(Ploughing {
            loaded,
            sliding,
            problem,
            before: before.map_err(|failure| failure.within(&loaded.name))?,
            law: HardnessLaw::of(loaded, sliding)?,
        })
    }

    /// The groove; with a hardness that depends on contact time, in ice whose hardness is
    /// consistent with the groove's length. The best groove where the accuracy is not reached.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for the case and a contact in parts, [`Failure::NotConverged`] where
    /// the solver stops short.
    pub fn groove(&self, options: &Options) -> Result<SolvedGroove, Failure> {
        if !self.law.of_time() {
            let value = self.problem.ice.hardness.unwrap_or(f64::INFINITY);
            return Ok(self.solved(value, options)?.0);
        }
        let coarse = Options {
            cells: Some(COARSE_CELLS),
            ..options.clone()
        };
        let (first, _) = self.hardness(INITIAL_LENGTH / self.sliding.v_mps)?;
        let first = self.iterate(first, &coarse, COARSE_RTOL)?.hardness.value;
        self.iterate(first, options, RTOL_FACTOR * options.p_max_tolerance)
    }

    /// The groove in ice of this hardness [Pa], and the hardness that the law states for its
    /// contact time.
    fn solved(&self, value: f64, options: &Options) -> Result<(SolvedGroove, f64), Failure> {
        let (solution, short) = self.at(value, options)?;
        let [front, back] = [solution.groove.front, solution.groove.back];
        let contact_time = Measure {
            value: (front.value - back.value) / self.sliding.v_mps,
            error: (front.error + back.error) / self.sliding.v_mps,
        };
        let (requested, from) = self.hardness(contact_time.value)?;
        let hardness = Hardness {
            value,
            from,
            contact_time,
        };
        let groove = SolvedGroove {
            solution,
            hardness,
            short,
        };
        Ok((groove, requested))
    }

    /// Fixed-point iteration from the hardness `first` [Pa]: each groove is solved at the hardness
    /// of the previous contact time, until the relative change is at most `rtol`.
    fn iterate(&self, first: f64, options: &Options, rtol: f64) -> Result<SolvedGroove, Failure> {
        let (mut value, mut difference) = (first, f64::INFINITY);
        for _ in 0..MAX_ITERATIONS {
            let (groove, requested) = self.solved(value, options)?;
            let change = (requested / value).ln();
            difference = change.abs();
            if difference <= rtol {
                return Ok(groove);
            }
            value = match groove.hardness.from {
                HardnessFrom::Melting => requested,
                _ => value * (change / (1.0 - FEEDBACK)).exp(),
            };
        }
        Err(Failure::NotConverged(format!(
            "{}: sliding.hardness: hardness and contact time still differ by {difference:.1e} of the hardness after {MAX_ITERATIONS} grooves, requested {rtol:.1e}",
            self.loaded.name
        )))
    }

    /// The groove in ice of another hardness [Pa], and why the requested accuracy was not reached
    /// (`None` if it was).
    ///
    /// # Errors
    /// As [`groove`](Self::groove).
    pub fn at(
        &self,
        hardness: f64,
        options: &Options,
    ) -> Result<(SlidingSolution, Option<Failure>), Failure> {
        let mut problem = self.problem.clone();
        problem.ice.hardness = Some(hardness);
        let refused = |reason: String| self.loaded.bad_input(format_args!("[sliding]: {reason}"));
        let (solution, short) = match slide(&problem, self.before.as_ref(), options) {
            Ok(solution) => (solution, None),
            Err(error @ Error::NotSliding { .. }) => return Err(refused(error.to_string())),
            Err(error) => {
                let failure = self.loaded.failure(&error);
                match error {
                    Error::SlidingAccuracyNotReached { best, .. } => (*best, Some(failure)),
                    _ => return Err(failure),
                }
            }
        };
        match parts(&solution) {
            1 => Ok((solution, short)),
            parts => Err(refused(format!(
                "the contact lies in {parts} parts, one behind the other: expected one, for the film begins at its front"
            ))),
        }
    }

    fn hardness(&self, contact_time: f64) -> Result<(f64, HardnessFrom), Failure> {
        let found = self.law.at(self.sliding.ice_c, contact_time);
        found.map_err(film_failure(self.loaded))
    }
}

/// Number of separate contact patches along x.
fn parts(solution: &SlidingSolution) -> usize {
    let field = &solution.contact.surface;
    let nx = field.x.len();
    let touches = |i: usize| field.pressure.iter().skip(i).step_by(nx).any(|p| *p > 0.0);
    (0..nx)
        .filter(|&i| touches(i) && (i == 0 || !touches(i - 1)))
        .count()
}

/// The section at the back of the depth map `groove.exr` in `folder`.
///
/// # Errors
/// [`Failure::BadInput`] naming the file where it is missing, has no channel `depth`, or has
/// invalid depths.
fn previous_groove(folder: &Path) -> Result<GrooveProfile, Failure> {
    let path = folder.join(GROOVE_FILE);
    let read = || {
        let image = ExrImage::load(&path)?;
        let depth = image.channel("depth").in_file(&path)?;
        let [columns, rows] = image.size;
        let y = (0..rows).map(|j| image.origin_m[1] + j as f64 * image.pixel_m[1]);
        let last = (0..rows).map(|j| depth[j * columns]);
        GrooveProfile::new(y.collect(), last.collect()).in_file(&path)
    };
    read().map_err(|failure| failure.within("sliding.previous"))
}
