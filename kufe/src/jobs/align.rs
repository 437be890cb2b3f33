//! Alignment of recorded runs to a common distance along their track.

use std::collections::BTreeMap;
use std::path::PathBuf;

use kufe_sled::{
    Needs, PrepareOptions, Prepared, Run, Track, TrackEstimate, TrackShape, align, prepare_all,
    read_runs, state_places, track_file,
};

use crate::jobs::failure::Failure;
use crate::jobs::runs::{gaps_of, load_model, on_gaps, run_inputs};
use crate::jobs::watch::Watch;
use crate::results::{AlignedTrack, Alignment, TrackErrors};

/// Input files and options of an alignment.
#[derive(Clone, Debug)]
pub struct AlignOptions {
    /// Index file of the runs.
    pub runs: PathBuf,
    /// Model file of the sled: positions of its sensors, and tolerances.
    pub model: PathBuf,
    /// Estimate every track from its runs, even if a survey exists.
    pub estimate: bool,
    /// Refuse runs with gaps.
    pub strict: bool,
}

/// Runs with their distance along the tracks.
pub struct AlignedRuns {
    /// The runs.
    pub runs: Vec<Run>,
    /// Name and table of each track; `None` if no two runs overlap.
    pub tracks: Vec<(String, Option<TrackTable>)>,
    /// The document.
    pub document: Alignment,
}

/// The table of a track.
pub enum TrackTable {
    /// Table of a survey.
    Survey(Track),
    /// Estimate from the runs.
    Estimate(TrackEstimate),
}

impl TrackTable {
    /// Writes the table.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write_csv(&self, writer: impl std::io::Write) -> std::io::Result<()> {
        match self {
            TrackTable::Survey(track) => track.write_csv(writer),
            TrackTable::Estimate(estimate) => estimate.write_csv(writer),
        }
    }
}

impl AlignOptions {
    /// The files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = run_inputs(&self.runs);
        inputs.push(self.model.clone());
        inputs
    }

    /// The survey of a track, where there is one and the track is not to be estimated.
    fn survey_file(&self, track: &str) -> Option<PathBuf> {
        let file = self.runs.with_file_name(track_file(track));
        (!self.estimate && file.exists()).then_some(file)
    }

    /// Reads the runs and aligns them track by track.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place, and for a run that is not on its track, or on
    /// several places of it.
    pub fn align(&self, watch: &Watch) -> Result<AlignedRuns, Failure> {
        watch.progress("reading the runs");
        let (model, vehicle) = load_model(&self.model)?;
        let needs = Needs::PLACE;
        let mut runs = read_runs(&self.runs, &needs, on_gaps(self.strict))?;
        watch.progress(&format!("aligning {} runs", runs.len()));
        let options = PrepareOptions {
            needs,
            ..PrepareOptions::default()
        };
        let prepared = prepare_all(&runs, &vehicle, model.noise.as_ref(), &options)?;
        let mut members: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (i, run) in prepared.iter().enumerate() {
            members.entry(&run.entry.track).or_default().push(i);
        }
        let tolerances = model.tolerances.unwrap_or_default();
        let (mut tracks, mut documents) = (Vec::new(), Vec::new());
        for (name, members) in members {
            let track_runs: Vec<&Prepared> = members.iter().map(|i| &prepared[*i]).collect();
            let survey = self.survey_file(name);
            let survey = survey.map(|path| Track::load(&path)).transpose()?;
            let shape = survey.as_ref().map(TrackShape::new);
            let aligned = align(&track_runs, &vehicle, shape.as_ref(), &tolerances)?;
            for (i, run) in members.iter().zip(&aligned.runs) {
                state_places(&mut runs[*i], &run.warp)?;
            }
            documents.push(AlignedTrack {
                track: name.to_owned(),
                surveyed: survey.is_some(),
                runs: aligned.runs,
                estimate: aligned.estimate.as_ref().map(TrackErrors::of),
            });
            let estimate = aligned.estimate.map(TrackTable::Estimate);
            let table = survey.map(TrackTable::Survey).or(estimate);
            if table.is_none() {
                watch.warn(&format!(
                    "track {name}: no two runs overlap: no track is estimated"
                ));
            }
            tracks.push((name.to_owned(), table));
        }
        let document = Alignment {
            index: self.runs.display().to_string(),
            tracks: documents,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            gaps: gaps_of(&prepared),
        };
        Ok(AlignedRuns {
            runs,
            tracks,
            document,
        })
    }
}
