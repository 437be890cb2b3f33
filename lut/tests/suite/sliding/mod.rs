//! Tables of runners that slide, over speed and temperature of the ice too.

mod lookup;
mod programs;
mod sweep;
