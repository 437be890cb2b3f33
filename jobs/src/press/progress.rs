//! How far a contact is.

use kufe_contact::Iterate;

/// One line while the solver works: the mesh in hand, and how far those before it are from the relative error `asked`.
pub fn progress_line(state: &Iterate, asked: f64) -> String {
    let so_far = state
        .error_before
        .map_or("not known yet".to_owned(), percent);
    format!(
        "mesh {}: {} unknowns, {} nodes touch, p_max {:.1} MPa, residual {:.0e}; error {so_far}, asked {}",
        state.level + 1,
        state.dofs,
        state.contact_nodes,
        state.p_max / 1e6,
        state.residual,
        percent(asked)
    )
}

/// A share in per cent with two digits at least.
pub fn percent(share: f64) -> String {
    let percent = 1e2 * share;
    match percent.abs() < 0.1 && percent != 0.0 {
        true => format!("{percent:.3} %"),
        false => format!("{percent:.2} %"),
    }
}
