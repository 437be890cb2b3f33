//! `kufe completions` and `kufe man`: what a shell and `man` want to know of this command.

use std::path::PathBuf;

use clap::Command;
use clap_complete::Shell;
use kufe::jobs::Failure;

use crate::about::reference;
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

/// Writes kufe.1 and one page for each command, those within commands too: kufe-lut-query.1.
///
/// # Errors
/// [`Failure::BadInput`] where the folder cannot be written.
pub fn man(args: &ManArgs, global: &Global, mut command: Command) -> Result<(), Failure> {
    if let Some(path) = &args.markdown {
        let page = reference::page(&command);
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
    output.commit()?;
    if !global.quiet {
        say(&format!(
            "{} pages written to {}\n",
            pages.len(),
            args.out.display()
        ));
    }
    Ok(())
}

/// A command and all within it, each after the one that it belongs to, with its page's name.
fn below<'a>(pages: &mut Vec<(String, &'a Command)>, command: &'a Command, name: &str) {
    pages.push((name.to_owned(), command));
    for sub in command.get_subcommands() {
        if !sub.is_hide_set() {
            below(pages, sub, &format!("{name}-{}", sub.get_name()));
        }
    }
}
