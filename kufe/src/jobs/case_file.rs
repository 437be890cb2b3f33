//! A case with its file: reading, messages that name the file, and checks of its hull.

use std::fmt::Display;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use kufe_contact::{Error, NUMERICS, Problem, Solution, SurfaceField};
use kufe_files::{read_regular, sha256, text_of_regular};
use kufe_mesh::{Hull, HullFormat, Orientation, hull_files, smaller_by};

use crate::case::{Case, FittedHull};
use crate::jobs::failure::{Failure, Located};
use crate::jobs::watch::Watch;
use crate::plot::{percent, quantity};

/// The built-in case, which is solved if no file is given.
pub const EXAMPLE: &str = include_str!("../../assets/example.toml");

/// Largest size of a case file, which is a page of text [bytes].
const MAX_CASE_BYTES: u64 = 1 << 20;
/// Largest size of a file that a case names [bytes].
const MAX_FILE_BYTES: u64 = 1 << 31;

/// A case and its folder.
#[derive(Clone, Debug)]
pub struct LoadedCase {
    /// Name of the case in messages.
    pub name: String,
    /// The folder that a hull's path starts from.
    pub base: PathBuf,
    /// The case.
    pub case: Case,
    /// The hull in memory, in runner axes, which replaces the file that `runner.hull` names.
    pub hull: Option<Arc<Hull>>,
}

impl LoadedCase {
    /// The built-in example.
    ///
    /// # Errors
    /// None in a released program; the example is part of it.
    pub fn example() -> Result<LoadedCase, Failure> {
        LoadedCase::parse("the built-in example", Path::new(""), EXAMPLE)
    }

    /// Reads a case file.
    ///
    /// # Errors
    /// [`Failure::BadInput`] naming the file, the line, the key, the value and what was expected.
    pub fn read(path: &Path) -> Result<LoadedCase, Failure> {
        let ending = path.extension().unwrap_or_default();
        if ending.eq_ignore_ascii_case("3mf") || HullFormat::of(path).is_ok() {
            let reason = format_args!(
                "this is a hull, expected a case: kufe hull check {} -o case.toml writes one",
                path.display()
            );
            return Err(Failure::in_file(path, reason));
        }
        let text = text_of_regular(path, MAX_CASE_BYTES).in_file(path)?;
        let base = path.parent().unwrap_or(Path::new(""));
        LoadedCase::parse(&path.display().to_string(), base, &text)
    }

    /// Parses a case's text; `name` is its name in messages, a hull's path starts from `base`.
    ///
    /// # Errors
    /// [`Failure::BadInput`] naming the line, the key, the value and what was expected.
    pub fn parse(name: &str, base: &Path, text: &str) -> Result<LoadedCase, Failure> {
        Ok(LoadedCase {
            name: name.to_string(),
            base: base.to_path_buf(),
            case: Case::parse(text).map_err(|error| Failure::bad_input(error).within(name))?,
            hull: None,
        })
    }

    /// Bad input in the case.
    pub(crate) fn bad_input(&self, reason: impl Display) -> Failure {
        Failure::bad_input(reason).within(&self.name)
    }

    /// Converts the error of a library into bad input in the case.
    pub(crate) fn valid<T>(&self, result: Result<T, impl Display>) -> Result<T, Failure> {
        result.map_err(|error| self.bad_input(error))
    }

    /// Converts the error of a solver into a failure of the case.
    pub(crate) fn solved<T>(&self, result: Result<T, Error>) -> Result<T, Failure> {
        result.map_err(|error| self.failure(&error))
    }

    /// Every file that is read for the case in addition to its own, with the key that names it:
    /// hull and its buffers, mesh, section, ice surface, groove.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if a hull that names further files cannot be read.
    pub fn files(&self) -> Result<Vec<(&'static str, PathBuf)>, Failure> {
        let mut files = Vec::new();
        for (key, file) in self.case.files() {
            let path = self.base.join(file);
            if key != "runner.hull" {
                files.push((key, path));
            } else if self.hull.is_none() {
                let parts = hull_files(&path);
                let parts = parts.map_err(|e| self.bad_input(format_args!("{key}: {e}")))?;
                files.extend(parts.into_iter().map(|part| (key, part)));
            }
        }
        Ok(files)
    }

    /// Hexadecimal SHA-256 of the content of every file that the case reads in addition to its own,
    /// and of the version of the numerics. Names and times of the files do not enter.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if a file cannot be read.
    pub fn content(&self) -> Result<String, Failure> {
        let mut digests = vec![format!("numerics {NUMERICS}")];
        if let Some(hull) = &self.hull {
            let numbers = hull.positions.as_flattened().iter();
            let mut bytes: Vec<u8> = numbers.flat_map(|v| v.to_le_bytes()).collect();
            let corners = hull.triangles.as_flattened().iter();
            bytes.extend(corners.flat_map(|k| k.to_le_bytes()));
            digests.push(sha256(&bytes));
        }
        for (key, file) in self.files()? {
            let bytes = read_regular(&file, MAX_FILE_BYTES).in_file(&file);
            let bytes = bytes.map_err(|failure| failure.within(key).within(&self.name))?;
            digests.push(sha256(&bytes));
        }
        Ok(sha256(digests.join("\n").as_bytes()))
    }

    /// The problem that the case states, of a contact at rest, and its hull, where it names one.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if the hull cannot be obtained, and for a case that slides.
    pub fn stated(&self) -> Result<(Problem, Option<FittedHull>), Failure> {
        self.at_rest()?;
        self.stated_sliding()
    }

    /// Refuses a case that slides.
    pub(crate) fn at_rest(&self) -> Result<(), Failure> {
        match self.case.sliding {
            None => Ok(()),
            Some(_) => Err(self.bad_input(
                "[sliding]: expected a case at rest: `kufe press` and `kufe friction --groove` take one that slides",
            )),
        }
    }

    /// The problem that the case states, sliding or not.
    ///
    /// # Errors
    /// As [`stated`](Self::stated).
    pub fn stated_sliding(&self) -> Result<(Problem, Option<FittedHull>), Failure> {
        self.valid(self.case.stated(&self.base, self.hull.as_deref()))
    }

    /// The case with another value of a number of its runner's shape.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a runner without a shape, a key that the shape does not have, and
    /// a value out of range.
    pub fn with_shape(&self, key: &str, value: f64) -> Result<LoadedCase, Failure> {
        let wrong =
            |reason: &dyn Display| self.bad_input(format_args!("runner.shape.{key}: {reason}"));
        let Some(shape) = &self.case.runner.shape else {
            return Err(wrong(&"the runner is a hull, expected a shape"));
        };
        let mut table = toml::Table::try_from(shape).map_err(|error| wrong(&error))?;
        if key == "kind" || !table.contains_key(key) {
            let known = table.keys().map(String::as_str);
            let known: Vec<&str> = known.filter(|key| *key != "kind").collect();
            return Err(wrong(&format_args!(
                "found no such key, expected one of {}",
                known.join(", ")
            )));
        }
        table.insert(key.to_owned(), value.into());
        let mut loaded = self.clone();
        loaded.name = format!("{} with {key} = {value}", self.name);
        loaded.case.runner.shape = Some(table.try_into().map_err(|error| wrong(&error))?);
        let checked = loaded.case.check();
        checked.map_err(|error| self.bad_input(format_args!("with {key} = {value}: {error}")))?;
        Ok(loaded)
    }

    /// Reports the warnings about the hull, and returns them.
    pub(crate) fn hull_warnings(&self, hull: Option<&FittedHull>, watch: &Watch) -> Vec<String> {
        let warnings = hull.iter().flat_map(|hull| &hull.report.warnings);
        let named = warnings.map(|text| format!("{}: {}: {text}", self.name, self.hull_key()));
        named.inspect(|warning| watch.warn(warning)).collect()
    }

    /// The key that names the hull or the mesh.
    fn hull_key(&self) -> &'static str {
        match self.case.runner.mesh {
            Some(_) => "runner.mesh",
            None => "runner.hull",
        }
    }

    /// As [`fine_within`](Self::fine_within), for a solution on the hull.
    pub(crate) fn fine_enough(
        &self,
        hull: Option<&FittedHull>,
        solution: &Solution,
    ) -> Result<(), Failure> {
        self.fine_within(hull, depth(solution), patch(&solution.surface))
    }

    /// Refuses a hull whose fit has an error of more than 5 % of the indentation of the ice `depth`
    /// [m] within the patch `[x_min, x_max, y_min, y_max]` [m], or a larger fraction if the
    /// requested accuracy of the peak is coarser.
    ///
    /// # Errors
    /// [`Failure::BadInput`] with the fit's error, the indentation and the largest error allowed.
    pub(crate) fn fine_within(
        &self,
        hull: Option<&FittedHull>,
        depth: f64,
        patch: [f64; 4],
    ) -> Result<(), Failure> {
        let Some(hull) = hull else { return Ok(()) };
        let fraction = self.case.accuracy.p_max.max(0.05);
        let (error, allowed) = (hull.underside.error_within(patch), fraction * depth);
        if error <= allowed {
            return Ok(());
        }
        let (key, remedy) = (self.hull_key(), self.remedy(hull, error / allowed));
        let [error, depth, allowed] = [error, depth, allowed].map(|length| quantity(length, "m"));
        Err(self.bad_input(format_args!(
            "{key}: too coarse for its load: the surface through its vertices is uncertain by {error}, \
             the ice is pressed in by {depth}; expected at most {allowed}: {remedy}",
        )))
    }

    /// The remark that a scan is rotated about z although its case states no rotation: the contact
    /// is then oblique to the grid, which needs many more cells.
    pub(crate) fn turned(&self, hull: &FittedHull) -> Option<String> {
        const MAX_YAW: f64 = 0.005;
        let runner = &self.case.runner;
        let stated = [runner.yaw_rad, runner.pitch_rad, runner.roll_rad];
        if stated.iter().any(Option::is_some) {
            return None;
        }
        let orientation = Orientation::of(hull.scan.as_ref()?, hull.noise.found, [0.0; 3]).ok()?;
        let [.., yaw] = orientation.rotation;
        (yaw.abs() > MAX_YAW).then(|| {
            format!(
                "the hull is turned about z, into runner axes by runner.yaw_rad = {yaw:.4}: its contact lies aslant on the grid; \
                 `kufe hull check -o` writes a case with its yaw, pitch and roll"
            )
        })
    }

    /// Advice for a hull that is too coarse by the factor `times`: to rotate it if it is turned,
    /// else finer sampling.
    fn remedy(&self, hull: &FittedHull, times: f64) -> String {
        self.turned(hull).unwrap_or_else(|| finer(hull, times))
    }

    /// The failure that the hull's vertices leave the peak uncertain by the relative error `error`,
    /// more than requested.
    pub(crate) fn peak_uncertain(&self, hull: &FittedHull, error: f64) -> Failure {
        let requested = self.case.accuracy.p_max;
        Failure::NotConverged(format!(
            "{}: {}: its vertices leave the peak uncertain by {}, where {} is requested: {}",
            self.name,
            self.hull_key(),
            percent(error),
            percent(requested),
            self.remedy(hull, error / requested)
        ))
    }

    /// The failure that the effect of vertex noise `noise` [m] on the peak is unknown.
    pub(crate) fn noise_effect_unknown(&self, noise: f64) -> Failure {
        Failure::NotConverged(format!(
            "{}: {}: its vertices have noise of {}, and how far that moves the peak could not be estimated by boundary elements: expected \
             vertices on a smooth surface, or runner.noise_m = 0 where they are",
            self.name,
            self.hull_key(),
            quantity(noise, "m")
        ))
    }

    /// Converts an error of the solver into a failure of the command.
    pub fn failure(&self, error: &Error) -> Failure {
        let text = format!("{}: {error}", self.name);
        match error {
            Error::NotConverged { .. }
            | Error::AccuracyNotReached { .. }
            | Error::Unsolved(_)
            | Error::FarField { .. }
            | Error::NoAnswer { .. }
            | Error::SlidingAccuracyNotReached { .. } => Failure::NotConverged(text),
            Error::Stopped => Failure::Partial(text),
            _ => Failure::BadInput(text),
        }
    }
}

/// Advice on the sampling that would lower a hull's error by `factor`.
fn finer(hull: &FittedHull, factor: f64) -> String {
    let noise = hull.noise.found;
    // Rounded up, so that the stated factor suffices.
    let closer = (10.0 * smaller_by(factor, noise > 0.0)).ceil() / 10.0;
    if let Some(length) = hull.strips {
        return format!(
            "its triangles are strips of {} along the runner: export it with shorter edges",
            quantity(length, "m")
        );
    }
    if noise == 0.0 {
        return format!("vertices {closer:.1} times closer would do");
    }
    format!(
        "noise of {} in place of {}, or vertices {closer:.1} times closer both ways, would do",
        quantity(noise / closer, "m"),
        quantity(noise, "m")
    )
}

/// Indentation of the ice, which the error of a hull's fit is compared with [m]. The approach of an
/// elastic runner includes its own bending, so its bound is the largest displacement of the ice.
pub(crate) fn depth(solution: &Solution) -> f64 {
    let deepest = |field: &SurfaceField| field.uz.iter().fold(0.0, |max, uz| f64::max(max, -uz));
    match solution.runner_volume {
        Some(_) => deepest(&solution.surface).min(solution.approach),
        None => solution.approach,
    }
}

/// The bounding rectangle `[x_min, x_max, y_min, y_max]` of points; without points
/// `[inf, -inf, inf, -inf]`.
pub(crate) fn around(places: impl Iterator<Item = [f64; 2]>) -> [f64; 4] {
    const INF: f64 = f64::INFINITY;
    places.fold([INF, -INF, INF, -INF], |[x0, x1, y0, y1], [x, y]| {
        [x0.min(x), x1.max(x), y0.min(y), y1.max(y)]
    })
}

/// The bounding rectangle `[x_min, x_max, y_min, y_max]` of the nodes in contact [m].
pub(crate) fn patch(field: &SurfaceField) -> [f64; 4] {
    let columns = field.x.len();
    let touching = field.pressure.iter().enumerate().filter(|(_, p)| **p > 0.0);
    around(touching.map(|(k, _)| [field.x[k % columns], field.y[k / columns]]))
}
