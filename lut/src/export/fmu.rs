//! A table as a Functional Mock-up Unit, FMI 3.0, Model Exchange and Co-Simulation.
//!
//! The library inside is the same for every table: it was compiled with this crate and reads the table from the
//! unit's resources. So an FMU is written without a compiler.

use std::io::{Cursor, Write};

use sha2::{Digest, Sha256};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

use crate::error::Error;
use crate::export::header::{EVALUATION, rocker_on_axis};
use crate::table::lookup::Lookup;
use crate::table::mode::Mode;
use crate::table::nodes::Table;
use crate::table::quantity::Quantity;

static LIBRARY: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/kufe_lut_fmu.bin"));
const PLATFORM: &str = env!("KUFE_FMU_PLATFORM");
const SUFFIX: &str = env!("KUFE_FMU_SUFFIX");
const REASON: &str = env!("KUFE_FMU_REASON");
const DESCRIPTION: &str = include_str!("../../c/modelDescription.xml");
const BUILD_DESCRIPTION: &str = include_str!("../../c/buildDescription.xml");
const SOURCE: &str = include_str!("../../c/fmu.c");
const INTERFACE: &str = include_str!("../../c/fmi3.h");

impl Table {
    /// Writes an FMU whose inputs are `fz`, `v`, `pitch_rate` and `curvature` and whose outputs are `pressure`
    /// (the peak pressure) and `out_of_range`.
    ///
    /// The parameter `use_curvature` takes the input `curvature` instead of `-pitch_rate / v`; `smooth` chooses
    /// the mode. The unit holds a library for the platform that this crate was built on, and its sources
    /// for others. `rocker_radius` as in [`Table::write_header`].
    ///
    /// # Errors
    /// [`Error::NoFmuLibrary`] where this crate was built without a C compiler; [`Error::RockerNeeded`],
    /// [`Error::RockerOutside`]; [`Error::Zip`] and [`Error::Write`].
    pub fn write_fmu(
        &self,
        name: &str,
        rocker_radius: Option<f64>,
        writer: &mut dyn Write,
    ) -> Result<(), Error> {
        if LIBRARY.is_empty() {
            return Err(Error::NoFmuLibrary { reason: REASON });
        }
        rocker_on_axis(self, rocker_radius)?;
        let numbers = self.fmu_numbers(rocker_radius)?;
        let token: String = Sha256::digest(&numbers)
            .iter()
            .map(|byte| format!("{byte:02x}"))
            .collect();
        let mut table = b"KUFELUT1".to_vec();
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

    /// What follows magic and token in `resources/table.bin` (see `Head` in c/fmu.c), little-endian.
    fn fmu_numbers(&self, rocker_radius: Option<f64>) -> Result<Vec<u8>, Error> {
        let rough = Lookup::with_rocker(self, Quantity::PMax, Mode::Bilinear, rocker_radius)?;
        let smooth = Lookup::with_rocker(self, Quantity::PMax, Mode::Smooth, rocker_radius)?;
        let (_, jets, logarithmic) = smooth.parts();
        let (fz, curvature) = (self.axes().fz(), self.axes().curvature());
        let mut bytes = Vec::new();
        for count in [
            fz.len() as u32,
            curvature.len() as u32,
            u32::from(logarithmic),
            u32::from(self.axes().flush().is_some()),
        ] {
            bytes.extend(count.to_le_bytes());
        }
        let mut numbers = Vec::new();
        numbers.extend(self.axes().flush().iter().flat_map(|flush| flush.numbers()));
        numbers.extend(fz);
        numbers.extend(fz.iter().map(|fz| fz.ln()));
        numbers.extend(curvature);
        numbers.extend(rough.parts().0);
        numbers.extend(jets.iter().flat_map(|j| [j.f, j.fx, j.fy, j.fxy]));
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
        Ok(bytes)
    }

    fn model_description(&self, name: &str, token: &str) -> String {
        DESCRIPTION
            .replace("@name@", &escape(name))
            .replace("@token@", token)
            .replace("@version@", &escape(&self.version))
            .replace("@case@", &escape(&self.case_sha256))
            .replace("@fz@", &self.axes().fz()[0].to_string())
    }
}

fn escape(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control())
        .map(|c| match c {
            '&' => "&amp;".into(),
            '<' => "&lt;".into(),
            '>' => "&gt;".into(),
            '"' => "&quot;".into(),
            c => c.to_string(),
        })
        .collect()
}
