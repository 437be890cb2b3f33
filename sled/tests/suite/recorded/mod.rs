//! Files of runs: good ones come back, faulty ones are refused by name, and what has gaps is used
//! without them.

mod bad_input;
mod conditions;
mod examined;
mod formats;
mod gaps;
mod needs;
