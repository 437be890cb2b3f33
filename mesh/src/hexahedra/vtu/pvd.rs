//! Series of VTU files as PVD files.

use std::io::Write;

/// Writes a PVD file, which ParaView opens as time: pairs of time (or load, or whatever is stepped) and file.
///
/// # Errors
/// Those of the writer.
pub fn write_pvd(steps: &[(f64, &str)], mut writer: impl Write) -> std::io::Result<()> {
    writeln!(writer, "<?xml version=\"1.0\"?>")?;
    writeln!(
        writer,
        "<VTKFile type=\"Collection\" version=\"0.1\" byte_order=\"LittleEndian\">"
    )?;
    writeln!(writer, "  <Collection>")?;
    for &(time, file) in steps {
        let file = quick_xml::escape::escape(file);
        writeln!(
            writer,
            "    <DataSet timestep=\"{time}\" part=\"0\" file=\"{file}\"/>"
        )?;
    }
    writeln!(writer, "  </Collection>")?;
    writeln!(writer, "</VTKFile>")
}
