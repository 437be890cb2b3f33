//! How a friction fit fails.

use kufe::jobs::Failure;

/// A library's error as the command's.
pub fn failure(error: &kufe_sled::friction::Error) -> Failure {
    match error {
        kufe_sled::friction::Error::NotConverged { .. } => Failure::NotConverged(error.to_string()),
        _ => Failure::bad_input(error),
    }
}
