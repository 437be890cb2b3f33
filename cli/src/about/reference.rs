//! The command's reference as one page of Markdown: every `--help` there is.

use std::fmt::Write;

use clap::Command;

/// A section a command, its help as `--help` prints it.
pub fn page(command: &Command) -> String {
    let mut built = command.clone();
    built.build();
    let mut page = String::from(
        "# The command\n\nWritten by `kufe man --markdown` from each command's `--help`.\n\n\
         Exit codes: 0 done; 2 wrong arguments; 3 bad input, or output that cannot be written; 4 accuracy not reached; \
         5 partly done, the same command resumes. An output folder receives all of its files or none.\n",
    );
    section(&mut page, command, &built, vec!["kufe".to_owned()]);
    page
}

fn section(page: &mut String, root: &Command, command: &Command, words: Vec<String>) {
    let asked = words.iter().cloned().chain(["--help".to_owned()]);
    if let Err(help) = root.clone().try_get_matches_from(asked) {
        let help = help.render().to_string();
        let lines: Vec<&str> = help.trim_end().lines().map(str::trim_end).collect();
        // Writing to a String cannot fail.
        let _ = write!(
            page,
            "\n## {}\n\n```text\n{}\n```\n",
            words.join(" "),
            lines.join("\n")
        );
    }
    for sub in command.get_subcommands() {
        if sub.get_name() != "help" && !sub.is_hide_set() {
            let words = words.iter().cloned().chain([sub.get_name().to_owned()]);
            section(page, root, sub, words.collect());
        }
    }
}
