//! What a command prints.

use std::io::{ErrorKind, Write};
use std::sync::OnceLock;

use kufe::jobs::Failure;

/// Why standard output takes no more.
static LOST: OnceLock<std::io::Error> = OnceLock::new();

/// Prints on standard output.
///
/// Where that takes no more, the command continues its work and fails at its end, in [`all_said`].
pub fn say(text: &str) {
    if LOST.get().is_some() {
        return;
    }
    let mut out = std::io::stdout().lock();
    let text = printable(text);
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        let _ = LOST.set(error);
    }
}

/// Prints a line on standard error, after the command's name.
///
/// A text of several lines is indented, so that each line of its own begins with `kufe: `.
/// What standard error does not take is lost, and no failure.
pub fn note(text: &str) {
    let text = printable(text).trim_end().replace('\n', "\n  ");
    let _ = writeln!(std::io::stderr().lock(), "kufe: {text}");
}

/// Prints a warning on standard error.
pub fn warn(text: &str) {
    note(&format!("warning: {text}"));
}

/// Whether standard output has taken all; a reader that has read enough is no failure.
///
/// # Errors
/// [`Failure::BadInput`] with the reason where something was lost.
pub fn all_said() -> Result<(), Failure> {
    match LOST.get() {
        Some(error) if error.kind() != ErrorKind::BrokenPipe => Err(Failure::BadInput(format!(
            "standard output: cannot be written: {error}"
        ))),
        _ => Ok(()),
    }
}

/// The text with control characters escaped, which names in foreign files may have: they would
/// change the terminal or the direction of writing. Line breaks and tabulators are unchanged.
fn printable(text: &str) -> String {
    let mut shown = String::with_capacity(text.len());
    for c in text.chars() {
        let harmless = matches!(c, '\n' | '\t') || !c.is_control();
        let reorders = matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
        if harmless && !reorders {
            shown.push(c);
        } else {
            shown.extend(c.escape_unicode());
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::printable;

    #[test]
    fn control_characters_are_escaped() {
        assert_eq!(printable("Königssee 5 µm\n\ta"), "Königssee 5 µm\n\ta");
        for c in [
            '\u{1b}', '\r', '\u{7f}', '\u{85}', '\u{9b}', '\u{202e}', '\0',
        ] {
            assert!(!printable(&format!("a{c}b")).contains(c), "{c:?}");
        }
    }
}
