//! The further forms of a table.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, table::read_table};
use kufe_lut::{Fmi, OCTAVE_FUNCTION, Table, binding_files, simulink_files};
use serde::Serialize;

use crate::output::{OutputFiles, of_file};
use crate::terminal::Global;

/// Files that were written.
#[derive(Serialize)]
struct Exported<'a> {
    written: &'a [PathBuf],
}

/// Which forms of a table to write as well.
#[derive(clap::Args, Debug, Default)]
pub struct Forms {
    /// Write one row a node as CSV
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

/// A form of a table.
#[derive(Clone, Copy, Debug)]
enum Form {
    Csv,
    Mat,
    Octave,
    Header,
    Ctypes,
    CSharp,
    SFunction,
    SimulinkScript,
    Fmu(Fmi),
}

/// Arguments of `kufe lut export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    #[command(flatten)]
    forms: Forms,
}

/// Writes the requested forms.
///
/// # Errors
/// [`Failure::Usage`] where none is requested, [`Failure::BadInput`] for files.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if args.forms.places(Path::new("")).is_empty() {
        return Err(Failure::Usage(
            "nothing to export: give --csv, --mat, --octave, --header, --ctypes, --csharp, --simulink, --fmu or --fmu2".into(),
        ));
    }
    let inputs = std::slice::from_ref(&args.table);
    let outputs = args.forms.paths(&args.table);
    let files = OutputFiles::begin("lut export", inputs, &outputs, global.force)?;
    let table = read_table(&args.table)?;
    let written = args.forms.write(&table, &args.table, &files)?;
    files.commit()?;
    global.print(&Exported { written: &written }, || {
        let line = |path: &PathBuf| format!("wrote {}\n", path.display());
        written.iter().map(line).collect()
    })
}

impl Forms {
    /// The requested forms with their files: in the folder of the table where they name none.
    fn places(&self, sibling: &Path) -> Vec<(Form, PathBuf)> {
        let named = [
            (&self.csv, Form::Csv, ".csv"),
            (&self.mat, Form::Mat, ".mat"),
            (&self.header, Form::Header, ".h"),
            (&self.fmu, Form::Fmu(Fmi::V3), ".fmu"),
            (&self.fmu2, Form::Fmu(Fmi::V2), "_fmi2.fmu"),
        ];
        let stem = stem(sibling);
        let requested = named.into_iter().filter_map(|(requested, form, ending)| {
            let named = requested.as_ref()?.clone();
            let own = || sibling.with_file_name(format!("{stem}{ending}"));
            Some((form, named.unwrap_or_else(own)))
        });
        let mut places: Vec<(Form, PathBuf)> = requested.collect();
        let [header, source, script] = simulink_files(&stem);
        let [_, ctypes, csharp] = binding_files(&stem);
        let c = self.simulink || self.ctypes || self.csharp;
        for (requested, form, name) in [
            (c, Form::Header, header),
            (self.simulink, Form::SFunction, source),
            (self.simulink, Form::SimulinkScript, script),
            (self.ctypes, Form::Ctypes, ctypes),
            (self.csharp, Form::CSharp, csharp),
            (self.octave, Form::Octave, "kufe_lut_at.m".into()),
        ] {
            let path = sibling.with_file_name(name);
            if requested && places.iter().all(|(_, known)| *known != path) {
                places.push((form, path));
            }
        }
        places
    }

    /// The files of the requested forms.
    pub fn paths(&self, sibling: &Path) -> Vec<PathBuf> {
        let places = self.places(sibling).into_iter();
        places.map(|(_, path)| path).collect()
    }

    /// Writes the table itself and its requested forms, whose files are returned, to their places.
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
        let written = self.write(table, out, &files)?;
        files.commit()?;
        Ok(written)
    }

    /// Writes the requested forms; returns their files.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where a form cannot be made of this table or a file not be written.
    pub fn write(
        &self,
        table: &Table,
        sibling: &Path,
        files: &OutputFiles,
    ) -> Result<Vec<PathBuf>, Failure> {
        let (stem, radius) = (stem(sibling), self.rocker_radius_m);
        let write = |form: Form, bytes: &mut Vec<u8>| match form {
            Form::Csv => table.write_csv(bytes),
            Form::Mat => table.write_mat(bytes),
            Form::Octave => {
                bytes.extend(OCTAVE_FUNCTION.as_bytes());
                Ok(())
            }
            Form::Header => table.write_header(&stem, radius, bytes),
            Form::Ctypes => table.write_ctypes(&stem, bytes),
            Form::CSharp => table.write_csharp(&stem, bytes),
            Form::SFunction => table.write_s_function(&stem, radius, bytes),
            Form::SimulinkScript => table.write_simulink_script(&stem, bytes),
            Form::Fmu(fmi) => table.write_fmu(&stem, radius, fmi, bytes),
        };
        let mut written = Vec::new();
        for (form, path) in self.places(sibling) {
            let mut bytes = Vec::new();
            write(form, &mut bytes).map_err(of_file(&path))?;
            files.bytes(&path, &bytes)?;
            written.push(path);
        }
        Ok(written)
    }
}

/// The table's name.
fn stem(table: &Path) -> String {
    let stem = table.file_stem();
    stem.map_or("table".into(), |stem| stem.to_string_lossy().into_owned())
}
