//! Formulas of named columns, for effects that a person adds: read once, then evaluated by index.

mod formula;
mod parser;

pub use formula::Expression;
pub use parser::ExpressionError;
