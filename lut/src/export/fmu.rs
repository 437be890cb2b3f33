//! A table as a Functional Mock-up Unit, FMI 2.0 or 3.0, Model Exchange and Co-Simulation.
//!
//! The libraries inside are the same for every table and both versions: they were compiled with
//! this crate and read the table from the unit's resources. So an FMU is written without a
//! compiler.

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

/// A compiled library, its platform as each version of FMI names it.
struct Library {
    fmi2: &'static str,
    fmi3: &'static str,
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
    /// The platforms that it has a library for, as FMI names them.
    pub platforms: Vec<String>,
}

/// Reads the table of an FMU back.
///
/// # Errors
/// [`Error::Invalid`] past [`MAX_FILE_BYTES`]; [`Error::Zip`] where it is no archive or has no
/// table in its resources; those of [`Table::read`], which bounds what the table takes when it is
/// expanded.
pub fn read_fmu(mut reader: impl Read + Seek) -> Result<Fmu, Error> {
    if reader.seek(SeekFrom::End(0))? > MAX_FILE_BYTES {
        return Err(Error::too_large(MAX_FILE_BYTES));
    }
    reader.rewind()?;
    let mut archive = ZipArchive::new(reader)?;
    let platform = |name: &str| {
        Some(
            name.strip_prefix("binaries/")?
                .split_once('/')?
                .0
                .to_owned(),
        )
    };
    let names: Result<Vec<_>, _> = archive.file_names().collect();
    let mut platforms: Vec<String> = names?.iter().filter_map(|name| platform(name)).collect();
    platforms.sort();
    platforms.dedup();
    let table = Table::read(&mut archive.by_name("resources/table.lut")?)?;
    Ok(Fmu { table, platforms })
}

impl Table {
    /// Writes an FMU whose inputs are `fz`, `v`, `pitch_rate` and `curvature` and whose outputs are
    /// `pressure` (the peak pressure) and `out_of_range`; of a runner that slides also the input
    /// `ice_c` and the outputs `mu`, `mu_ploughing`, `mu_viscous`, `mu_boundary`, `groove_depth`
    /// and `film_mean`.
    ///
    /// The parameter `use_curvature` takes the input `curvature` instead of `-pitch_rate / v`;
    /// `smooth` chooses the mode. The unit holds libraries for the platform that this crate was
    /// built on and, where it was built with MinGW-w64 at hand, for Windows, and its sources for
    /// others. `rocker_radius` as in [`Table::write_header`].
    ///
    /// # Errors
    /// [`Error::Invalid`] where this crate was built without a C compiler, or the radius is not on
    /// the axis; [`Error::RockerNeeded`]; [`Error::Zip`] and [`Error::Stream`].
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
        let sources = SOURCES[usize::from(fmi == Fmi::V3)];
        files.extend(sources.map(|(file, text)| (format!("sources/{file}"), text.as_bytes())));
        if fmi == Fmi::V3 {
            let build = "sources/buildDescription.xml".into();
            files.push((build, BUILD_DESCRIPTION.as_bytes()));
        }
        files.extend(LIBRARIES.iter().map(|library| {
            let platform = match fmi {
                Fmi::V2 => library.fmi2,
                Fmi::V3 => library.fmi3,
            };
            let path = format!("binaries/{platform}/kufe_lut.{}", library.ending);
            (path, library.bytes)
        }));
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        for (path, bytes) in files {
            let mode = if path.starts_with("binaries/") {
                0o755
            } else {
                0o644
            };
            zip.start_file(path, options.unix_permissions(mode))?;
            zip.write_all(bytes)?;
        }
        writer.write_all(&zip.finish()?.into_inner())?;
        Ok(())
    }

    /// What follows magic and token in `resources/table.bin` (see `Head` in c/unit.h),
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
                let stack = LAYER_AXES
                    .iter()
                    .filter_map(|(kind, _)| smooth.layer_axis(*kind));
                for axis in stack {
                    numbers.extend(&axis.points.plain);
                    numbers.extend(&axis.points.scaled);
                    numbers.extend(axis.slopes.concat().concat());
                }
            }
            logarithmic |= u32::from(smooth.is_logarithmic()) << k;
            // The plain values do not depend on the mode but at a rocker radius between
            // breakpoints, which exports refuse.
            numbers.extend(smooth.values());
            numbers.extend(smooth.flat_jets());
        }
        let length = |kind| axes.get(kind).map_or(0, <[f64]>::len) as u32;
        let kinds = [
            AxisKind::Fz,
            AxisKind::Curvature,
            AxisKind::Speed,
            AxisKind::IceTemperature,
        ];
        let rules = kinds.iter().enumerate();
        let outside = rules.fold(0, |bits, (k, &kind)| {
            bits | (axes.outside(kind) as u32) << (2 * k)
        });
        let mut bytes = Vec::new();
        for count in [
            length(kinds[0]),
            length(kinds[1]),
            length(kinds[2]),
            length(kinds[3]),
            quantities.len() as u32,
            logarithmic,
            u32::from(axes.flush().is_some()),
            outside,
        ] {
            bytes.extend(count.to_le_bytes());
        }
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
        Ok(bytes)
    }

    /// The peak pressure, and the further quantities of a runner that slides.
    fn fmu_quantities(&self) -> Vec<Quantity> {
        let at_rest = Quantity::of(false).len();
        let sliding = self.quantities()[at_rest..].iter().copied();
        std::iter::once(Quantity::PMax).chain(sliding).collect()
    }

    /// The variables, whose value references are their places.
    fn fmu_variables(&self) -> Vec<Variable> {
        let axes = self.axes();
        let first = |axis: Option<&[f64]>| axis.map_or(0.0, |axis| axis[0]);
        let real = |causality, name, unit, description| Variable {
            name,
            causality,
            unit,
            description,
            start: None,
        };
        let input = |name, unit, start: f64, description| Variable {
            start: Some(start.to_string()),
            ..real("input", name, unit, description)
        };
        let boolean = |name, start: bool, description| Variable {
            start: Some(start.to_string()),
            ..real("parameter", name, BOOLEAN, description)
        };
        let mut variables = vec![
            real("independent", "time", "s", "Time"),
            input("fz", "N", axes.fz()[0], "Normal force on the runner"),
            input("v", "m/s", first(axes.speed()), "Speed, forward positive"),
            input("pitch_rate", "rad/s", 0.0, "Pitch rate, nose down positive"),
            input(
                "curvature",
                "1/m",
                0.0,
                "Track curvature, valley positive; used where use_curvature is true",
            ),
            real("output", "pressure", "Pa", "Peak contact pressure"),
            real(
                "output",
                "out_of_range",
                BOOLEAN,
                "An input is outside the table, or is NaN",
            ),
            boolean(
                "use_curvature",
                false,
                "Take the input curvature instead of -pitch_rate / v",
            ),
            boolean("smooth", true, "C1 interpolation instead of bilinear"),
        ];
        if self.is_sliding() {
            let start = first(axes.ice_c());
            variables.push(input("ice_c", "degC", start, "Temperature of the ice"));
        }
        let further = self.fmu_quantities().into_iter().skip(1);
        variables.extend(further.map(|quantity| {
            let unit = quantity.unit();
            real("output", quantity.name(), unit, quantity.title())
        }));
        variables
    }

    /// modelDescription.xml.
    fn model_description(&self, name: &str, token: &str, fmi: Fmi) -> String {
        let variables = self.fmu_variables();
        let places = |causality: &'static str| {
            let pairs = variables.iter().enumerate();
            pairs.filter(move |(_, v)| v.causality == causality)
        };
        // FMI 2.0 counts variables from 1, FMI 3.0 names their references, which begin at 0.
        let place = |k: usize| match fmi {
            Fmi::V2 => k + 1,
            Fmi::V3 => k,
        };
        let list = |causality| {
            let places: Vec<String> = places(causality)
                .map(|(k, _)| place(k).to_string())
                .collect();
            places.join(" ")
        };
        let (inputs, parameters) = (list("input"), list("parameter"));
        let unknowns = |element: &str, dependencies: &str| -> String {
            let key = match fmi {
                Fmi::V2 => "index",
                Fmi::V3 => "valueReference",
            };
            let lines = places("output").map(|(k, _)| {
                format!(
                    "    <{element} {key}=\"{}\" dependencies=\"{dependencies}\"/>\n",
                    place(k)
                )
            });
            lines.collect()
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
        let variables: String = variables
            .iter()
            .enumerate()
            .map(|(k, variable)| variable.element(k, fmi))
            .collect();
        let units: String = UNITS
            .iter()
            .map(|(name, base)| format!("    <Unit name=\"{name}\">{base}</Unit>\n"))
            .collect();
        let (version, token_key, kinds) = match fmi {
            Fmi::V2 => {
                let kind = "modelIdentifier=\"kufe_lut\" canGetAndSetFMUstate=\"true\" canSerializeFMUstate=\"true\"";
                let [(source, _), _] = SOURCES[0];
                let sources = format!("<SourceFiles><File name=\"{source}\"/></SourceFiles>");
                let kinds = format!(
                    "  <ModelExchange {kind}>{sources}</ModelExchange>\n  \
                     <CoSimulation {kind} canHandleVariableCommunicationStepSize=\"true\">{sources}</CoSimulation>\n"
                );
                ("2.0", "guid", kinds)
            }
            Fmi::V3 => {
                let kind = "modelIdentifier=\"kufe_lut\" canGetAndSetFMUState=\"true\" canSerializeFMUState=\"true\"";
                let kinds = format!(
                    "  <ModelExchange {kind} needsCompletedIntegratorStep=\"true\"/>\n  \
                     <CoSimulation {kind} canHandleVariableCommunicationStepSize=\"true\"/>\n"
                );
                ("3.0", "instantiationToken", kinds)
            }
        };
        format!(
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <fmiModelDescription fmiVersion=\"{version}\" modelName=\"{name}\" {token_key}=\"{token}\"\n  \
             description=\"Peak contact pressure of a runner on ice over normal force and track curvature; case sha256 {case}\"\n  \
             version=\"{by}\" generationTool=\"kufe {by}\" variableNamingConvention=\"flat\">\n\
             {kinds}  <UnitDefinitions>\n{units}  </UnitDefinitions>\n  \
             <DefaultExperiment startTime=\"0\" stopTime=\"1\" stepSize=\"0.01\"/>\n  \
             <ModelVariables>\n{variables}  </ModelVariables>\n  \
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
    start: Option<String>,
    description: &'static str,
}

/// In the place of a unit: the variable is a Boolean.
const BOOLEAN: &str = "";

/// Units of variables, but 1, with what they are made of.
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
    /// Its element at a place of the list.
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
        let mut own = String::new();
        if !is_boolean && self.unit != "1" {
            own += &format!(" unit=\"{}\"", self.unit);
        }
        if let Some(start) = &self.start {
            own += &format!(" start=\"{start}\"");
        }
        match (fmi, is_boolean) {
            (Fmi::V2, true) => {
                format!("    <ScalarVariable {common}><Boolean{own}/></ScalarVariable>\n")
            }
            (Fmi::V2, false) => {
                format!("    <ScalarVariable {common}><Real{own}/></ScalarVariable>\n")
            }
            (Fmi::V3, true) => format!("    <Boolean {common}{own}/>\n"),
            (Fmi::V3, false) => format!("    <Float64 {common}{own}/>\n"),
        }
    }
}
