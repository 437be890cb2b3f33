//! `kufe lut export`: writes a table in other formats.

use std::io::Write;
use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, Located, table::read_table};
use kufe_lut::{Fmi, OCTAVE_FUNCTION, Table, binding_files, simulink_files};
use serde::Serialize;

use crate::output::OutputFiles;
use crate::terminal::Global;
use crate::text::print_document;

/// The files that were written.
#[derive(Serialize)]
struct Exported<'a> {
    written: &'a [PathBuf],
}

/// The formats in which a table is written besides `.lut`.
#[derive(clap::Args, Debug, Default)]
pub struct Forms {
    /// Write a CSV file with one row per node
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub csv: Option<Option<PathBuf>>,
    /// Write a MATLAB v5 file
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub mat: Option<Option<PathBuf>>,
    /// Write a C99 header with arrays and functions, whose names begin with that of the file
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub header: Option<Option<PathBuf>>,
    /// Write a block for Simulink into the folder of the table: a C header, an S-function and the
    /// MATLAB script that builds both into a library
    #[arg(long)]
    pub simulink: bool,
    /// Write an FMU (FMI 3.0, co-simulation and model exchange)
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub fmu: Option<Option<PathBuf>>,
    /// Write an FMU of FMI 2.0 [default file: the table's name with _fmi2.fmu]
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub fmu2: Option<Option<PathBuf>>,
    /// Write a Python module that calls the C header's shared library by ctypes, and the header,
    /// into the folder of the table
    #[arg(long)]
    pub ctypes: bool,
    /// Write a C# class that calls the C header's shared library, and the header, into the folder
    /// of the table
    #[arg(long)]
    pub csharp: bool,
    /// Write kufe_lut_at.m, which evaluates MAT-files of tables in MATLAB and Octave, into the
    /// folder of the table
    #[arg(long)]
    pub octave: bool,
    /// Radius of the rocker [m], for C, Simulink and FMUs where the table has that axis
    #[arg(long, value_name = "METRES")]
    pub rocker_radius_m: Option<f64>,
}

/// A format of a table.
#[derive(Clone, Copy, PartialEq)]
enum Format {
    Csv,
    Mat,
    Header,
    Fmu(Fmi),
    SFunction,
    SimulinkScript,
    Ctypes,
    CSharp,
    Octave,
}

impl Format {
    /// Writes the table of this name; `radius` is that of the rocker [m], for the formats that need
    /// one.
    fn write(
        self,
        table: &Table,
        name: &str,
        radius: Option<f64>,
        out: &mut dyn Write,
    ) -> Result<(), kufe_lut::Error> {
        match self {
            Format::Csv => table.write_csv(out),
            Format::Mat => table.write_mat(out),
            Format::Header => table.write_header(name, radius, out),
            Format::Fmu(version) => table.write_fmu(name, radius, version, out),
            Format::SFunction => table.write_s_function(name, radius, out),
            Format::SimulinkScript => table.write_simulink_script(name, out),
            Format::Ctypes => table.write_ctypes(name, out),
            Format::CSharp => table.write_csharp(name, out),
            Format::Octave => Ok(out.write_all(OCTAVE_FUNCTION.as_bytes())?),
        }
    }
}

/// Arguments of `kufe lut export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    #[command(flatten)]
    forms: Forms,
}

/// Writes the requested formats.
///
/// # Errors
/// [`Failure::Usage`] if none is requested, [`Failure::BadInput`] for files.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if args.forms.paths(Path::new("")).is_empty() {
        return Err(Failure::Usage(
            "nothing to export: give --csv, --mat, --octave, --header, --ctypes, --csharp, --simulink, --fmu or --fmu2".into(),
        ));
    }
    let inputs = std::slice::from_ref(&args.table);
    let outputs = args.forms.paths(&args.table);
    let files = OutputFiles::begin("lut export", inputs, &outputs, global.force)?;
    let table = read_table(&args.table)?;
    args.forms.write(&table, &args.table, &files)?;
    files.commit()?;
    print_document(&Exported { written: &outputs }, global)
}

impl Forms {
    /// The requested formats and their files. A file that is not named is in the folder of the
    /// table.
    fn requested(&self, table: &Path) -> Vec<(PathBuf, Format)> {
        let stem = stem(table);
        let named = |file: &Option<Option<PathBuf>>, ending: &str| {
            let default = || table.with_file_name(format!("{stem}{ending}"));
            file.clone().map(|file| file.unwrap_or_else(default))
        };
        let fixed = |requested: bool, name: &str| requested.then(|| table.with_file_name(name));
        let [header, source, script] = simulink_files(&stem);
        let [_, ctypes, csharp] = binding_files(&stem);
        let needs_header = self.simulink || self.ctypes || self.csharp;
        let formats = [
            (named(&self.csv, ".csv"), Format::Csv),
            (named(&self.mat, ".mat"), Format::Mat),
            (named(&self.header, ".h"), Format::Header),
            (named(&self.fmu, ".fmu"), Format::Fmu(Fmi::V3)),
            (named(&self.fmu2, "_fmi2.fmu"), Format::Fmu(Fmi::V2)),
            (fixed(needs_header, &header), Format::Header),
            (fixed(self.simulink, &source), Format::SFunction),
            (fixed(self.simulink, &script), Format::SimulinkScript),
            (fixed(self.ctypes, &ctypes), Format::Ctypes),
            (fixed(self.csharp, &csharp), Format::CSharp),
            (fixed(self.octave, "kufe_lut_at.m"), Format::Octave),
        ];
        let mut requested = Vec::new();
        for (path, format) in formats {
            // The header may be requested by its name too; it is written once.
            let new = path.map(|path| (path, format));
            requested.extend(new.filter(|new| !requested.contains(new)));
        }
        requested
    }

    /// Checks that a radius is given for the formats of a table with rocker radii that do not have
    /// this axis.
    ///
    /// # Errors
    /// [`Failure::Usage`] if it is not given.
    pub fn require_radius(&self) -> Result<(), Failure> {
        let has_axis = |format| matches!(format, Format::Csv | Format::Mat | Format::Octave);
        let mut requested = self.requested(Path::new("")).into_iter();
        if self.rocker_radius_m.is_none() && requested.any(|(_, format)| !has_axis(format)) {
            return Err(Failure::Usage(
                "the table has a rocker radius axis, and C, Simulink and FMUs have none: give --rocker-radius-m".into(),
            ));
        }
        Ok(())
    }

    /// The files of the requested formats.
    pub fn paths(&self, table: &Path) -> Vec<PathBuf> {
        let requested = self.requested(table).into_iter();
        requested.map(|(path, _)| path).collect()
    }

    /// Writes the table and the requested formats. Returns the files of the formats.
    ///
    /// # Errors
    /// As [`write`](Self::write).
    pub fn commit(
        &self,
        table: &Table,
        out: &Path,
        files: OutputFiles,
    ) -> Result<Vec<PathBuf>, Failure> {
        files.write(out, |writer| table.write(writer))?;
        self.write(table, out, &files)?;
        files.commit()?;
        Ok(self.paths(out))
    }

    /// Writes the requested formats.
    ///
    /// # Errors
    /// [`Failure::BadInput`] if a format does not support this table or a file cannot be written.
    fn write(&self, table: &Table, out: &Path, files: &OutputFiles) -> Result<(), Failure> {
        for (path, format) in self.requested(out) {
            // Headers of one table, such as those of two rocker radii, differ by their files' names.
            let name = match format {
                Format::Header => stem(&path),
                _ => stem(out),
            };
            let mut bytes = Vec::new();
            let written = format.write(table, &name, self.rocker_radius_m, &mut bytes);
            written.in_file(&path)?;
            files.bytes(&path, &bytes)?;
        }
        Ok(())
    }
}

/// The name of a table: its file name without extension.
fn stem(table: &Path) -> String {
    let stem = table.file_stem();
    stem.map_or("table".into(), |stem| stem.to_string_lossy().into_owned())
}
