//! An example for every command whose arguments have none.

use clap::Command;

/// Commands by their words, and the examples that their help ends with.
const EXAMPLES: [(&str, &str); 21] = [
    (
        "press",
        "Examples:
  kufe press                          the built-in runner, into out/
  kufe press case.toml -o bob/        a case of your own
  kufe press case.toml --json -q      figures on standard output",
    ),
    (
        "hull",
        "Examples:
  kufe hull bob -o bob.obj            a bobsled runner
  kufe hull luge -o luge.stl          a luge steel",
    ),
    (
        "hull bob",
        "Examples:
  kufe hull bob -o bob.obj --rocker-radius-m 25
  kufe hull bob -o bob.glb --rocker-points rocker.csv",
    ),
    (
        "hull luge",
        "Example:
  kufe hull luge -o luge.obj --tilt-rad 0.01 --edge-radius-m 0.0005",
    ),
    (
        "hull check",
        "Examples:
  kufe hull check scan.stl                            unit, axes, radii, spacing, noise, and the loads that it resolves
  kufe hull check scan.stl --fz-n 800 -o case.toml    and the case that reads it so, at this load",
    ),
    (
        "mesh",
        "Example:
  kufe mesh case.toml -o mesh/        ice.vtu, runner.vtu and what their cells are like",
    ),
    (
        "info",
        "Examples:
  kufe info bob.obj                   a hull's size, holes and warnings
  kufe info out/pressure.exr          a map's channels and place
  kufe info front.lut --json          a table's axes, ranges and errors",
    ),
    (
        "lut show",
        "Example:
  kufe lut show front.lut --quantity area -o area.png",
    ),
    (
        "lut query",
        "Examples:
  kufe lut query front.lut --fz-n 1800 --radius-m 40
  kufe lut query front.lut --fz-n 1800 --v-mps 30 --pitch-rate-radps -0.8 --json",
    ),
    (
        "lut export",
        "Example:
  kufe lut export front.lut --csv --header=front.h",
    ),
    (
        "export",
        "Examples:
  kufe export case.toml --calculix deck.inp        an input deck of CalculiX
  kufe export case.toml --stiffness K.mtx          the stiffness as a sparse matrix",
    ),
    (
        "lut plan",
        "Example:
  kufe lut plan table.toml -o plan/ --shards 50",
    ),
    (
        "lut run",
        "Example:
  kufe lut run plan/ --shard 7/50",
    ),
    (
        "lut merge",
        "Example:
  kufe lut merge plan/ -o front.lut",
    ),
    (
        "friction fit",
        "Example:
  kufe friction fit experiments.csv -o fit/",
    ),
    (
        "icehouse",
        "Example:
  kufe icehouse glides.csv -o icehouse/",
    ),
    (
        "fit lateral",
        "Example:
  kufe fit lateral runs.csv --model model.toml -o fit/",
    ),
    (
        "discover",
        "Examples:
  kufe discover runs.csv --model model.toml -o finding/
  kufe discover pressures.csv --model case.toml -o finding/
  kufe discover campaign.toml -o finding/  runs, experiments and pressures that belong together, in one search
  kufe report finding/ -o finding.html",
    ),
    (
        "doctor",
        "Example:
  kufe doctor --json",
    ),
    (
        "completions",
        "Example:
  kufe completions bash               print it; source it, or save it where your shell expects it",
    ),
    (
        "man",
        "Example:
  kufe man -o man/                    then: man ./man/kufe.1",
    ),
];

/// The command with every example in its help.
pub fn added(mut command: Command) -> Command {
    for (words, examples) in EXAMPLES {
        let words: Vec<&str> = words.split(' ').collect();
        command = at(command, &words, examples);
    }
    command
}

fn at(command: Command, words: &[&str], examples: &str) -> Command {
    let Some((first, rest)) = words.split_first() else {
        // What the command itself says after its help stays.
        let more = match command.get_after_help() {
            Some(own) => format!("{examples}\n\n{own}"),
            None => examples.to_string(),
        };
        return command.after_help(more);
    };
    command.mut_subcommand(first, |inner| at(inner, rest, examples))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::Cli;
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
