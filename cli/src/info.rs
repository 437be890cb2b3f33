//! `kufe info FILE`: the main figures of a hull, a lookup table, a pressure map or a result.

use std::collections::BTreeMap;
use std::io::BufReader;
use std::path::{Path, PathBuf};

use exr::meta::attribute::AttributeValue;
use kufe::jobs::{Failure, Located, table::read_table};
use kufe::report::{MAX_TREE_BYTES, read_json};
use kufe::results::{Data, Datum, DocumentKind, TableInfo};
use kufe_files::open_regular;
use kufe_lut::{Table, read_fmu};
use kufe_mesh::{HullOptions, load_hull};
use serde::Serialize;

use crate::terminal::Global;
use crate::text::document_text;

/// Arguments of `kufe info`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// A hull (.obj, .glb, .gltf, .stl, .3mf), a lookup table (.lut, .fmu), a map (.exr) or a
    /// result (.json)
    pub file: PathBuf,
}

/// A hull, with coordinates in metres.
#[derive(Serialize)]
struct HullInfo {
    kind: &'static str,
    vertices: usize,
    triangles: usize,
    length_m: f64,
    width_m: f64,
    height_m: f64,
    /// Volume of a closed hull.
    #[serde(skip_serializing_if = "Option::is_none")]
    volume_m3: Option<f64>,
    open_edges: usize,
    flipped_edges: usize,
    warnings: Vec<String>,
}

/// Size, channels and own attributes of a map.
#[derive(Serialize)]
struct MapInfo {
    kind: &'static str,
    width: usize,
    height: usize,
    channels: Vec<String>,
    attributes: Data,
}

/// A result of a command.
#[derive(Serialize)]
struct ResultInfo {
    kind: &'static str,
    written_by: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    version: Option<Datum>,
    #[serde(flatten)]
    figures: Data,
}

/// Prints the contents of the file.
///
/// # Errors
/// [`Failure::BadInput`] if the file is missing, of an unknown kind, or broken.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let path = &args.file;
    let unreadable = |error: std::io::Error| Failure::unreadable(path, error);
    let table = |table: &Table, platforms| {
        let info = TableInfo::new(table, platforms).in_file(path)?;
        Ok::<_, Failure>(Datum::of(&info))
    };
    let metadata = path.metadata().map_err(unreadable)?;
    if metadata.is_dir() {
        let reason = "is a folder: expected a file; kufe report shows folders";
        return Err(Failure::in_file(path, reason));
    }
    let ending = path.extension().unwrap_or_default().to_string_lossy();
    let contents = match ending.to_ascii_lowercase().as_str() {
        // For CAD and unsupported formats the error of the reader names a conversion.
        "obj" | "glb" | "gltf" | "stl" | "3mf" | "step" | "stp" | "iges" | "igs" | "ply"
        | "off" => Datum::of(&hull(path)?),
        "lut" => table(&read_table(path)?, None)?,
        "fmu" => {
            let file = open_regular(path).in_file(path)?;
            let unit = read_fmu(BufReader::new(file)).in_file(path)?;
            table(&unit.table, Some(unit.platforms.join(", ")))?
        }
        "exr" => Datum::of(&map(path).in_file(path)?),
        "json" => Datum::of(&result(path)?),
        other => {
            let reason = format!(
                "kind \".{other}\" is not known: expected a hull (.obj, .glb, .gltf, .stl, .3mf), a lookup \
                 table (.lut, .fmu), a map (.exr) or a result (.json)"
            );
            return Err(Failure::in_file(path, reason));
        }
    };
    let mut info = Data::from([
        ("file".to_owned(), Datum::Text(path.display().to_string())),
        ("size_bytes".to_owned(), Datum::Large(metadata.len())),
    ]);
    if let Datum::Group(contents) = contents? {
        info.extend(contents);
    }
    let info = Datum::Group(info);
    let text = document_text(&info)?;
    global.answer(&info, || text)
}

/// Size, holes and warnings of a hull, with coordinates in metres.
fn hull(path: &Path) -> Result<HullInfo, Failure> {
    let (hull, report) = load_hull(path, &HullOptions::default())?;
    let [length_m, width_m, height_m] = report.extent;
    Ok(HullInfo {
        kind: "hull",
        vertices: hull.positions.len(),
        triangles: hull.triangles.len(),
        length_m,
        width_m,
        height_m,
        volume_m3: Some(report.volume).filter(|_| report.open_edges == 0),
        open_edges: report.open_edges,
        flipped_edges: report.flipped_edges,
        warnings: report.warnings.iter().map(ToString::to_string).collect(),
    })
}

/// Kind, command, version and figures of a result.
fn result(path: &Path) -> Result<ResultInfo, Failure> {
    let document: Datum = read_json(path, MAX_TREE_BYTES)?;
    let Some(kind) = DocumentKind::of(&document) else {
        let reason = "not a result of kufe: expected result.json or another that a command writes";
        return Err(Failure::in_file(path, reason));
    };
    let document = document.effective();
    Ok(ResultInfo {
        kind: kind.name,
        written_by: kind.command,
        version: document
            .group()
            .and_then(|group| group.get("version"))
            .cloned(),
        figures: document.summary(),
    })
}

/// Size, channels and own attributes of a map; its pixels are read, but not decoded.
fn map(path: &Path) -> exr::error::Result<MapInfo> {
    let reader = exr::block::read(BufReader::new(open_regular(path)?), false)?;
    let meta = reader.meta_data().clone();
    // Reading all chunks detects a truncated file.
    for chunk in reader.all_chunks(false)? {
        chunk?;
    }
    let header = meta.headers.first();
    let header = header.ok_or(exr::error::Error::Invalid("a map has a layer".into()))?;
    let own = header.own_attributes.other.iter();
    let attributes = own.chain(&header.shared_attributes.other);
    let attributes = attributes.map(|(name, value)| (name.to_string(), attribute(value)));
    // The map sorts the attributes by name.
    let attributes: BTreeMap<String, Datum> = attributes.collect();
    let channels = header.channels.list.iter();
    Ok(MapInfo {
        kind: "map",
        width: header.layer_size.width(),
        height: header.layer_size.height(),
        channels: channels.map(|channel| channel.name.to_string()).collect(),
        attributes: attributes.into_iter().collect(),
    })
}

fn attribute(value: &AttributeValue) -> Datum {
    let number = |value: f64| {
        if value.is_finite() {
            Datum::Number(value)
        } else {
            Datum::Text(value.to_string().to_lowercase())
        }
    };
    match value {
        AttributeValue::Text(text) => Datum::Text(text.to_string()),
        AttributeValue::F64(value) => number(*value),
        AttributeValue::F32(value) => number(f64::from(*value)),
        AttributeValue::I32(value) => Datum::Whole(i64::from(*value)),
        AttributeValue::FloatVec2(pair) => {
            Datum::List(vec![number(pair.0.into()), number(pair.1.into())])
        }
        other => Datum::Text(format!("{other:?}")),
    }
}
