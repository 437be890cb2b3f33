//! What an output folder holds from earlier runs: what a command may replace of it, and what goes with it.

use std::path::{Path, PathBuf};

use kufe::jobs::Failure;
use kufe_files::same_file;
use serde_json::Value;

use crate::output::documents::{DOCUMENTS, Known, document};
use crate::output::marks::{is_marked, version_of};

/// The key of a document that lists the files written with it, and their lengths [bytes].
pub const FILES: &str = "files";
/// The page that `kufe report` makes of a folder.
const PAGE: &str = "report.html";

/// The documents of an output folder, and the files that they account for.
pub struct Held {
    folder: PathBuf,
    documents: Vec<Document>,
}

struct Document {
    known: &'static Known,
    /// Names and lengths [bytes], where it states them; earlier versions' documents do not.
    files: Option<Vec<(String, Option<u64>)>>,
}

impl Held {
    /// What commands left in `folder`; nothing where there is no such folder.
    pub fn of(folder: &Path) -> Held {
        let mut documents: Vec<Document> = Vec::new();
        for name in DOCUMENTS.iter().map(|known| known.name) {
            if name.is_empty() || documents.iter().any(|one| one.known.name == name) {
                continue;
            }
            if let Some((known, value)) = document(folder, name) {
                let files = listed(&value[FILES]);
                documents.push(Document { known, files });
            }
        }
        Held {
            folder: folder.to_path_buf(),
            documents,
        }
    }

    /// Refuses the folder for a command that writes files of these names, a document among them: where one of them is of another
    /// command's result, of which it reads nothing, and none of its own stands there; and where one of the files is not kufe's.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the folder, or with the file.
    pub fn check(&self, inputs: &[PathBuf], names: &[impl AsRef<Path>]) -> Result<(), Failure> {
        let names: Vec<&Path> = names.iter().map(AsRef::as_ref).collect();
        let writes = |name: &str| names.contains(&Path::new(name));
        if !DOCUMENTS.iter().any(|known| writes(known.name)) {
            return Ok(());
        }
        let own = |one: &&Document| writes(one.known.name);
        let mixes = |one: &&Document| {
            let mut files = one.files.iter().flatten();
            files.any(|(name, _)| writes(name))
        };
        let read = |one: &&Document| self.all(one).any(|path| is_one_of(&path, inputs));
        if !self.documents.iter().any(|one| own(&one) || read(&one))
            && let Some(Document { known, .. }) = self.documents.iter().find(mixes)
        {
            return Err(Failure::BadInput(format!(
                "{}: cannot be written to: it holds {} ({}, by {}); expected another folder",
                self.folder.display(),
                known.kind,
                known.name,
                known.command
            )));
        }
        names
            .iter()
            .try_for_each(|name| self.may_replace(name, &own))
    }

    /// Refuses a file that stands in the folder and that kufe did not write, or not as it is.
    fn may_replace(&self, name: &Path, own: &dyn Fn(&&Document) -> bool) -> Result<(), Failure> {
        let path = self.folder.join(name);
        let Some(length) = path.metadata().ok().filter(|found| found.is_file()) else {
            return Ok(());
        };
        let length = length.len();
        let stated = |one: &Document| match &one.files {
            // It lists none: it accounts for what its command writes.
            None => own(&one).then_some(length),
            Some(files) => {
                let entry = files.iter().find(|(known, _)| Path::new(known) == name);
                entry.map(|(_, stated)| stated.unwrap_or(length))
            }
        };
        let is_document = self
            .documents
            .iter()
            .any(|one| Path::new(one.known.name) == name);
        let lengths: Vec<u64> = self.documents.iter().filter_map(stated).collect();
        if length == 0 || is_document || lengths.contains(&length) || is_marked(&path) {
            return Ok(());
        }
        let reason = match lengths.is_empty() {
            true => "it stands there already and kufe did not write it",
            false => "it was changed since kufe wrote it",
        };
        Err(Failure::BadInput(format!(
            "{}: cannot be written: {reason}; expected another folder",
            path.display()
        )))
    }

    /// The files that the document `name` accounts for and that are as kufe wrote them, the document, and a page that
    /// `kufe report` made of them.
    pub fn written_with(&self, name: &str) -> Vec<PathBuf> {
        let Some(one) = self.documents.iter().find(|one| one.known.name == name) else {
            return Vec::new();
        };
        let as_written = |(name, length): &(String, Option<u64>)| {
            let path = self.folder.join(name);
            let found = path.symlink_metadata().ok()?;
            let same = length.is_none_or(|length| length == found.len());
            (found.is_file() && same).then_some(path)
        };
        let files = one.files.iter().flatten();
        let mut written: Vec<PathBuf> = files.filter_map(as_written).collect();
        written.push(self.folder.join(name));
        let page = self.folder.join(PAGE);
        if page.is_file() && matches!(version_of(&page), Ok(Some(_))) {
            written.push(page);
        }
        written
    }

    /// What goes when a command that reads `inputs` writes files of these names: what its document there was written with,
    /// unless the command reads of it.
    pub fn replaced(&self, inputs: &[PathBuf], names: &[PathBuf]) -> Vec<PathBuf> {
        let own = |one: &&Document| names.iter().any(|name| name == Path::new(one.known.name));
        let own = self.documents.iter().filter(own);
        let read = |one: &&Document| self.all(one).any(|path| is_one_of(&path, inputs));
        own.filter(|one| !read(one))
            .flat_map(|one| self.written_with(one.known.name))
            .collect()
    }

    /// A document and the files that it lists, whether they are there or not.
    fn all<'a>(&'a self, one: &'a Document) -> impl Iterator<Item = PathBuf> + 'a {
        let files = one.files.iter().flatten().map(|(name, _)| name.as_str());
        let names = files.chain([one.known.name]);
        names.map(|name| self.folder.join(name))
    }
}

fn is_one_of(path: &Path, inputs: &[PathBuf]) -> bool {
    inputs.iter().any(|input| same_file(input, path))
}

/// Names with their lengths, or names alone; those that lead out of the folder are left out.
fn listed(files: &Value) -> Option<Vec<(String, Option<u64>)>> {
    let plain = |name: &str| Path::new(name).file_name().is_some_and(|file| file == name);
    let mut all: Vec<(String, Option<u64>)> = match files {
        Value::Object(files) => files
            .iter()
            .map(|(name, length)| (name.clone(), Some(length.as_u64().unwrap_or(u64::MAX))))
            .collect(),
        Value::Array(names) => names
            .iter()
            .filter_map(|name| Some((name.as_str()?.to_owned(), None)))
            .collect(),
        _ => return None,
    };
    all.retain(|(name, _)| plain(name));
    Some(all)
}
