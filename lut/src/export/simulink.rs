//! A table as a Simulink block: a C MEX S-function that includes its header, and the MATLAB script
//! that builds a library with it.

use std::io::Write;

use crate::error::Error;
use crate::export::escape::{comment, identifier};
use crate::export::fill;
use crate::export::header::rocker_on_axis;
use crate::interpolator::Mode;
use crate::quantity::Quantity;
use crate::table::Table;

/// An input or output of the block: its name, and its unit in Simulink's spelling.
type Port = (&'static str, &'static str);

/// The description in the block's mask; text within single quotes of MATLAB.
const DESCRIPTION: &str = "Figures of a contact over normal force and track curvature; out_of_range is 1 where an input was outside";

/// The files of the block for a table of this name: header, S-function, script.
pub fn simulink_files(name: &str) -> [String; 3] {
    let name = identifier(name);
    [
        format!("{name}.h"),
        format!("{name}_sfun.c"),
        format!("build_{name}.m"),
    ]
}

impl Table {
    /// Writes the S-function (level 2, C MEX) that includes the header of [`Table::write_header`]
    /// and has one output per quantity of the table; its last output states whether an input was
    /// outside. Its parameter is 1 for the smooth mode and 2 for the bilinear mode.
    ///
    /// Sources: MathWorks, "Create C S-Functions" (Simulink): the four callbacks that a level-2
    /// S-function must have.
    ///
    /// # Errors
    /// [`Error::RockerNeeded`] and [`Error::Invalid`] as [`Table::write_header`];
    /// [`Error::Stream`].
    pub fn write_s_function(
        &self,
        name: &str,
        rocker_radius: Option<f64>,
        writer: &mut dyn Write,
    ) -> Result<(), Error> {
        rocker_on_axis(self, rocker_radius)?;
        let name = identifier(name);
        let (inputs, outputs) = self.ports();
        let arguments = (0..inputs.len()).map(|k| format!("*ssGetInputPortRealSignal(S, {k})"));
        let arguments: Vec<String> = arguments.collect();
        let mut outputs_text = String::new();
        for (k, quantity) in self.quantities().iter().enumerate() {
            let symbol = format!("{name}_{}", quantity.name());
            let [smooth, bilinear] = [Mode::Smooth, Mode::Bilinear]
                .map(|mode| format!("{symbol}_{}({})", mode.name(), arguments.join(", ")));
            outputs_text += &format!(
                "  found = smooth ? {smooth} : {bilinear};\n  *ssGetOutputPortRealSignal(S, {k}) = found.value;\n  \
                 outside |= found.out_of_range;\n  refused |= found.out_of_range == 2;\n"
            );
        }
        let listed = |ports: &[Port]| {
            let names: Vec<&str> = ports.iter().map(|(name, _)| *name).collect();
            names.join(", ")
        };
        let [inputs_count, outputs_count] = [inputs.len(), outputs.len()].map(|n| n.to_string());
        let slots = [
            ("name", &*name),
            ("version", &comment(self.origin.version())),
            ("ins", &listed(&inputs)),
            ("outs", &listed(&outputs)),
            ("inputs", &inputs_count),
            ("outputs", &outputs_count),
            ("last", &(outputs.len() - 1).to_string()),
            ("outputs_text", &outputs_text),
        ];
        fill(writer, include_str!("s_function.c.txt"), &slots)
    }

    /// Writes the MATLAB script that compiles the S-function and builds a library, `NAME_lib`, with
    /// one block. Its ports have the names and units of the table's columns; its parameter chooses
    /// the mode.
    ///
    /// # Errors
    /// [`Error::Stream`].
    pub fn write_simulink_script(&self, name: &str, writer: &mut dyn Write) -> Result<(), Error> {
        let name = identifier(name);
        let (inputs, outputs) = self.ports();
        let list = |ports: &[Port]| {
            let rows = ports
                .iter()
                .map(|(name, unit)| format!("'{name}', '{unit}'"));
            rows.collect::<Vec<String>>().join("; ")
        };
        let slots = [
            ("name", &*name),
            ("version", &comment(self.origin.version())),
            ("bottom", &(60 + 40 * outputs.len()).to_string()),
            ("ins", &list(&inputs)),
            ("outs", &list(&outputs)),
            ("described", DESCRIPTION),
        ];
        fill(writer, include_str!("simulink.m.txt"), &slots)
    }

    /// Inputs and outputs with their units; 1 for dimensionless quantities.
    fn ports(&self) -> (Vec<Port>, Vec<Port>) {
        let mut inputs = vec![("fz_n", "N"), ("curvature_1pm", "1/m")];
        if self.axes().is_sliding() {
            inputs.extend([("v_mps", "m/s"), ("ice_c", "degC")]);
        }
        let port = |quantity: &Quantity| match quantity.unit() {
            "m2" => (quantity.key(), "m^2"),
            unit => (quantity.key(), unit),
        };
        let mut outputs: Vec<Port> = self.quantities().iter().map(port).collect();
        outputs.push(("out_of_range", "1"));
        (inputs, outputs)
    }
}
