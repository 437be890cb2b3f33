//! How a friction fit fails.

use kufe_jobs::Failure;

/// A library's error as the command's.
pub fn failure(error: &kufe_friction::Error) -> Failure {
    match error {
        kufe_friction::Error::NotConverged { .. } => Failure::NotConverged(error.to_string()),
        _ => Failure::bad_input(error),
    }
}
