//! Other worlds: runs by a second generator, in which the data are wrong the way real data are.
//!
//! The sled is the published one, but everything that makes data of it is written anew: the road
//! turns by rotation matrices, the equations of motion are those of speed, course and yaw,
//! integrated at the rate of a logger by a predictor and a corrector, and the recorders have
//! delays, filters, scales and biases of their own. A world states what is wrong in it besides noise;
//! an effect may be hidden there or not.
//!
//! | world | what is wrong |
//! |---|---|
//! | `clean` | noise alone |
//! | `delays` | every channel is late by 0 to 20 ms of its own |
//! | `gyros` | gyroscopes read 1 % and 2 mrad/s (standard deviations) off |
//! | `body` | inertias 10 %, the centre of gravity 3 cm off |
//! | `curvature` | the track's curvature 10 % off |
//! | `lines` | each driver takes a line of his own up the banks |
//! | `sessions` | friction and grip scatter by 5 % from session to session |
//! | `filters` | coloured noise through anti-alias filters, stated wrongly by a factor of two |
//! | `coloured` | noise of a colour of each channel's own, through anti-alias filters or none, which nobody states |
//! | `bare` | no column and no track table beyond what is required |
//! | `few` | six to ten runs |
//! | `many` | forty runs |
//! | `walls` | some runs hit a wall somewhere, harder or softer |
//! | `uphill` | the track tables count slope uphill |
//!
//! `W-effect/CASE` hides an effect of a size that somebody who looks for it would meet;
//! `W-effect/CASE@0.02` one that leaves 2 % of the noise's variance when base and installation are
//! fitted again, or as much as its bounds let it.
//!
//! In the worlds of `recovery` noise is 0, 0.1, 1 and 10 % of what each channel spreads in a run,
//! and nobody states it.
//!
//! Hidden in any world may be `wall-contact-by-run` and `wall-contact-by-driver`: one to six places
//! that 20 to 80 % of the runs hit, with lognormal strengths, or each driver in a way of his own.

mod build;
mod effects;
mod files;
mod gauge;
mod hidden;
mod plan;
mod recorder;
mod ride;
mod road;
mod runners;
mod walls;
mod wrong;

pub use build::build;
pub use effects::{EFFECTS, sized};
pub use hidden::Effect;
pub use wrong::{LEVELS, WORLDS, World};
