//! A table as a C99 header: its arrays and the functions that evaluate them.

use std::fmt::Write as _;
use std::io::Write;

use crate::axes::AxisKind;
use crate::error::Error;
use crate::export::escape::{comment, identifier};
use crate::interpolator::{Interpolator, LayerAxis, Mode};
use crate::table::Table;

/// The axes along which layers lie, as C code has them.
pub(crate) const LAYER_AXES: [(AxisKind, &str); 2] =
    [(AxisKind::Speed, "v"), (AxisKind::IceTemperature, "ice")];

/// The evaluation in C, shared by headers and FMUs.
pub(crate) const EVALUATION: &str = include_str!("../../c/kufe_lut.h");

impl Table {
    /// Writes a C99 header with all quantities: `NAME_QUANTITY_bilinear(fz, curvature)` and
    /// `NAME_QUANTITY_smooth(fz, curvature)` return a value and the out-of-range flag; nothing else
    /// is needed to use them but `libm`. Where the table has speeds or temperatures of the ice the
    /// functions take `(fz, curvature, v, ice_c)`.
    ///
    /// `name` becomes a C identifier; several such headers fit into one program. `rocker_radius`
    /// chooses a breakpoint of the rocker axis where the table has one [m].
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
        let name = identifier(name);
        let guard = format!("KUFE_LUT_TABLE_{}_H", name.to_uppercase());
        let fz = self.axes().fz();
        let curvature = self.axes().curvature();
        let log_fz: Vec<f64> = fz.iter().map(|fz| fz.ln()).collect();
        let mut text = self.header_comment(&name, rocker_radius)?;
        text += &format!("#ifndef {guard}\n#define {guard}\n\n{EVALUATION}\n");
        array(&mut text, &format!("{name}_fz"), fz);
        array(&mut text, &format!("{name}_log_fz"), &log_fz);
        array(&mut text, &format!("{name}_curvature"), curvature);
        let flush = match self.axes().flush() {
            None => "0".to_string(),
            Some(flush) => {
                array(&mut text, &format!("{name}_flush"), &flush.numbers());
                format!("{name}_flush")
            }
        };
        let layered = self.axes().is_sliding();
        if layered {
            let smooth = Interpolator::new(self, self.judged(), Mode::Smooth, rocker_radius)?;
            for (kind, axis) in LAYER_AXES {
                text += &layer_axis(smooth.layer_axis(kind), &format!("{name}_{axis}"));
            }
        }
        for &quantity in self.quantities() {
            let own = format!("{name}_{}", quantity.name());
            let smooth = Interpolator::new(self, quantity, Mode::Smooth, rocker_radius)?;
            text += &format!("/* {} [{}] */\n", quantity.key(), quantity.unit());
            array(&mut text, &format!("{own}_values"), smooth.values());
            array(&mut text, &format!("{own}_jets"), &smooth.flat_jets());
            let table = format!(
                "{{ {}, {}, {name}_fz, {name}_log_fz, {name}_curvature, {flush}, {own}_values, {own}_jets, {} }}",
                fz.len(),
                curvature.len(),
                u8::from(smooth.is_logarithmic())
            );
            let (kind, table, further, given) = if layered {
                let table = format!("{{ {table}, &{name}_v, &{name}_ice }}");
                ("layers", table, ", double v, double ice_c", ", v, ice_c")
            } else {
                ("table", table, "", "")
            };
            text += &format!("static KUFE_LUT_UNUSED const kufe_lut_{kind} {own} = {table};\n");
            let of_layers = if layered { "layers_" } else { "" };
            for mode in Mode::ALL.map(Mode::name) {
                text += &format!(
                    "static KUFE_LUT_UNUSED kufe_lut_interpolated {own}_{mode}(double fz, double curvature{further}) {{\n  \
                     return kufe_lut_{of_layers}{mode}(&{own}, fz, curvature{given});\n}}\n"
                );
            }
            text.push('\n');
        }
        text += &format!("#endif /* {guard} */\n");
        writer.write_all(text.as_bytes())?;
        Ok(())
    }

    fn header_comment(&self, name: &str, rocker_radius: Option<f64>) -> Result<String, Error> {
        let mut text = format!(
            "/* Lookup table {name}: contact figures over normal force [N] and track curvature [1/m]{}.\n   \
             kufe {}, case sha256 {}.\n   {}: estimated solver error {:.2e} (relative)",
            if self.axes().is_sliding() {
                ", speed v [m/s] and ice_c [C]"
            } else {
                ""
            },
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

/// An axis of layers with its arrays.
fn layer_axis(axis: Option<&LayerAxis>, name: &str) -> String {
    let mut text = String::new();
    let definition = match axis {
        None => "{ 0, 0, 0, 0, 0 }".to_string(),
        Some(axis) => {
            array(&mut text, &format!("{name}_values"), &axis.points.plain);
            array(&mut text, &format!("{name}_scaled"), &axis.points.scaled);
            let mut slopes = axis.slopes.concat().concat();
            // One breakpoint has no cell, and C no empty array.
            slopes.resize(slopes.len().max(1), 0.0);
            array(&mut text, &format!("{name}_slopes"), &slopes);
            format!(
                "{{ {}, {name}_values, {name}_scaled, {name}_slopes, {} }}",
                axis.points.plain.len(),
                u8::from(axis.points.kind.is_logarithmic())
            )
        }
    };
    text + &format!("static KUFE_LUT_UNUSED const kufe_lut_axis {name} = {definition};\n")
}

/// An export has no rocker axis: its radius must be a breakpoint.
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
        // Shortest text that reads back as the same bits; writing to a String cannot fail.
        let _ = write!(text, "{value:e},");
    }
    *text += "\n};\n";
}
