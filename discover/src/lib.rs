//! Finds where simulation and measurement disagree, names the missing effect and adds it.
