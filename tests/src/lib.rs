//! Verification suite.
