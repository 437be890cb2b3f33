//! The further forms of a table.

use std::path::{Path, PathBuf};

use kufe_jobs::{Failure, table::read_table, write_whole};
use kufe_lut::{Error, Table};

use crate::output::global::Global;

/// Which forms to write beside a table.
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
    /// Write an FMU (FMI 3.0, co-simulation and model exchange)
    #[arg(long, value_name = "FILE", num_args = 0..=1, require_equals = true)]
    pub fmu: Option<Option<PathBuf>>,
    /// Rocker radius for --header and --fmu, where the table has that axis [m]
    #[arg(long, value_name = "METRES")]
    pub rocker: Option<f64>,
}

/// Arguments of `kufe lut export`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The table
    pub table: PathBuf,
    #[command(flatten)]
    forms: Forms,
}

/// Writes the forms asked for.
///
/// # Errors
/// [`Failure::Usage`] where none is asked for, [`Failure::BadInput`] for files.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    if args.forms.none() {
        return Err(Failure::Usage(
            "nothing to export: give --csv, --mat, --header or --fmu".into(),
        ));
    }
    let table = read_table(&args.table)?;
    let written = args.forms.write(&table, &args.table)?;
    if global.json {
        let names: Vec<String> = written.iter().map(|p| p.display().to_string()).collect();
        println!("{}", serde_json::json!({ "written": names }));
    } else if !global.quiet {
        for path in written {
            println!("wrote {}", path.display());
        }
    }
    Ok(())
}

impl Forms {
    fn none(&self) -> bool {
        [&self.csv, &self.mat, &self.header, &self.fmu]
            .iter()
            .all(|form| form.is_none())
    }

    /// Writes the forms, beside the table where they name no file; returns what was written.
    ///
    /// # Errors
    /// [`Failure::BadInput`] where a form cannot be made of this table or a file not be written.
    pub fn write(&self, table: &Table, beside: &Path) -> Result<Vec<PathBuf>, Failure> {
        let stem = beside
            .file_stem()
            .map_or("table".into(), |stem| stem.to_string_lossy().into_owned());
        type Write<'a> = &'a dyn Fn(&mut Vec<u8>) -> Result<(), Error>;
        let forms: [(&Option<Option<PathBuf>>, &str, Write); 4] = [
            (&self.csv, "csv", &|bytes| table.write_csv(bytes)),
            (&self.mat, "mat", &|bytes| table.write_mat(bytes)),
            (&self.header, "h", &|bytes| {
                table.write_header(&stem, self.rocker, bytes)
            }),
            (&self.fmu, "fmu", &|bytes| {
                table.write_fmu(&stem, self.rocker, bytes)
            }),
        ];
        let mut written = Vec::new();
        for (asked, ending, write) in forms {
            let Some(path) = asked else { continue };
            let path = match path {
                Some(path) => path.clone(),
                None => beside.with_extension(ending),
            };
            let mut bytes = Vec::new();
            write(&mut bytes)
                .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
            write_whole(&path, |writer| writer.write_all(&bytes))?;
            written.push(path);
        }
        Ok(written)
    }
}

/// Writes the table itself.
///
/// # Errors
/// [`Failure::BadInput`] with the path.
pub fn write_table(table: &Table, path: &Path) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    table
        .write(&mut bytes)
        .map_err(|error| Failure::BadInput(format!("{}: {error}", path.display())))?;
    write_whole(path, |writer| writer.write_all(&bytes))
}
