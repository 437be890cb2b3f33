//! What can be wrong with the effects of a model.

use crate::effects::expression::ExpressionError;

/// What is wrong with an `[effects.NAME]` table.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EffectError {
    /// The name is neither in the catalogue nor an expression.
    #[error(
        "[effects.{name}]: unknown effect; expected one of {known}, or a table with `expression`"
    )]
    UnknownEffect {
        /// The name found.
        name: String,
        /// All names.
        known: String,
    },
    /// A key that the effect does not have.
    #[error("[effects.{name}]: unknown key `{key}`; expected {expected}")]
    UnknownKey {
        /// The effect.
        name: String,
        /// The key found.
        key: String,
        /// The keys it has.
        expected: String,
    },
    /// A value of the wrong type or out of bounds.
    #[error("[effects.{name}]: `{key}` = {found}; expected {expected}")]
    Value {
        /// The effect.
        name: String,
        /// The key.
        key: String,
        /// What stands there.
        found: String,
        /// What may stand there.
        expected: String,
    },
    /// The expression cannot be read.
    #[error("[effects.{name}]: `expression` {source}")]
    Expression {
        /// The effect.
        name: String,
        /// Where it stops making sense.
        source: ExpressionError,
    },
    /// A column that an effect needs is neither recorded nor stated.
    #[error(
        "[effects.{name}]: needs the column {column}, which is neither recorded nor stated; found {found}"
    )]
    MissingColumn {
        /// The effect.
        name: String,
        /// The column.
        column: String,
        /// The columns that there are.
        found: String,
    },
}
