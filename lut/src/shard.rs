//! A sweep cut into shards that run anywhere, and put together again.
//!
//! A plan's folder holds `plan.json` ([`Manifest`]: the points of one round) and `points/` (a [`Store`]). Shard `i` of
//! `n` solves its share of the points that have no result; running it again does nothing. When
//! all are there, [`next_batch`] either gives the table or, where a tolerance rules the sweep, the next round's points.

use std::io::Read;
use std::path::Path;

use serde_json::{Map, Value, json};

use crate::each::each;
use crate::read::{get, list, number, object, text, wrong};
use crate::store::{point_json, write_renamed};
use crate::sweep::{Plan, SweepError, Swept, sweep_batches};
use crate::{Error, MAX_NODES, Origin, Point, Solved, Store};

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
        write_renamed(path, text.as_bytes())
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
        let file = std::fs::File::open(path).map_err(io("cannot be opened"))?;
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
    if whole("format_version", 0)? != FORMAT_VERSION {
        return Err(wrong("format_version", "another", "1"));
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
        Ok(Point {
            fz: at("fz_n")?,
            curvature: at("curvature_1pm")?,
            rocker_radius: map
                .contains_key("rocker_radius_m")
                .then(|| at("rocker_radius_m"))
                .transpose()?,
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

/// What a batch of points took.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Done {
    /// Points that were solved now.
    pub solved: usize,
    /// Points that had their result already.
    pub kept: usize,
    /// Damaged results that were solved again: what was wrong with them.
    pub repaired: Vec<String>,
}

/// Solves the points that have no result in the store, in parallel, keeping each as soon as it is there.
///
/// A point's failure does not keep the others from being solved and kept. A damaged result is solved again and told.
///
/// # Errors
/// [`SweepError::Solve`] with the first failed point; [`Error::Mixture`] before anything is solved; [`Error::Io`]
/// where a result cannot be kept, after which no further point is begun.
pub fn solve_missing<E>(
    store: &Store,
    points: &[Point],
    solve: impl Fn(&Point) -> Result<Solved, E> + Sync,
) -> Result<Done, SweepError<E>>
where
    E: std::error::Error + Send + 'static,
{
    use std::sync::atomic::{AtomicBool, Ordering};
    let mut done = Done::default();
    let mut missing = Vec::new();
    for point in points {
        match store.get(point) {
            Ok(Some(_)) => done.kept += 1,
            Ok(None) => missing.push(*point),
            Err(error @ Error::Corrupt { .. }) => {
                done.repaired.push(error.to_string());
                missing.push(*point);
            }
            Err(error) => return Err(error.into()),
        }
    }
    let broken = AtomicBool::new(false);
    let outcomes: Vec<Option<Result<(), SweepError<E>>>> = each(&missing, |point| {
        if broken.load(Ordering::Relaxed) {
            return None;
        }
        let solved = match solve(point) {
            Ok(solved) => solved,
            Err(source) => {
                let point = *point;
                return Some(Err(SweepError::Solve { point, source }));
            }
        };
        let kept = crate::table::finite(point, &solved).and_then(|()| store.put(point, &solved));
        broken.fetch_or(kept.is_err(), Ordering::Relaxed);
        Some(kept.map_err(SweepError::Table))
    });
    for outcome in outcomes.into_iter().flatten() {
        outcome?;
        done.solved += 1;
    }
    Ok(done)
}

/// Where a sweep stands.
#[derive(Debug)]
pub enum Next {
    /// These points are to be solved; `missing` of them have no result yet.
    Points {
        /// The whole batch.
        points: Vec<Point>,
        /// Number of the batch, from 1.
        round: usize,
        /// How many have no result.
        missing: usize,
        /// The first of those.
        first: Point,
    },
    /// Nothing is missing.
    Finished(Box<Swept>),
}

/// Replays a sweep from stored results: its table, or the first batch that is not complete.
///
/// # Errors
/// [`Error::Corrupt`] and [`Error::Mixture`] naming the file, and the plan's own errors.
pub fn next_batch(plan: &Plan, store: &Store) -> Result<Next, Error> {
    enum Stop {
        Missing(Vec<Point>, usize, Point),
        Failed(Error),
    }
    impl From<Error> for Stop {
        fn from(error: Error) -> Self {
            Stop::Failed(error)
        }
    }
    let mut round = 0;
    let swept = sweep_batches(plan, |points| {
        round += 1;
        let mut solved = Vec::with_capacity(points.len());
        let mut missing = Vec::new();
        for point in points {
            match store.get(point)? {
                Some(result) => solved.push(result),
                None => missing.push(*point),
            }
        }
        match missing.first() {
            None => Ok(solved),
            Some(&first) => Err(Stop::Missing(points.to_vec(), missing.len(), first)),
        }
    });
    match swept {
        Ok(mut swept) => {
            swept.table.version = store.origin().version.clone();
            swept.table.case_sha256 = store.origin().case_sha256.clone();
            Ok(Next::Finished(Box::new(swept)))
        }
        Err(Stop::Missing(points, missing, first)) => Ok(Next::Points {
            points,
            round,
            missing,
            first,
        }),
        Err(Stop::Failed(error)) => Err(error),
    }
}
