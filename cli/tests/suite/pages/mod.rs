//! Pages to look at, in a browser where there is one.

mod browser;
mod finding;
mod hostile;
mod report;
mod results;
mod runs;
mod view;
