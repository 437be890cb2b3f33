//! The kinds of JSON documents that commands write, identified by their keys.

use crate::results::datum::Datum;

/// A kind of document.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DocumentKind {
    /// Contents of the document.
    pub name: &'static str,
    /// The command that writes it.
    pub command: &'static str,
}

/// All kinds of documents: name, command, and the keys by which a kind is recognised. The first
/// kind whose keys are all present applies; for a list, the keys of its first row count.
#[rustfmt::skip]
const DOCUMENT_KINDS: [(&str, &str, &[&str]); 21] = [
    ("a solved contact", "kufe press", &["p_max_pa", "kkt_residual", "history"]),
    ("a comparison of two contacts", "kufe compare", &["quantities", "map", "first"]),
    ("a series of contacts", "kufe press", &["step", "folder"]),
    ("an evaluation of drivers", "kufe evaluate", &["runs", "groups", "interval"]),
    ("a finding", "kufe discover", &["verdict", "steps", "held_out"]),
    ("the runner with the least friction", "kufe friction --optimise", &["parameters", "response_scatter"]),
    ("friction over speed and temperature", "kufe friction", &["points", "cases"]),
    ("a fit of lateral friction", "kufe fit lateral", &["front", "rear", "excluded_contacts"]),
    ("a fit of mu over pressure", "kufe friction fit", &["parameters", "covariance_bcd"]),
    ("a comparison of model and runs", "kufe validate", &["runs", "left_out_as_fitted"]),
    ("simulated runs", "kufe simulate", &["runs", "times_real_time"]),
    ("a replay of a measured run", "kufe simulate --replay", &["replay", "measured"]),
    ("gliding runs in an ice house", "kufe icehouse", &["specimens", "uphill"]),
    ("an examination of runs", "kufe runs check", &["index", "wrong", "runs"]),
    ("runs on one distance along their track", "kufe runs align", &["index", "tracks"]),
    ("imported runs", "kufe runs import", &["mapping", "files", "runs"]),
    ("sample runs, and what is hidden in them", "kufe simulate --sample-data", &["seed", "drivers", "runs"]),
    ("the quality of a mesh", "kufe mesh", &["ice", "version"]),
    ("the plan of a table", "kufe lut plan", &["shards", "points", "origin"]),
    ("how an imported run was made", "kufe runs import", &["mapping_sha256", "channels"]),
    ("a schema by which editors check a file of keys", "kufe init, kufe schema", &["type", "properties"]),
];

impl DocumentKind {
    /// The kind of a document; `None` for one that kufe did not write.
    pub fn of(document: &Datum) -> Option<DocumentKind> {
        let group = document.list().first().unwrap_or(document).group()?;
        let mut kinds = DOCUMENT_KINDS.into_iter();
        let fits = |keys: &[&str]| keys.iter().all(|key| group.contains_key(*key));
        let (name, command, _) = kinds.find(|(_, _, keys)| fits(keys))?;
        Some(DocumentKind { name, command })
    }
}
