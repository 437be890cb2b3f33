//! Import of recordings of other programs.

use std::path::{Path, PathBuf};

use kufe_sled::{RunFormat, file_stem, run_file, write_run};
use kufe_telemetry::{
    ExcludedRun, Importer, Note, Plan, PlannedRun, index_csv, model_fragment, plan,
};
use rayon::prelude::*;

use crate::jobs::failure::{Failure, Located};
use crate::jobs::field::NewFiles;
use crate::jobs::watch::Watch;
use crate::results::{ImportList, ImportedRun};

/// File that lists the runs and files of an import.
const LIST: &str = "import.json";
/// File of the part of a model that the mapping states.
const FRAGMENT: &str = "model.import.toml";

/// A mapping, and the runs whose files it names.
pub struct RunImport {
    mapping: PathBuf,
    importer: Importer,
    runs: Vec<PlannedRun>,
    excluded: Vec<ExcludedRun>,
    format: RunFormat,
    fragment: Option<String>,
    strict: bool,
}

/// The result of an import.
pub struct ImportedRuns {
    /// The document.
    pub list: ImportList,
    /// How each run was made.
    pub notes: Vec<Note>,
}

impl RunImport {
    /// Reads the mapping and finds the files of its runs; `strict` refuses runs with missing files
    /// instead of excluding them.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file, key and value.
    pub fn read(mapping: &Path, strict: bool) -> Result<RunImport, Failure> {
        let file = mapping.display().to_string();
        let text = kufe_files::text_of_regular(mapping, 1 << 24).in_file(mapping)?;
        let importer = Importer::new(&text, &file).bad_input()?;
        let folder = mapping.parent().unwrap_or(Path::new(""));
        let Plan { runs, excluded } = plan(importer.mapping(), folder, &file).bad_input()?;
        if let Some(first) = excluded.first().filter(|_| strict) {
            return Err(Failure::BadInput(first.reason.clone()));
        }
        Ok(RunImport {
            mapping: mapping.to_path_buf(),
            runs,
            excluded,
            format: importer.mapping().format,
            fragment: model_fragment(importer.mapping(), &file).bad_input()?,
            importer,
            strict,
        })
    }

    /// The files that are read.
    pub fn inputs(&self) -> Vec<PathBuf> {
        let table = self.importer.mapping().index.table.as_deref();
        let table = table.map(|table| self.mapping.with_file_name(table));
        let files = self.runs.iter().flat_map(|run| run.files.values().cloned());
        let inputs = [self.mapping.clone()].into_iter().chain(table);
        inputs.chain(files).collect()
    }

    /// Reads, converts and resamples the runs, and writes them with runs.csv, import.json and, of
    /// each run, RUN.import.json. Runs that cannot be imported are excluded.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with file, channel, row, value and what was expected where no run can
    /// be imported or one is refused, and for a file that cannot be written; [`Failure::Partial`]
    /// where it was stopped.
    pub fn write(mut self, output: &NewFiles, watch: &Watch) -> Result<ImportedRuns, Failure> {
        watch.progress("importing the runs");
        let write = |run| self.write_run(run, output, watch);
        let written: Vec<_> = self.runs.par_iter().map(write).collect();
        let (mut notes, mut imported) = (Vec::new(), Vec::new());
        for (run, written) in self.runs.into_iter().zip(written) {
            match written? {
                Ok(note) => {
                    notes.push(note);
                    imported.push(run);
                }
                Err(reason) if self.strict => return Err(Failure::BadInput(reason)),
                Err(reason) => self.excluded.push(ExcludedRun {
                    run: run.name,
                    reason,
                }),
            }
        }
        if imported.is_empty() {
            let first = self.excluded.into_iter().next().map(|run| run.reason);
            return Err(Failure::BadInput(first.unwrap_or_default()));
        }
        let index = index_csv(&imported, self.format.extension()).bad_input()?;
        output.bytes("runs.csv", index)?;
        if let Some(fragment) = &self.fragment {
            output.bytes(FRAGMENT, fragment)?;
        }
        let list = ImportList {
            mapping: self.mapping.display().to_string(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            files: names_of(&imported, self.format, self.fragment.is_some()),
            runs: notes.iter().map(ImportedRun::of).collect(),
            excluded: self.excluded,
        };
        output.json(LIST, &list)?;
        Ok(ImportedRuns { list, notes })
    }

    /// Imports one run and writes its files. The inner error is the reason why it cannot be
    /// imported.
    fn write_run(
        &self,
        planned: &PlannedRun,
        output: &NewFiles,
        watch: &Watch,
    ) -> Result<Result<Note, String>, Failure> {
        let stopped = |failure: Failure| failure.within(self.mapping.display());
        watch.check().map_err(stopped)?;
        let imported = match self.importer.run(planned) {
            Ok(imported) => imported,
            Err(error) => return Ok(Err(error.to_string())),
        };
        output.write(&run_file(&planned.name, self.format), |mut file| {
            write_run(&imported.run, &mut file, self.format)
        })?;
        output.json(&note_file(&planned.name), &imported.note)?;
        Ok(Ok(imported.note))
    }
}

impl ImportedRuns {
    /// The failure that names the runs that were not imported; `None` if all were.
    pub fn shortfall(&self) -> Option<Failure> {
        let excluded = &self.list.excluded;
        let names: Vec<&str> = excluded.iter().map(|run| run.run.as_str()).collect();
        let (missing, count) = (names.len(), names.len() + self.list.runs.len());
        let names = names.join(", ");
        let text = format!("{missing} of {count} runs are not imported: {names}");
        (missing > 0).then_some(Failure::Partial(text))
    }
}

/// Name of the file that describes how a run was imported.
fn note_file(run: &str) -> String {
    format!("{}.import.json", file_stem(run))
}

/// Names of the files of an import.
fn names_of(runs: &[PlannedRun], format: RunFormat, fragment: bool) -> Vec<String> {
    let mut names = vec!["runs.csv".to_owned(), LIST.to_owned()];
    names.extend(fragment.then(|| FRAGMENT.to_owned()));
    for run in runs {
        names.push(run_file(&run.name, format));
        names.push(note_file(&run.name));
    }
    names
}
