//! Writing of `.lut` files (docs/tables.md), and reading with checks of every number.
//!
//! A file is parsed while it is read, into lists of bounded length, so that no file takes more
//! memory than the largest table.

use std::collections::BTreeMap;
use std::fmt;
use std::io::{BufReader, Read, Write};
use std::marker::PhantomData;

use serde::de::{
    Deserialize, DeserializeSeed, Deserializer, Error as _, IntoDeserializer, SeqAccess, Visitor,
};
use serde::{Serialize, Serializer};
use serde_json::value::RawValue;

use crate::axes::{Axes, AxisKind, KINDS, MAX_AXIS, MAX_NODES, Outside, Point};
use crate::error::Error;
use crate::interpolator::Mode;
use crate::quantity::{Figures, Method, Quantity};
use crate::reduced::CurvatureScaling;
use crate::solve::Solve;
use crate::table::{InterpolationError, Origin, Table};

/// Largest size of a table file [bytes].
pub const MAX_FILE_BYTES: u64 = 384 << 20;

/// Largest number of checks of a table.
const MAX_CHECKS: usize = 1 << 19;

/// The value of the key `format`.
const FORMAT: &str = "kufe-lut";
/// The value of the key `format_version`.
const FORMAT_VERSION: u64 = 1;

/// The keys of a table file.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct TableFile {
    format: String,
    format_version: u64,
    version: String,
    case_sha256: String,
    case: Box<RawValue>,
    accuracy: Accuracy,
    #[serde(deserialize_with = "bounded::<_, _, KINDS>")]
    axes: Vec<AxisFile>,
    quantities: BTreeMap<Quantity, ColumnFile>,
    #[serde(default)]
    method: Option<Nested<Method>>,
    #[serde(deserialize_with = "bounded::<_, _, MAX_CHECKS>")]
    checks: Vec<Solve>,
}

/// Accuracy of the table. All but the request follows from the rest of the file.
#[derive(Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct Accuracy {
    /// The quantity of the request and of the solver's error.
    quantity: Quantity,
    interpolation_requested: Option<f64>,
    solver: Option<f64>,
    checks: usize,
    interpolation: BTreeMap<Mode, BTreeMap<Quantity, InterpolationError>>,
}

#[derive(Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct AxisFile {
    name: String,
    unit: String,
    values: Nested<f64>,
    /// Rule for inputs outside.
    #[serde(default, skip_serializing_if = "Outside::is_hold")]
    outside: Outside,
    /// Parameters of a reduced curvature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    flush: Option<CurvatureScaling>,
    /// With `flush`: the curvature of every node, for readers that do not need the reduced
    /// curvature.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    curvature_1pm: Option<Nested<f64>>,
}

#[derive(Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ColumnFile {
    unit: String,
    values: Nested<f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    errors: Option<Nested<f64>>,
}

impl Table {
    /// Reads a table and checks every number in it.
    ///
    /// # Errors
    /// [`Error::Invalid`] past [`MAX_FILE_BYTES`]; [`Error::Json`] with line and column where the
    /// JSON is broken or a key is unknown, missing or of the wrong type; [`Error::Format`] with
    /// key, value and expectation; the errors of [`Axes::with`]; [`Error::Stream`] where the reader
    /// fails.
    pub fn read(reader: &mut dyn Read) -> Result<Self, Error> {
        let mut bounded = BufReader::new(reader.take(MAX_FILE_BYTES + 1));
        let parsed = serde_json::from_reader(&mut bounded);
        if bounded.get_ref().limit() == 0 {
            return Err(Error::too_large(MAX_FILE_BYTES));
        }
        match parsed {
            Ok(file) => from_file(file),
            Err(error) if error.is_io() => Err(Error::Stream(error.into())),
            Err(error) => Err(Error::Json(error)),
        }
    }

    /// Writes the table as JSON; equal tables give equal bytes.
    ///
    /// # Errors
    /// [`Error::Stream`] if the writer fails, [`Error::Invalid`] if a check is not on the rocker
    /// axis, [`Error::Json`] if the case is not JSON.
    pub fn write(&self, writer: &mut dyn Write) -> Result<(), Error> {
        let case: &RawValue = serde_json::from_str(&self.case)?;
        let entries = [
            ("format", json(&FORMAT)?),
            ("format_version", json(&FORMAT_VERSION)?),
            ("version", json(&self.origin.version())?),
            ("case_sha256", json(&self.origin.case_sha256())?),
            ("case", json(case)?),
            ("accuracy", json(&self.accuracy()?)?),
        ];
        for (n, (key, value)) in entries.into_iter().enumerate() {
            let start = if n == 0 { "{" } else { "," };
            write!(writer, "{start}\n\"{key}\": {value}")?;
        }
        let axes = self.axes().present().zip(self.axes().named());
        let axes = axes.map(|((kind, _), named)| json(&self.axis(kind, named)));
        write_lines(writer, "axes", ['[', ']'], axes)?;
        let shape = self.axes().shape();
        let columns = self.quantities().iter().map(|&quantity| {
            let nested = |list| Nested::new(&shape, list);
            let column = ColumnFile {
                unit: quantity.unit().into(),
                values: nested(self.values(quantity).unwrap_or_default()),
                errors: self.errors(quantity).map(nested),
            };
            Ok(format!("\"{}\": {}", quantity.name(), json(&column)?))
        });
        write_lines(writer, "quantities", ['{', '}'], columns)?;
        let methods = self.nodes().iter().map(|node| node.method);
        if methods.clone().any(|method| !method.is_default()) {
            let methods = json(&Nested::new(&shape, methods.collect()))?;
            write!(writer, ",\n\"method\": {methods}")?;
        }
        write_lines(writer, "checks", ['[', ']'], self.checks().iter().map(json))?;
        writeln!(writer, "\n}}")?;
        Ok(())
    }

    fn axis(&self, kind: AxisKind, (name, unit, values): (&str, &str, &[f64])) -> AxisFile {
        let flush = self.axes().flush().filter(|_| name == "reduced_curvature");
        let curvatures = flush.map(|_| {
            let points = self.axes().points();
            let curvatures: Vec<f64> = points.iter().map(|point| point.curvature).collect();
            Nested::new(&self.axes().shape(), curvatures)
        });
        AxisFile {
            name: name.into(),
            unit: unit.into(),
            values: Nested::new(&[values.len()], values.to_vec()),
            outside: self.axes().outside(kind),
            flush: flush.copied(),
            curvature_1pm: curvatures,
        }
    }

    fn accuracy(&self) -> Result<Accuracy, Error> {
        let mut interpolation: BTreeMap<Mode, BTreeMap<_, _>> = BTreeMap::new();
        for mode in Mode::ALL {
            let of_mode = interpolation.entry(mode).or_default();
            for &quantity in self.quantities() {
                let error = self.interpolation_error(quantity, mode)?;
                of_mode.extend(error.map(|error| (quantity, error)));
            }
        }
        Ok(Accuracy {
            quantity: self.judged(),
            interpolation_requested: self.interpolation_requested,
            solver: self.solver_error_of(self.judged()),
            checks: self.checks().len(),
            interpolation,
        })
    }
}

fn json<T: Serialize + ?Sized>(value: &T) -> Result<String, Error> {
    Ok(serde_json::to_string(value)?)
}

/// Writes a list or an object, one entry per line.
fn write_lines(
    writer: &mut dyn Write,
    key: &str,
    [open, close]: [char; 2],
    lines: impl Iterator<Item = Result<String, Error>>,
) -> Result<(), Error> {
    write!(writer, ",\n\"{key}\": {open}")?;
    for (n, line) in lines.enumerate() {
        let end = if n == 0 { "" } else { "," };
        write!(writer, "{end}\n {}", line?)?;
    }
    write!(writer, "\n{close}")?;
    Ok(())
}

fn from_file(file: TableFile) -> Result<Table, Error> {
    if file.format != FORMAT {
        return Err(Error::format("format", &file.format, FORMAT));
    }
    if file.format_version != FORMAT_VERSION {
        let [found, expected] = [file.format_version, FORMAT_VERSION].map(|n| n.to_string());
        return Err(Error::format("format_version", &found, expected));
    }
    let origin = Origin::new(file.version, file.case_sha256)?;
    let axes = from_axes(file.axes)?;
    let shape = axes.shape();
    let sliding = axes.is_sliding() || file.quantities.contains_key(&Quantity::Mu);
    let expected = Quantity::of(sliding);
    if !file.quantities.keys().eq(expected) {
        let names = |list: Vec<&Quantity>| -> String {
            let names: Vec<&str> = list.iter().map(|quantity| quantity.name()).collect();
            names.join(", ")
        };
        let found = names(file.quantities.keys().collect());
        let expected = names(expected.iter().collect());
        return Err(Error::format("quantities", &found, expected));
    }
    let judged = Quantity::judged(sliding);
    if file.quantities[&judged].errors.is_none() {
        let key = format!("quantities.{}", judged.name());
        return Err(Error::format(&key, "no key errors", "estimated errors"));
    }
    let mut nodes = vec![Figures::at_rest([f64::NAN; 6]); axes.node_count()];
    for (quantity, column) in file.quantities {
        let key = |of: &str| format!("quantities.{}.{of}", quantity.name());
        if column.unit != quantity.unit() {
            return Err(Error::format(&key("unit"), &column.unit, quantity.unit()));
        }
        let expectation = |value| quantity.expectation(value);
        let values = numbers(&key("values"), column.values, &shape, expectation)?;
        for (node, value) in nodes.iter_mut().zip(values) {
            *node = node.with(quantity, value);
        }
        if let Some(errors) = column.errors {
            let expectation = Quantity::error_expectation;
            let errors = numbers(&key("errors"), errors, &shape, expectation)?;
            for (node, error) in nodes.iter_mut().zip(errors) {
                *node = node.with_error(quantity, error);
            }
        }
    }
    if let Some(methods) = file.method {
        let methods: Vec<Method> = methods.of_shape("method", &shape)?;
        for (node, method) in nodes.iter_mut().zip(methods) {
            node.method = method;
        }
    }
    for (n, check) in file.checks.iter().enumerate() {
        check_place(&format!("checks[{n}]"), &check.point, &axes)?;
    }
    let mut table = Table::new(axes, &nodes, file.checks)?;
    table.interpolation_requested = file.accuracy.interpolation_requested;
    table.case = file.case.get().into();
    table.origin = origin;
    Ok(table)
}

fn from_axes(files: Vec<AxisFile>) -> Result<Axes, Error> {
    if files.len() < 2 {
        let expected = "fz_n and curvature_1pm";
        return Err(Error::format("axes", "fewer than two axes", expected));
    }
    let mut axes = Axes::default();
    let mut last = None;
    for (n, axis) in files.into_iter().enumerate() {
        let wrong = |key: &str, found: &str, expected: &str| {
            Err(Error::format(&format!("axes[{n}].{key}"), found, expected))
        };
        let allowed: Vec<AxisKind> = match n {
            0 | 1 => vec![AxisKind::ALL[n]],
            _ => AxisKind::ALL
                .into_iter()
                .filter(|kind| Some(*kind) > last)
                .collect(),
        };
        let reduced = n == 1 && axis.name == "reduced_curvature";
        let mut named = allowed.iter();
        let Some(&kind) = named.find(|kind| reduced || kind.key() == axis.name) else {
            let names: Vec<&str> = allowed.iter().map(|kind| kind.key()).collect();
            return wrong("name", &axis.name, &names.join(" or "));
        };
        let unit = if reduced { "1" } else { kind.unit() };
        if axis.unit != unit {
            return wrong("unit", &axis.unit, unit);
        }
        if axis.flush.is_some() != reduced {
            let expected = "flush with the axis reduced_curvature, and only there";
            return wrong("flush", &axis.name, expected);
        }
        if kind == AxisKind::RockerRadius && !axis.outside.is_hold() {
            let expected = "no such key: a rocker radius outside is refused in any case";
            return wrong("outside", axis.outside.name(), expected);
        }
        let length = [axis.values.flat.len()];
        let values = axis
            .values
            .of_shape(&format!("axes[{n}].values"), &length)?;
        axes = match axis.flush {
            Some(flush) => axes.with_reduced(values, flush)?,
            None => axes.with(kind, values)?,
        };
        axes = axes.with_outside(kind, axis.outside);
        last = Some(kind);
    }
    Ok(axes)
}

/// The numbers of a list of this shape; `expectation` returns the expectation that a number
/// violates.
fn numbers(
    key: &str,
    list: Nested<f64>,
    shape: &[usize],
    expectation: impl Fn(f64) -> Option<&'static str>,
) -> Result<Vec<f64>, Error> {
    let numbers = list.of_shape(key, shape)?;
    for (n, &number) in numbers.iter().enumerate() {
        if let Some(expected) = expectation(number) {
            let (key, found) = (format!("{key}, number {}", n + 1), number.to_string());
            return Err(Error::format(&key, &found, expected));
        }
    }
    Ok(numbers)
}

/// Checks that a point has a coordinate within each further axis, and no other coordinates.
fn check_place(key: &str, point: &Point, axes: &Axes) -> Result<(), Error> {
    for kind in AxisKind::ALL.into_iter().skip(2) {
        let given = point.get(kind);
        let expected = match (axes.get(kind), given) {
            (None, None) => continue,
            (None, Some(_)) => "no such coordinate",
            (Some(_), None) => "a coordinate",
            (Some(axis), Some(value)) if (axis[0]..=axis[axis.len() - 1]).contains(&value) => {
                continue;
            }
            (Some(_), Some(_)) => "a value within the axis",
        };
        let found = given.map_or("nothing".into(), |value| value.to_string());
        return Err(Error::format(
            &format!("{key}.{}", kind.key()),
            &found,
            expected,
        ));
    }
    Ok(())
}

/// Reads a list of at most `MAX` entries.
fn bounded<'de, D, T, const MAX: usize>(deserializer: D) -> Result<Vec<T>, D::Error>
where
    D: Deserializer<'de>,
    T: Deserialize<'de>,
{
    struct Bounded<T, const MAX: usize>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>, const MAX: usize> Visitor<'de> for Bounded<T, MAX> {
        type Value = Vec<T>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(f, "a list of at most {MAX} entries")
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Vec<T>, A::Error> {
            let mut list = Vec::new();
            while let Some(entry) = seq.next_element()? {
                if list.len() == MAX {
                    return Err(A::Error::invalid_length(MAX + 1, &self));
                }
                list.push(entry);
            }
            Ok(list)
        }
    }
    deserializer.deserialize_seq(Bounded::<T, MAX>(PhantomData))
}

/// Nested lists along the axes, as for `numpy.array`, of at most [`MAX_NODES`] entries.
struct Nested<T> {
    shape: Vec<usize>,
    flat: Vec<T>,
}

impl<T> Nested<T> {
    fn new(shape: &[usize], flat: Vec<T>) -> Self {
        let shape = shape.to_vec();
        Nested { shape, flat }
    }

    /// The entries, if they have this shape.
    fn of_shape(self, key: &str, shape: &[usize]) -> Result<Vec<T>, Error> {
        if self.shape == shape {
            return Ok(self.flat);
        }
        let named = |shape: &[usize]| format!("lists of shape {shape:?}");
        Err(Error::format(key, &named(&self.shape), named(shape)))
    }
}

impl<T: Serialize> Serialize for Nested<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Rows(&self.shape, &self.flat).serialize(serializer)
    }
}

/// Shape and entries, the last axis fastest.
struct Rows<'a, T>(&'a [usize], &'a [T]);

impl<T: Serialize> Serialize for Rows<'_, T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self.0 {
            [rows, inner @ ..] if !inner.is_empty() => {
                let chunks = self.1.chunks_exact(self.1.len() / rows);
                serializer.collect_seq(chunks.map(|chunk| Rows(inner, chunk)))
            }
            _ => serializer.collect_seq(self.1),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Nested<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let mut lists = Lists {
            depth: 0,
            lengths: [None; KINDS],
            leaves: None,
            flat: Vec::new(),
        };
        lists.deserialize(deserializer)?;
        let depth = lists.leaves.unwrap_or(1).max(1);
        let shape = lists.lengths[..depth].iter().map(|n| n.unwrap_or(0));
        Ok(Nested {
            shape: shape.collect(),
            flat: lists.flat,
        })
    }
}

/// State of the reading of nested lists.
struct Lists<T> {
    /// Number of open lists.
    depth: usize,
    /// Lengths of the lists by depth.
    lengths: [Option<usize>; KINDS],
    /// Depth of the entries.
    leaves: Option<usize>,
    flat: Vec<T>,
}

impl<T> Lists<T> {
    fn push<E: serde::de::Error>(&mut self, entry: Result<T, E>) -> Result<(), E> {
        let depth = *self.leaves.get_or_insert(self.depth);
        if depth == 0 || depth != self.depth {
            return Err(E::custom("expected lists of one depth"));
        }
        if self.flat.len() == MAX_NODES {
            return Err(E::custom(format!("expected at most {MAX_NODES} entries")));
        }
        self.flat.push(entry?);
        Ok(())
    }
}

/// Reads a list or an entry.
impl<'de, T: Deserialize<'de>> DeserializeSeed<'de> for &mut Lists<T> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_any(self)
    }
}

impl<'de, T: Deserialize<'de>> Visitor<'de> for &mut Lists<T> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a finite number or a list of such")
    }

    fn visit_f64<E: serde::de::Error>(self, value: f64) -> Result<(), E> {
        self.push(T::deserialize(value.into_deserializer()))
    }

    fn visit_u64<E: serde::de::Error>(self, value: u64) -> Result<(), E> {
        self.push(T::deserialize(value.into_deserializer()))
    }

    fn visit_i64<E: serde::de::Error>(self, value: i64) -> Result<(), E> {
        self.push(T::deserialize(value.into_deserializer()))
    }

    fn visit_str<E: serde::de::Error>(self, value: &str) -> Result<(), E> {
        self.push(T::deserialize(value.into_deserializer()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<(), A::Error> {
        if self.depth == KINDS {
            let text = format!("expected lists of at most {KINDS} levels");
            return Err(A::Error::custom(text));
        }
        self.depth += 1;
        let mut length = 0;
        while seq.next_element_seed(&mut *self)?.is_some() {
            length += 1;
            if length > MAX_AXIS {
                let text = format!("expected at most {MAX_AXIS} entries");
                return Err(A::Error::custom(text));
            }
        }
        self.depth -= 1;
        let known = *self.lengths[self.depth].get_or_insert(length);
        if known != length {
            let text = format!("found a list of {length} entries, expected {known}");
            return Err(A::Error::custom(text));
        }
        Ok(())
    }
}
