//! The end of each command's help: examples and outputs.

use clap::Command;

/// The command with the sections of `examples.txt` in its help.
pub fn added(mut command: Command) -> Command {
    let sections = include_str!("examples.txt").split("## kufe").skip(1);
    for section in sections {
        let (words, examples) = section.split_once('\n').unwrap_or((section, ""));
        let words: Vec<&str> = words.split_whitespace().collect();
        command = at(command, &words, examples.trim_end());
    }
    command
}

fn at(command: Command, words: &[&str], examples: &str) -> Command {
    let Some((first, rest)) = words.split_first() else {
        return command.after_help(examples.to_owned());
    };
    command.mut_subcommand(first, |inner| at(inner, rest, examples))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cli;
    use clap::CommandFactory;

    /// The examples in a help text: lines that begin with two spaces and `kufe`, without the
    /// comments after them.
    fn lines(help: &str) -> Vec<Vec<String>> {
        help.lines()
            .filter_map(|line| line.strip_prefix("  kufe"))
            .map(|line| format!("kufe{}", line.split("  ").next().unwrap_or_default()))
            .map(|line| line.split_whitespace().map(str::to_string).collect())
            .collect()
    }

    fn check(command: &Command, path: &[&str], seen: &mut usize) {
        let help = command.get_after_help().map(ToString::to_string);
        let examples = lines(&help.unwrap_or_default());
        assert!(!examples.is_empty(), "kufe {path:?} has no example");
        let mut own = 0;
        for example in &examples {
            let parsed = added(Cli::command()).try_get_matches_from(example);
            assert!(parsed.is_ok(), "{example:?}: {}", parsed.unwrap_err());
            own += usize::from(
                example[1..]
                    .iter()
                    .zip(path)
                    .filter(|(a, b)| a == b)
                    .count()
                    == path.len(),
            );
        }
        assert!(own > 0, "kufe {path:?} has examples of other commands only");
        *seen += examples.len();
        for inner in command
            .get_subcommands()
            .filter(|inner| inner.get_name() != "help")
        {
            check(inner, &[path, &[inner.get_name()]].concat(), seen);
        }
    }

    #[test]
    fn every_command_has_an_example_that_parses() {
        let mut seen = 0;
        check(&added(Cli::command()), &[], &mut seen);
        assert!(seen > 30, "{seen} examples");
    }
}
