//! Recorded runs brought to one distance along their track.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use kufe_sled::{
    Entry, Model, Needs, PrepareOptions, Prepared, Run, SampleCoverage, Track, TrackEstimate,
    TrackShape, Vehicle, align, prepare_all, read_index, read_runs, state_places, track_file,
};

use crate::jobs::failure::Failure;
use crate::jobs::runs::{on_gaps, run_inputs};
use crate::jobs::watch::Watch;
use crate::results::{AlignedTrack, Alignment, TrackErrors};

/// Which runs are aligned, and how.
#[derive(Clone, Debug)]
pub struct AlignOptions {
    /// Index of the runs.
    pub runs: PathBuf,
    /// Sled: where its sensors are, and its tolerances.
    pub model: PathBuf,
    /// Estimate every track from its runs, also where there is a survey.
    pub estimate: bool,
    /// Refuse runs with gaps.
    pub strict: bool,
}

/// Runs that are read, and what they are aligned with.
pub struct RunsToAlign {
    options: AlignOptions,
    model: Model,
    vehicle: Vehicle,
    needs: Needs,
    runs: Vec<Run>,
}

/// Runs with their places along the tracks.
pub struct AlignedRuns {
    /// The runs.
    pub runs: Vec<Run>,
    /// The tracks by name: the survey, or what the runs measured; none where too few did.
    pub tracks: Vec<(String, Option<TrackTable>)>,
    /// The document.
    pub document: Alignment,
}

/// The table of a track.
pub enum TrackTable {
    /// As surveyed.
    Survey(Track),
    /// As the runs measured it.
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
    fn survey_file(&self, track: &str) -> PathBuf {
        let folder = self.runs.parent().unwrap_or(Path::new(""));
        folder.join(track_file(track))
    }
}

impl RunsToAlign {
    /// Reads model and runs.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file and place.
    pub fn read(options: AlignOptions) -> Result<RunsToAlign, Failure> {
        let model = Model::load(&options.model)?;
        let vehicle = Vehicle::with_effects(&model)?;
        let surveyed =
            |entry: &Entry| !options.estimate && options.survey_file(&entry.track).exists();
        let entries = read_index(&options.runs)?;
        let needs = if entries.iter().all(surveyed) {
            Needs::PLACE
        } else {
            Needs::TRACK
        };
        let runs = read_runs(&options.runs, &needs, on_gaps(options.strict))?;
        Ok(RunsToAlign {
            options,
            model,
            vehicle,
            needs,
            runs,
        })
    }

    /// The files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let mut inputs = run_inputs(&self.options.runs);
        inputs.push(self.options.model.clone());
        inputs
    }

    /// Aligns the runs track by track.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a run that is not on its track, or on several places of it.
    pub fn align(mut self, watch: &Watch) -> Result<AlignedRuns, Failure> {
        watch.progress(&format!("aligning {} runs", self.runs.len()));
        let options = PrepareOptions {
            needs: self.needs,
            ..PrepareOptions::default()
        };
        let noise = self.model.noise.as_ref();
        let prepared = prepare_all(&self.runs, &self.vehicle, noise, &options)?;
        let mut members: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
        for (i, run) in prepared.iter().enumerate() {
            members.entry(&run.entry.track).or_default().push(i);
        }
        let tolerances = self.model.tolerances.unwrap_or_default();
        let (mut tracks, mut documents) = (Vec::new(), Vec::new());
        for (name, members) in members {
            let of: Vec<&Prepared> = members.iter().map(|i| &prepared[*i]).collect();
            let path = self.options.survey_file(name);
            let survey = if self.options.estimate || !path.exists() {
                None
            } else {
                Some(Track::load(&path)?)
            };
            let shape = survey.as_ref().map(TrackShape::new);
            let aligned = align(&of, &self.vehicle, shape.as_ref(), &tolerances)?;
            for (i, found) in members.iter().zip(&aligned.runs) {
                state_places(&mut self.runs[*i], &found.warp)?;
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
                    "track {name}: fewer than two runs measured the same metre: no track is estimated"
                ));
            }
            tracks.push((name.to_owned(), table));
        }
        let coverage = prepared.iter().map(|run| run.taking_part.clone());
        let gaps: Vec<SampleCoverage> = coverage.filter(|run| !run.gaps.is_none()).collect();
        Ok(AlignedRuns {
            runs: self.runs,
            tracks,
            document: Alignment {
                index: self.options.runs.display().to_string(),
                tracks: documents,
                version: env!("CARGO_PKG_VERSION").to_owned(),
                gaps,
            },
        })
    }
}
