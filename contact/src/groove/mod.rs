//! Steady sliding on ice that yields: the groove that the runner leaves, and the force that ploughs it.
//!
//! Ice comes towards the runner from the front, +x. It yields where the pressure reaches its hardness H, keeps its plastic
//! depth u_p on the way back, and springs back elastically:
//!
//! ```text
//! 0 <= p <= H,   gap = h - N q + u_e(p) + u_p >= 0,   p gap = 0
//! u_p never falls towards the back, and p = H where it grows
//! ```
//!
//! `memory` solves that on the contact plane for a given response of the bodies and a given motion, `load_balance` finds the
//! motion that carries the load, `elastic_response` lets the bodies on their mesh correct the response, `on_mesh` brings these
//! together, `rims` finds where the patch ends below the cell, `measures` reads the groove, `sequence` goes from mesh to mesh.

pub(crate) mod elastic_response;
pub(crate) mod errors;
pub(crate) mod load_balance;
pub(crate) mod measures;
pub(crate) mod memory;
pub(crate) mod on_mesh;
pub(crate) mod profile;
pub(crate) mod rims;
pub(crate) mod sequence;
pub(crate) mod slid;
pub(crate) mod slide;
pub(crate) mod solution;
