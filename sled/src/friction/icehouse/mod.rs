//! From gliding runs in an ice house to coefficients of friction by specimen.

pub mod glide_run;
pub mod glides;
pub mod line_fit;
pub mod specimens;
