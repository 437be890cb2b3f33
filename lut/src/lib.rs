//! Lookup tables of contact pressure over normal force and track curvature.
