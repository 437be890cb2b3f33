//! Steady sliding on ice that yields: the groove of the runner, and the ploughing force.
//!
//! Relative to the runner, ice moves from the front, +x, to the back. It yields where the pressure
//! reaches its hardness H, keeps its plastic depth u_p towards the back, and recovers elastically:
//!
//! ```text
//! 0 <= p <= H,   gap = h - N q + u_e(p) + u_p >= 0,   p gap = 0
//! u_p never falls towards the back, and p = H where it grows
//! ```
//!
//! `plastic_contact` solves this on the contact plane for a given compliance of the bodies and a
//! given motion. `on_mesh` finds the motion that balances the load, and corrects the compliance by
//! the bodies on their mesh. `measures` computes the rims of the patch with sub-cell resolution and
//! the figures of the groove. `sequence` solves on a sequence of meshes.

pub(crate) mod measures;
pub(crate) mod on_mesh;
pub(crate) mod plastic_contact;
pub(crate) mod sequence;
pub(crate) mod solution;
