//! The command's reference as one page of Markdown: every `--help` there is.

use std::fmt::Write;

use clap::{Arg, Command};

/// A section a command, its help as `--help` prints it, without the options that every command has.
pub fn page(command: &Command) -> String {
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
