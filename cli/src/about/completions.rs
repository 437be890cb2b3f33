//! `kufe completions` and `kufe man`: completion scripts for shells, and manual pages.

use std::fmt::Write;
use std::path::PathBuf;

use clap::{Arg, Command};
use clap_complete::Shell;
use kufe::jobs::Failure;

use crate::output::{OutputDir, write_file};
use crate::terminal::{Global, say};

/// Arguments of `kufe completions`.
#[derive(clap::Args, Debug)]
pub struct Args {
    /// The shell
    pub shell: Shell,
}

/// Prints the completion script of one shell on standard output.
///
/// # Errors
/// None.
pub fn run(args: &Args, mut command: Command) -> Result<(), Failure> {
    let mut script = Vec::new();
    clap_complete::generate(args.shell, &mut command, "kufe", &mut script);
    say(&String::from_utf8_lossy(&script));
    Ok(())
}

/// Arguments of `kufe man`.
#[derive(clap::Args, Debug)]
pub struct ManArgs {
    /// Folder for the manual pages
    #[arg(long, short, value_name = "FOLDER", default_value = "man")]
    pub out: PathBuf,
    /// Write the whole reference as one page of Markdown instead
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    pub markdown: Option<PathBuf>,
}

/// Writes kufe.1 and one page per command and subcommand, as kufe-lut-query.1.
///
/// # Errors
/// [`Failure::BadInput`] if the folder cannot be written.
pub fn man(args: &ManArgs, global: &Global, mut command: Command) -> Result<(), Failure> {
    if let Some(path) = &args.markdown {
        let page = reference(&command);
        return write_file("man", &[], path, page.as_bytes(), global);
    }
    command = command.disable_help_subcommand(true);
    command.build();
    let output = OutputDir::begin("man", &[], &args.out, global.force)?;
    let mut pages = Vec::new();
    below(&mut pages, &command, "kufe");
    for (name, page) in &pages {
        output.write(&format!("{name}.1"), |mut file| {
            clap_mangen::Man::new((*page).clone())
                .source(concat!("kufe ", env!("CARGO_PKG_VERSION")))
                .render(&mut file)
        })?;
    }
    let (count, out) = (output.commit()?.len(), args.out.display());
    if !global.quiet {
        say(&format!("{count} pages written to {out}\n"));
    }
    Ok(())
}

/// Appends a command and its subcommands, depth first, with the names of their pages.
fn below<'a>(pages: &mut Vec<(String, &'a Command)>, command: &'a Command, name: &str) {
    pages.push((name.to_owned(), command));
    for sub in command.get_subcommands() {
        if !sub.is_hide_set() {
            below(pages, sub, &format!("{name}-{}", sub.get_name()));
        }
    }
}

/// The reference page: one section per command with its help, without the global options.
fn reference(command: &Command) -> String {
    let mut built = command.clone();
    built.build();
    let version = env!("CARGO_PKG_VERSION");
    let mut page = format!(
        "# The command\n\nWritten by kufe {version} (`kufe man --markdown`) from each command's `--help`. The options under `kufe` itself are every \
         command's, and are listed only there.\n\n\
         Exit codes: 0 done; 2 wrong arguments; 3 bad input, or output that cannot be written; 4 accuracy not reached; \
         5 partly done, the same command resumes. An output folder receives all of its files or none.\n",
    );
    section(&mut page, &built, &["kufe"]);
    page
}

fn section(page: &mut String, command: &Command, words: &[&str]) {
    let common =
        |arg: &Arg| arg.is_global_set() || ["help", "version"].contains(&arg.get_id().as_str());
    let mut shown = command.clone();
    if words.len() > 1 {
        shown = shown.mut_args(|arg| if common(&arg) { arg.hide(true) } else { arg });
    }
    let help = shown.render_long_help().to_string();
    let lines: Vec<&str> = help.trim_end().lines().map(str::trim_end).collect();
    // Writing to a String cannot fail.
    let _ = write!(
        page,
        "\n## {}\n\n```text\n{}\n```\n",
        words.join(" "),
        lines.join("\n")
    );
    for sub in command.get_subcommands() {
        if sub.get_name() != "help" && !sub.is_hide_set() {
            section(page, sub, &[words, &[sub.get_name()]].concat());
        }
    }
}
