//! Search of a campaign's data.

use std::path::{Path, PathBuf};

use kufe_sled::Model;

use crate::error::Result;
use crate::evidence::experiments::evidence::Experiments;
use crate::evidence::maps::evidence::Maps;
use crate::evidence::maps::rows::Measured;
use crate::evidence::runs::campaign::Campaign;
use crate::evidence::{experiments, maps, runs};
use crate::joint::file::{CampaignFile, case_of};
use crate::joint::indexed::{Indexed, KindEvidence};
use crate::joint::kinds::{Joint, PRESSURES};
use crate::options::Options;
use crate::procedure::search::{Found, search_evidence};

/// Searches all data of a campaign together; a single kind is searched as usual.
///
/// # Errors
/// Errors of the campaign's file and of the readers and searches of its data.
pub fn search(path: &Path, options: &Options, progress: &(dyn Fn(&str) + Sync)) -> Result<Found> {
    let files = CampaignFile::read(path)?;
    let model = files.model.as_deref().map(Model::load).transpose()?;
    match (&files.runs, &files.experiments, &files.pressures, &model) {
        (None, Some(rows), None, Some(model)) => {
            return experiments::search(rows, model, options, progress);
        }
        (None, None, Some(pressures), _) => {
            return maps::search(pressures, &case_of(pressures)?, options, progress);
        }
        _ => {}
    }
    options.check_names(model.as_ref())?;
    let model = model.as_ref();
    let read = |index: &PathBuf| {
        progress("reading runs");
        model.map(|model| runs::read(index, model, options))
    };
    let data = files.runs.as_ref().and_then(read).transpose()?;
    if let (Some(data), Some(model), None, None) =
        (&data, model, &files.experiments, &files.pressures)
    {
        return runs::search(data, model, options, progress);
    }
    let measured = match &files.pressures {
        None => None,
        Some(pressures) => {
            let case = case_of(pressures)?;
            let rows = Measured::read(pressures, &case, &options.rules.maps)?;
            Some((case, rows))
        }
    };
    let mut parts: Vec<(&'static str, KindEvidence)> = Vec::new();
    if let (Some(data), Some(model)) = (&data, model) {
        let campaign = Campaign::new(data, model, options)?;
        parts.push(("runs", Box::new(Indexed::new(campaign))));
    }
    if let (Some(rows), Some(model)) = (&files.experiments, model) {
        let experiments = Experiments::read(rows, model, options)?;
        parts.push(("experiments", Box::new(Indexed::new(experiments))));
    }
    if let Some((case, rows)) = &measured {
        progress("solving the case of the pressures");
        let maps = Maps::new(rows, case, options, progress)?;
        parts.push((PRESSURES, Box::new(Indexed::new(maps))));
    }
    let mut joint = Joint::new(parts, options);
    let mut found = search_evidence(&mut joint, options, progress)?;
    if let Some(data) = &data {
        found.report.gaps.clone_from(&data.gaps);
    }
    Ok(found)
}
