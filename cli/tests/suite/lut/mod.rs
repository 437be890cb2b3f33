//! Tables: made, cut into shards, looked up, and held against contacts solved apart.

mod held_out;
mod hertz;
mod shards;
mod sliding;
mod slurm;
mod table;
