//! Tables from outside the crate, each chapter a module.

mod bindings;
mod c;
mod c_header;
mod files;
mod fmu;
mod hertz;
mod lookup;
mod outside;
mod python;
mod python_reads;
mod safety;
mod simulink;
mod sliding;
mod sweep;
mod tables;
mod windows;
