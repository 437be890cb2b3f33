//! Contacts against closed forms, textbooks and other programs.

mod asperities;
mod assembled;
mod boundary_elements;
mod burrs;
mod coverage;
mod energy;
mod hertz;
mod hostile;
mod ice;
mod methods;
mod mounts;
mod numerics;
mod shapes;
mod slender;
mod sliding;
mod solid;
mod stress;
