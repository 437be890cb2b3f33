//! A table as a C99 header: its arrays and the functions that evaluate them.

use std::fmt::Write as _;
use std::io::Write;

use crate::error::Error;
use crate::table::lookup::Lookup;
use crate::table::mode::Mode;
use crate::table::nodes::Table;
use crate::table::quantity::Quantity;

/// The evaluation in C, shared by headers and FMUs.
pub(crate) const EVALUATION: &str = include_str!("../../c/kufe_lut.h");

impl Table {
    /// Writes a C99 header with all quantities: `NAME_QUANTITY_bilinear(fz, curvature)` and `NAME_QUANTITY_smooth(fz,
    /// curvature)` return a value and the out-of-range flag; nothing else is needed to use them but `libm`.
    ///
    /// `name` becomes a C identifier; several such headers fit into one program. `rocker_radius` chooses a
    /// breakpoint of the rocker axis where the table has one [m].
    ///
    /// # Errors
    /// [`Error::RockerNeeded`] and [`Error::RockerOutside`] as [`Lookup::with_rocker`]; [`Error::Write`].
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
        for quantity in Quantity::ALL {
            let own = format!("{name}_{}", quantity.name());
            let rough = Lookup::with_rocker(self, quantity, Mode::Bilinear, rocker_radius)?;
            let smooth = Lookup::with_rocker(self, quantity, Mode::Smooth, rocker_radius)?;
            let (_, jets, logarithmic) = smooth.parts();
            let jets: Vec<f64> = jets.iter().flat_map(|j| [j.f, j.fx, j.fy, j.fxy]).collect();
            text += &format!("/* {} [{}] */\n", quantity.key(), quantity.unit());
            array(&mut text, &format!("{own}_values"), rough.parts().0);
            array(&mut text, &format!("{own}_jets"), &jets);
            text += &format!(
                "static KUFE_LUT_UNUSED const kufe_lut_table {own} = {{ {}, {}, {name}_fz, {name}_log_fz, \
                 {name}_curvature, {flush}, {own}_values, {own}_jets, {} }};\n",
                fz.len(),
                curvature.len(),
                u8::from(logarithmic)
            );
            for mode in Mode::ALL.map(Mode::name) {
                text += &format!(
                    "static KUFE_LUT_UNUSED kufe_lut_looked {own}_{mode}(double fz, double curvature) {{\n  \
                     return kufe_lut_{mode}(&{own}, fz, curvature);\n}}\n"
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
            "/* Lookup table {name}: contact figures over normal force [N] and track curvature [1/m].\n   \
             kufe {}, case sha256 {}.\n   Peak pressure: estimated solver error {:.2e} (relative)",
            self.version.replace("*/", ""),
            self.case_sha256.replace("*/", ""),
            self.solver_error()
        );
        for mode in Mode::ALL {
            if let Some(measured) = self.interpolation_error(Quantity::PMax, mode)? {
                text += &format!(", {} interpolation error {:.2e}", mode.name(), measured.max);
            }
        }
        if let Some(radius) = rocker_radius {
            text += &format!(".\n   Rocker radius {radius} m");
        }
        Ok(text + ". */\n")
    }
}

/// The table's rocker radii hold no value between them for an export: they must be met.
pub(crate) fn rocker_on_axis(table: &Table, rocker_radius: Option<f64>) -> Result<(), Error> {
    match (table.axes().rocker_radius(), rocker_radius) {
        (Some(radii), Some(value)) if !radii.contains(&value) => {
            let list: Vec<String> = radii.iter().map(f64::to_string).collect();
            Err(Error::RockerOutside {
                value,
                span: format!("{} m, and an export takes one of these", list.join(", ")),
            })
        }
        _ => Ok(()),
    }
}

/// Letters, digits and underscores, not starting with a digit.
pub(crate) fn identifier(name: &str) -> String {
    let mut id: String = name
        .chars()
        .map(|c| if c.is_ascii_alphanumeric() { c } else { '_' })
        .collect();
    if id.is_empty() || id.starts_with(|c: char| c.is_ascii_digit()) {
        id.insert_str(0, "lut_");
    }
    id
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
