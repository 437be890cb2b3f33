//! The command itself.

use std::io::Read;
use std::process::{Command, Stdio};

#[test]
fn a_reader_that_has_seen_enough_of_the_list_may_go_away() {
    let mut list = Command::new(env!("CARGO_BIN_EXE_blind"))
        .arg("list")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(list.stdout.take());
    let mut printed = String::new();
    let mut errors = list.stderr.take().unwrap();
    errors.read_to_string(&mut printed).unwrap();
    let status = list.wait().unwrap();
    assert!(
        status.success() && printed.is_empty(),
        "{status}: {printed}"
    );
}
