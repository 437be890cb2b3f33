//! The figures of a contact for text and pages: label, value with unit and error, note.

use serde::Serialize;

use crate::plot::{measured, percent, quantity, shown_unit};
use crate::results::contact::{ContactResult, HullFit, RunnerResult, SlidingResult};
use crate::results::datum::{Data, Datum};

use crate::results::quantity::{Mu, PeakPressure, QUANTITIES, ResultQuantity};

/// A figure with its unit and error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// Label of the figure.
    pub name: String,
    /// Value with error and unit.
    pub text: String,
    /// Parts or source of the value; may be empty.
    pub note: String,
}

impl Figure {
    /// A figure with a note.
    pub fn new(name: &str, text: impl Into<String>, note: impl Into<String>) -> Self {
        let (name, text, note) = (name.to_owned(), text.into(), note.into());
        Figure { name, text, note }
    }
}

impl ContactResult {
    /// The peak with its total error first, then the friction, then every other quantity.
    ///
    /// # Errors
    /// Those of a number that cannot be written as JSON.
    pub fn figures(&self) -> serde_json::Result<Vec<Figure>> {
        let mut figures = vec![self.peak_figure()];
        let document = Datum::of(self)?;
        let whole = document.group();
        let parts = ["subsurface", "mu_sensitivity"].map(|key| whole?.get(key)?.group());
        let groups: Vec<&Data> = parts.into_iter().chain([whole]).flatten().collect();
        let first = [PeakPressure::DESCRIPTION, Mu::DESCRIPTION];
        let others = QUANTITIES.iter().filter(|one| !first.contains(one));
        let others = first[1..].iter().chain(others);
        figures.extend(others.filter_map(|one| {
            let text = groups.iter().find_map(|data| measured_in(data, one.key));
            Some(Figure::new(one.label, text?, ""))
        }));
        let absent = self.check_absent.as_deref();
        figures.extend(absent.map(|reason| Figure::new("by boundary elements", "no peak", reason)));
        figures.push(Figure::new("normal force", quantity(self.fz_n, "N"), ""));
        figures.extend(self.hull_fit.as_ref().map(HullFit::figure));
        figures.extend(self.runner.as_ref().map(RunnerResult::figure));
        figures.extend(self.sliding.as_ref().map(SlidingResult::hardness_figure));
        let work = format!("{} unknowns, {} iterations", self.dofs, self.iterations);
        figures.push(Figure::new("solved in", quantity(self.seconds, "s"), work));
        Ok(figures)
    }

    /// The peak with its error and the parts of the error. In ice that yields, the peak is the
    /// hardness, which does not depend on the mesh.
    fn peak_figure(&self) -> Figure {
        let (peak, parts) = (&self.p_max, self.peak_error_parts());
        let note = if parts[0].error == 0.0 {
            "all that the ice bears".to_owned()
        } else {
            let mut note = format!("estimated error {}", percent(peak.error / peak.value));
            if parts.len() > 1 {
                let parts = parts.iter();
                let parts = parts
                    .map(|part| format!("{} by {}", percent(part.error / peak.value), part.source));
                note += &format!(": {}", parts.collect::<Vec<_>>().join(", "));
            }
            if !self.accuracy_reached {
                note += "; the requested accuracy was not reached";
            }
            note
        };
        Figure::new(PeakPressure::DESCRIPTION.label, peak.to_string(), note)
    }
}

impl HullFit {
    fn figure(&self) -> Figure {
        let share = percent(self.residual_over_approach);
        let note = format!("from the hull's vertices, {share} of the approach");
        Figure::new("hull's fit", quantity(self.residual_rms_m, "m"), note)
    }
}

impl RunnerResult {
    fn figure(&self) -> Figure {
        let [x, y, z] = self.runner_von_mises_at_m.map(|place| quantity(place, "m"));
        let stress = quantity(self.runner_von_mises_max_pa, "Pa");
        let note = format!("largest von Mises stress, at x = {x}, y = {y}, z = {z}");
        Figure::new("runner's stress", stress, note)
    }
}

impl SlidingResult {
    fn hardness_figure(&self) -> Figure {
        let from = self.hardness_from.replace('-', " ");
        Figure::new("hardness", quantity(self.hardness_pa, "Pa"), from)
    }
}

/// A number of a document with its error.
pub fn measured_in(data: &Data, key: &str) -> Option<String> {
    let (value, error) = (data.get(key)?.number()?, error_in(data, key)?);
    Some(measured(value, error, &shown_unit(key)))
}

/// The error of a number of a document.
pub fn error_in(data: &Data, key: &str) -> Option<f64> {
    let known = QUANTITIES.iter().find(|known| known.key == key)?;
    data.get(known.error_key)?.number()
}
