//! How data speak of an effect.

/// Which test decides about an effect on runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judged {
    /// Sample by sample within runs, everywhere.
    WithinRuns,
    /// Within runs, in a window of distance on one track that is searched for.
    InWindow,
    /// By its level from run to run.
    BetweenRuns,
    /// By its level from session to session.
    BetweenSessions,
    /// In the balance of speed and height, where no friction is left, as one size everywhere.
    BySlope,
    /// In the same balance, place by place.
    ByProfile,
    /// Sample by sample within runs, where the installation is off by more than its tolerances can mean: else sessions that differ look like it.
    BeyondTolerance,
    /// By measured pressures: no effect on runs.
    ByPressure,
}

/// The level on which an effect varies, and with it the unit that randomisation must move as one piece.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Level {
    /// Within a run, from sample to sample.
    Sample,
    /// From run to run.
    Run,
    /// From session to session.
    Session,
    /// The same in all runs on one track.
    Track,
}

impl Level {
    /// The level in words.
    pub fn name(self) -> &'static str {
        match self {
            Level::Sample => "sample",
            Level::Run => "run",
            Level::Session => "session",
            Level::Track => "track",
        }
    }
}

impl Judged {
    /// What varies as one piece.
    pub fn level(self) -> Level {
        match self {
            Judged::WithinRuns | Judged::BeyondTolerance | Judged::ByPressure => Level::Sample,
            Judged::BetweenRuns => Level::Run,
            Judged::BetweenSessions => Level::Session,
            Judged::InWindow | Judged::BySlope | Judged::ByProfile => Level::Track,
        }
    }
}

/// What a table of friction coefficients says of an effect on them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Experiments {
    /// It can be tested where the columns that it needs are there and vary.
    AsNeeded,
    /// It can be tested where these columns are there and vary.
    Needs(&'static [super::column::Column]),
    /// It cannot be tested, for this reason.
    Never(&'static str),
}
