//! The further forms of a table.

use std::path::{Path, PathBuf};

use kufe::jobs::{Failure, table::read_table};
use kufe_lut::{Table, simulink_files};
use serde::Serialize;

use crate::output::OutputFiles;
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
    /// Radius of the rocker [m], for --header, --simulink and --fmu where the table has that axis
    #[arg(long, value_name = "METRES")]
    pub rocker_radius_m: Option<f64>,
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
    if args.forms.none() {
        return Err(Failure::Usage(
            "nothing to export: give --csv, --mat, --header, --simulink or --fmu".into(),
        ));
    }
    let inputs = std::slice::from_ref(&args.table);
    let outputs = args.forms.paths(&args.table);
    let files = OutputFiles::begin("lut export", inputs, &outputs, global.force)?;
    let table = read_table(&args.table)?;
    let written = args.forms.write(&table, &args.table, &files)?;
    files.commit()?;
    global.print(&Exported { written: &written }, || {
        let lines = written
            .iter()
            .map(|path| format!("wrote {}\n", path.display()));
        lines.collect()
    })
}

impl Forms {
    fn none(&self) -> bool {
        [&self.csv, &self.mat, &self.header, &self.fmu]
            .iter()
            .all(|form| form.is_none())
            && !self.simulink
    }

    /// The requested forms with their files: in the folder of the table where they name none.
    fn places(&self, sibling: &Path) -> Vec<(&'static str, PathBuf)> {
        let forms = [
            (&self.csv, "csv"),
            (&self.mat, "mat"),
            (&self.header, "h"),
            (&self.fmu, "fmu"),
        ];
        let requested = forms.into_iter().filter_map(|(requested, ending)| {
            let named = requested.as_ref()?.clone();
            Some((
                ending,
                named.unwrap_or_else(|| sibling.with_extension(ending)),
            ))
        });
        let mut places: Vec<(&'static str, PathBuf)> = requested.collect();
        if self.simulink {
            let folder = sibling.parent().unwrap_or(Path::new(""));
            for (form, name) in ["h", "sfun", "m"]
                .into_iter()
                .zip(simulink_files(&stem(sibling)))
            {
                let path = folder.join(name);
                if places.iter().all(|(_, known)| *known != path) {
                    places.push((form, path));
                }
            }
        }
        places
    }

    /// The files of the requested forms.
    pub fn paths(&self, sibling: &Path) -> Vec<PathBuf> {
        let places = self.places(sibling).into_iter();
        places.map(|(_, path)| path).collect()
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
        let stem = stem(sibling);
        let form = |ending: &str, bytes: &mut Vec<u8>| match ending {
            "csv" => table.write_csv(bytes),
            "mat" => table.write_mat(bytes),
            "h" => table.write_header(&stem, self.rocker_radius_m, bytes),
            "sfun" => table.write_s_function(&stem, self.rocker_radius_m, bytes),
            "m" => table.write_simulink_script(&stem, bytes),
            _ => table.write_fmu(&stem, self.rocker_radius_m, bytes),
        };
        let mut written = Vec::new();
        for (ending, path) in self.places(sibling) {
            let mut bytes = Vec::new();
            form(ending, &mut bytes)
                .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
            files.write(&path, |writer| writer.write_all(&bytes))?;
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

/// Writes the table itself.
///
/// # Errors
/// [`Failure::BadInput`] with the path.
pub fn write_table(table: &Table, path: &Path, files: &OutputFiles) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    table
        .write(&mut bytes)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
    files.write(path, |writer| writer.write_all(&bytes))
}
