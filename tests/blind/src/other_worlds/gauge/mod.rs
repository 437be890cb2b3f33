//! How large a hidden effect is: what of it stays when base and installation are fitted again, over
//! the noise's variance.

mod installation;
mod inversion;
mod share;

pub use share::{Gauge, Start};
