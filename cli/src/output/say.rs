//! What a command says on standard output.

use std::io::Write;

/// Prints on standard output; a reader that has gone away (`| head`) is no failure.
pub fn say(text: &str) {
    let _ = std::io::stdout().lock().write_all(text.as_bytes());
}
