//! A table as a C99 header: arrays, and functions that evaluate them.

use std::fmt::Write as _;
use std::io::Write;

use crate::axes::AxisKind;
use crate::error::Error;
use crate::export::escape::{comment, identifier};
use crate::interpolator::{Breakpoints, Interpolator, Mode};
use crate::table::Table;

/// The axes that stack layers, with their names in C.
pub(crate) const LAYER_AXES: [(AxisKind, &str); 2] =
    [(AxisKind::Speed, "v"), (AxisKind::IceTemperature, "ice_c")];

/// The evaluation in C, shared by headers and FMUs.
pub(crate) const EVALUATION: &str = include_str!("../../c/kufe_lut.h");

/// The functions of a table in C: one for each quantity and mode, and one with derivatives.
pub(crate) struct Symbols {
    /// The table's name as an identifier, the prefix of the functions' names.
    pub name: String,
    /// Arguments in order.
    pub arguments: &'static [&'static str],
    /// Names, without the prefix, of the functions that return `kufe_lut_interpolated`. With
    /// [`DERIVATIVES`] appended they return `kufe_lut_derivatives`.
    pub functions: Vec<String>,
}

impl Symbols {
    /// The arguments with their type.
    pub(crate) fn declared(&self) -> String {
        let declared = self.arguments.iter();
        let declared: Vec<String> = declared.map(|name| format!("double {name}")).collect();
        declared.join(", ")
    }
}

/// Suffix of the functions that also return derivatives.
pub(crate) const DERIVATIVES: &str = "_derivatives";

/// Fields of `kufe_lut_derivatives`, all of type double, before its flag `out_of_range`.
pub(crate) const FIELDS: [&str; 5] = ["value", "d_fz", "d_curvature", "d_v", "d_ice_c"];

impl Table {
    /// The functions of the header of this name.
    pub(crate) fn symbols(&self, name: &str) -> Symbols {
        let functions = self.quantities().iter().flat_map(|quantity| {
            Mode::ALL.map(|mode| format!("{}_{}", quantity.name(), mode.name()))
        });
        Symbols {
            name: identifier(name),
            arguments: if self.axes().is_sliding() {
                &["fz", "curvature", "v", "ice_c"]
            } else {
                &["fz", "curvature"]
            },
            functions: functions.collect(),
        }
    }

    /// Writes a C99 header with all quantities: `NAME_QUANTITY_bilinear(fz, curvature)` and
    /// `NAME_QUANTITY_smooth(fz, curvature)` return a value and the out-of-range flag, and with the
    /// suffix `_derivatives` also the first derivatives. They need only `libm`. If the table has
    /// speeds or temperatures of the ice, the arguments are `(fz, curvature, v, ice_c)`.
    ///
    /// Macros state the range and the rule of every axis (`NAME_FZ_N_MIN`, `_MAX`, `_OUTSIDE`), and
    /// `NAME_QUANTITY_errors` the measured errors. `KUFE_LUT_SHARED` exports the functions from a
    /// shared library.
    ///
    /// `name` becomes a C identifier; several such headers fit into one program. `rocker_radius` is
    /// a breakpoint of the rocker axis, if the table has one [m].
    ///
    /// # Errors
    /// [`Error::RockerNeeded`] and [`Error::Invalid`] as [`Interpolator::new`];
    /// [`Error::Stream`].
    pub fn write_header(
        &self,
        name: &str,
        rocker_radius: Option<f64>,
        writer: &mut dyn Write,
    ) -> Result<(), Error> {
        rocker_on_axis(self, rocker_radius)?;
        let symbols = self.symbols(name);
        let name = &symbols.name;
        let guard = format!("KUFE_LUT_TABLE_{}_H", name.to_uppercase());
        let mut text = self.header_comment(name, rocker_radius)?;
        text += &format!("#ifndef {guard}\n#define {guard}\n\n{EVALUATION}\n");
        text += &self.ranges(name);
        let smooth = Interpolator::new(self, self.judged(), Mode::Smooth, rocker_radius)?;
        let surface = [(AxisKind::Fz, "fz"), (AxisKind::Curvature, "curvature")];
        for (kind, axis) in surface.into_iter().chain(LAYER_AXES) {
            text += &axis_of(smooth.axis(kind), &format!("{name}_{axis}"));
        }
        let flush = match self.axes().flush() {
            None => "0".to_string(),
            Some(flush) => {
                array(&mut text, &format!("{name}_flush"), &flush.numbers());
                format!("{name}_flush")
            }
        };
        let declared = symbols.declared();
        let passed = match symbols.arguments.len() {
            2 => "fz, curvature, 0.0, 0.0",
            _ => "fz, curvature, v, ice_c",
        };
        for &quantity in self.quantities() {
            let symbol = format!("{name}_{}", quantity.name());
            let smooth = Interpolator::new(self, quantity, Mode::Smooth, rocker_radius)?;
            text += &format!("/* {} [{}] */\n", quantity.key(), quantity.unit());
            array(&mut text, &format!("{symbol}_values"), &smooth.values);
            array(&mut text, &format!("{symbol}_jets"), &smooth.flat_jets());
            let mut errors = vec![self.solver_error_of(quantity)];
            for mode in [Mode::Smooth, Mode::Bilinear] {
                let measured = self.interpolation_error(quantity, mode)?;
                errors.push(measured.map(|measured| measured.max));
            }
            let number = |error: f64| format!("{error:e}");
            let errors = errors.into_iter();
            let errors = errors.map(|error| error.map_or("(double)NAN".into(), number));
            let errors: Vec<String> = errors.collect();
            text += &format!(
                "static KUFE_LUT_UNUSED const kufe_lut_errors {symbol}_errors = {{ {} }};\n\
                 static KUFE_LUT_UNUSED const kufe_lut_table {symbol} = {{ &{name}_fz, &{name}_curvature, &{name}_v, \
                 &{name}_ice_c, {flush}, {symbol}_values, {symbol}_jets, {} }};\n",
                errors.join(", "),
                u8::from(smooth.logarithmic)
            );
            for mode in Mode::ALL {
                let function = format!("{symbol}_{}", mode.name());
                let smooth = u8::from(mode == Mode::Smooth);
                text += &format!(
                    "KUFE_LUT_API kufe_lut_interpolated {function}({declared}) {{\n  \
                     return kufe_lut_at(&{symbol}, {passed}, {smooth});\n}}\n\
                     KUFE_LUT_API kufe_lut_derivatives {function}{DERIVATIVES}({declared}) {{\n  \
                     return kufe_lut_derivatives_at(&{symbol}, {passed}, {smooth});\n}}\n"
                );
            }
            text.push('\n');
        }
        text += &format!("#endif /* {guard} */\n");
        writer.write_all(text.as_bytes())?;
        Ok(())
    }

    /// Macros with range and rule of each axis of the functions.
    fn ranges(&self, name: &str) -> String {
        let name = name.to_uppercase();
        let axes = self.axes();
        let kinds = AxisKind::ALL.into_iter();
        let kinds = kinds.filter(|kind| *kind != AxisKind::RockerRadius);
        let ranges = kinds.filter_map(|kind| {
            let [low, high] = axes.range(kind, axes.fz()[0])?;
            let key = kind.key().to_uppercase();
            let rule = axes.outside(kind).name().to_uppercase();
            Some(format!(
                "#define {name}_{key}_MIN {low:e}\n#define {name}_{key}_MAX {high:e}\n\
                 #define {name}_{key}_OUTSIDE KUFE_LUT_{rule}\n"
            ))
        });
        ranges.collect()
    }

    fn header_comment(&self, name: &str, rocker_radius: Option<f64>) -> Result<String, Error> {
        let sliding = ", speed v [m/s] and ice_c [C]";
        let sliding = Some(sliding).filter(|_| self.axes().is_sliding());
        let mut text = format!(
            "/* Lookup table {name}: contact figures over normal force [N] and track curvature [1/m]{}.\n   \
             kufe {}, case sha256 {}.\n   {}: estimated solver error {:.2e} (relative)",
            sliding.unwrap_or_default(),
            comment(self.origin.version()),
            comment(self.origin.case_sha256()),
            self.judged().title(),
            self.solver_error()
        );
        for mode in Mode::ALL {
            if let Some(measured) = self.interpolation_error(self.judged(), mode)? {
                text += &format!(", {} interpolation error {:.2e}", mode.name(), measured.max);
            }
        }
        if let Some(radius) = rocker_radius {
            text += &format!(".\n   Rocker radius {radius} m");
        }
        Ok(text + ". */\n")
    }
}

/// C definition of an axis with its arrays; without breakpoints for an absent axis.
fn axis_of(points: Option<&Breakpoints>, name: &str) -> String {
    let mut text = String::new();
    let definition = match points {
        None => "{ 0, 0, 0, 0, 0, 0 }".to_string(),
        Some(points) => {
            array(&mut text, &format!("{name}_values"), &points.plain);
            let mut names = [format!("{name}_values"), "0".into()];
            if points.scaled != points.plain {
                names[0] = format!("{name}_scaled");
                array(&mut text, &names[0], &points.scaled);
            }
            // An axis of one breakpoint has no cell, and C has no empty arrays.
            if !points.slopes.is_empty() {
                names[1] = format!("{name}_slopes");
                array(&mut text, &names[1], &points.slopes.concat().concat());
            }
            let [scaled, slopes] = names;
            format!(
                "{{ {}, KUFE_LUT_{}, {}, {name}_values, {scaled}, {slopes} }}",
                points.plain.len(),
                points.outside.name().to_uppercase(),
                u8::from(points.kind.is_logarithmic()),
            )
        }
    };
    text + &format!("static KUFE_LUT_UNUSED const kufe_lut_axis {name} = {definition};\n")
}

/// An export has no rocker axis: the radius must be a breakpoint.
pub(crate) fn rocker_on_axis(table: &Table, rocker_radius: Option<f64>) -> Result<(), Error> {
    match (table.axes().rocker_radius(), rocker_radius) {
        (Some(radii), Some(value)) if !radii.contains(&value) => {
            let list: Vec<String> = radii.iter().map(f64::to_string).collect();
            let span = format!("{} m, and an export takes one of these", list.join(", "));
            Err(Error::rocker_outside(value, &span))
        }
        _ => Ok(()),
    }
}

fn array(text: &mut String, name: &str, values: &[f64]) {
    *text += &format!(
        "static KUFE_LUT_UNUSED const double {name}[{}] = {{",
        values.len()
    );
    for (n, value) in values.iter().enumerate() {
        *text += if n % 6 == 0 { "\n  " } else { " " };
        // The shortest text that reads back as equal bits; writing to a String cannot fail.
        let _ = write!(text, "{value:e},");
    }
    *text += "\n};\n";
}
