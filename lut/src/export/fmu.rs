//! A table as a Functional Mock-up Unit, FMI 3.0, Model Exchange and Co-Simulation.
//!
//! The library inside is the same for every table: it was compiled with this crate and reads the
//! table from the unit's resources. So an FMU is written without a compiler.

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

static LIBRARY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/kufe_lut_fmu.bin"));
const PLATFORM: &str = env!("KUFE_FMU_PLATFORM");
const SUFFIX: &str = env!("KUFE_FMU_SUFFIX");
const REASON: &str = env!("KUFE_FMU_REASON");
const DESCRIPTION: &str = include_str!("../../c/modelDescription.xml");
const BUILD_DESCRIPTION: &str = include_str!("../../c/buildDescription.xml");
const SOURCE: &str = include_str!("../../c/fmu.c");
const INTERFACE: &str = include_str!("../../c/fmi3.h");

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
    /// `smooth` chooses the mode. The unit holds a library for the platform that this crate was
    /// built on, and its sources for others. `rocker_radius` as in [`Table::write_header`].
    ///
    /// # Errors
    /// [`Error::Invalid`] where this crate was built without a C compiler, or the radius is not on
    /// the axis; [`Error::RockerNeeded`]; [`Error::Zip`] and [`Error::Stream`].
    pub fn write_fmu(
        &self,
        name: &str,
        rocker_radius: Option<f64>,
        writer: &mut dyn Write,
    ) -> Result<(), Error> {
        if LIBRARY.is_empty() {
            return Err(Error::Invalid(format!(
                "this kufe was built where no C compiler was found, so it cannot make an FMU: \
                 {REASON}; rebuild with a C compiler, or use --header"
            )));
        }
        rocker_on_axis(self, rocker_radius)?;
        let numbers = self.fmu_numbers(rocker_radius)?;
        let token = kufe_files::sha256(&numbers);
        let mut table = b"KUFELUT2".to_vec();
        table.extend(token.as_bytes());
        table.extend(&numbers);
        let mut lut = Vec::new();
        self.write(&mut lut)?;

        let library = format!("binaries/{PLATFORM}/kufe_lut.{SUFFIX}");
        let description = self.model_description(name, &token);
        let files: [(&str, &[u8]); 8] = [
            ("modelDescription.xml", description.as_bytes()),
            (&library, LIBRARY),
            ("resources/table.bin", &table),
            ("resources/table.lut", &lut),
            ("sources/buildDescription.xml", BUILD_DESCRIPTION.as_bytes()),
            ("sources/fmu.c", SOURCE.as_bytes()),
            ("sources/fmi3.h", INTERFACE.as_bytes()),
            ("sources/kufe_lut.h", EVALUATION.as_bytes()),
        ];
        let mut zip = ZipWriter::new(Cursor::new(Vec::new()));
        let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
        for (path, bytes) in files {
            let mode = if path == library { 0o755 } else { 0o644 };
            zip.start_file(path, options.unix_permissions(mode))?;
            zip.write_all(bytes)?;
        }
        writer.write_all(&zip.finish()?.into_inner())?;
        Ok(())
    }

    /// What follows magic and token in `resources/table.bin` (see `Head` in c/fmu.c),
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
        let mut bytes = Vec::new();
        for count in [
            length(AxisKind::Fz),
            length(AxisKind::Curvature),
            length(AxisKind::Speed),
            length(AxisKind::IceTemperature),
            quantities.len() as u32,
            logarithmic,
            u32::from(axes.flush().is_some()),
            0,
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

    fn model_description(&self, name: &str, token: &str) -> String {
        let mut texts: [String; 5] = Default::default();
        let [units, variables, ice, outputs, unknowns] = &mut texts;
        if self.is_sliding() {
            *units = "    <Unit name=\"m\"><BaseUnit m=\"1\"/></Unit>\n    \
                      <Unit name=\"degC\"><BaseUnit K=\"1\" offset=\"273.15\"/></Unit>\n"
                .into();
            let start = self.axes().ice_c().map_or(0.0, |ice| ice[0]);
            *variables = format!(
                "    <Float64 name=\"ice_c\" valueReference=\"{ICE_C}\" causality=\"input\" variability=\"continuous\" unit=\"degC\" \
                 start=\"{start}\" description=\"Temperature of the ice\"/>\n"
            );
            *ice = format!(" {ICE_C}");
        }
        for (k, quantity) in self.fmu_quantities().into_iter().skip(1).enumerate() {
            let reference = ICE_C + 1 + k;
            let unit = match quantity.unit() {
                "1" => String::new(),
                unit => format!(" unit=\"{unit}\""),
            };
            *variables += &format!(
                "    <Float64 name=\"{}\" valueReference=\"{reference}\" causality=\"output\" variability=\"continuous\"{unit} \
                 description=\"{}\"/>\n",
                quantity.name(),
                xml(quantity.title())
            );
            *outputs += &format!(
                "    <Output valueReference=\"{reference}\" dependencies=\"1 2 3 4 {ICE_C}\"/>\n"
            );
            *unknowns += &format!(
                "    <InitialUnknown valueReference=\"{reference}\" dependencies=\"1 2 3 4 {ICE_C} 7 8\"/>\n"
            );
        }
        DESCRIPTION
            .replace("@name@", &xml(name))
            .replace("@token@", token)
            .replace("@version@", &xml(self.origin.version()))
            .replace("@case@", &xml(self.origin.case_sha256()))
            .replace("@fz@", &self.axes().fz()[0].to_string())
            .replace("@units@", units)
            .replace("@variables@", variables)
            .replace("@ice@", ice)
            .replace("@outputs@", outputs)
            .replace("@unknowns@", unknowns)
    }
}

/// Value reference of the temperature of the ice; those of the outputs of sliding follow.
const ICE_C: usize = 9;
