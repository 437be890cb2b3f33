//! Steady sliding on ice that yields: the groove that the runner leaves, and the force that ploughs
//! it.
//!
//! Ice comes towards the runner from the front, +x. It yields where the pressure reaches its
//! hardness H, keeps its plastic depth u_p on the way back, and springs back elastically:
//!
//! ```text
//! 0 <= p <= H,   gap = h - N q + u_e(p) + u_p >= 0,   p gap = 0
//! u_p never falls towards the back, and p = H where it grows
//! ```
//!
//! `plastic_contact` solves that on the contact plane for a given response of the bodies and a
//! given motion, and lets the bodies on their mesh correct the response. `on_mesh` finds the motion
//! that carries the load. `measures` finds where the patch ends below the cell and reads the
//! groove. `sequence` goes from mesh to mesh.

pub(crate) mod measures;
pub(crate) mod on_mesh;
pub(crate) mod plastic_contact;
pub(crate) mod sequence;
pub(crate) mod solution;
