//! A table for Python and C#, through the shared library of its header; and the function that
//! evaluates MAT-files in MATLAB and Octave.

use std::io::Write;

use crate::error::Error;
use crate::export::escape::{comment, identifier};
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
        let listed = |names: &mut dyn Iterator<Item = &str>| {
            let quoted: Vec<String> = names.map(|name| format!("\"{name}\"")).collect();
            quoted.join(", ")
        };
        let text = format!(
            "\"\"\"Lookup table {name}, by kufe {version}: the functions of the library of {name}.h, in the same folder.\n\n    \
             cc {flags} -x c {name}.h -o lib{name}.so -lm\n\n\
             Arguments: {arguments}. The functions return `value` and `out_of_range`, with\n\
             {DERIVATIVES} behind their name also the derivatives by the arguments.\n\"\"\"\n\n\
             import ctypes\nimport os\nimport sys\n\n\n\
             class Interpolated(ctypes.Structure):\n    \
             _fields_ = [(\"value\", ctypes.c_double), (\"out_of_range\", ctypes.c_int)]\n\n\n\
             class Derivatives(ctypes.Structure):\n    \
             _fields_ = [\n        \
             *((_field, ctypes.c_double) for _field in ({fields})),\n        \
             (\"out_of_range\", ctypes.c_int),\n    ]\n\n\n\
             _file = {{\"win32\": \"{name}.dll\", \"darwin\": \"lib{name}.dylib\"}}.get(sys.platform, \"lib{name}.so\")\n\
             _library = ctypes.CDLL(os.path.join(os.path.dirname(os.path.abspath(__file__)), _file))\n\
             for _name in ({functions}):\n    \
             for _ending, _type in ((\"\", Interpolated), (\"{DERIVATIVES}\", Derivatives)):\n        \
             _function = getattr(_library, \"{name}_\" + _name + _ending)\n        \
             _function.argtypes, _function.restype = [ctypes.c_double] * {count}, _type\n        \
             globals()[_name + _ending] = _function\n",
            version = comment(self.origin.version()),
            flags = FLAGS,
            arguments = symbols.arguments.join(", "),
            fields = listed(&mut FIELDS.iter().copied()),
            functions = listed(&mut symbols.own_names()),
            count = symbols.arguments.len(),
        );
        writer.write_all(text.as_bytes())?;
        Ok(())
    }

    /// Writes the class for C# that calls the library of [`Table::write_header`].
    ///
    /// # Errors
    /// [`Error::Stream`].
    pub fn write_csharp(&self, name: &str, writer: &mut dyn Write) -> Result<(), Error> {
        let symbols = self.symbols(name);
        let name = &symbols.name;
        let declared: Vec<String> = symbols
            .arguments
            .iter()
            .map(|argument| format!("double {argument}"))
            .collect();
        let declared = declared.join(", ");
        let functions: String = symbols
            .own_names()
            .flat_map(|own| [("", "Interpolated"), (DERIVATIVES, "Derivatives")].map(|pair| (own, pair)))
            .map(|(own, (ending, kind))| {
                format!(
                    "    [DllImport(\"{name}\", EntryPoint = \"{name}_{own}{ending}\", CallingConvention = CallingConvention.Cdecl)]\n    \
                     public static extern {kind} {own}{ending}({declared});\n"
                )
            })
            .collect();
        let text = format!(
            "// Lookup table {name}, by kufe {version}: the functions of the library of {name}.h, lib{name}.so or {name}.dll:\n//   \
             cc {flags} -x c {name}.h -o lib{name}.so -lm\n//   \
             x86_64-w64-mingw32-gcc {flags} -x c {name}.h -o {name}.dll\n\
             using System.Runtime.InteropServices;\n\n\
             public static class @{name}\n{{\n    \
             [StructLayout(LayoutKind.Sequential)]\n    \
             public struct Interpolated {{ public double value; public int out_of_range; }}\n\n    \
             [StructLayout(LayoutKind.Sequential)]\n    \
             public struct Derivatives {{ public double {fields}; public int out_of_range; }}\n\n\
             {functions}}}\n",
            version = comment(self.origin.version()),
            flags = FLAGS,
            fields = FIELDS.join(", "),
        );
        writer.write_all(text.as_bytes())?;
        Ok(())
    }
}

/// How a header is compiled to a shared library.
const FLAGS: &str = "-std=c99 -O2 -ffp-contract=off -shared -fPIC -DKUFE_LUT_SHARED";
