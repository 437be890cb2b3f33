//! A case's groove, and the pressure at which its ice yields.

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
    /// [`IceHardness`] of its temperature and of the time that it is under the runner.
    TimeLaw,
    /// It would melt before it yields.
    Melting,
}

impl HardnessFrom {
    /// As `result.json` has it.
    pub fn name(self) -> &'static str {
        match self {
            HardnessFrom::Given => "given",
            HardnessFrom::TemperatureLaw => "temperature-law",
            HardnessFrom::TimeLaw => "time-law",
            HardnessFrom::Melting => "melting",
        }
    }
}

/// The law that a case states.
#[derive(Clone, Copy, Debug)]
pub(crate) enum HardnessLaw {
    Given(f64),
    OfTemperature,
    OfTime(IceHardness),
}

impl HardnessLaw {
    /// Of a case with the hardness `stated` in its table of the ice [Pa], the word
    /// "from-temperature" being none.
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

    /// Whether the time under the runner counts.
    pub fn of_time(&self) -> bool {
        matches!(self, HardnessLaw::OfTime(_))
    }

    /// Hardness [Pa] of ice at `ice_c` [C] that is `contact_time` [s] under the runner, and its
    /// source.
    ///
    /// # Errors
    /// [`kufe_sled::Error::OutOfRange`] for a time that is not positive.
    pub fn at(
        &self,
        ice_c: f64,
        contact_time: f64,
    ) -> Result<(f64, HardnessFrom), kufe_sled::Error> {
        let (own, from) = match self {
            HardnessLaw::Given(pressure) => (*pressure, HardnessFrom::Given),
            HardnessLaw::OfTemperature => (ice_hardness(ice_c), HardnessFrom::TemperatureLaw),
            HardnessLaw::OfTime(law) => {
                let own = law.at(ice_c, contact_time, &Properties::WATER_AND_ICE)?;
                (own, HardnessFrom::TimeLaw)
            }
        };
        // The law of creep has the melting pressure in it already.
        let melting = ice_melting_pressure(ice_c);
        Ok(if own < melting {
            (own, from)
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
    /// Why the requested accuracy was not reached, where it was not.
    pub short: Option<Failure>,
}

/// The pressure at which the ice yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hardness {
    /// The pressure [Pa].
    pub value: f64,
    /// Its source.
    pub from: HardnessFrom,
    /// Time that the ice is under the runner: the patch's length over the speed [s].
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

/// Most grooves until hardness and contact time agree.
const ROUNDS: usize = 8;
/// What they may differ by, the hardness over itself: of coarse grooves, and of the last ones over
/// the requested accuracy, for lengths on two meshes scatter by about that and a third of it is the
/// hardness's.
const COARSELY: f64 = 1e-2;
const CLOSELY: f64 = 0.25;
/// Share of a change of the hardness that its contact time gives back, where H ~ t^(-1/3) and the
/// length l ~ H^(-1/2).
const GIVEN_BACK: f64 = 1.0 / 6.0;
/// Cells over half the patch of a coarse groove.
const COARSE: usize = 6;
/// The patch of a bob runner, from which the search begins [m].
const USUAL_LENGTH: f64 = 0.05;

impl<'a> Ploughing<'a> {
    /// The case's, with the groove that it meets.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for that groove and for an anchor of the law of creep.
    pub fn new(
        loaded: &'a LoadedCase,
        sliding: &'a SlidingTable,
        problem: &'a Problem,
    ) -> Result<Self, Failure> {
        let remaining = |folder: &std::path::PathBuf| groove_left(&loaded.base.join(folder));
        let before = sliding.previous.as_ref().map(remaining).transpose();
        Ok(Ploughing {
            loaded,
            sliding,
            problem,
            before: before.map_err(|failure| failure.within(&loaded.name))?,
            law: HardnessLaw::of(loaded, sliding)?,
        })
    }

    /// The groove, and where the law needs it the hardness that goes with its contact time; the
    /// best one where the accuracy is not reached.
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
            cells: Some(COARSE),
            ..options.clone()
        };
        let (first, _) = self.hardness(USUAL_LENGTH / self.sliding.v_mps)?;
        let first = self.agreed(first, &coarse, COARSELY)?.hardness.value;
        self.agreed(first, options, CLOSELY * options.p_max_tolerance)
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

    /// Groove after groove, each at the hardness of the contact time of the last one.
    fn agreed(&self, first: f64, options: &Options, within: f64) -> Result<SolvedGroove, Failure> {
        let (mut value, mut apart) = (first, f64::INFINITY);
        for _ in 0..ROUNDS {
            let (groove, requested) = self.solved(value, options)?;
            let change = (requested / value).ln();
            apart = change.abs();
            if apart <= within {
                return Ok(groove);
            }
            value = match groove.hardness.from {
                HardnessFrom::Melting => requested,
                _ => value * (change / (1.0 - GIVEN_BACK)).exp(),
            };
        }
        Err(Failure::NotConverged(format!(
            "{}: sliding.hardness: hardness and contact time still differ by {apart:.1e} of the hardness after {ROUNDS} grooves, requested {within:.1e}",
            self.loaded.name
        )))
    }

    /// The groove in ice of another hardness [Pa], and why it is short of the requested accuracy,
    /// where it is.
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

/// Stretches along x that touch.
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
/// [`Failure::BadInput`] naming the file where it is missing, has no channel `depth`, or holds no
/// depths.
fn groove_left(folder: &Path) -> Result<GrooveProfile, Failure> {
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
