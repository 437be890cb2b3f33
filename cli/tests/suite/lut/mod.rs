//! Tables: solved, in shards, looked up, and compared with contacts solved separately.

mod held_out;
mod hertz;
mod shards;
mod sliding;
mod slurm;
mod table;
