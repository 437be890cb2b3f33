//! `plan.json`: the points of one round of a sweep.

use std::io::Read;
use std::path::Path;

use serde_json::{Map, Value, json};

use crate::error::Error;
use crate::file::json::{get, list, number, object, point_json, text, wrong};
use crate::store::results::{Origin, write_file};
use crate::table::axes::MAX_NODES;
use crate::table::solved::Point;

const FORMAT: &str = "kufe-lut-plan";
const FORMAT_VERSION: u64 = 1;
const MAX_PLAN_BYTES: u64 = 256 << 20;

/// The points of one round of a sweep, as `plan.json` holds them.
#[derive(Clone, Debug, PartialEq)]
pub struct Manifest {
    /// What every result must belong to.
    pub origin: Origin,
    /// The table file that was planned.
    pub table: String,
    /// Number of the round, from 1; given points need one.
    pub round: usize,
    /// Into how many shards the scripts cut the points.
    pub shards: usize,
    /// The points.
    pub points: Vec<Point>,
}

impl Manifest {
    /// Writes `plan.json`, whole or not at all.
    ///
    /// # Errors
    /// [`Error::Io`] with the file.
    pub fn write(&self, path: &Path) -> Result<(), Error> {
        let mut text = json!({
            "format": FORMAT,
            "format_version": FORMAT_VERSION,
            "version": self.origin.version,
            "case_sha256": self.origin.case_sha256,
            "table": self.table,
            "round": self.round,
            "shards": self.shards,
        })
        .to_string();
        text.pop();
        text += ",\"points\":[";
        for (n, point) in self.points.iter().enumerate() {
            let end = if n == 0 { "\n " } else { ",\n " };
            text += end;
            text += &point_json(point).to_string();
        }
        text += "\n]}\n";
        write_file(path, text.as_bytes())
    }

    /// Reads `plan.json`.
    ///
    /// # Errors
    /// [`Error::Io`], [`Error::TooLarge`], [`Error::Format`] with the place.
    pub fn read(path: &Path) -> Result<Self, Error> {
        let io = |action| {
            let path = path.display().to_string();
            move |source| Error::Io {
                path,
                action,
                source,
            }
        };
        let file = kufe_files::open_regular(path).map_err(io("cannot be opened"))?;
        let mut bytes = Vec::new();
        file.take(MAX_PLAN_BYTES + 1)
            .read_to_end(&mut bytes)
            .map_err(io("cannot be read"))?;
        if bytes.len() as u64 > MAX_PLAN_BYTES {
            return Err(Error::TooLarge {
                limit: MAX_PLAN_BYTES,
            });
        }
        let damaged = |reason: String| Error::Corrupt {
            path: path.display().to_string(),
            reason,
        };
        let value: Value =
            serde_json::from_slice(&bytes).map_err(|error| damaged(error.to_string()))?;
        from_value(&value).map_err(|error| damaged(error.to_string()))
    }

    /// The points of shard `index` (from 1) of `count`: neighbours stay together.
    ///
    /// # Errors
    /// [`Error::Shard`] where `index` is not within 1 to `count`.
    pub fn shard(&self, index: usize, count: usize) -> Result<&[Point], Error> {
        if index == 0 || index > count {
            return Err(Error::Shard { index, count });
        }
        let at = |n: usize| (n as u128 * self.points.len() as u128 / count as u128) as usize;
        Ok(&self.points[at(index - 1)..at(index)])
    }
}

fn from_value(value: &Value) -> Result<Manifest, Error> {
    let top = object(value, "the file")?;
    if text(top, "format")? != FORMAT {
        return Err(wrong("format", text(top, "format")?, FORMAT));
    }
    let whole = |key: &str, low: u64| {
        let value = get(top, key, "the file")?;
        let found = value.as_u64().filter(|n| (low..=1 << 20).contains(n));
        found.ok_or_else(|| wrong(key, &value.to_string(), "a whole number"))
    };
    let version = whole("format_version", 0)?;
    if version != FORMAT_VERSION {
        let expected = FORMAT_VERSION.to_string();
        return Err(wrong("format_version", &version.to_string(), &expected));
    }
    let points = list(get(top, "points", "the file")?, "points")?;
    if points.len() > 4 * MAX_NODES {
        return Err(Error::TooManyNodes {
            found: points.len(),
            limit: 4 * MAX_NODES,
        });
    }
    let points = points.iter().enumerate().map(|(n, point)| {
        let place = format!("points[{n}]");
        let map: &Map<String, Value> = object(point, &place)?;
        let at = |key: &str| number(get(map, key, &place)?, &format!("{place}.{key}"));
        let perhaps = |key: &str| map.contains_key(key).then(|| at(key)).transpose();
        Ok(Point {
            fz: at("fz_n")?,
            curvature: at("curvature_1pm")?,
            rocker_radius: perhaps("rocker_radius_m")?,
            speed: perhaps("v_mps")?,
            ice_c: perhaps("ice_c")?,
        })
    });
    Ok(Manifest {
        origin: Origin {
            version: text(top, "version")?.into(),
            case_sha256: text(top, "case_sha256")?.into(),
        },
        table: text(top, "table")?.into(),
        round: whole("round", 1)? as usize,
        shards: whole("shards", 1)? as usize,
        points: points.collect::<Result<_, Error>>()?,
    })
}
