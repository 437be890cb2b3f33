//! A table as a Functional Mock-up Unit, FMI 2.0 or 3.0, Model Exchange and Co-Simulation.
//!
//! The libraries inside are equal for all tables and both versions. They are compiled with this
//! crate and read the table from the resources of the FMU, so that writing an FMU needs no
//! compiler.

use std::collections::BTreeSet;
use std::io::{Cursor, Read, Seek, SeekFrom, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use crate::axes::AxisKind;
use crate::error::Error;
use crate::export::escape::xml;
use crate::export::header::{EVALUATION, LAYER_AXES, rocker_on_axis};
use crate::file::MAX_FILE_BYTES;
use crate::interpolator::{Interpolator, Mode};
use crate::quantity::Quantity;
use crate::table::Table;

/// A compiled library, with the names of its platform in FMI 2.0 and 3.0.
struct Library {
    platform: [&'static str; 2],
    ending: &'static str,
    bytes: &'static [u8],
}

static LIBRARIES: &[Library] = &include!(concat!(env!("OUT_DIR"), "/libraries.rs"));
const REASON: &str = env!("KUFE_FMU_REASON");
const UNIT: &str = include_str!("../../c/unit.h");
const BUILD_DESCRIPTION: &str = include_str!("../../c/buildDescription.xml");
const SOURCES: [[(&str, &str); 2]; 2] = [
    [
        ("fmi2.c", include_str!("../../c/fmi2.c")),
        ("fmi2.h", include_str!("../../c/fmi2.h")),
    ],
    [
        ("fmi3.c", include_str!("../../c/fmi3.c")),
        ("fmi3.h", include_str!("../../c/fmi3.h")),
    ],
];

/// A version of the Functional Mock-up Interface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fmi {
    /// 2.0.
    V2,
    /// 3.0.
    V3,
}

/// The content of an FMU that [`Table::write_fmu`] wrote.
#[derive(Clone, Debug)]
pub struct Fmu {
    /// Its table.
    pub table: Table,
    /// FMI names of the platforms of its libraries.
    pub platforms: Vec<String>,
}

/// Reads the table of an FMU back.
///
/// # Errors
/// [`Error::Invalid`] for more than [`MAX_FILE_BYTES`]; [`Error::Zip`] if it is not an archive or
/// has no table in its resources; errors of [`Table::read`], which limits the size of the expanded
/// table.
pub fn read_fmu(mut reader: impl Read + Seek) -> Result<Fmu, Error> {
    if reader.seek(SeekFrom::End(0))? > MAX_FILE_BYTES {
        return Err(Error::too_large(MAX_FILE_BYTES));
    }
    reader.rewind()?;
    let mut archive = ZipArchive::new(reader)?;
    let mut platforms = BTreeSet::new();
    for name in archive.file_names() {
        let name = name?;
        let binary = name.strip_prefix("binaries/");
        let platform = binary.and_then(|path| path.split_once('/'));
        platforms.extend(platform.map(|(platform, _)| platform.to_owned()));
    }
    let platforms = platforms.into_iter().collect();
    let table = Table::read(&mut archive.by_name("resources/table.lut")?)?;
    Ok(Fmu { table, platforms })
}

impl Table {
    /// Writes an FMU whose inputs are `fz`, `v`, `pitch_rate` and `curvature` and whose outputs are
    /// `pressure` (the peak pressure) and `out_of_range`; for a sliding runner also the input
    /// `ice_c` and the outputs `mu`, `mu_ploughing`, `mu_viscous`, `mu_boundary`, `groove_depth`
    /// and `film_mean`.
    ///
    /// The parameter `use_curvature` takes the input `curvature` instead of `-pitch_rate / v`;
    /// `smooth` chooses the mode. The FMU contains libraries for the platform of this crate's build
    /// and, if it was built with MinGW-w64, for Windows, and the sources for other platforms.
    /// `rocker_radius` as in [`Table::write_header`].
    ///
    /// # Errors
    /// [`Error::Invalid`] if this crate was built without a C compiler, or if the radius is not a
    /// breakpoint of the axis; [`Error::RockerNeeded`]; [`Error::Zip`] and [`Error::Stream`].
    pub fn write_fmu(
        &self,
        name: &str,
        rocker_radius: Option<f64>,
        fmi: Fmi,
        writer: &mut dyn Write,
    ) -> Result<(), Error> {
        if LIBRARIES.is_empty() {
            return Err(Error::Invalid(format!(
                "this kufe was built where no C compiler was found, so it cannot make an FMU: \
                 {REASON}; rebuild with a C compiler, or use --header"
            )));
        }
        rocker_on_axis(self, rocker_radius)?;
        let numbers = self.fmu_numbers(rocker_radius)?;
        let token = kufe_files::sha256(&numbers);
        let mut table = b"KUFELUT3".to_vec();
        table.extend(token.as_bytes());
        table.extend(&numbers);
        let mut lut = Vec::new();
        self.write(&mut lut)?;

        let description = self.model_description(name, &token, fmi);
        let mut files: Vec<(String, &[u8])> = vec![
            ("modelDescription.xml".into(), description.as_bytes()),
            ("resources/table.bin".into(), &table),
            ("resources/table.lut".into(), &lut),
            ("sources/unit.h".into(), UNIT.as_bytes()),
            ("sources/kufe_lut.h".into(), EVALUATION.as_bytes()),
        ];
        files.extend(
            SOURCES[fmi as usize].map(|(file, text)| (format!("sources/{file}"), text.as_bytes())),
        );
        if fmi == Fmi::V3 {
            let build = "sources/buildDescription.xml".into();
            files.push((build, BUILD_DESCRIPTION.as_bytes()));
        }
        files.extend(LIBRARIES.iter().map(|library| {
            let platform = library.platform[fmi as usize];
            let path = format!("binaries/{platform}/kufe_lut.{}", library.ending);
            (path, library.bytes)
        }));
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        for (path, bytes) in files {
            let is_library = path.starts_with("binaries/");
            let permissions = if is_library { 0o755 } else { 0o644 };
            zip.start_file(path, options.unix_permissions(permissions))?;
            zip.write_all(bytes)?;
        }
        writer.write_all(&zip.finish()?.into_inner())?;
        Ok(())
    }

    /// The numbers after magic and token in `resources/table.bin` (see `Head` in c/unit.h),
    /// little-endian.
    fn fmu_numbers(&self, rocker_radius: Option<f64>) -> Result<Vec<u8>, Error> {
        let quantities = self.fmu_quantities();
        let axes = self.axes();
        let mut numbers = Vec::new();
        numbers.extend(axes.flush().iter().flat_map(|flush| flush.numbers()));
        numbers.extend(axes.fz());
        numbers.extend(axes.fz().iter().map(|fz| fz.ln()));
        numbers.extend(axes.curvature());
        let mut logarithmic = 0u32;
        for (k, &quantity) in quantities.iter().enumerate() {
            let smooth = Interpolator::new(self, quantity, Mode::Smooth, rocker_radius)?;
            if k == 0 {
                for axis in LAYER_AXES.iter().flat_map(|(kind, _)| smooth.axis(*kind)) {
                    numbers.extend(&axis.plain);
                    numbers.extend(&axis.scaled);
                    numbers.extend(axis.slopes.concat().concat());
                }
            }
            logarithmic |= u32::from(smooth.logarithmic) << k;
            // The values without logarithm depend on the mode only at a rocker radius between
            // breakpoints, which exports refuse.
            numbers.extend(&smooth.values);
            numbers.extend(smooth.flat_jets());
        }
        let kinds = AxisKind::ALL.into_iter();
        let kinds = kinds.filter(|kind| *kind != AxisKind::RockerRadius);
        let (mut counts, mut outside) = (Vec::new(), 0);
        for (k, kind) in kinds.enumerate() {
            counts.push(axes.get(kind).map_or(0, <[f64]>::len) as u32);
            outside |= (axes.outside(kind) as u32) << (2 * k);
        }
        let reduced = u32::from(axes.flush().is_some());
        counts.extend([quantities.len() as u32, logarithmic, reduced, outside]);
        let counts = counts.iter().flat_map(|count| count.to_le_bytes());
        let numbers = numbers.iter().flat_map(|number| number.to_le_bytes());
        Ok(counts.chain(numbers).collect())
    }

    /// The peak pressure, and for a sliding runner the further quantities.
    fn fmu_quantities(&self) -> Vec<Quantity> {
        let at_rest = Quantity::of(false).len();
        let sliding = self.quantities()[at_rest..].iter().copied();
        std::iter::once(Quantity::PMax).chain(sliding).collect()
    }

    /// The variables; the value reference of a variable is its index.
    fn fmu_variables(&self) -> Vec<Variable> {
        let of_table = |line: &&str| self.is_sliding() || !line.contains(";ice_c;");
        let variable = |line: &'static str| {
            let mut cells = line.splitn(5, ';');
            let [causality, name, unit, start, description] =
                [(); 5].map(|()| cells.next().unwrap_or_default());
            let axis = AxisKind::ALL.into_iter().find(|kind| kind.key() == start);
            let first = axis.map(|kind| self.axes().get(kind).map_or(0.0, |axis| axis[0]));
            Variable {
                causality,
                name,
                unit,
                start: first.map_or(start.to_string(), |first| first.to_string()),
                description,
            }
        };
        let further = self.fmu_quantities().into_iter().skip(1);
        let further = further.map(|quantity| Variable {
            causality: "output",
            name: quantity.name(),
            unit: quantity.unit(),
            start: String::new(),
            description: quantity.title(),
        });
        let variables = VARIABLES.lines().filter(of_table).map(variable);
        variables.chain(further).collect()
    }

    /// modelDescription.xml.
    fn model_description(&self, name: &str, token: &str, fmi: Fmi) -> String {
        let variables = self.fmu_variables();
        // FMI 2.0 numbers variables from 1; FMI 3.0 uses value references, which begin at 0.
        let first = [1, 0][fmi as usize];
        let places = |causality: &'static str| {
            let pairs = variables.iter().zip(first..);
            let own = pairs.filter(move |(v, _)| v.causality == causality);
            own.map(|(_, place): (_, usize)| place.to_string())
        };
        let list = |causality| places(causality).collect::<Vec<String>>().join(" ");
        let (inputs, parameters) = (list("input"), list("parameter"));
        let unknowns = |element: &str, dependencies: &str| -> String {
            let key = ["index", "valueReference"][fmi as usize];
            let line =
                |k| format!("    <{element} {key}=\"{k}\" dependencies=\"{dependencies}\"/>\n");
            places("output").map(line).collect()
        };
        let with_parameters = format!("{inputs} {parameters}");
        let structure = match fmi {
            Fmi::V2 => format!(
                "    <Outputs>\n{}    </Outputs>\n    <InitialUnknowns>\n{}    </InitialUnknowns>\n",
                unknowns("Unknown", &inputs),
                unknowns("Unknown", &with_parameters)
            ),
            Fmi::V3 => unknowns("Output", &inputs) + &unknowns("InitialUnknown", &with_parameters),
        };
        let elements = variables.iter().enumerate();
        let elements: String = elements
            .map(|(k, variable)| variable.element(k, fmi))
            .collect();
        let unit = |(name, base)| format!("    <Unit name=\"{name}\">{base}</Unit>\n");
        let units: String = UNITS.map(unit).concat();
        let version = ["2.0", "3.0"][fmi as usize];
        let token_key = ["guid", "instantiationToken"][fmi as usize];
        let kinds = match fmi {
            Fmi::V2 => {
                let kind = "modelIdentifier=\"kufe_lut\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"";
                let [(source, _), _] = SOURCES[0];
                let sources = format!("<SourceFiles><File name=\"{source}\"/></SourceFiles>");
                format!(
                    "  <ModelExchange {kind}>{sources}</ModelExchange>\n  \
                     <CoSimulation {kind} canHandleVariableCommunicationStepSize=\"true\">{sources}</CoSimulation>\n"
                )
            }
            Fmi::V3 => {
                let kind = "modelIdentifier=\"kufe_lut\" canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"";
                format!(
                    "  <ModelExchange {kind} needsCompletedIntegratorStep=\"true\"/>\n  \
                     <CoSimulation {kind} canHandleVariableCommunicationStepSize=\"true\"/>\n"
                )
            }
        };
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <fmiModelDescription fmiVersion=\"{version}\" modelName=\"{name}\" {token_key}=\"{token}\"\n  \
             description=\"Peak contact pressure of a runner on ice over normal force and track curvature; case sha256 {case}\"\n  \
             version=\"{by}\" generationTool=\"kufe {by}\" variableNamingConvention=\"flat\">\n\
             {kinds}  <UnitDefinitions>\n{units}  </UnitDefinitions>\n  \
             <DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"0.01\"/>\n  \
             <ModelVariables>\n{elements}  </ModelVariables>\n  \
             <ModelStructure>\n{structure}  </ModelStructure>\n</fmiModelDescription>\n",
            name = xml(name),
            by = xml(self.origin.version()),
            case = xml(self.origin.case_sha256()),
        )
    }
}

/// A variable of an FMU.
struct Variable {
    name: &'static str,
    causality: &'static str,
    /// The unit of a real number, or [`BOOLEAN`].
    unit: &'static str,
    /// The start value; empty without one.
    start: String,
    description: &'static str,
}

/// Unit that marks a Boolean variable.
const BOOLEAN: &str = "";

/// Causality, name, unit, start value and description of all variables except further quantities.
/// The key of an axis as start value means its first breakpoint.
const VARIABLES: &str = include_str!("variables.csv");

/// Units of variables, except 1, with their base units.
const UNITS: [(&str, &str); 8] = [
    ("s", "<BaseUnit s=\"1\"/>"),
    ("N", "<BaseUnit kg=\"1\" m=\"1\" s=\"-2\"/>"),
    (
        "Pa",
        "<BaseUnit kg=\"1\" m=\"-1\" s=\"-2\"/><DisplayUnit name=\"MPa\" factor=\"1e-6\"/>",
    ),
    ("m/s", "<BaseUnit m=\"1\" s=\"-1\"/>"),
    ("rad/s", "<BaseUnit rad=\"1\" s=\"-1\"/>"),
    ("1/m", "<BaseUnit m=\"-1\"/>"),
    ("m", "<BaseUnit m=\"1\"/>"),
    ("degC", "<BaseUnit K=\"1\" offset=\"273.15\"/>"),
];

impl Variable {
    /// The XML element of the variable with the value reference `place`.
    fn element(&self, place: usize, fmi: Fmi) -> String {
        let is_boolean = self.unit == BOOLEAN;
        let variability = match (self.causality, is_boolean) {
            ("parameter", _) => "fixed",
            (_, true) => "discrete",
            (_, false) => "continuous",
        };
        let common = format!(
            "name=\"{}\" valueReference=\"{place}\" causality=\"{}\" variability=\"{variability}\" description=\"{}\"",
            self.name,
            self.causality,
            xml(self.description)
        );
        let mut attributes = String::new();
        if !is_boolean && self.unit != "1" {
            attributes += &format!(" unit=\"{}\"", self.unit);
        }
        if !self.start.is_empty() {
            attributes += &format!(" start=\"{}\"", self.start);
        }
        let real = ["Real", "Float64"][fmi as usize];
        let kind = if is_boolean { "Boolean" } else { real };
        match fmi {
            Fmi::V2 => {
                format!("    <ScalarVariable {common}><{kind}{attributes}/></ScalarVariable>\n")
            }
            Fmi::V3 => format!("    <{kind} {common}{attributes}/>\n"),
        }
    }
}
