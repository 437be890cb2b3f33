//! Names of options: an option has one name and one help text in all commands.

use std::any::TypeId;
use std::collections::{BTreeMap, BTreeSet};

use clap::{Arg, Command, CommandFactory};

use crate::Cli;

/// Ending of an option's name for each unit that its help states, as in keys of files.
const ENDS: [(&str, &str); 11] = [
    ("m", "m"),
    ("N", "n"),
    ("rad", "rad"),
    ("1/m", "1pm"),
    ("m/s", "mps"),
    ("rad/s", "radps"),
    ("degrees Celsius", "c"),
    ("Pa", "pa"),
    ("%", "pct"),
    ("Hz", "hz"),
    ("s", "s"),
];

/// Numbers without a unit.
const PURE: [&str; 3] = ["confidence", "p-max", "skill"];

/// Options whose help may differ between commands: outputs, and the runs that are read or made.
const OWN: [&str; 9] = [
    "driver", "mat", "out", "run", "runs", "seed", "session", "strict", "track",
];

/// All long options with the path of the command that declares them; global ones at the root.
fn options() -> Vec<(String, Arg)> {
    fn below(command: &Command, path: &str, found: &mut Vec<(String, Arg)>) {
        let own = command
            .get_arguments()
            .filter(|arg| arg.get_long().is_some());
        found.extend(own.map(|arg| (path.to_owned(), arg.clone())));
        for inner in command.get_subcommands() {
            below(inner, &format!("{path} {}", inner.get_name()), found);
        }
    }
    let mut found = Vec::new();
    below(&Cli::command(), "kufe", &mut found);
    found
}

fn name(option: &Arg) -> &str {
    option.get_long().unwrap_or_default()
}

fn help(option: &Arg) -> String {
    option
        .get_help()
        .map(ToString::to_string)
        .unwrap_or_default()
}

/// The unit in brackets.
fn unit(help: &str) -> Option<&'static str> {
    let brackets = help
        .split('[')
        .skip(1)
        .filter_map(|rest| rest.split_once(']'));
    let mut ends = brackets.filter_map(|(text, _)| ENDS.iter().find(|(unit, _)| *unit == text));
    ends.next().map(|(_, end)| *end)
}

#[test]
fn a_quantity_is_named_with_its_unit_as_keys_of_files_are() {
    let mut quantities = BTreeSet::new();
    for (command, option) in options() {
        let (name, end) = (name(&option), unit(&help(&option)));
        let ends_in = |end: &str| name.ends_with(&format!("-{end}"));
        let named = ENDS.iter().find(|(_, end)| ends_in(end));
        assert_eq!(named.map(|(_, end)| *end), end, "{command} --{name}");
        let number = option.get_value_parser().type_id() == TypeId::of::<f64>();
        assert!(
            !number || end.is_some() || PURE.contains(&name),
            "{command} --{name}: a number without a unit"
        );
        quantities.extend(end.map(|_| name.to_owned()));
    }
    assert!(quantities.len() > 20, "{quantities:?}");
}

#[test]
fn no_option_has_a_second_name_or_is_hidden() {
    for (command, option) in options() {
        let aliases = option.get_all_aliases().unwrap_or_default();
        assert!(aliases.is_empty(), "{command} --{}", name(&option));
        assert!(!option.is_hide_set(), "{command} --{}", name(&option));
    }
}

#[test]
fn a_name_has_one_letter_and_one_meaning() {
    let mut known: BTreeMap<String, (String, Option<char>, String)> = BTreeMap::new();
    for (command, option) in options() {
        let name = name(&option);
        let printed = help(&option);
        let meaning = if OWN.contains(&name) {
            ""
        } else {
            let first = printed.split([',', ';', ':', '.', '[', '(']).next();
            first.unwrap_or_default().trim()
        };
        let meaning = meaning.to_owned();
        let own = (command, option.get_short(), meaning);
        let first = known.entry(name.to_owned()).or_insert_with(|| own.clone());
        assert_eq!(
            (&first.1, &first.2),
            (&own.1, &own.2),
            "--{name} of {} and {}",
            first.0,
            own.0
        );
    }
    assert!(known.len() > 60, "{} options", known.len());
}
