//! Tables from outside the crate, each chapter a module.

mod c;
mod c_header;
mod fmu;
mod hertz;
mod lookup;
mod lut_files;
mod python;
mod python_reads;
mod shards;
mod simulink;
mod sliding;
mod sweep;
mod tables;
