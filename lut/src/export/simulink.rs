//! A table as a block for Simulink: a C MEX S-function of its header, and the MATLAB script that
//! builds a library with it.

use std::io::Write;

use crate::error::Error;
use crate::export::escape::{comment, identifier, matlab_string};
use crate::export::header::rocker_on_axis;
use crate::interpolator::Mode;
use crate::quantity::Quantity;
use crate::table::Table;

/// An input or output of the block: its name with the unit, and that unit as Simulink writes it.
struct Port {
    name: &'static str,
    unit: &'static str,
}

const fn port(name: &'static str, unit: &'static str) -> Port {
    Port { name, unit }
}

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
    /// and gives each quantity of the table at one output, and whether an input was outside at the
    /// last. Its parameter is 1 for the smooth mode, 2 for the bilinear one.
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
        let given: Vec<String> = (0..inputs.len())
            .map(|k| format!("*ssGetInputPortRealSignal(S, {k})"))
            .collect();
        let mut outputs_text = String::new();
        for (k, quantity) in self.quantities().iter().enumerate() {
            let own = format!("{name}_{}", quantity.name());
            let [smooth, bilinear] = [Mode::Smooth, Mode::Bilinear]
                .map(|mode| format!("{own}_{}({})", mode.name(), given.join(", ")));
            outputs_text += &format!(
                "  found = smooth ? {smooth} : {bilinear};\n  *ssGetOutputPortRealSignal(S, {k}) = found.value;\n  \
                 outside |= found.out_of_range;\n  refused |= found.out_of_range == 2;\n"
            );
        }
        let listed = |ports: &[Port]| {
            let names: Vec<&str> = ports.iter().map(|port| port.name).collect();
            names.join(", ")
        };
        let text = format!(
            "/* Lookup table {name} as an S-function. By kufe {version}; build_{name}.m compiles it.\n   \
             Inputs: {ins}. Outputs: {outs}.\n   Parameter: 1 smooth, 2 bilinear. */\n\
             #define S_FUNCTION_NAME {name}_sfun\n#define S_FUNCTION_LEVEL 2\n\
             #include \"simstruc.h\"\n#include \"{name}.h\"\n\n\
             static void mdlInitializeSizes(SimStruct *S) {{\n  int_T n;\n  ssSetNumSFcnParams(S, 1);\n  \
             if (ssGetNumSFcnParams(S) != ssGetSFcnParamsCount(S)) return;\n  ssSetSFcnParamTunable(S, 0, 0);\n  \
             ssSetNumContStates(S, 0);\n  ssSetNumDiscStates(S, 0);\n  if (!ssSetNumInputPorts(S, {inputs})) return;\n  \
             for (n = 0; n < {inputs}; ++n) {{\n    ssSetInputPortWidth(S, n, 1);\n    ssSetInputPortDirectFeedThrough(S, n, 1);\n    \
             ssSetInputPortRequiredContiguous(S, n, 1);\n  }}\n  if (!ssSetNumOutputPorts(S, {outputs})) return;\n  \
             for (n = 0; n < {outputs}; ++n) ssSetOutputPortWidth(S, n, 1);\n  ssSetNumSampleTimes(S, 1);\n  \
             ssSetOptions(S, SS_OPTION_EXCEPTION_FREE_CODE);\n}}\n\n\
             static void mdlInitializeSampleTimes(SimStruct *S) {{\n  ssSetSampleTime(S, 0, INHERITED_SAMPLE_TIME);\n  \
             ssSetOffsetTime(S, 0, 0.0);\n}}\n\n\
             static void mdlOutputs(SimStruct *S, int_T tid) {{\n  const int smooth = mxGetScalar(ssGetSFcnParam(S, 0)) < 1.5;\n  \
             int outside = 0, refused = 0;\n  kufe_lut_interpolated found;\n  (void)tid;\n{outputs_text}  \
             *ssGetOutputPortRealSignal(S, {last}) = outside != 0;\n  \
             if (refused) ssSetErrorStatus(S, \"{name}: an input is outside the table along an axis whose rule is error\");\n}}\n\n\
             static void mdlTerminate(SimStruct *S) {{ (void)S; }}\n\n\
             #ifdef MATLAB_MEX_FILE\n#include \"simulink.c\"\n#else\n#include \"cg_sfun.h\"\n#endif\n",
            version = comment(self.origin.version()),
            ins = listed(&inputs),
            outs = listed(&outputs),
            inputs = inputs.len(),
            outputs = outputs.len(),
            last = outputs.len() - 1,
        );
        writer.write_all(text.as_bytes())?;
        Ok(())
    }

    /// Writes the MATLAB script that compiles the S-function and builds a library, `NAME_lib`, with
    /// one block: ports have the names and units of the table's columns, the block's parameter
    /// chooses the mode.
    ///
    /// # Errors
    /// [`Error::Stream`].
    pub fn write_simulink_script(&self, name: &str, writer: &mut dyn Write) -> Result<(), Error> {
        let name = identifier(name);
        let (inputs, outputs) = self.ports();
        let list = |ports: &[Port]| {
            let rows: Vec<String> = ports
                .iter()
                .map(|port| {
                    format!(
                        "'{}', '{}'",
                        matlab_string(port.name),
                        matlab_string(port.unit)
                    )
                })
                .collect();
            rows.join("; ")
        };
        let text = format!(
            "% Builds the library {name}_lib with the block of lookup table {name}. By kufe {version}.\n\
             % Call it in MATLAB with Simulink and a C compiler (mex -setup C); {name}.h and {name}_sfun.c are in the same folder.\n\
             function build_{name}()\n\
             here = fileparts(mfilename('fullpath'));\n\
             mex('-outdir', here, fullfile(here, '{name}_sfun.c'));\n\
             addpath(here);\n\
             library = '{name}_lib';\n\
             if bdIsLoaded(library)\n  close_system(library, 0);\nend\n\
             new_system(library, 'Library');\n\
             block = [library '/{name}'];\n\
             add_block('built-in/Subsystem', block, 'Position', [120 60 300 {bottom}]);\n\
             table = [block '/table'];\n\
             add_block('built-in/S-Function', table, 'Position', [220 40 380 {bottom}]);\n\
             set_param(table, 'FunctionName', '{name}_sfun', 'Parameters', '1');\n\
             inputs = {{{ins}}};\n\
             outputs = {{{outs}}};\n\
             ports('Inport', inputs, 60);\n\
             ports('Outport', outputs, 520);\n\
             set_param(block, 'Mask', 'on', 'MaskPromptString', 'Between the nodes', ...\n  \
             'MaskStyleString', 'popup(smooth|bilinear)', 'MaskVariables', 'mode=@1;', 'MaskValueString', 'smooth', ...\n  \
             'MaskDescription', '{described}');\n\
             set_param(table, 'Parameters', 'mode');\n\
             save_system(library, fullfile(here, [library '.slx']));\n\
             close_system(library);\n\n\
             \x20 function ports(kind, listed, left)\n  \
             for n = 1:size(listed, 1)\n    \
             port = [block '/' listed{{n, 1}}];\n    \
             top = 40 * n;\n    \
             add_block(['built-in/' kind], port, 'Position', [left top left + 30 top + 14]);\n    \
             set_param(port, 'Port', int2str(n), 'Unit', listed{{n, 2}});\n    \
             if strcmp(kind, 'Inport')\n      \
             add_line(block, sprintf('%s/1', listed{{n, 1}}), sprintf('table/%d', n));\n    \
             else\n      \
             add_line(block, sprintf('table/%d', n), sprintf('%s/1', listed{{n, 1}}));\n    \
             end\n  end\n  end\nend\n",
            version = comment(self.origin.version()),
            bottom = 60 + 40 * outputs.len(),
            ins = list(&inputs),
            outs = list(&outputs),
            described = matlab_string(
                "Figures of a contact over normal force and track curvature; out_of_range is 1 where an input was outside"
            ),
        );
        writer.write_all(text.as_bytes())?;
        Ok(())
    }

    /// What goes in and what comes out, with units; 1 for pure numbers.
    fn ports(&self) -> (Vec<Port>, Vec<Port>) {
        let mut inputs = vec![port("fz_n", "N"), port("curvature_1pm", "1/m")];
        if self.axes().is_sliding() {
            inputs.extend([port("v_mps", "m/s"), port("ice_c", "degC")]);
        }
        let of = |quantity: &Quantity| match quantity.unit() {
            "m2" => port(quantity.key(), "m^2"),
            unit => port(quantity.key(), unit),
        };
        let mut outputs: Vec<Port> = self.quantities().iter().map(of).collect();
        outputs.push(port("out_of_range", "1"));
        (inputs, outputs)
    }
}
