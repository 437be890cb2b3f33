//! Tables of runners that slide, over speed and temperature of the ice too.

mod files;
mod lookup;
mod programs;
mod sweep;
