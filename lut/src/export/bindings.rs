//! A table for Python and C#, through the shared library of its header, and the function that
//! evaluates MAT-files in MATLAB and Octave.

use std::io::Write;

use crate::error::Error;
use crate::export::escape::{comment, identifier};
use crate::export::fill;
use crate::export::header::{DERIVATIVES, FIELDS};
use crate::table::Table;

/// `kufe_lut_at.m`: the bilinear mode of any table that [`Table::write_mat`] wrote.
pub const OCTAVE_FUNCTION: &str = include_str!("kufe_lut_at.m");

/// The files of a table of this name: header, Python with ctypes, C#.
pub fn binding_files(name: &str) -> [String; 3] {
    ["h", "py", "cs"].map(|ending| format!("{}.{ending}", identifier(name)))
}

impl Table {
    /// Writes the module for Python that calls the library of [`Table::write_header`] by ctypes.
    ///
    /// # Errors
    /// [`Error::Stream`].
    pub fn write_ctypes(&self, name: &str, writer: &mut dyn Write) -> Result<(), Error> {
        let symbols = self.symbols(name);
        let name = &symbols.name;
        let quoted = |name: &str| format!("{name:?}");
        let fields = FIELDS.map(quoted).join(", ");
        let functions: Vec<String> = symbols.functions.iter().map(|own| quoted(own)).collect();
        let slots = [
            ("name", &**name),
            ("version", &comment(self.origin.version())),
            ("flags", FLAGS),
            ("arguments", &symbols.arguments.join(", ")),
            ("derivatives", DERIVATIVES),
            ("fields", &fields),
            ("functions", &functions.join(", ")),
            ("count", &symbols.arguments.len().to_string()),
        ];
        fill(writer, include_str!("bindings.py.txt"), &slots)
    }

    /// Writes the class for C# that calls the library of [`Table::write_header`].
    ///
    /// # Errors
    /// [`Error::Stream`].
    pub fn write_csharp(&self, name: &str, writer: &mut dyn Write) -> Result<(), Error> {
        let symbols = self.symbols(name);
        let name = &symbols.name;
        let declared = symbols.declared();
        let mut functions = String::new();
        for own in &symbols.functions {
            for (ending, kind) in [("", "Interpolated"), (DERIVATIVES, "Derivatives")] {
                functions += &format!(
                    "    [DllImport(\"{name}\", EntryPoint = \"{name}_{own}{ending}\", CallingConvention = CallingConvention.Cdecl)]\n    \
                     public static extern {kind} {own}{ending}({declared});\n"
                );
            }
        }
        let slots = [
            ("name", &**name),
            ("version", &comment(self.origin.version())),
            ("flags", FLAGS),
            ("fields", &FIELDS.join(", ")),
            ("functions", &functions),
        ];
        fill(writer, include_str!("bindings.cs.txt"), &slots)
    }
}

/// Flags that compile a header to a shared library.
const FLAGS: &str = "-std=c99 -O2 -ffp-contract=off -shared -fPIC -DKUFE_LUT_SHARED";
