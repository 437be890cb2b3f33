//! `kufe lut export`: writes a table in other formats.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, table::read_table};
use kufe_lut::{Fmi, OCTAVE_FUNCTION, Table, binding_files, simulink_files};
use serde::Serialize;

use crate::output::{OutputFiles, of_file};
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
    /// Write a C99 header with arrays and functions
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

/// Writes a table in one format. The arguments are the table, its name, the rocker radius [m] if
/// the format needs one, and the output.
type WriteForm = fn(&Table, &str, Option<f64>, &mut Vec<u8>) -> Result<(), kufe_lut::Error>;

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
    fn requested(&self, table: &Path) -> Vec<(PathBuf, WriteForm)> {
        let stem = stem(table);
        let named = |file: &Option<Option<PathBuf>>, ending: &str| {
            let default = || table.with_file_name(format!("{stem}{ending}"));
            file.clone().map(|file| file.unwrap_or_else(default))
        };
        let fixed = |requested: bool, name: String| requested.then(|| table.with_file_name(name));
        let [header, source, script] = simulink_files(&stem);
        let [_, ctypes, csharp] = binding_files(&stem);
        let needs_header = self.simulink || self.ctypes || self.csharp;
        let write_header: WriteForm =
            |table, name, radius, out| table.write_header(name, radius, out);
        let named: [(Option<PathBuf>, WriteForm); 5] = [
            (named(&self.csv, ".csv"), |table, _, _, out| {
                table.write_csv(out)
            }),
            (named(&self.mat, ".mat"), |table, _, _, out| {
                table.write_mat(out)
            }),
            (named(&self.header, ".h"), write_header),
            (named(&self.fmu, ".fmu"), |table, name, radius, out| {
                table.write_fmu(name, radius, Fmi::V3, out)
            }),
            (
                named(&self.fmu2, "_fmi2.fmu"),
                |table, name, radius, out| table.write_fmu(name, radius, Fmi::V2, out),
            ),
        ];
        let fixed: [(Option<PathBuf>, WriteForm); 6] = [
            (fixed(needs_header, header), write_header),
            (fixed(self.simulink, source), |table, name, radius, out| {
                table.write_s_function(name, radius, out)
            }),
            (fixed(self.simulink, script), |table, name, _, out| {
                table.write_simulink_script(name, out)
            }),
            (fixed(self.ctypes, ctypes), |table, name, _, out| {
                table.write_ctypes(name, out)
            }),
            (fixed(self.csharp, csharp), |table, name, _, out| {
                table.write_csharp(name, out)
            }),
            (
                fixed(self.octave, "kufe_lut_at.m".into()),
                |_, _, _, out| {
                    out.extend(OCTAVE_FUNCTION.as_bytes());
                    Ok(())
                },
            ),
        ];
        let named = named.into_iter();
        let named = named.filter_map(|(path, write)| Some((path?, write)));
        let mut requested: Vec<(PathBuf, WriteForm)> = named.collect();
        for (path, write) in fixed {
            // The header may be requested by its name too; it is written once.
            let new = path.filter(|path| requested.iter().all(|(known, _)| known != path));
            requested.extend(new.map(|path| (path, write)));
        }
        requested
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
        for (path, write) in self.requested(out) {
            let mut bytes = Vec::new();
            let written = write(table, &stem(out), self.rocker_radius_m, &mut bytes);
            written.map_err(of_file(&path))?;
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
