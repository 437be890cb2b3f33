//! The kinds of JSON documents that commands write, identified by their keys.

use crate::results::datum::Datum;

/// A kind of document.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DocumentKind {
    /// What it describes.
    pub name: &'static str,
    /// The command that writes it.
    pub command: &'static str,
    /// The keys that it has and no earlier kind of [`DOCUMENT_KINDS`] has all of; of a list, its
    /// first row.
    keys: &'static [&'static str],
}

const fn kind(
    name: &'static str,
    command: &'static str,
    keys: &'static [&'static str],
) -> DocumentKind {
    DocumentKind {
        name,
        command,
        keys,
    }
}

/// All kinds of documents.
#[rustfmt::skip]
const DOCUMENT_KINDS: [DocumentKind; 21] = [
    kind("a solved contact", "kufe press", &["p_max_pa", "kkt_residual", "history"]),
    kind("a comparison of two contacts", "kufe compare", &["quantities", "map", "first"]),
    kind("a series of contacts", "kufe press", &["step", "folder"]),
    kind("an evaluation of drivers", "kufe evaluate", &["runs", "groups", "interval"]),
    kind("a finding", "kufe discover", &["verdict", "steps", "held_out"]),
    kind("the runner with the least friction", "kufe friction --optimise", &["parameters", "response_scatter"]),
    kind("friction over speed and temperature", "kufe friction", &["points", "cases"]),
    kind("a fit of lateral friction", "kufe fit lateral", &["front", "rear", "excluded_contacts"]),
    kind("a fit of mu over pressure", "kufe friction fit", &["parameters", "covariance_bcd"]),
    kind("a comparison of model and runs", "kufe validate", &["runs", "left_out_as_fitted"]),
    kind("simulated runs", "kufe simulate", &["runs", "times_real_time"]),
    kind("a replay of a measured run", "kufe simulate --replay", &["replay", "measured"]),
    kind("gliding runs in an ice house", "kufe icehouse", &["specimens", "uphill"]),
    kind("an examination of runs", "kufe runs check", &["index", "wrong", "runs"]),
    kind("runs on one distance along their track", "kufe runs align", &["index", "tracks"]),
    kind("imported runs", "kufe runs import", &["mapping", "files", "runs"]),
    kind("sample runs, and what is hidden in them", "kufe simulate --sample-data", &["seed", "drivers", "runs"]),
    kind("the quality of a mesh", "kufe mesh", &["ice", "version"]),
    kind("the plan of a table", "kufe lut plan", &["shards", "points", "origin"]),
    kind("how an imported run was made", "kufe runs import", &["mapping_sha256", "channels"]),
    kind("a schema by which editors check a file of keys", "kufe init, kufe schema", &["type", "properties"]),
];

impl DocumentKind {
    /// The kind of a document; `None` for one that kufe did not write.
    pub fn of(document: &Datum) -> Option<&'static DocumentKind> {
        let keys = document.list().first().unwrap_or(document).group()?;
        let fits = |kind: &&DocumentKind| kind.keys.iter().all(|key| keys.get(key).is_some());
        DOCUMENT_KINDS.iter().find(fits)
    }
}
