//! Files of recorded runs: valid files are read, faulty files are refused by name, gaps are
//! excluded.

mod bad_input;
mod conditions;
mod examined;
mod formats;
mod gaps;
mod needs;
