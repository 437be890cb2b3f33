//! `kufe init`: a commented case to start from.

use std::path::PathBuf;

use crate::case_file::EXAMPLE;
use crate::failure::Failure;
use crate::output::{Global, say, write_whole};

/// Arguments of `kufe init`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The file to write
    #[arg(default_value = "case.toml")]
    pub file: PathBuf,
    /// Replace a file that exists
    #[arg(long)]
    pub force: bool,
}

/// Writes the built-in example with its comments.
///
/// # Errors
/// [`Failure::BadInput`] where the file exists or cannot be written.
pub fn run(args: &Args, global: &Global) -> Result<(), Failure> {
    let path = args.file.display();
    if args.file.exists() && !args.force {
        return Err(Failure::BadInput(format!(
            "{path}: exists already; --force replaces it"
        )));
    }
    write_whole(&args.file, |writer| writer.write_all(EXAMPLE.as_bytes()))?;
    if global.json {
        say(&format!("{}\n", serde_json::json!({ "file": args.file })));
    } else if !global.quiet {
        say(&format!(
            "{path} written; solve it with: kufe press {path} -o out/\n"
        ));
    }
    Ok(())
}
