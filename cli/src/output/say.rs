//! What a command says on standard output.

use std::io::Write;
use std::sync::OnceLock;

use kufe::jobs::Failure;

/// Why standard output took no more.
static LOST: OnceLock<String> = OnceLock::new();

/// Prints on standard output. Where that takes no more (a full device, a reader that has gone away) the command goes on with its
/// work and fails at its end, in [`all_said`].
pub fn say(text: &str) {
    if LOST.get().is_some() {
        return;
    }
    let mut out = std::io::stdout().lock();
    if let Err(error) = out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        let _ = LOST.set(error.to_string());
    }
}

/// Whether all that was said has been taken.
///
/// # Errors
/// [`Failure::BadInput`] with the reason where something was lost.
pub fn all_said() -> Result<(), Failure> {
    match LOST.get() {
        None => Ok(()),
        Some(reason) => Err(Failure::BadInput(format!(
            "standard output: cannot be written: {reason}"
        ))),
    }
}
